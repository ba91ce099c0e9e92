// SPDX-License-Identifier: Apache-2.0
#include "relume/camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "gbuffer/camera_fit.h"
#include "made_camera.h"

namespace relume {
namespace {

using gbuffer::CameraFit;
using gbuffer::Sighting;
using gbuffer::Vector3;
using test::at_depth;
using test::look_at;

constexpr Window kDisplay{0, 0, 640, 360};

/// Sightings of hills through `camera`, with positions rounded to float as files hold them.
std::vector<Sighting> sightings(const Camera& camera, const Window& data, double distance, double noise = 0,
                                int step = 7) {
    std::mt19937 random(3);
    std::normal_distribution<double> error(0, 1);
    std::vector<Sighting> all;
    for (int y = data.y; y < data.y_end(); y += step) {
        for (int x = data.x; x < data.x_end(); x += step) {
            const double u = x + 0.5, v = y + 0.5;
            const double du = noise * error(random), dv = noise * error(random);
            Vector3 p = at_depth(camera, u + du, v + dv, test::hills(u, v, distance));
            for (double& c : p) c = static_cast<double>(static_cast<float>(c));
            all.push_back({u, v, p, 0});
        }
    }
    return all;
}

CameraFit fit(std::span<const Sighting> seen, const Window& display = kDisplay, double aspect = 1) {
    std::string why;
    const std::optional<CameraFit> result = gbuffer::fit_camera(seen, display, aspect, why);
    EXPECT_TRUE(result) << why;
    return result.value_or(CameraFit{});
}

TEST(Camera, IsRecoveredFromPositions) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (int i = 0; i < 40; ++i) {
        const Vector3 from{9 * unit(random), 9 * unit(random), 5 * unit(random)};
        const Vector3 to{unit(random), unit(random), unit(random)};
        Camera camera = look_at(from, to);
        test::set_lens(camera, kDisplay, 0.2 + 0.6 * std::abs(unit(random)));
        const double distance = 4 + 3 * std::abs(unit(random));
        const CameraFit found = fit(sightings(camera, kDisplay, distance));
        EXPECT_LT(test::largest_pixel_difference(camera, found.camera, kDisplay, distance), 2e-4) << i;
        // The rounding of the positions, not the fit, is what is left.
        EXPECT_LT(found.median_error, 1e-3);
        EXPECT_TRUE(found.centred);
        for (std::size_t k = 0; k < 16; ++k) {
            EXPECT_NEAR(found.camera.camera_to_world[k], camera.camera_to_world[k], 2e-5) << i << ' ' << k;
        }
        EXPECT_NEAR(found.camera.x_scale / camera.x_scale, 1, 1e-6);
    }
}

TEST(Camera, ShiftedLensCropAndPixelAspectAreRecovered) {
    Camera camera = look_at({3, -8, 4}, {0, 0, 1});
    const Window display{100, 50, 640, 360}, data{60, 20, 400, 300};
    test::set_lens(camera, display, 0.45, 2.0, 0.13, -0.07);
    const CameraFit found = fit(sightings(camera, data, 8), display, 2.0);
    EXPECT_FALSE(found.centred);
    EXPECT_LT(test::largest_pixel_difference(camera, found.camera, data, 8), 5e-4);
    EXPECT_NEAR(found.camera.y_scale / found.camera.x_scale, -0.5, 1e-6);

    // The same pixels of another display window are another lens, but the same camera.
    const CameraFit again = fit(sightings(camera, data, 8), kDisplay, 2.0);
    EXPECT_LT(test::largest_pixel_difference(camera, again.camera, data, 8), 5e-4);
}

TEST(Camera, NoiseIsAveragedOut) {
    Camera camera = look_at({3, -8, 4}, {0, 0, 1});
    test::set_lens(camera, kDisplay, 0.45);
    const CameraFit found = fit(sightings(camera, kDisplay, 8, 0.3, 5));
    // 9216 sightings with 0.3 px of noise on either axis leave a hundredth of it.
    EXPECT_LT(test::largest_pixel_difference(camera, found.camera, kDisplay, 8), 0.05);
    EXPECT_NEAR(found.median_error, 0.3 * 1.1774, 0.02);
}

TEST(Camera, OutliersAreLeftOut) {
    Camera camera = look_at({3, -8, 4}, {0, 0, 1});
    test::set_lens(camera, kDisplay, 0.45);
    std::vector<Sighting> seen = sightings(camera, kDisplay, 8);
    // Every tenth position lies half way to the camera's own height: a mixture of two surfaces.
    for (std::size_t i = 0; i < seen.size(); i += 10)
        seen[i].point = gbuffer::plus(gbuffer::scaled(seen[i].point, 0.93), {0.1, 0.2, -0.1});
    const CameraFit found = fit(seen);
    EXPECT_LT(test::largest_pixel_difference(camera, found.camera, kDisplay, 8), 1e-3);
}

TEST(Camera, OrthographicIsRecognised) {
    Camera camera = look_at({3, -8, 4}, {0, 0, 1});
    camera.projection = Projection::orthographic;
    test::set_lens(camera, kDisplay, 3, 1.5, 0.1, 0.05);
    for (const double noise : {0.0, 0.3}) {
        const CameraFit found = fit(sightings(camera, kDisplay, 8, noise), kDisplay, 1.5);
        ASSERT_EQ(found.camera.projection, Projection::orthographic) << noise;
        EXPECT_LT(test::largest_pixel_difference(camera, found.camera, kDisplay, 8), noise > 0 ? 0.1 : 5e-4);
        for (std::size_t i = 0; i < 3; ++i) {
            EXPECT_NEAR(found.camera.forward()[i], camera.forward()[i], noise > 0 ? 1e-3 : 2e-6);
        }
        // It stands before everything that it sees.
        for (const Sighting& s : sightings(camera, kDisplay, 8))
            EXPECT_GT(gbuffer::planar_depth(found.camera, s.point), 0);
    }
}

TEST(Camera, LongLensesStayPerspective) {
    Camera camera = look_at({30, -80, 40}, {0, 0, 1});
    test::set_lens(camera, kDisplay, 0.02);
    const CameraFit found = fit(sightings(camera, kDisplay, 94));
    EXPECT_EQ(found.camera.projection, Projection::perspective);
    EXPECT_LT(test::largest_pixel_difference(camera, found.camera, kDisplay, 94), 0.05);
}

TEST(Camera, LeftHandedWorldsAreSeen) {
    Camera camera = look_at({3, -8, 4}, {0, 0, 1});
    test::set_lens(camera, kDisplay, 0.45);
    std::vector<Sighting> seen = sightings(camera, kDisplay, 8);
    for (Sighting& s : seen) s.point[1] = -s.point[1];
    const CameraFit found = fit(seen);
    EXPECT_TRUE(found.mirrored);
    EXPECT_LT(found.median_error, 1e-3);
    EXPECT_NEAR(found.camera.position()[0], 3, 1e-4);
    EXPECT_NEAR(found.camera.position()[1], 8, 1e-4);
    EXPECT_NEAR(found.camera.position()[2], 4, 1e-4);
}

TEST(Camera, OnePlaneNeedsACentredLens) {
    Camera camera = look_at({3, -8, 4}, {0, 0, 0});
    test::set_lens(camera, kDisplay, 0.45);
    std::vector<Sighting> seen;
    for (int y = 0; y < 360; y += 5) {
        for (int x = 0; x < 640; x += 5) {
            const Vector3 from = at_depth(camera, x + 0.5, y + 0.5, 0), to = at_depth(camera, x + 0.5, y + 0.5, 1);
            const double t = from[2] / (from[2] - to[2]);
            const Vector3 p{from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1]), 0};
            if (t > 0) seen.push_back({x + 0.5, y + 0.5, p, 0});
        }
    }
    const CameraFit found = fit(seen);
    EXPECT_TRUE(found.planar);
    EXPECT_LT(test::largest_pixel_difference(camera, found.camera, kDisplay, 9), 1e-3);
    EXPECT_NEAR(found.camera.x_scale / camera.x_scale, 1, 1e-6);
}

TEST(Camera, APlaneSeenSquarelyNeedsDepths) {
    Camera camera = look_at({0, 0, 6}, {0, 0, 0}, {0, 1, 0});
    test::set_lens(camera, kDisplay, 0.36);
    std::vector<Sighting> seen;
    for (int y = 0; y < 360; y += 5) {
        for (int x = 0; x < 640; x += 5) seen.push_back({x + 0.5, y + 0.5, at_depth(camera, x + 0.5, y + 0.5, 6), 0});
    }
    std::string why;
    EXPECT_FALSE(gbuffer::fit_camera(seen, kDisplay, 1, why));
    EXPECT_NE(why.find("plane"), std::string::npos);
    for (Sighting& s : seen) s.depth = 6;
    const CameraFit found = fit(seen);
    EXPECT_LT(test::largest_pixel_difference(camera, found.camera, kDisplay, 6), 1e-6);
}

TEST(Camera, DegeneratePositionsSayWhy) {
    std::string why;
    std::vector<Sighting> seen;
    EXPECT_FALSE(gbuffer::fit_camera(seen, kDisplay, 1, why));
    EXPECT_NE(why.find("few"), std::string::npos);
    for (int i = 0; i < 100; ++i) seen.push_back({i + 0.5, 2 * i + 0.5, {i * 0.1, i * 0.2, i * 0.3}, 0});
    EXPECT_FALSE(gbuffer::fit_camera(seen, kDisplay, 1, why));
    EXPECT_NE(why.find("line"), std::string::npos);
    for (Sighting& s : seen) s.point = {1, 2, 3};
    EXPECT_FALSE(gbuffer::fit_camera(seen, kDisplay, 1, why));
    // Nothing that any camera sees: the fit must not claim otherwise.
    std::mt19937 random(5);
    std::uniform_real_distribution<double> unit(0, 1);
    for (Sighting& s : seen)
        s = {640 * unit(random), 360 * unit(random), {unit(random), unit(random), unit(random)}, 0};
    const std::optional<CameraFit> wild = gbuffer::fit_camera(seen, kDisplay, 1, why);
    EXPECT_TRUE(!wild || wild->median_error > 10);
}

TEST(Camera, ProjectionsAreTakenApart) {
    Camera camera = look_at({3, -8, 4}, {0, 0, 1});
    test::set_lens(camera, kDisplay, 0.45, 1.2, 0.1, -0.2);
    const std::array<double, 16>& m = camera.camera_to_world;
    // Rows of world to camera, then pixels·depth.
    std::array<std::array<double, 4>, 3> view{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) view[i][j] = m[4 * j + i];
        view[i][3] = -(view[i][0] * m[3] + view[i][1] * m[7] + view[i][2] * m[11]);
    }
    std::array<double, 12> p{}, q{};
    for (std::size_t k = 0; k < 4; ++k) {
        const double w = -view[2][k], last = k == 3 ? 1.0 : 0.0;
        p[k] = (view[0][k] - camera.x_offset * w) / camera.x_scale;
        p[4 + k] = (view[1][k] - camera.y_offset * w) / camera.y_scale;
        p[8 + k] = w;
        q[k] = (view[0][k] - camera.x_offset * last) / camera.x_scale;
        q[4 + k] = (view[1][k] - camera.y_offset * last) / camera.y_scale;
        q[8 + k] = last;
    }
    const std::optional<Camera> found = gbuffer::camera_from_projection(p);
    ASSERT_TRUE(found);
    EXPECT_LT(test::largest_pixel_difference(camera, *found, kDisplay, 8), 1e-9);
    const std::optional<Camera> parallel = gbuffer::camera_from_affine(q);
    ASSERT_TRUE(parallel);
    camera.projection = Projection::orthographic;
    EXPECT_LT(test::largest_pixel_difference(camera, *parallel, kDisplay, 8), 1e-9);
    EXPECT_FALSE(gbuffer::camera_from_projection({}));
    EXPECT_FALSE(gbuffer::camera_from_affine({}));
}

}  // namespace
}  // namespace relume
