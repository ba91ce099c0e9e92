// SPDX-License-Identifier: Apache-2.0
// Values keyed over the frames of a sequence.

#include <gtest/gtest.h>

#include "relume/error.h"
#include "relume/light.h"
#include "relume/rig.h"

namespace relume {
namespace {

constexpr const char* kSun = "[[light]]\nname = 'key'\ntype = 'sun'\ndirection = [0, 0, -1]\n";

double exposure_at(const Rig& rig, double frame) {
    return rig.at(frame).light("key")->values.number(find_light_type("sun")->parameters, "exposure");
}

TEST(RigKeys, EachInterpolationAtAndBetweenAndBeyondItsKeys) {
    const std::string keys = "exposure = { keys = [[1001, 0.0], [1011, 2.0], [1021, -1.0]]";
    const Rig linear = Rig::loads(kSun + keys + " }");
    EXPECT_DOUBLE_EQ(exposure_at(linear, 900), 0);
    EXPECT_DOUBLE_EQ(exposure_at(linear, 1001), 0);
    EXPECT_DOUBLE_EQ(exposure_at(linear, 1006), 1);
    EXPECT_DOUBLE_EQ(exposure_at(linear, 1011), 2);
    EXPECT_DOUBLE_EQ(exposure_at(linear, 1012.5), 2 - 0.15 * 3);
    EXPECT_DOUBLE_EQ(exposure_at(linear, 5000), -1);

    const Rig hold = Rig::loads(kSun + keys + ", interpolation = 'hold' }");
    EXPECT_DOUBLE_EQ(exposure_at(hold, 1010.999), 0);
    EXPECT_DOUBLE_EQ(exposure_at(hold, 1011), 2);
    EXPECT_DOUBLE_EQ(exposure_at(hold, 1020), 2);

    const Rig smooth = Rig::loads(kSun + keys + ", interpolation = 'smooth' }");
    EXPECT_DOUBLE_EQ(exposure_at(smooth, 1006), 1);
    EXPECT_NEAR(exposure_at(smooth, 1003.5), 2 * (3 * 0.0625 - 2 * 0.015625), 1e-12);
    EXPECT_NEAR((exposure_at(smooth, 1001.001) - exposure_at(smooth, 1001)) / 0.001, 0, 1e-3) << "level at its keys";
}

TEST(RigKeys, ColoursAndVectorsInBothForms) {
    const Rig flat = Rig::loads(std::string(kSun) + "color = { keys = [[1, 1, 0, 0], [3, 0, 0, 1]] }");
    const Rig nested = Rig::loads(std::string(kSun) + "color = { keys = [[1, [1, 0, 0]], [3, [0, 0, 1]]] }");
    const Rig grey = Rig::loads(std::string(kSun) + "color = { keys = [[1, 1], [3, 3]] }");
    EXPECT_TRUE(flat == nested);
    const auto table = find_light_type("sun")->parameters;
    EXPECT_EQ(flat.at(2).lights[0].values.triple(table, "color"), (std::array<double, 3>{0.5, 0, 0.5}));
    EXPECT_EQ(grey.at(2).lights[0].values.triple(table, "color"), (std::array<double, 3>{2, 2, 2}));
    const Rig turned = Rig::loads("[[light]]\ntype = 'sun'\ndirection = { keys = [[0, 1, 0, 0], [10, 0, 0, -1]] }");
    EXPECT_EQ(turned.at(5).lights[0].values.triple(table, "direction"), (std::array<double, 3>{0.5, 0, -0.5}));
}

TEST(RigKeys, ShadersAndPaths) {
    Rig rig = Rig::loads("[[shader]]\nuse = 'ggx'\nroughness = { keys = [[0, 0.2], [10, 0.6]] }\n" + std::string(kSun));
    const auto table = shader_use_parameters("ggx");
    EXPECT_DOUBLE_EQ(rig.at(5).shaders[0].values.number(table, "roughness"), 0.4);
    EXPECT_DOUBLE_EQ(rig.shaders[0].values.number(table, "roughness"), 0.2) << "without a frame: its first key";
    rig.set("light.key.exposure", "{ keys = [[1, 0], [2, 4]], interpolation = 'hold' }");
    EXPECT_EQ(rig.get("light.key.exposure"), "{ keys = [[1, 0], [2, 4]], interpolation = \"hold\" }");
    EXPECT_DOUBLE_EQ(exposure_at(rig, 1.5), 0);
    EXPECT_TRUE(Rig::loads(rig.to_toml()) == rig);
    rig.set("light.key.exposure", "3");
    EXPECT_DOUBLE_EQ(exposure_at(rig, 1.5), 3);
}

TEST(RigKeys, MistakesAreNamed) {
    const auto message = [](const std::string& text) -> std::string {
        try {
            Rig::loads(text);
        } catch (const Error& error) {
            return error.what();
        }
        return "";
    };
    const auto says = [&](const std::string& text, const std::string& what) {
        EXPECT_NE(message(text).find(what), std::string::npos) << text << "\n" << message(text);
    };
    const std::string sun = kSun;
    says(sun + "exposure = { keys = [] }", "without any frame");
    says(sun + "exposure = { keys = [[2, 0], [1, 1]] }", "do not rise");
    says(sun + "exposure = { keys = [[1, 0], [1, 1]] }", "do not rise");
    says(sun + "exposure = { keys = [1, 2] }", "write { keys = [[frame, value], …]");
    says(sun + "exposure = { keys = [[1, 'a']] }", "write { keys = [[frame, value], …]");
    says(sun + "exposure = { keys = [[1, 0]], interpolation = 'cubic' }", "\"linear\", \"hold\" or \"smooth\"");
    says(sun + "exposure = { keys = [[1, 0]], step = 2 }", "'step'");
    says(sun + "exposure = { keys = [[1, 0, 0, 1]] }", "takes a number");
    says(sun + "color = { keys = [[1, 1], [2, 1, 0, 0]] }", "mixed");
    says(sun + "diffuse = { keys = [[1, 1], [7, -1]] }", "frame 7");
    says(sun + "enabled = { keys = [[1, 1]] }", "takes true or false, not keys over frames");
    says("[camera]\nfov = { keys = [[1, 30]] }", "keys over frames");
    says("[[shader]]\nuse = 'ggx'\nroughness = { channel = 'r', scale = { keys = [[1, 1]] } }", "cannot be keyed");
    for (const char* at : {":5:1", ":5:"}) says(sun + "exposure = { keys = [] }", at);
}

}  // namespace
}  // namespace relume
