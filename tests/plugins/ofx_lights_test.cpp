// SPDX-License-Identifier: Apache-2.0
// The lights' knobs: types, keys, picks, and what projects keep of a choice.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>

#include "ofx/layout.h"
#include "ofx_scene.h"
#include "relume/light.h"
#include "relume/scenes.h"

namespace relume::ofx::test {
namespace {

const SceneClips& scene() {
    static const SceneClips made(80, 48, 12, 7);
    return made;
}

using Triple = std::array<double, 3>;

Triple at(const char* channel, int x, int y) {
    const auto& planes = scene().channels.at(channel);
    const auto pixel = static_cast<std::size_t>(scene().bounds.y2 - 1 - y) * static_cast<std::size_t>(scene().width) +
                       static_cast<std::size_t>(x - scene().bounds.x1);
    Triple v{};
    for (std::size_t k = 0; k < 3; ++k) v[k] = static_cast<double>(planes[k][pixel]);
    return v;
}

double length(const Triple& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

void expect_near(const std::vector<double>& got, const Triple& wanted, double slack = 1e-5) {
    ASSERT_EQ(got.size(), 3u);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(got[k], wanted[k], slack) << k;
}

class OfxLightsTest : public testing::Test {
protected:
    void SetUp() override { scene().connect(node); }
    void TearDown() override { EXPECT_EQ(complaints(host), ""); }

    std::vector<float> rendered(double time = 0) {
        EXPECT_EQ(node.render({.time = time, .window = scene().bounds}, image), kOk) << node.instance().message;
        return pixels(*image);
    }
    std::vector<float> by_library(const std::string& lights) const {
        return scene().relit(Rig::loads(lights), kAllClips);
    }

    Host host;
    Node node{host, name::kContextGeneral};
    std::unique_ptr<Image> image;
};

TEST_F(OfxLightsTest, EveryTypeWithItsDefaults) {
    for (const LightType& type : light_types()) {
        node.choose("light2_type", std::string(type.name));
        node.set("light2_position", std::vector{0.0, 3.0, 0.0});
        node.set("light2_direction", std::vector{0.0, -1.0, 0.0});
        std::string rig = "[[light]]\nname = \"light2\"\ntype = \"" + std::string(type.name) + "\"\n";
        for (const relume::Parameter& row : type.parameters) {
            if (row.name == "position") rig += "position = [0, 3, 0]\n";
            if (row.name == "direction") rig += "direction = [0, -1, 0]\n";
        }
        EXPECT_EQ(rendered(), by_library(rig)) << type.name;
    }
}

TEST_F(OfxLightsTest, KeysAreReadAtTheRendersTime) {
    light_one(node);
    Parameter& exposure = node.parameter("light1_exposure");
    exposure.keys[10] = std::vector{-1.0};
    exposure.keys[20] = std::vector{3.0};
    Parameter& direction = node.parameter("light1_direction");
    direction.keys[10] = std::vector{0.0, -1.0, 0.0};
    direction.keys[20] = std::vector{1.0, -1.0, 0.0};
    EXPECT_EQ(rendered(15), by_library("[[light]]\ntype = \"sun\"\nirradiance = [2.0, 1.9, 1.7]\nexposure = 1.0\n"
                                       "direction = [0.5, -1, 0]"));
    EXPECT_EQ(rendered(30), by_library("[[light]]\ntype = \"sun\"\nirradiance = [2.0, 1.9, 1.7]\nexposure = 3.0\n"
                                       "direction = [1, -1, 0]"));
}

TEST_F(OfxLightsTest, PowerReplacesIntensity) {
    node.choose("light1_type", "point");
    node.set("light1_position", std::vector{0.5, 3.0, 0.2});
    node.set("light1_intensity", std::vector{3.0, 3.0, 3.0});
    node.set("light1_power", 90.0);
    node.set("light1_attenuation", std::vector{1.0, 0.1, 0.01});
    EXPECT_EQ(rendered(), by_library("[[light]]\ntype = \"point\"\nposition = [0.5, 3, 0.2]\npower = 90\n"
                                     "attenuation = [1, 0.1, 0.01]"));
}

TEST_F(OfxLightsTest, AFreshNodeShowsSomething) {
    const std::vector<float> fresh = rendered();
    EXPECT_GT(*std::max_element(fresh.begin(), fresh.end()), 0.2f);
    node.set("work_light", 0);
    EXPECT_EQ(node.render({.window = scene().bounds}, image), kFailed);
    EXPECT_NE(node.instance().message.find("light"), std::string::npos);
    // It is gone as soon as there is another.
    light_one(node);
    node.set("work_light", 1);
    EXPECT_EQ(rendered(), scene().relit(rig_one(), kAllClips));
}

TEST_F(OfxLightsTest, PickFacesTheSurface) {
    for (const auto& [x, y] : {std::pair(51, 28), std::pair(30, 12), std::pair(47, 33)}) {
        const Triple n = at("normal", x, y), p = at("position", x, y);
        ASSERT_NEAR(length(n), 1, 1e-4);
        node.set("light1_pick", std::vector{x + 0.5, y + 0.5});
        node.choose("light1_type", "sun");
        ASSERT_EQ(node.changed("light1_pick"), kOk) << node.instance().message;
        expect_near(node.numbers("light1_direction"), {-n[0], -n[1], -n[2]});
        node.choose("light1_type", "spot");
        node.set("light1_pick_distance", 2.5);
        ASSERT_EQ(node.changed("light1_pick"), kOk);
        expect_near(node.numbers("light1_position"), {p[0] + 2.5 * n[0], p[1] + 2.5 * n[1], p[2] + 2.5 * n[2]});
        expect_near(node.numbers("light1_direction"), {-n[0], -n[1], -n[2]});
        // Without a distance it keeps the one that it has.
        node.set("light1_pick_distance", 0.0);
        node.set("light1_position", std::vector{p[0] + 3, p[1], p[2] + 4});
        ASSERT_EQ(node.changed("light1_pick"), kOk);
        expect_near(node.numbers("light1_position"), {p[0] + 5 * n[0], p[1] + 5 * n[1], p[2] + 5 * n[2]}, 1e-4);
    }
}

TEST_F(OfxLightsTest, PickPutsTheHighlightThere) {
    // Of a phong surface that reflects nothing else, the brightest pixel is the picked one.
    node.choose("shader", "phong");
    node.set("override_channels", 1);
    node.set("phong_base_color", std::vector{0.0, 0.0, 0.0});
    node.set("phong_exponent", 60.0);
    node.choose("light1_type", "sun");
    node.choose("light1_pick_mode", "highlight");
    for (const auto& [x, y] : {std::pair(51, 28), std::pair(47, 31)}) {
        node.set("light1_pick", std::vector{x + 0.5, y + 0.5});
        ASSERT_EQ(node.changed("light1_pick"), kOk) << node.instance().message;
        const std::vector<float> got = rendered();
        std::size_t best = 0;
        for (std::size_t k = 0; k < got.size(); k += 4)
            if (got[k] > got[best]) best = k;
        const int bx = scene().bounds.x1 + static_cast<int>(best / 4) % scene().width;
        const int by = scene().bounds.y2 - 1 - static_cast<int>(best / 4) / scene().width;
        EXPECT_LE(std::abs(bx - x) + std::abs(by - y), 2) << bx << " " << by;
    }
}

TEST_F(OfxLightsTest, PickAimsALightThatStays) {
    const Triple p = at("position", 51, 28);
    node.choose("light1_type", "spot");
    node.choose("light1_pick_mode", "aim");
    node.set("light1_position", std::vector{p[0] + 1, p[1] + 2, p[2] + 2});
    node.set("light1_pick", std::vector{51.5, 28.5});
    ASSERT_EQ(node.changed("light1_pick"), kOk) << node.instance().message;
    expect_near(node.numbers("light1_direction"), {-1.0 / 3, -2.0 / 3, -2.0 / 3});
    expect_near(node.numbers("light1_position"), {p[0] + 1, p[1] + 2, p[2] + 2}, 1e-12);
    node.choose("light1_type", "sun");
    EXPECT_EQ(node.changed("light1_pick"), kFailed);
    EXPECT_NE(node.instance().message.find("sun"), std::string::npos);
}

TEST_F(OfxLightsTest, PickInCameraSpaceLightsTheSameSpot) {
    node.choose("light1_type", "sun");
    node.set("light1_pick", std::vector{51.5, 28.5});
    ASSERT_EQ(node.changed("light1_pick"), kOk);
    const std::vector<float> world = rendered();
    node.choose("light1_space", "camera");
    ASSERT_EQ(node.changed("light1_pick"), kOk);
    const std::vector<float> camera = rendered();
    double difference = 0;
    for (std::size_t k = 0; k < world.size(); ++k)
        difference = std::max(difference, std::abs(static_cast<double>(world[k] - camera[k])));
    EXPECT_LT(difference, 1e-4);
    EXPECT_GT(difference, -1);
}

TEST_F(OfxLightsTest, PickBesideTheSurfaceIsSaid) {
    node.choose("light1_type", "sun");
    const std::vector<double> before = node.numbers("light1_direction");
    for (const auto& point :
         {std::vector{15.0, 52.0}, std::vector{-500.0, 3.0}, std::vector{1e300, 0.0}, std::vector{std::nan(""), 3.0}}) {
        node.set("light1_pick", point);
        EXPECT_EQ(node.changed("light1_pick"), kFailed);
        EXPECT_NE(node.instance().message.find("point"), std::string::npos) << node.instance().message;
        EXPECT_EQ(node.numbers("light1_direction"), before);
    }
    node.clip("Position").has_image = false;
    node.choose("light1_type", "point");
    node.set("light1_pick", std::vector{51.5, 28.5});
    EXPECT_EQ(node.changed("light1_pick"), kFailed);
    EXPECT_NE(node.instance().message.find("Position"), std::string::npos) << node.instance().message;
}

TEST_F(OfxLightsTest, PickWritesOnlyForTheUsersHand) {
    node.choose("light1_type", "sun");
    node.set("light1_pick", std::vector{51.5, 28.5});
    const std::vector<double> before = node.numbers("light1_direction");
    EXPECT_NE(node.changed("light1_pick", 0, name::kChangeTime), kFailed);
    EXPECT_EQ(node.changed("light1_pick", 0, name::kChangePluginEdited), kOk);
    rendered();
    EXPECT_EQ(node.numbers("light1_direction"), before);
}

TEST(OfxPickTest, ReadsAFile) {
    const SceneFile file(80, 48);
    Host host;
    {
        Node node(host, name::kContextGenerator);
        node.set("gbuffer_file", file.path().string());
        node.choose("light1_type", "point");
        node.set("light1_pick", std::vector{39.5, 21.5});
        node.set("light1_pick_distance", 1.0);
        ASSERT_EQ(node.changed("light1_pick"), kOk) << node.instance().message;
        const Triple n = at("normal", 51, 28), p = at("position", 51, 28);
        expect_near(node.numbers("light1_position"), {p[0] + n[0], p[1] + n[1], p[2] + n[2]});
        node.set("light1_pick", std::vector{39.5, std::nan("")});
        EXPECT_EQ(node.changed("light1_pick"), kFailed);
        EXPECT_NE(node.instance().message.find("outside"), std::string::npos) << node.instance().message;
    }
    EXPECT_EQ(complaints(host), "");
}

TEST_F(OfxLightsTest, ChoicesKeepTheirNames) {
    const std::vector<std::string> now{"from the rig", "alpha", "ggx", "phong"};
    // The panel's choice is recorded with its name.
    EXPECT_EQ(choice_record(now, 2), "2 ggx");
    EXPECT_EQ(recorded_choice(now, 2, "2 ggx"), "ggx");
    // A model was added before it since: the index is the old one, the name says which.
    EXPECT_EQ(recorded_choice(now, 1, "1 ggx"), "ggx");
    // A script set the index and told nobody.
    EXPECT_EQ(recorded_choice(now, 3, "2 ggx"), "phong");
    EXPECT_EQ(recorded_choice(now, 3, ""), "phong");
    EXPECT_EQ(recorded_choice(now, 3, "nonsense"), "phong");
    EXPECT_EQ(recorded_choice(now, 9, "2 ggx"), "");
    node.choose("shader", "phong");
    ASSERT_EQ(node.changed("shader"), kOk);
    const std::string record = std::get<std::string>(node.parameter("shader_name").value);
    EXPECT_NE(record.find(" phong"), std::string::npos);
    // The same project in a version with another order.
    const int index = std::get<int>(node.parameter("shader").value);
    light_one(node);
    const std::vector<float> phong = rendered();
    node.set("shader", index - 1);
    node.set("shader_name", std::to_string(index - 1) + " phong");
    EXPECT_EQ(rendered(), phong);
    node.set("shader_name", std::to_string(index - 1) + " gone_model");
    EXPECT_EQ(node.render({.window = scene().bounds}, image), kFailed);
    EXPECT_NE(node.instance().message.find("gone_model"), std::string::npos) << node.instance().message;
}

}  // namespace
}  // namespace relume::ofx::test
