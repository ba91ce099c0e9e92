// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "gbuffer/pinhole.h"

namespace relume::gbuffer {

namespace {

/// The plane's frame as the camera sees it (columns: two directions and the origin, up to rounding orthonormal), made
/// so.
Pinhole posed(double f, double aspect, double cx, double cy, Vector3 r1, Vector3 r2, const Vector3& origin,
              const Matrix<3>& axes, double height) {
    r1 = scaled(r1, 1 / length(r1));
    r2 = minus(r2, scaled(r1, dot(r1, r2)));
    r2 = scaled(r2, 1 / length(r2));
    const Vector3 r3 = cross(r1, r2);
    const Matrix<3> plane_to_camera{{{r1[0], r2[0], r3[0]}, {r1[1], r2[1], r3[1]}, {r1[2], r2[2], r3[2]}}};
    Pinhole p;
    p.fx = f;
    p.fy = f * aspect;
    p.cx = cx;
    p.cy = cy;
    p.rotation = times(plane_to_camera, axes);
    p.translation = minus(origin, scaled(r3, height));
    return p;
}

/// With depths the homography has its scale, and even a plane that the camera faces squarely gives the focal length.
std::optional<Pinhole> planar_fit_by_depth(const Normalised& n, const Matrix<3>& axes, double aspect, double cx,
                                           double cy, double height) {
    Matrix<3> normal{};
    std::array<Vector3, 3> right{};
    for (const Sighting& s : n.sightings) {
        const Vector3 row{dot(axes[0], s.point), dot(axes[1], s.point), 1};
        const Vector3 seen{(s.u - cx) * s.depth, (s.v - cy) / aspect * s.depth, s.depth};
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 3; ++j) {
                normal[i][j] += row[i] * row[j];
                right[i][j] += seen[i] * row[j];
            }
        }
    }
    std::array<Vector3, 3> h{};  // rows: u·d, v·d and d as functions of the place on the plane
    for (std::size_t i = 0; i < 3; ++i) {
        if (!solve(normal, right[i], h[i])) return std::nullopt;
    }
    const double across = h[0][0] * h[0][0] + h[1][0] * h[1][0] + h[0][1] * h[0][1] + h[1][1] * h[1][1];
    const double along = 2 - h[2][0] * h[2][0] - h[2][1] * h[2][1];
    if (!(across > 0) || !(along > 1e-6)) return std::nullopt;
    const double f = std::sqrt(across / along);
    const auto column = [&](std::size_t j) { return Vector3{h[0][j] / f, h[1][j] / f, h[2][j]}; };
    return posed(f, aspect, cx, cy, column(0), column(1), column(2), axes, height);
}

}  // namespace

/// Points on one plane, seen through a lens whose axis meets the middle of the display window and whose pixels have the
/// header's shape: the homography of the plane then gives the focal length (Zhang 2000, section 3.1).
std::optional<Pinhole> planar_fit(const Normalised& n, const Matrix<3>& axes, const Window& display, double aspect) {
    Matrix<9> normal{};
    const auto accumulate = [&](const std::array<double, 9>& row) {
        for (std::size_t i = 0; i < 9; ++i) {
            for (std::size_t j = 0; j < 9; ++j) normal[i][j] += row[i] * row[j];
        }
    };
    const double cx = (display.x + display.width / 2.0 - n.u0) * n.pixel_scale;
    const double cy = (display.y + display.height / 2.0 - n.v0) * n.pixel_scale;
    double height = 0;
    for (const Sighting& s : n.sightings) {
        const double x = dot(axes[0], s.point), y = dot(axes[1], s.point);
        // In square pixels about the lens' axis.
        const double u = s.u - cx, v = (s.v - cy) / aspect;
        height += dot(axes[2], s.point) / static_cast<double>(n.sightings.size());
        accumulate({x, y, 1, 0, 0, 0, -u * x, -u * y, -u});
        accumulate({0, 0, 0, x, y, 1, -v * x, -v * y, -v});
    }
    const bool depths =
        std::all_of(n.sightings.begin(), n.sightings.end(), [](const Sighting& s) { return s.depth > 0; });
    if (depths) return planar_fit_by_depth(n, axes, aspect, cx, cy, height);
    const Eigen<9> eigen = symmetric_eigen(normal);
    Matrix<3> h{};
    for (std::size_t i = 0; i < 9; ++i) h[i / 3][i % 3] = eigen.vectors[i][0];
    const auto column = [&](std::size_t j) { return Vector3{h[0][j], h[1][j], h[2][j]}; };
    Vector3 h1 = column(0), h2 = column(1), h3 = column(2);
    // With ω = diag(1/f², 1/f², 1): h1·ω·h2 = 0 and h1·ω·h1 = h2·ω·h2. Both in the least-squares sense.
    const double a1 = h1[0] * h2[0] + h1[1] * h2[1], b1 = h1[2] * h2[2];
    const double a2 = h1[0] * h1[0] + h1[1] * h1[1] - h2[0] * h2[0] - h2[1] * h2[1];
    const double b2 = h1[2] * h1[2] - h2[2] * h2[2];
    const double f2 = -(a1 * a1 + a2 * a2) / (a1 * b1 + a2 * b2);
    // A plane that the camera faces squarely looks the same for every focal length.
    const double tilt = std::abs(b1) + std::abs(b2), size = h1[2] * h1[2] + h2[2] * h2[2] + h3[2] * h3[2];
    if (!(f2 > 0) || !std::isfinite(f2) || tilt < 1e-8 * size) return std::nullopt;
    const double f = std::sqrt(f2);
    for (Vector3* column_vector : {&h1, &h2, &h3}) {
        (*column_vector)[0] /= f;
        (*column_vector)[1] /= f;
    }
    double scale = 2 / (length(h1) + length(h2));
    if (h3[2] < 0) scale = -scale;
    return posed(f, aspect, cx, cy, scaled(h1, scale), scaled(h2, scale), scaled(h3, scale), axes, height);
}

}  // namespace relume::gbuffer
