// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "relume/error.h"
#include "relume/rig.h"

namespace relume {
namespace {

constexpr Parameter kTable[] = {
    {.name = "exposure", .value = {0.5}, .min = -10, .max = 10, .unit = "stops"},
    {.name = "count", .type = ParameterType::integer, .value = {2}, .min = 0, .max = 9},
    {.name = "tint", .type = ParameterType::color, .value = {1, 0.5, 0.25}, .min = 0},
    {.name = "axis", .type = ParameterType::vector, .value = {0, 0, -1}},
    {.name = "on", .type = ParameterType::boolean, .value = {1}},
    {.name = "mode", .type = ParameterType::choice, .value = {1}, .choices = "replace|add"},
    {.name = "label", .type = ParameterType::text, .text = "none"},
    {.name = "names", .type = ParameterType::text_list, .text = "a|b"},
    {.name = "falloff", .type = ParameterType::number_list, .count = 3, .has_default = false},
    {.name = "numbers", .type = ParameterType::number_list, .min = 0, .has_default = false},
    {.name = "rough", .value = {0.5}, .min = 0, .max = 1, .slot = 0},
    {.name = "flag", .type = ParameterType::boolean, .slot = 0},
};

using Triple = std::array<double, 3>;

std::string refusal(std::string_view name, const Value& value) {
    ParameterValues values;
    try {
        values.set(kTable, name, value, "light 'key'");
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::parameter);
        EXPECT_TRUE(values.all().empty()) << "a refused value was kept";
        return error.what();
    }
    return "accepted";
}

TEST(ParameterValues, DefaultsComeFromTheTable) {
    const ParameterValues none;
    EXPECT_EQ(none.number(kTable, "exposure"), 0.5);
    EXPECT_EQ(none.number(kTable, "count"), 2);
    EXPECT_EQ(none.triple(kTable, "tint"), (Triple{1, 0.5, 0.25}));
    EXPECT_TRUE(none.boolean(kTable, "on"));
    EXPECT_EQ(none.choice(kTable, "mode"), 1);
    EXPECT_EQ(none.text(kTable, "mode"), "add");
    EXPECT_EQ(none.text(kTable, "label"), "none");
    EXPECT_EQ(none.texts(kTable, "names"), (std::vector<std::string>{"a", "b"}));
    EXPECT_TRUE(none.numbers(kTable, "falloff").empty());
    EXPECT_FALSE(none.given("exposure"));
}

TEST(ParameterValues, EachTypeIsKeptInOneForm) {
    ParameterValues values;
    const auto set = [&](std::string_view name, const Value& value) {
        values.set(kTable, name, value, "test");
        return *values.find(name);
    };
    EXPECT_EQ(set("exposure", std::int64_t{3}), Value(3.0));
    EXPECT_EQ(set("count", 4.0), Value(std::int64_t{4}));
    EXPECT_EQ(set("tint", 0.5), Value(Triple{0.5, 0.5, 0.5}));
    EXPECT_EQ(set("tint", std::vector<double>{1, 2, 3}), Value(Triple{1, 2, 3}));
    EXPECT_EQ(set("axis", std::vector<double>{1, 2, 3}), Value(Triple{1, 2, 3}));
    EXPECT_EQ(set("names", std::string("car_*")), Value(std::vector<std::string>{"car_*"}));
    EXPECT_EQ(set("names", std::vector<double>{}), Value(std::vector<std::string>{}));
    EXPECT_EQ(set("falloff", Triple{1, 2, 3}), Value(std::vector<double>{1, 2, 3}));
    EXPECT_EQ(set("mode", std::string("replace")), Value(std::string("replace")));
    EXPECT_EQ(values.choice(kTable, "mode"), 0);
    EXPECT_EQ(values.number(kTable, "count"), 4);
    values.unset("count");
    EXPECT_EQ(values.number(kTable, "count"), 2);
}

TEST(ParameterValues, RefusalsSayWhatIsTaken) {
    EXPECT_EQ(refusal("exposur", 1.0), "unknown key 'exposur' in light 'key'; did you mean 'exposure'?");
    EXPECT_EQ(refusal("exposure", std::string("bright")),
              "light 'key': exposure takes a number, not the string 'bright'");
    EXPECT_EQ(refusal("exposure", true), "light 'key': exposure takes a number, not true");
    EXPECT_EQ(refusal("exposure", 11.0), "light 'key': exposure is 11; it must be within -10 … 10 stops");
    EXPECT_EQ(refusal("exposure", std::nan("")), "light 'key': exposure is nan; it must be finite");
    EXPECT_EQ(refusal("tint", HUGE_VAL), "light 'key': tint is inf; it must be finite");
    EXPECT_EQ(refusal("tint", Triple{1, -1, 1}), "light 'key': tint is -1; it must be at least 0");
    EXPECT_EQ(refusal("tint", std::vector<double>{1, 2}),
              "light 'key': tint takes a number or 3 numbers [r, g, b], not a list of 2 numbers");
    EXPECT_EQ(refusal("axis", 1.0), "light 'key': axis takes 3 numbers [x, y, z], not the number 1");
    EXPECT_EQ(refusal("count", 1.5), "light 'key': count takes a whole number, not the number 1.5");
    EXPECT_EQ(refusal("on", std::int64_t{1}), "light 'key': on takes true or false, not the number 1");
    EXPECT_EQ(refusal("mode", std::string("ad")), "light 'key': mode has no choice 'ad'; did you mean 'add'?");
    EXPECT_EQ(refusal("mode", std::string("multiply")),
              "light 'key': mode has no choice 'multiply'; there are replace, add");
    EXPECT_EQ(refusal("falloff", std::vector<double>{1, 2}),
              "light 'key': falloff takes a list of 3 numbers, not a list of 2 numbers");
    EXPECT_EQ(refusal("numbers", std::vector<double>{1, -2}), "light 'key': numbers is -2; it must be at least 0");
    EXPECT_EQ(refusal("label", std::int64_t{3}), "light 'key': label takes a string, not the number 3");
}

TEST(ParameterValues, ChannelsAreForNumbersOfShaders) {
    ParameterValues values;
    values.set(kTable, "rough", ChannelRef{"coat.X", 2, 1}, "shader");
    EXPECT_EQ(*values.find("rough"), Value(ChannelRef{"coat.X", 2, 1}));
    EXPECT_EQ(refusal("exposure", ChannelRef{"x"}), "light 'key': exposure takes a number, not the channel 'x'");
    EXPECT_EQ(refusal("flag", ChannelRef{"x"}), "light 'key': flag takes true or false, not the channel 'x'");
    EXPECT_EQ(refusal("rough", ChannelRef{""}), "light 'key': rough: the channel's name is empty");
    EXPECT_NE(refusal("rough", ChannelRef{"x", HUGE_VAL}), "accepted");
}

TEST(ParameterValues, LongAndHostileWordsStayOnOneShortLine) {
    const std::string message = refusal("a\n\x1b[31m" + std::string(1 << 20, 'x'), 1.0);
    EXPECT_LT(message.size(), 400u);
    EXPECT_EQ(message.find('\n'), std::string::npos);
    EXPECT_EQ(message.find('\x1b'), std::string::npos);
    EXPECT_NE(message.find("a\\n\\x1b[31mxxx"), std::string::npos) << message;
}

TEST(NearestName, FindsSlipsOfThePen) {
    constexpr std::string_view names[] = {"exposure",    "irradiance", "direction", "ggx",
                                          "blinn_phong", "phong",      "roughness", "specular_color"};
    const auto near = [&](std::string_view word) { return nearest_name(word, names); };
    EXPECT_EQ(near("exposur"), "exposure");    // left out
    EXPECT_EQ(near("exposuree"), "exposure");  // put in
    EXPECT_EQ(near("exqosure"), "exposure");   // replaced
    EXPECT_EQ(near("epxosure"), "exposure");   // swapped
    EXPECT_EQ(near("EXPOSURE"), "exposure");
    EXPECT_EQ(near("gxg"), "ggx");
    EXPECT_EQ(near("blin-phong"), "blinn_phong");
    EXPECT_EQ(near("rough"), "roughness");
    EXPECT_EQ(near("specularColour"), "specular_color");
    EXPECT_EQ(near("phongg"), "phong");
    EXPECT_EQ(near("completely_else"), "");
    EXPECT_EQ(near("abc"), "");
    EXPECT_EQ(near(""), "");
    EXPECT_EQ(near(std::string(100000, 'e')), "");
    EXPECT_EQ(nearest_name("x", {}), "");
}

TEST(NearestName, TakesTheNearestAndThenTheFirst) {
    constexpr std::string_view names[] = {"zip", "zips", "piz"};
    EXPECT_EQ(nearest_name("zipp", names), "zip");
    EXPECT_EQ(nearest_name("zipss", names), "zips");
    EXPECT_EQ(nearest_name("pizz", names), "piz");
}

TEST(NearestName, AWordIsNearestToItself) {
    for (const auto table :
         {output_parameters(), camera_parameters(), gbuffer_parameters(), channel_rule_parameters()}) {
        std::vector<std::string_view> names;
        for (const Parameter& p : table) names.push_back(p.name);
        for (const std::string_view name : names) EXPECT_EQ(nearest_name(name, names), name);
    }
}

}  // namespace
}  // namespace relume
