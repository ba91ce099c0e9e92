// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "gbuffer_files.h"
#include "made_camera.h"

namespace relume::test {

/// Hills that fill the picture, as a renderer would see them: what of them each producer writes is up to the test.
struct MadeScene {
    MadeWindows windows;
    Camera camera;
    double distance = 8;

    MadeScene() : camera(look_at({3, -8, 4}, {0, 0, 1})) { test::set_lens(camera, windows.display, 0.45); }

    double depth(int x, int y) const { return hills(x + 0.5, y + 0.5, distance); }
    Vector3 position(int x, int y) const { return at_depth(camera, x + 0.5, y + 0.5, depth(x, y)); }
    /// Away from the camera's axis, but never away from the camera: in camera space.
    Vector3 camera_normal(int x, int y) const {
        const double u = (x + 0.5) * camera.x_scale + camera.x_offset, v = (y + 0.5) * camera.y_scale + camera.y_offset;
        const Vector3 back{-u, -v, 1};
        Vector3 n = gbuffer::plus(gbuffer::scaled(back, 1 / gbuffer::length(back)),
                                  {0.8 * std::sin(0.4 * x), 0.8 * std::cos(0.3 * y), 0});
        return gbuffer::scaled(n, 1 / gbuffer::length(n));
    }
    Vector3 world_normal(int x, int y) const {
        const Vector3 n = camera_normal(x, y);
        const std::array<double, 16>& m = camera.camera_to_world;
        return {m[0] * n[0] + m[1] * n[1] + m[2] * n[2], m[4] * n[0] + m[5] * n[1] + m[6] * n[2],
                m[8] * n[0] + m[9] * n[1] + m[10] * n[2]};
    }
    Vector3 camera_position(int x, int y) const {
        const double u = (x + 0.5) * camera.x_scale + camera.x_offset, v = (y + 0.5) * camera.y_scale + camera.y_offset;
        const double d = depth(x, y);
        return {u * d, v * d, -d};
    }
    double ray_distance(int x, int y) const {
        const Vector3 p = camera_position(x, y);
        return gbuffer::length(p);
    }
    /// World to camera, row-major for column vectors.
    std::array<double, 16> view_matrix() const {
        const std::array<double, 16>& m = camera.camera_to_world;
        std::array<double, 16> v{};
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 3; ++j) v[4 * i + j] = m[4 * j + i];
            v[4 * i + 3] = -(m[i] * m[3] + m[4 + i] * m[7] + m[8 + i] * m[11]);
        }
        v[15] = 1;
        return v;
    }
};

/// Three channels of a vector: name + separator + letters.
using VectorFunction = std::function<Vector3(int, int)>;
inline void add_vector(MadePart& part, const std::string& layer, const VectorFunction& value,
                       const char* letters = "XYZ", PixelType type = PixelType::float32) {
    for (std::size_t k = 0; k < 3; ++k) {
        const std::string suffix(1, letters[k]);
        part.channels.push_back(
            {layer.empty() ? suffix : layer + "." + suffix, [=](int x, int y) { return value(x, y)[k]; }, type});
    }
}
inline VectorFunction constant(double r, double g, double b) {
    return [=](int, int) { return Vector3{r, g, b}; };
}
inline std::array<double, 16> transposed(const std::array<double, 16>& m) {
    std::array<double, 16> t{};
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) t[4 * i + j] = m[4 * j + i];
    }
    return t;
}
inline std::array<double, 16> product(const std::array<double, 16>& a, const std::array<double, 16>& b) {
    std::array<double, 16> c{};
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) {
            for (std::size_t k = 0; k < 4; ++k) c[4 * i + j] += a[4 * i + k] * b[4 * k + j];
        }
    }
    return c;
}

/// The largest difference between an answered vector and what it should be.
inline double largest_difference(const Answer& answer, const Window& window, const VectorFunction& expected) {
    double largest = 0;
    for (int y = 0; y < window.height; ++y) {
        for (int x = 0; x < window.width; ++x) {
            const Vector3 e = expected(window.x + x, window.y + y);
            for (std::size_t k = 0; k < 3; ++k) {
                const double v =
                    static_cast<double>(answer[k][static_cast<std::size_t>(y)][static_cast<std::size_t>(x)]);
                largest = std::max(largest, std::isnan(v) ? 1e30 : std::abs(v - e[k]));
            }
        }
    }
    return largest;
}

}  // namespace relume::test
