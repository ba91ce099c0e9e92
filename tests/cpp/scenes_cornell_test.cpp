// SPDX-License-Identifier: Apache-2.0
// The geometry and materials of the built-in scene cornell. Its light paths: scenes_room_test.cpp.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>
#include <tuple>
#include <vector>

#include <glm/geometric.hpp>

#include "relume/scenes.h"
#include "scene_pixels.h"
#include "scenes/cornell_scene.h"

namespace relume {
namespace {

using glm::dvec3;
using scene::CornellScene;
using scene::Surface;

TEST(CornellSceneTest, RaysMeetTheWallsAndSpheresWhereAlgebraSays) {
    struct Ball {
        long double x, y, z, r;
    };
    std::vector<Ball> balls{{-9, -9.3L, 20, 3}, {0, -9.3L, 20, 3}, {9, -9.3L, 20, 3}};
    for (int i = 0; i < 5; ++i) balls.push_back({-10.0L + 5 * i, 0, 23, 1.75L});
    const CornellScene scene(96, 72, 8);
    std::array<int, 15> seen{};
    for (int j = 0; j < 72; ++j) {
        for (int i = 0; i < 96; ++i) {
            const Surface s = scene.trace({i + 0.5, j + 0.5});
            // From the origin along (x, y, 1): half the width is the tangent of 45°, rows have the columns' size.
            const long double x = (i + 0.5L - 48) / 48;
            const long double y = (36 - j - 0.5L) / 48;
            long double depth = 1e30L;
            int object = 0;
            const auto meet = [&](long double z, int what, bool inside) {
                if (inside && z > 0 && z < depth) {
                    depth = z;
                    object = what;
                }
            };
            const auto within = [](long double value, long double low, long double high) {
                return value >= low && value <= high;
            };
            meet(25, 1, within(25 * x, -12.6L, 12.6L) && within(25 * y, -12.6L, 12.6L));
            for (const auto& [height, what, near, far, half] : {std::tuple{-12.45L, 2, 15.0L, 25.0L, 12.6L},
                                                                {12.5L, 3, 15.0L, 25.0L, 12.6L},
                                                                {12.4L, 6, 17.5L, 22.5L, 5.0L}}) {
                const long double z = height / y;
                meet(z, what, within(z, near, far) && within(z * x, -half, half));
            }
            for (const auto& [side, what] : {std::pair{-12.5L, 4}, {12.5L, 5}}) {
                const long double z = side / x;
                meet(z, what, within(z, 15, 25) && within(z * y, -12.6L, 12.6L));
            }
            for (std::size_t k = 0; k < balls.size(); ++k) {
                const Ball& ball = balls[k];
                const long double a = x * x + y * y + 1;
                const long double b = x * ball.x + y * ball.y + ball.z;
                const long double c = ball.x * ball.x + ball.y * ball.y + ball.z * ball.z - ball.r * ball.r;
                if (b * b - a * c >= 0) meet(c / (b + std::sqrt(b * b - a * c)), static_cast<int>(7 + k), true);
            }
            ASSERT_EQ(s.object, object) << i << " " << j;
            ++seen[static_cast<std::size_t>(object)];
            if (object == 0) continue;
            EXPECT_NEAR(s.depth, static_cast<double>(depth), 1e-11);
            EXPECT_NEAR(glm::length(s.position - dvec3(double(x), double(y), 1) * s.depth), 0, 1e-11);
            EXPECT_LT(glm::dot(s.normal, s.direction), 0);
            dvec3 normal(0);
            if (object == 1) normal = {0, 0, -1};
            if (object == 2) normal = {0, 1, 0};
            if (object == 3 || object == 6) normal = {0, -1, 0};
            if (object == 4) normal = {1, 0, 0};
            if (object == 5) normal = {-1, 0, 0};
            if (object >= 7) {
                const Ball& ball = balls[static_cast<std::size_t>(object - 7)];
                normal = (s.position - dvec3(double(ball.x), double(ball.y), double(ball.z))) / double(ball.r);
            }
            EXPECT_NEAR(glm::length(s.normal - normal), 0, 1e-11);
        }
    }
    // The frame is too wide for the height of 72 rows: floor, ceiling and sides, but little background.
    for (int object = 1; object <= 14; ++object) EXPECT_GT(seen[static_cast<std::size_t>(object)], 10) << object;
}

TEST(CornellSceneTest, MaterialsReachTheirChannels) {
    SceneOptions options;
    options.width = options.height = 64;
    options.samples = 1;
    options.paths = 0;
    const SceneImage image = render_scene("cornell", options);
    EXPECT_EQ(image.find("ViewLayer.Combined.R"), nullptr);
    int light = 0;
    std::set<float> shiny;
    for (int j = 0; j < 64; ++j) {
        for (int i = 0; i < 64; ++i) {
            const int object = static_cast<int>(at(image, "IndexOB.X", i, j));
            const dvec3 emission = triple(image, "Emit", "RGB", i, j);
            const dvec3 specular_color = triple(image, "specular_color", "RGB", i, j);
            const double p = at(image, "percent_specular.X", i, j);
            const double roughness = at(image, "roughness.X", i, j);
            if (object == 6) {
                ++light;
                EXPECT_LT(glm::length(emission - dvec3(20, 18, 14)), 1e-6);
                continue;
            }
            EXPECT_EQ(emission, dvec3(0));
            if (object >= 1 && object <= 5) {
                EXPECT_EQ(p, 0);
            }
            if (object == 4) {
                EXPECT_LT(glm::length(triple(image, "albedo", "RGB", i, j) - dvec3(0.7, 0.1, 0.1)), 1e-6);
            }
            if (object == 9) {
                EXPECT_EQ(p, 0.5);
                EXPECT_EQ(specular_color, dvec3(1, 0, 0));
                EXPECT_NEAR(roughness, 0.4, 1e-7);
            }
            if (object >= 10) {
                EXPECT_EQ(p, 1);
                EXPECT_EQ(roughness, 0.25 * (object - 10));
                EXPECT_LT(glm::length(specular_color - dvec3(0.3, 1, 0.3)), 1e-6);
                shiny.insert(static_cast<float>(roughness));
            }
        }
    }
    EXPECT_GT(light, 20);
    EXPECT_EQ(shiny.size(), 5u);
}

}  // namespace
}  // namespace relume
