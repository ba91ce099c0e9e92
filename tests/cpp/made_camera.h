// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <random>

#include "gbuffer/dense.h"
#include "relume/camera.h"
#include "relume/image.h"

namespace relume::test {

using gbuffer::Vector3;

/// A camera at `from` that looks at `to`, with +Z up.
inline Camera look_at(const Vector3& from, const Vector3& to, const Vector3& up = {0, 0, 1}) {
    using namespace gbuffer;
    Vector3 z = minus(from, to);
    z = scaled(z, 1 / length(z));
    Vector3 x = cross(up, z);
    x = scaled(x, 1 / length(x));
    const Vector3 y = cross(z, x);
    Camera camera;
    for (std::size_t i = 0; i < 3; ++i) {
        camera.camera_to_world[4 * i] = x[i];
        camera.camera_to_world[4 * i + 1] = y[i];
        camera.camera_to_world[4 * i + 2] = z[i];
        camera.camera_to_world[4 * i + 3] = from[i];
    }
    return camera;
}

/// A lens that shows ±half_width at distance 1 across the display window; the lens' axis is shifted by shares of its
/// width.
inline void set_lens(Camera& camera, const Window& display, double half_width, double aspect = 1, double shift_x = 0,
                     double shift_y = 0) {
    camera.x_scale = 2 * half_width / display.width;
    camera.y_scale = -camera.x_scale / aspect;
    camera.x_offset = -(display.x + display.width * (0.5 + shift_x)) * camera.x_scale;
    camera.y_offset = -(display.y + display.height * 0.5 + display.width * shift_y) * camera.y_scale;
}

/// Where the ray of the pixel coordinates (u, v) is at a depth along the view axis.
inline Vector3 at_depth(const Camera& camera, double u, double v, double depth) {
    const double x = u * camera.x_scale + camera.x_offset, y = v * camera.y_scale + camera.y_offset;
    const bool parallel = camera.projection == Projection::orthographic;
    const Vector3 p = parallel ? Vector3{x, y, -depth} : Vector3{x * depth, y * depth, -depth};
    const std::array<double, 16>& m = camera.camera_to_world;
    return {m[0] * p[0] + m[1] * p[1] + m[2] * p[2] + m[3], m[4] * p[0] + m[5] * p[1] + m[6] * p[2] + m[7],
            m[8] * p[0] + m[9] * p[1] + m[10] * p[2] + m[11]};
}

/// A hilly surface in front of the camera: its depth at pixel coordinates, smooth, between 0.8 and 1.2 of `distance`.
inline double hills(double u, double v, double distance) {
    return distance * (1 + 0.1 * std::sin(u * 0.11 + 1) + 0.1 * std::cos(v * 0.17 + 0.05 * u));
}

/// The largest difference of two cameras: of the pixel that sees a point 1 unit of distance away, anywhere in the
/// window.
inline double largest_pixel_difference(const Camera& a, const Camera& b, const Window& window, double distance) {
    double largest = 0;
    for (int j = 0; j <= 4; ++j) {
        for (int i = 0; i <= 4; ++i) {
            for (const double d : {0.8 * distance, distance, 1.2 * distance}) {
                const double u = window.x + window.width * i / 4.0, v = window.y + window.height * j / 4.0;
                const Vector3 p = at_depth(a, u, v, d);
                const std::array<double, 16>& m = b.camera_to_world;
                const Vector3 q{p[0] - m[3], p[1] - m[7], p[2] - m[11]};
                const double x = m[0] * q[0] + m[4] * q[1] + m[8] * q[2], y = m[1] * q[0] + m[5] * q[1] + m[9] * q[2];
                const double z = -(m[2] * q[0] + m[6] * q[1] + m[10] * q[2]);
                const double w = b.projection == Projection::orthographic ? 1 : z;
                largest = std::max({largest, std::abs((x / w - b.x_offset) / b.x_scale - u),
                                    std::abs((y / w - b.y_offset) / b.y_scale - v)});
            }
        }
    }
    return largest;
}

}  // namespace relume::test
