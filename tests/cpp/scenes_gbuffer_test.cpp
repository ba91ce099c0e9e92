// SPDX-License-Identifier: Apache-2.0
// A built-in scene's file is a G-buffer that the reader understands, camera included, with nothing told to it.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <string>

#include "relume/gbuffer.h"
#include "relume/scenes.h"

namespace relume {
namespace {

class ScenesGBufferTest : public testing::TestWithParam<std::string> {
protected:
    ScenesGBufferTest() {
        options_.width = 160;
        options_.height = 90;
        options_.samples = 2;
        options_.paths = 1;
        path_ = testing::TempDir() + "relume_scene_" + GetParam() + ".exr";
        write_scene(GetParam(), path_, options_);
    }
    ~ScenesGBufferTest() override { std::filesystem::remove(path_); }

    SceneOptions options_;
    std::filesystem::path path_;
};

TEST_P(ScenesGBufferTest, ChannelsAreFoundByBlendersNames) {
    const GBuffer gbuffer = GBuffer::read(path_);
    EXPECT_EQ(gbuffer.producer(), "Blender");
    std::vector<std::string> wanted{"beauty",     "normal",    "position",  "depth",
                                    "base_color", "roughness", "object_id", "material_id"};
    if (GetParam() == "sdf") {
        wanted.insert(wanted.end(), {"metallic", "specular", "ambient_occlusion"});
    } else {
        wanted.push_back("emission");
    }
    for (const std::string& name : wanted) {
        const ChannelInfo* found = gbuffer.find(name);
        ASSERT_NE(found, nullptr) << name;
        const bool averaged = found->interpretation.find("divided by coverage") != std::string::npos;
        const bool as_stored = name == "beauty" || name == "position" || name == "depth" || name.ends_with("_id");
        EXPECT_NE(averaged, as_stored) << name << ": " << found->interpretation;
    }
    const auto& mattes = gbuffer.cryptomatte();
    ASSERT_TRUE(mattes.contains("ViewLayer.CryptoObject"));
    EXPECT_EQ(mattes.at("ViewLayer.CryptoObject").size(), GetParam() == "sdf" ? 2u : 14u);
}

TEST_P(ScenesGBufferTest, TheCameraFollowsFromThePositions) {
    const GBuffer gbuffer = GBuffer::read(path_);
    ASSERT_TRUE(gbuffer.camera()) << gbuffer.camera_reason();
    const Camera& found = *gbuffer.camera();
    const Camera made = render_scene(GetParam(), {.width = 160, .height = 90, .samples = 1, .paths = 0}).camera;
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(found.position()[k], made.position()[k], 1e-3) << k;
    // Where the rays of the corners go, in world space.
    const auto ray = [](const Camera& c, double u, double v) {
        const std::array<double, 3> r{u * c.x_scale + c.x_offset, v * c.y_scale + c.y_offset, -1};
        const double length = std::hypot(r[0], r[1], r[2]);
        std::array<double, 3> world{};
        for (std::size_t row = 0; row < 3; ++row) {
            for (std::size_t k = 0; k < 3; ++k) world[row] += c.camera_to_world[4 * row + k] * r[k] / length;
        }
        return world;
    };
    for (const auto& [u, v] : {std::pair{0.0, 0.0}, {160.0, 0.0}, {0.0, 90.0}, {160.0, 90.0}, {80.0, 45.0}}) {
        const auto a = ray(found, u, v);
        const auto b = ray(made, u, v);
        for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], 2e-4) << u << " " << v;
    }
}

INSTANTIATE_TEST_SUITE_P(Scenes, ScenesGBufferTest, testing::Values("sdf", "cornell"),
                         [](const auto& instance) { return instance.param; });

}  // namespace
}  // namespace relume
