// SPDX-License-Identifier: Apache-2.0
// The built-in scenes through the whole house: rendered, written, read, relit with their rigs.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include <glm/geometric.hpp>

#include "relume/gbuffer.h"
#include "relume/relight.h"
#include "relume/rig.h"
#include "relume/scenes.h"
#include "scene_pixels.h"

namespace relume {
namespace {

using glm::dvec3;

struct Relit {
    SceneImage scene;
    std::array<std::vector<float>, 4> rgba;
    RelightReport report;

    dvec3 pixel(int i, int j) const {
        const auto at = static_cast<std::size_t>(j * scene.window.width + i);
        return {rgba[0][at], rgba[1][at], rgba[2][at]};
    }
};

Relit relit(const std::string& name, const SceneOptions& options) {
    const std::filesystem::path path = testing::TempDir() + "relume_relit_" + name + ".exr";
    write_scene(name, path, options);
    const GBuffer gbuffer = GBuffer::read(path);
    const Rig rig = Rig::load(std::filesystem::path(RELUME_SOURCE_DIR) / "examples" / "rigs" / (name + ".relume"));
    Relit result{render_scene(name, options), {}, {}};
    std::vector<Plane> planes;
    for (std::vector<float>& plane : result.rgba) {
        plane.resize(static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height));
        planes.push_back(
            {reinterpret_cast<std::byte*>(plane.data()), PixelType::float32, 4, std::ptrdiff_t{4} * options.width});
    }
    result.report = relight(gbuffer, rig, {{"beauty", planes}});
    std::filesystem::remove(path);
    return result;
}

TEST(ScenesRelightTest, SdfGivesItsOwnBeautyBack) {
    // The relit picture has no shadow of the sun: where the scene has none either, the two are the same.
    SceneOptions options;
    options.width = 192;
    options.height = 108;
    options.samples = 1;
    const Relit result = relit("sdf", options);
    EXPECT_TRUE(result.report.nonfinite.empty());
    int compared = 0;
    for (int j = 0; j < options.height; ++j) {
        for (int i = 0; i < options.width; ++i) {
            const dvec3 found = result.pixel(i, j);
            if (at(result.scene, "IndexOB.X", i, j) == 0) {
                EXPECT_EQ(found, dvec3(0));
                continue;
            }
            if (at(result.scene, "Shadow.R", i, j) != 1) continue;
            ++compared;
            const dvec3 expected = triple(result.scene, "Combined", "RGB", i, j);
            // The camera is recovered from float positions: 1e-6 of the view direction, which the highlight feels.
            for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[k], expected[k], 1e-4 * expected[k]) << i << " " << j;
        }
    }
    EXPECT_GT(compared, 12000);
}

TEST(ScenesRelightTest, SilhouettesAreCoverageTimesTheSurface) {
    // A mean of shaded samples and the shading of mean samples differ; on the flat ground's horizon they do not.
    SceneOptions options;
    options.width = 192;
    options.height = 108;
    options.samples = 16;
    const Relit result = relit("sdf", options);
    int edges = 0;
    for (int i = 0; i < options.width; ++i) {
        for (int j = 0; j < options.height; ++j) {
            const double coverage = at(result.scene, "albedo.A", i, j);
            if (coverage == 0 || coverage == 1) continue;
            ++edges;
            const dvec3 found = result.pixel(i, j);
            const dvec3 expected = triple(result.scene, "Combined", "RGB", i, j);
            for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[k], expected[k], 0.01 * coverage) << i << " " << j;
        }
    }
    EXPECT_GT(edges, 100);
}

TEST(ScenesRelightTest, CornellsWallsUnderASpot) {
    SceneOptions options;
    options.width = options.height = 96;
    options.samples = 1;
    options.paths = 0;
    const Relit result = relit("cornell", options);
    EXPECT_TRUE(result.report.nonfinite.empty());
    const dvec3 lamp(0, 12.4, 20);
    int compared = 0;
    for (int j = 0; j < options.height; ++j) {
        for (int i = 0; i < options.width; ++i) {
            const int object = static_cast<int>(at(result.scene, "IndexOB.X", i, j));
            const dvec3 found = result.pixel(i, j);
            if (object == 6) {
                EXPECT_LT(glm::length(found - dvec3(20, 18, 14)), 1e-4);
            }
            if (object < 1 || object > 5) continue;
            const dvec3 way = lamp - triple(result.scene, "Position", "XYZ", i, j);
            const double r = glm::length(way);
            const double at_lamp = std::max(0.0, way.y / r);
            const double at_wall = std::max(0.0, glm::dot(triple(result.scene, "Normal", "XYZ", i, j), way) / r);
            const dvec3 irradiance = dvec3(1000, 900, 700) * (at_lamp * at_wall / (r * r)) + dvec3(0.55, 0.55, 0.28);
            const dvec3 expected = triple(result.scene, "albedo", "RGB", i, j) * irradiance / std::numbers::pi;
            for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[k], expected[k], 2e-5 * expected[k]) << i << " " << j;
            ++compared;
        }
    }
    EXPECT_GT(compared, 3000);
}

}  // namespace
}  // namespace relume
