// SPDX-License-Identifier: Apache-2.0
// The light paths of the built-in scene cornell against integrals that are known.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "scenes/cornell_scene.h"
#include "scenes/random.h"
#include "scenes/room.h"

namespace relume::scene {
namespace {

using glm::dvec3;

constexpr double kPi = std::numbers::pi;

TEST(ScenesRandomTest, PhiloxKnownAnswers) {
    // The known-answer vectors that the authors of Philox publish with it (philox4x32, 10 rounds).
    using Words = std::array<std::uint32_t, 4>;
    EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}), (Words{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
    EXPECT_EQ(philox({~0u, ~0u, ~0u, ~0u}, {~0u, ~0u}), (Words{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
    EXPECT_EQ(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
              (Words{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

struct Estimate {
    dvec3 mean{0};
    dvec3 error{0};  ///< standard error of the mean
};

/// The radiance from `hit` back along `direction`, over `count` paths.
Estimate estimate(const Room& room, const RoomHit& hit, const dvec3& direction, const PathOptions& options, int count) {
    dvec3 sum(0);
    dvec3 squares(0);
    for (int path = 0; path < count; ++path) {
        const dvec3 sample = room.radiance(hit, direction, {7, 0, static_cast<std::uint32_t>(path)}, options);
        sum += sample;
        squares += sample * sample;
    }
    const double n = count;
    return {sum / n, glm::sqrt(glm::max(squares / n - sum * sum / (n * n), dvec3(0)) / n)};
}

/// Irradiance at p with normal n from a rectangle of radiance 1 that lies above p's horizon: Lambert's formula for
/// polygons, ½·Σ angle between neighbouring corners · n·(normal of the plane through them and p).
double polygon_irradiance(const std::array<dvec3, 4>& corners, const dvec3& p, const dvec3& n) {
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const dvec3 a = glm::normalize(corners[i] - p);
        const dvec3 b = glm::normalize(corners[(i + 1) % 4] - p);
        sum += std::acos(glm::dot(a, b)) * glm::dot(n, glm::normalize(glm::cross(a, b)));
    }
    return std::abs(sum) / 2;
}

constexpr std::array<dvec3, 4> kLight{dvec3{-5, 12.4, 17.5}, dvec3{5, 12.4, 17.5}, dvec3{5, 12.4, 22.5},
                                      dvec3{-5, 12.4, 22.5}};

struct WallPoint {
    dvec3 position;
    dvec3 normal;
    int object;
    int material;
    dvec3 albedo;
};

TEST(RoomTest, DirectLightOnTheWallsIsTheFormFactor) {
    // Nothing stands between these and the light. A path starts kNudge above its wall: the closed form does as well.
    const Room room = cornell_room();
    const std::array<WallPoint, 4> points{{{{0, 6, 25}, {0, 0, -1}, 1, 1, dvec3(0.7)},
                                           {{-12.5, 2, 18}, {1, 0, 0}, 4, 2, {0.7, 0.1, 0.1}},
                                           {{12.5, -8, 16}, {-1, 0, 0}, 5, 3, {0.1, 0.7, 0.1}},
                                           {{5, -12.45, 15.5}, {0, 1, 0}, 2, 1, dvec3(0.7)}}};
    for (const WallPoint& point : points) {
        const double factor = polygon_irradiance(kLight, point.position + point.normal * 0.01, point.normal) / kPi;
        const dvec3 expected = point.albedo * dvec3(20, 18, 14) * factor;
        const RoomHit hit{1, point.object, point.material, point.position, point.normal};
        for (const bool aim : {true, false}) {
            const Estimate found = estimate(room, hit, -point.normal, {1, aim}, aim ? 20000 : 100000);
            for (int k = 0; k < 3; ++k) {
                EXPECT_NEAR(found.mean[k], expected[k], 4 * found.error[k]) << point.object << " " << aim;
                EXPECT_LT(found.error[k], (aim ? 0.01 : 0.03) * expected[k]);
            }
        }
    }
}

TEST(RoomTest, AimingAtTheLightDoesNotChangeTheMean) {
    const Room room = cornell_room();
    const std::array<dvec3, 6> seen{dvec3{-9, -8, 20}, {0, -8, 20},   {9, -7.5, 20},
                                    {5, 1.2, 23},      {10, 1.2, 23}, {8, 12.5, 22}};
    for (const dvec3& target : seen) {
        const dvec3 direction = glm::normalize(target);
        const std::optional<RoomHit> hit = room.trace(dvec3(0), direction);
        ASSERT_TRUE(hit);
        const Estimate aimed = estimate(room, *hit, direction, {8, true}, 30000);
        const Estimate waiting = estimate(room, *hit, direction, {8, false}, 60000);
        for (int k = 0; k < 3; ++k) {
            EXPECT_NEAR(aimed.mean[k], waiting.mean[k], 4 * std::hypot(aimed.error[k], waiting.error[k]))
                << hit->object << " " << k;
        }
        EXPECT_GT(glm::length(aimed.mean), 0.01) << hit->object;
        EXPECT_LT(glm::length(aimed.error), 1.5 * glm::length(waiting.error)) << hit->object;
    }
}

TEST(RoomTest, AFurnaceGivesTheGeometricSeries) {
    // Inside a ball whose surface emits and reflects the same everywhere each path carries e·Σ ρ^k, whatever its turns.
    for (const double p : {0.0, 0.4, 1.0}) {
        for (const double roughness : {0.0, 0.5, 1.0}) {
            Room room;
            room.materials = {{dvec3(0.6, 0.3, 0.9), dvec3(0.6, 0.3, 0.9), dvec3(2, 1, 0.5), p, roughness}};
            room.spheres = {{{1, 2, 3}, 40, 1, 0}};
            const std::optional<RoomHit> hit = room.trace({0, 0, 0}, {0, 0, 1});
            ASSERT_TRUE(hit);
            for (const int bounces : {0, 1, 8, 40}) {
                const Estimate found = estimate(room, *hit, {0, 0, 1}, {bounces, true}, 50);
                for (int k = 0; k < 3; ++k) {
                    const double rho = room.materials[0].albedo[k];
                    const double expected =
                        room.materials[0].emission[k] * (1 - std::pow(rho, bounces + 1)) / (1 - rho);
                    EXPECT_NEAR(found.mean[k], expected, 1e-12 * expected);
                    EXPECT_LT(found.error[k], 1e-7 * expected);
                }
            }
        }
    }
}

TEST(RoomTest, NoLightIsMade) {
    // With every surface white and one light, radiance can't pass the light's own.
    Room room = cornell_room();
    for (RoomMaterial& m : room.materials) {
        if (m.emission == dvec3(0)) m.albedo = m.specular_color = dvec3(1);
    }
    for (int i = 0; i < 6; ++i) {
        const dvec3 direction = glm::normalize(dvec3(-8 + 3 * i, 6 - 2.5 * i, 20));
        const std::optional<RoomHit> hit = room.trace(dvec3(0), direction);
        ASSERT_TRUE(hit);
        const Estimate found = estimate(room, *hit, direction, {64, true}, 2000);
        EXPECT_LT(found.mean.x, 20);
        EXPECT_GT(found.mean.x, 0.1);
    }
}

/// f·n·l of the mirror lobe for directions normalize((1 − t)·rv + t·d), t = roughness², d cosine-distributed: the
/// density of d over the stretch of solid angle from d to l, summed over the directions d that end in l.
double lobe(const dvec3& n, const dvec3& rv, const dvec3& l, double roughness) {
    const double t = roughness * roughness;
    const double mu = glm::dot(l, rv);
    const double root = (1 - t) * (1 - t) * mu * mu - (1 - 2 * t);
    if (root < 0) return 0;
    double sum = 0;
    for (const double sign : {-1.0, 1.0}) {
        const double s = (1 - t) * mu + sign * std::sqrt(root);
        if (s <= 0) continue;
        const dvec3 d = (l * s - rv * (1 - t)) / t;
        sum += std::max(0.0, glm::dot(n, d)) * s * s / (kPi * t * t * std::abs(glm::dot(l, d)));
    }
    return sum;
}

TEST(RoomTest, TheMirrorLobeIsSpecularMixes) {
    // A reflecting floor under one light: the radiance is the lobe integrated over the light. From a coarse mirror (two
    // roots, an edge in the lobe) to Lambert.
    for (const double roughness : {0.3, 0.5, 0.65, 0.75, 0.9, 1.0}) {
        Room room;
        room.materials = {{dvec3(0), dvec3(0.5, 0.25, 1), dvec3(0), 1, roughness},
                          {dvec3(0), dvec3(0), dvec3(3), 0, 1}};
        room.rectangles = {{1, {-50, 0, -50}, {50, 0, 50}, 1, 0}, {1, {0, 5, -2}, {4, 5, 3}, 2, 1}};
        const dvec3 direction = glm::normalize(dvec3(1, -2, 0.3));
        const RoomHit hit{1, 1, 0, dvec3(0), dvec3(0, 1, 0)};
        const dvec3 rv(direction.x, -direction.y, direction.z);
        double integral = 0;
        constexpr int steps = 800;
        for (int i = 0; i < steps; ++i) {
            for (int j = 0; j < steps; ++j) {
                const dvec3 way(4 * (i + 0.5) / steps, 4.99, -2 + 5 * (j + 0.5) / steps);
                const double r = glm::length(way);
                integral += lobe({0, 1, 0}, rv, way / r, roughness) * way.y / (r * r * r);
            }
        }
        integral *= 20.0 / steps / steps;
        const Estimate found = estimate(room, hit, direction, {1, false}, 100000);
        for (int k = 0; k < 3; ++k) {
            const double expected = 3 * room.materials[0].specular_color[k] * integral;
            // Midpoints are slow to see the edge, 1/√ in the angle, that the lobe has below roughness √½.
            const double quadrature = roughness * roughness < 0.5 ? 1e-2 : 1e-5;
            EXPECT_NEAR(found.mean[k], expected, 4 * found.error[k] + quadrature * expected) << roughness;
            EXPECT_LT(found.error[k], 0.01 * expected) << roughness;
        }
        if (roughness == 1.0) {
            const std::array<dvec3, 4> corners{dvec3{0, 5, -2}, {4, 5, -2}, {4, 5, 3}, {0, 5, 3}};
            EXPECT_NEAR(integral, polygon_irradiance(corners, {0, 0.01, 0}, {0, 1, 0}) / kPi, 1e-6);
        }
    }
}

TEST(RoomTest, AMirrorShowsTheLight) {
    Room room = cornell_room();
    room.materials[1].percent_specular = 1;
    room.materials[1].roughness = 0;
    room.materials[1].specular_color = dvec3(0.5, 0.25, 1);
    const dvec3 direction = glm::normalize(dvec3(-0.5, -12.45, 0.8));
    const RoomHit hit{1, 2, 1, {4.5, -12.45, 17}, {0, 1, 0}};
    const Estimate found = estimate(room, hit, direction, {1, true}, 3);
    EXPECT_NEAR(found.mean.x, 10, 1e-12);
    EXPECT_NEAR(found.mean.y, 4.5, 1e-12);
    EXPECT_NEAR(found.mean.z, 14, 1e-12);
    EXPECT_EQ(found.error, dvec3(0));
}

TEST(RoomTest, BlockedMeansASurfaceBeforeTheEnd) {
    const Room room = cornell_room();
    EXPECT_TRUE(room.blocked({0, 0, 0}, {0, 0, 1}, 21.5));  // the sphere in the middle, from z = 21.25 on
    EXPECT_FALSE(room.blocked({0, 0, 0}, {0, 0, 1}, 21.0));
    EXPECT_FALSE(room.blocked({0, -5, 0}, {0, 0, 1}, 24.9));
    EXPECT_TRUE(room.blocked({0, -5, 0}, {0, 0, 1}, 25.1));  // the back wall
}

}  // namespace
}  // namespace relume::scene
