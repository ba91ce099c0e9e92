// SPDX-License-Identifier: Apache-2.0
#include "gbuffer/camera_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gbuffer/pinhole.h"

namespace relume::gbuffer {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kLeastSightings = 24;

std::optional<Pinhole> linear_fit(Normalised& n) {
    Matrix<12> normal{};
    const auto accumulate = [&](const std::array<double, 12>& row) {
        for (std::size_t i = 0; i < 12; ++i) {
            for (std::size_t j = i; j < 12; ++j) normal[i][j] += row[i] * row[j];
        }
    };
    for (const Sighting& s : n.sightings) {
        const auto& [x, y, z] = s.point;
        accumulate({x, y, z, 1, 0, 0, 0, 0, -s.u * x, -s.u * y, -s.u * z, -s.u});
        accumulate({0, 0, 0, 0, x, y, z, 1, -s.v * x, -s.v * y, -s.v * z, -s.v});
    }
    for (std::size_t i = 0; i < 12; ++i) {
        for (std::size_t j = 0; j < i; ++j) normal[i][j] = normal[j][i];
    }
    const Eigen<12> eigen = symmetric_eigen(normal);
    std::array<Vector3, 3> m{};
    Vector3 t{};
    double in_front = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) m[i][j] = eigen.vectors[4 * i + j][0];
        t[i] = eigen.vectors[4 * i + 3][0];
    }
    for (const Sighting& s : n.sightings) in_front += dot(m[2], s.point) + t[2] > 0 ? 1 : -1;
    if (in_front < 0) {
        for (std::size_t i = 0; i < 3; ++i) {
            m[i] = scaled(m[i], -1);
            t[i] = -t[i];
        }
    }
    std::optional<Pinhole> pinhole = decompose(m, t);
    if (!pinhole) return std::nullopt;
    if (determinant(pinhole->rotation) < 0) {
        // A left-handed world: fit its mirror image with a proper rotation.
        n.mirrored = true;
        for (Sighting& s : n.sightings) s.point[2] = -s.point[2];
        for (Vector3& row : pinhole->rotation) row[2] = -row[2];
    }
    return pinhole;
}

/// Leaves out what lies far off: pixels whose position is a mixture of two surfaces. Whether that changed anything.
bool keep_inliers(const Pinhole& p, std::span<const Sighting> sightings, std::vector<std::uint8_t>& kept) {
    std::vector<double> errors(sightings.size());
    for (std::size_t i = 0; i < sightings.size(); ++i) {
        const Vector<2> r = residual(p, sightings[i]);
        errors[i] = std::sqrt(r[0] * r[0] + r[1] * r[1]);
    }
    std::vector<double> sorted = errors;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    const double limit = 5 * *middle + 1e-12;
    bool changed = false;
    for (std::size_t i = 0; i < sightings.size(); ++i) {
        const std::uint8_t keep = errors[i] <= limit;
        changed = changed || keep != kept[i];
        kept[i] = keep;
    }
    return changed;
}

/// Parallel rays: u and v are affine in the point.
std::optional<Camera> affine_fit(const Normalised& n, std::span<const std::uint8_t> kept) {
    Matrix<4> a{};
    Vector<4> bu{}, bv{};
    for (std::size_t i = 0; i < n.sightings.size(); ++i) {
        if (!kept[i]) continue;
        const Sighting& s = n.sightings[i];
        const Vector<4> row{s.point[0], s.point[1], s.point[2], 1};
        for (std::size_t r = 0; r < 4; ++r) {
            bu[r] += row[r] * s.u;
            bv[r] += row[r] * s.v;
            for (std::size_t k = 0; k < 4; ++k) a[r][k] += row[r] * row[k];
        }
    }
    Vector<4> u{}, v{};
    if (!solve(a, bu, u) || !solve(a, bv, v)) return std::nullopt;
    Vector3 across{u[0], u[1], u[2]}, down{v[0], v[1], v[2]};
    // Parallel rays do not tell a left-handed world; what the linear fit thought of it does not count.
    if (n.mirrored) across[2] = -across[2], down[2] = -down[2];
    const double pixels = n.point_scale / n.pixel_scale;
    std::optional<Camera> camera = orthographic(scaled(across, pixels), scaled(down, pixels), n.centre,
                                                u[3] / n.pixel_scale + n.u0, v[3] / n.pixel_scale + n.v0);
    return camera;
}

/// Moves an orthographic camera back along its axis until all points lie in front.
void step_back(Camera& camera, std::span<const Sighting> sightings) {
    double nearest = kInfinity, farthest = -kInfinity;
    for (const Sighting& s : sightings) {
        nearest = std::min(nearest, planar_depth(camera, s.point));
        farthest = std::max(farthest, planar_depth(camera, s.point));
    }
    const double back = std::max(0.1 * (farthest - nearest), 1e-6) - nearest;
    for (std::size_t i = 0; i < 3; ++i) camera.camera_to_world[4 * i + 3] += back * camera.camera_to_world[4 * i + 2];
}

/// Sum of squared pixel errors of the kept sightings.
double squared_error(const Camera& camera, std::span<const Sighting> sightings, std::span<const std::uint8_t> kept) {
    double sum = 0;
    for (std::size_t i = 0; i < sightings.size(); ++i) {
        if (!kept[i]) continue;
        const auto [u, v] = project(camera, sightings[i].point);
        sum += (u - sightings[i].u) * (u - sightings[i].u) + (v - sightings[i].v) * (v - sightings[i].v);
    }
    return sum;
}

}  // namespace

double median_reprojection_error(const Camera& camera, std::span<const Sighting> sightings) {
    if (sightings.empty()) return kInfinity;
    std::vector<double> errors;
    errors.reserve(sightings.size());
    for (const Sighting& s : sightings) {
        const auto [u, v] = project(camera, s.point);
        const double error = std::sqrt((u - s.u) * (u - s.u) + (v - s.v) * (v - s.v));
        errors.push_back(std::isnan(error) ? kInfinity : error);
    }
    const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
    std::nth_element(errors.begin(), middle, errors.end());
    return *middle;
}

std::optional<CameraFit> fit_camera(std::span<const Sighting> sightings, const Window& display, double pixel_aspect,
                                    std::string& why) {
    if (sightings.size() < kLeastSightings) {
        why = "too few pixels hold a position";
        return std::nullopt;
    }
    Normalised n = normalise(sightings);
    Matrix<3> spread{};
    for (const Sighting& s : n.sightings) {
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 3; ++j) spread[i][j] += s.point[i] * s.point[j];
        }
    }
    const Eigen<3> axes = symmetric_eigen(spread);
    // Positions are floats: what departs from a plane by less than 1e-5 of its size is rounding.
    const bool planar = axes.values[0] < 1e-10 * axes.values[2];
    if (axes.values[1] < 1e-10 * axes.values[2]) {
        why = "all positions lie on one line";
        return std::nullopt;
    }

    CameraFit fit;
    fit.planar = planar;
    std::vector<std::uint8_t> kept(n.sightings.size(), 1);
    std::optional<Pinhole> pinhole;
    if (planar) {
        const auto column = [&](std::size_t k) {
            return Vector3{axes.vectors[0][k], axes.vectors[1][k], axes.vectors[2][k]};
        };
        const Vector3 x = column(2), y = column(1);
        pinhole = planar_fit(n, {x, y, cross(x, y)}, display, pixel_aspect);
        if (!pinhole) {
            why = "all positions lie on one plane that the camera faces squarely, so its distance cannot be told";
            return std::nullopt;
        }
    } else {
        pinhole = linear_fit(n);
    }
    // By depths the plane's lens and pose are exact already, and squarely seen planes have nothing to refine by.
    const bool exact = planar && n.sightings.front().depth > 0;
    if (pinhole) {
        if (!exact) refine(*pinhole, n.sightings, kept, !planar, pixel_aspect);
        for (int round = 0; !exact && round < 3 && keep_inliers(*pinhole, n.sightings, kept); ++round) {
            refine(*pinhole, n.sightings, kept, !planar, pixel_aspect);
        }
        fit.camera = to_camera(*pinhole, n);
    }
    const auto count = static_cast<double>(std::count(kept.begin(), kept.end(), 1));
    double error = pinhole ? squared_error(fit.camera, sightings, kept) : kInfinity;
    // Rounding of the positions alone makes errors of this size.
    const double noise = 1e-10 * count;

    if (pinhole && !planar) {
        Pinhole centred = *pinhole;
        centred.cx = (display.x + display.width / 2.0 - n.u0) * n.pixel_scale;
        centred.cy = (display.y + display.height / 2.0 - n.v0) * n.pixel_scale;
        centred.fy = centred.fx * pixel_aspect;
        refine(centred, n.sightings, kept, false, pixel_aspect);
        const Camera camera = to_camera(centred, n);
        const double centred_error = squared_error(camera, sightings, kept);
        // Three numbers more explain noise by a few parts in `count`; the rounding of positions is less even than
        // noise.
        const bool rounding = median_reprojection_error(camera, sightings) <=
                              1.1 * median_reprojection_error(fit.camera, sightings) + 1e-6;
        if (centred_error <= error * (1 + 30 / count) + noise || (rounding && centred_error <= 1.1 * error)) {
            fit.camera = camera;
            fit.centred = true;
            error = centred_error;
        }
    }
    if (!planar) {
        const std::optional<Camera> parallel = affine_fit(n, kept);
        // A few more degrees of freedom explain noise by a few parts in `count`, not by a percent.
        if (parallel && squared_error(*parallel, sightings, kept) <= 1.01 * error + noise) {
            fit.camera = *parallel;
            fit.centred = false;
            step_back(fit.camera, sightings);
        }
    }
    if (!std::isfinite(error)) {
        why = "no camera sees the positions where they are";
        return std::nullopt;
    }
    fit.mirrored = n.mirrored;
    fit.median_error = median_reprojection_error(fit.camera, sightings);
    return fit;
}

}  // namespace relume::gbuffer
