// SPDX-License-Identifier: Apache-2.0
// The built-in scene sdf against closed forms in double precision.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "relume/scenes.h"
#include "scene_pixels.h"
#include "scenes/sdf_scene.h"

namespace relume {
namespace {

using glm::dvec2;
using glm::dvec3;
using scene::SdfScene;
using scene::Surface;

/// The eye and the ray through a point of the film, from the definition: eye on a circle, looking at the origin, focal
/// length 1.5 half-heights.
struct Ray {
    dvec3 origin;
    dvec3 direction;
};
Ray sdf_ray(int width, int height, double time, dvec2 film) {
    const double phi = 0.3 * time;
    const dvec3 eye(3 * std::cos(phi), 1.5, 3 * std::sin(phi));
    const dvec3 back = eye / glm::length(eye);
    const dvec3 right = glm::normalize(dvec3(back.z, 0, -back.x));
    const dvec3 up = glm::cross(back, right);
    const double half = 0.5 * height;
    return {eye, glm::normalize(right * ((film.x - 0.5 * width) / half) + up * ((0.5 * height - film.y) / half) -
                                back * 1.5)};
}

TEST(SdfSceneTest, HitsLieOnTheSphereAndTheGround) {
    for (const double time : {0.0, 1.7, 12.0}) {
        const SdfScene scene(160, 90, time);
        int checked = 0;
        for (int j = 0; j < 90; ++j) {
            for (int i = 0; i < 160; ++i) {
                const Ray ray = sdf_ray(160, 90, time, {i + 0.5, j + 0.5});
                const Surface s = scene.trace({i + 0.5, j + 0.5});
                EXPECT_NEAR(glm::length(s.direction - ray.direction), 0, 1e-12);

                const double b = glm::dot(ray.origin, ray.direction);
                const double root = b * b - glm::dot(ray.origin, ray.origin) + 1;
                const double miss = std::sqrt(std::max(0.0, 1 - root)) - 1;  // gap between ray and sphere
                if (miss > -0.01 && miss < 0.01) continue;                   // silhouettes belong to either
                const double ground = ray.direction.y < 0 ? -(ray.origin.y + 1) / ray.direction.y : 1e9;
                if (root > 0) {
                    const double t = -b - std::sqrt(root);
                    const dvec3 normal = ray.origin + ray.direction * t;
                    ASSERT_EQ(s.object, 1);
                    const double slack = 0.001 / -glm::dot(normal, ray.direction);
                    const double found = glm::dot(s.position - ray.origin, ray.direction);
                    EXPECT_LE(found, t + 1e-12);
                    EXPECT_GE(found, t - slack - 1e-9);
                    EXPECT_NEAR(glm::length(s.normal - glm::normalize(s.position)), 0, 1e-6);
                    EXPECT_EQ(s.base_color, dvec3(0.8, 0.2, 0.2));
                    EXPECT_EQ(s.roughness, 0.35);
                } else if (ground < 40) {
                    ASSERT_EQ(s.object, 2);
                    const double found = glm::dot(s.position - ray.origin, ray.direction);
                    EXPECT_LE(found, ground + 1e-9);
                    EXPECT_GE(found, ground - 0.001 / -ray.direction.y - 1e-9);
                    if (s.position.y + 1 < glm::length(s.position) - 1 - 0.01) {
                        EXPECT_NEAR(glm::length(s.normal - dvec3(0, 1, 0)), 0, 1e-9);
                    }
                    const int tile =
                        static_cast<int>(std::floor(s.position.x)) + static_cast<int>(std::floor(s.position.z));
                    EXPECT_EQ(s.base_color, dvec3(tile % 2 == 0 ? 0.3 : 0.6));
                    EXPECT_EQ(s.roughness, 0.8);
                } else if (ground > 52) {
                    EXPECT_EQ(s.object, 0);
                }
                ++checked;
            }
        }
        EXPECT_GT(checked, 12000);
    }
}

TEST(SdfSceneTest, SilhouettesHaveNoHoles) {
    const SdfScene scene(480, 270, 0);
    int off = 0;
    for (int j = 100; j < 200; ++j) {
        for (int i = 0; i < 480; ++i) {
            const Surface s = scene.trace({i + 0.5, j + 0.5});
            ASSERT_NE(s.object, 0) << i << " " << j;
            // Out of steps, most rays stand within a hair of the sphere; a few had just begun to leave it.
            off += scene::sdf_distance(s.position) > 0.0025;
            EXPECT_LT(scene::sdf_distance(s.position), 0.25);
        }
    }
    EXPECT_LE(off, 12);
}

TEST(SdfSceneTest, AmbientOcclusion) {
    // In the open the distance along the normal is the tap itself: nothing is missing.
    EXPECT_NEAR(scene::sdf_ambient_occlusion({0, 1, 0}, {0, 1, 0}), 1, 1e-12);
    EXPECT_NEAR(scene::sdf_ambient_occlusion({9, -1, 4}, {0, 1, 0}), 1, 1e-12);
    // Where sphere and ground meet the taps go into the sphere.
    EXPECT_EQ(scene::sdf_ambient_occlusion({0, -1, 0}, {0, 1, 0}), 0);
    // Beside the sphere, written out: the distance to it where that is less than the height.
    const std::array taps{0.01, 0.04, 0.07, 0.10, 0.13};
    const std::array weights{1.0, 0.95, 0.9025, 0.857375, 0.81450625};
    for (const double x : {0.1, 0.3, 0.42, 0.6}) {
        double missing = 0;
        for (std::size_t i = 0; i < 5; ++i) {
            const double to_sphere = std::hypot(x, taps[i] - 1) - 1;
            missing += weights[i] * (taps[i] - std::min(taps[i], to_sphere));
        }
        const double expected = std::max(0.0, 1 - 3 * missing);
        EXPECT_NEAR(scene::sdf_ambient_occlusion({x, -1, 0}, {0, 1, 0}), expected, 1e-12) << x;
        EXPECT_LT(expected, 1.0000001);
    }
}

TEST(SdfSceneTest, Shadow) {
    const dvec3 sun = scene::sdf_lights().to_sun;
    EXPECT_NEAR(glm::length(sun - dvec3(0.6, 0.8, -0.5) / std::sqrt(1.25)), 0, 1e-12);
    // The axis of the shadow on the ground, open ground, and the sphere's lit side.
    const dvec3 axis = sun * (-1 / sun.y);
    EXPECT_EQ(scene::sdf_shadow(axis, sun), 0);
    EXPECT_EQ(scene::sdf_shadow({3, -1, -3}, sun), 1);
    EXPECT_EQ(scene::sdf_shadow(sun * 1.001, sun), 1);
    // Across the penumbra: never below the least of 8·distance/t on the whole way, which the steps sample, and near it.
    const dvec3 across = glm::normalize(glm::cross(sun, dvec3(0, 1, 0)));
    double previous = 0;
    int partial = 0;
    for (double offset = 0.8; offset < 2.2; offset += 0.01) {
        const dvec3 p = axis + across * offset;
        double least = 1;
        for (double t = 0.02; t < 4.8; t += 1e-4) {
            const double gap = std::min(glm::length(p + sun * t) - 1, sun.y * t);
            least = std::min(least, std::clamp(8 * gap / t, 0.0, 1.0));
        }
        const double light = scene::sdf_shadow(p, sun);
        EXPECT_GE(light, least - 1e-3) << offset;
        EXPECT_LE(light, least + 0.03) << offset;
        EXPECT_GE(light, previous - 0.02) << offset;
        previous = light;
        partial += light > 0.01 && light < 0.99;
    }
    EXPECT_GT(partial, 5);
}

TEST(SdfSceneTest, BeautyFromTheTextbook) {
    SceneOptions options;
    options.width = 64;
    options.height = 36;
    options.samples = 1;
    const SceneImage image = render_scene("sdf", options);
    const dvec3 sun = dvec3(0.6, 0.8, -0.5) / std::sqrt(1.25);
    const dvec3 back = dvec3(-0.6, 0, 0.5) / std::sqrt(0.61);
    constexpr double pi = std::numbers::pi;
    int lit = 0;
    for (int j = 0; j < 36; ++j) {
        for (int i = 0; i < 64; ++i) {
            if (at(image, "IndexOB.X", i, j) == 0) continue;
            const dvec3 n = triple(image, "Normal", "XYZ", i, j);
            const dvec3 v = -sdf_ray(64, 36, 0, {i + 0.5, j + 0.5}).direction;
            const dvec3 c = triple(image, "albedo", "RGB", i, j);
            const double ao = at(image, "AO.R", i, j);
            const double alpha = std::pow(at(image, "roughness.X", i, j), 2);
            const double n_l = glm::dot(n, sun);
            const double n_v = glm::dot(n, v);
            dvec3 expected =
                c *
                ((0.5 + 0.5 * n.y) * dvec3(0.08, 0.2, 0.4) + (0.5 + 0.5 * glm::dot(n, back)) * dvec3(0.15, 0.1, 0.08)) *
                ao;
            if (n_l > 0 && n_v > 0) {
                const dvec3 h = (v + sun) / glm::length(v + sun);
                const double cos2 = std::pow(glm::dot(n, h), 2);
                const double tan2 = 1 / cos2 - 1;
                const double d = 1 / (pi * alpha * alpha * cos2 * cos2 * std::pow(1 + tan2 / (alpha * alpha), 2));
                const auto lambda = [&](double x) {
                    return (std::sqrt(1 + alpha * alpha * (1 / (x * x) - 1)) - 1) / 2;
                };
                const double g = 1 / (1 + lambda(n_l) + lambda(n_v));
                const double f = 0.04 + 0.96 * std::pow(1 - glm::dot(v, h), 5);
                const dvec3 reflected = (1 - f) * c / pi * n_l + dvec3(d * g * f / (4 * n_v));
                expected += reflected * dvec3(2, 1.9, 1.7) * double(at(image, "Shadow.R", i, j));
                ++lit;
            }
            const dvec3 found = triple(image, "Combined", "RGB", i, j);
            for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[k], expected[k], 3e-5 * expected[k] + 1e-6) << i << " " << j;
        }
    }
    EXPECT_GT(lit, 1000);
}

}  // namespace
}  // namespace relume
