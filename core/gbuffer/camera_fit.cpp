// SPDX-License-Identifier: Apache-2.0
#include "gbuffer/camera_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace relume::gbuffer {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kLeastSightings = 24;

/// A pinhole whose own axes run right, down and forward, in the normalised coordinates of the fit.
struct Pinhole {
    double fx = 1, fy = 1, cx = 0, cy = 0;
    Matrix<3> rotation{};
    Vector3 translation{};
};

/// What the fit works on: centred and scaled points and pixels, so that the normal equations are well conditioned.
struct Normalised {
    std::vector<Sighting> sightings;
    double u0 = 0, v0 = 0, pixel_scale = 1;  ///< u' = (u − u0)·pixel_scale
    Vector3 centre{};
    double point_scale = 1;  ///< p' = (p − centre)·point_scale, z negated when mirrored
    bool mirrored = false;
};

Normalised normalise(std::span<const Sighting> sightings) {
    Normalised n;
    const double count = static_cast<double>(sightings.size());
    for (const Sighting& s : sightings) {
        n.u0 += s.u / count;
        n.v0 += s.v / count;
        n.centre = plus(n.centre, scaled(s.point, 1 / count));
    }
    double pixels = 0, points = 0;
    for (const Sighting& s : sightings) {
        pixels += std::sqrt((s.u - n.u0) * (s.u - n.u0) + (s.v - n.v0) * (s.v - n.v0)) / count;
        points += length(minus(s.point, n.centre)) / count;
    }
    n.pixel_scale = pixels > 0 ? std::sqrt(2.0) / pixels : 1;
    n.point_scale = points > 0 ? std::sqrt(3.0) / points : 1;
    n.sightings.reserve(sightings.size());
    for (const Sighting& s : sightings) {
        n.sightings.push_back({(s.u - n.u0) * n.pixel_scale, (s.v - n.v0) * n.pixel_scale,
                               scaled(minus(s.point, n.centre), n.point_scale)});
    }
    return n;
}

/// Splits a projection into lens and pose by a QR decomposition from the last row up; the sign is such that most of the
/// points lie in front. Nothing when it is singular.
std::optional<Pinhole> decompose(std::array<Vector3, 3> m, Vector3 t) {
    const double k33 = length(m[2]);
    if (!(k33 > 0) || !std::isfinite(k33)) return std::nullopt;
    for (std::size_t i = 0; i < 3; ++i) {
        m[i] = scaled(m[i], 1 / k33);
        t[i] /= k33;
    }
    Pinhole p;
    const Vector3 r3 = m[2];
    p.cy = dot(m[1], r3);
    const Vector3 y = minus(m[1], scaled(r3, p.cy));
    p.fy = length(y);
    if (!(p.fy > 0)) return std::nullopt;
    const Vector3 r2 = scaled(y, 1 / p.fy);
    p.cx = dot(m[0], r3);
    const double skew = dot(m[0], r2);
    const Vector3 x = minus(m[0], plus(scaled(r3, p.cx), scaled(r2, skew)));
    p.fx = length(x);
    if (!(p.fx > 0)) return std::nullopt;
    p.rotation = {scaled(x, 1 / p.fx), r2, r3};
    p.translation[2] = t[2];
    p.translation[1] = (t[1] - p.cy * t[2]) / p.fy;
    p.translation[0] = (t[0] - p.cx * t[2] - skew * p.translation[1]) / p.fx;
    return p;
}

std::optional<Pinhole> linear_fit(Normalised& n) {
    Matrix<12> normal{};
    const auto accumulate = [&](const std::array<double, 12>& row) {
        for (std::size_t i = 0; i < 12; ++i) {
            for (std::size_t j = i; j < 12; ++j)
                normal[i][j] += row[i] * row[j];
        }
    };
    for (const Sighting& s : n.sightings) {
        const auto& [x, y, z] = s.point;
        accumulate({x, y, z, 1, 0, 0, 0, 0, -s.u * x, -s.u * y, -s.u * z, -s.u});
        accumulate({0, 0, 0, 0, x, y, z, 1, -s.v * x, -s.v * y, -s.v * z, -s.v});
    }
    for (std::size_t i = 0; i < 12; ++i) {
        for (std::size_t j = 0; j < i; ++j)
            normal[i][j] = normal[j][i];
    }
    const Eigen<12> eigen = symmetric_eigen(normal);
    std::array<Vector3, 3> m{};
    Vector3 t{};
    double in_front = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j)
            m[i][j] = eigen.vectors[4 * i + j][0];
        t[i] = eigen.vectors[4 * i + 3][0];
    }
    for (const Sighting& s : n.sightings)
        in_front += dot(m[2], s.point) + t[2] > 0 ? 1 : -1;
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
        for (Sighting& s : n.sightings)
            s.point[2] = -s.point[2];
        for (Vector3& row : pinhole->rotation)
            row[2] = -row[2];
    }
    return pinhole;
}

Vector<2> residual(const Pinhole& p, const Sighting& s) {
    const Vector3 c = plus(times(p.rotation, s.point), p.translation);
    if (!(c[2] > 0)) return {kInfinity, kInfinity};
    return {p.fx * c[0] / c[2] + p.cx - s.u, p.fy * c[1] / c[2] + p.cy - s.v};
}

double squared_error(const Pinhole& p, std::span<const Sighting> sightings, std::span<const std::uint8_t> kept) {
    double sum = 0;
    for (std::size_t i = 0; i < sightings.size(); ++i) {
        if (!kept[i]) continue;
        const Vector<2> r = residual(p, sightings[i]);
        sum += r[0] * r[0] + r[1] * r[1];
    }
    return sum;
}

/// The rotation by the vector `w` (Rodrigues 1840).
Matrix<3> rotation_by(const Vector3& w) {
    const double angle = length(w);
    if (angle < 1e-300) return {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    const Vector3 k = scaled(w, 1 / angle);
    const double c = std::cos(angle), s = std::sin(angle), d = 1 - c;
    return {{{c + k[0] * k[0] * d, k[0] * k[1] * d - k[2] * s, k[0] * k[2] * d + k[1] * s},
             {k[1] * k[0] * d + k[2] * s, c + k[1] * k[1] * d, k[1] * k[2] * d - k[0] * s},
             {k[2] * k[0] * d - k[1] * s, k[2] * k[1] * d + k[0] * s, c + k[2] * k[2] * d}}};
}

/// What of the lens may move: `free_lens` all four numbers, else the focal length alone with fy = fx·aspect.
Pinhole step(const Pinhole& p, const Vector<10>& d, bool free_lens, double aspect) {
    Pinhole q = p;
    q.rotation = times(rotation_by({d[0], d[1], d[2]}), p.rotation);
    q.translation = plus(times(rotation_by({d[0], d[1], d[2]}), p.translation), {d[3], d[4], d[5]});
    q.fx += d[6];
    if (free_lens) {
        q.fy += d[7];
        q.cx += d[8];
        q.cy += d[9];
    } else {
        q.fy = q.fx * aspect;
    }
    return q;
}

/// Levenberg 1944, Marquardt 1963 on the reprojection error.
void refine(Pinhole& p, std::span<const Sighting> sightings, std::span<const std::uint8_t> kept, bool free_lens,
            double aspect) {
    double error = squared_error(p, sightings, kept);
    double damping = 1e-6;
    for (int iteration = 0; iteration < 60; ++iteration) {
        Matrix<10> a{};
        Vector<10> b{};
        for (std::size_t i = 0; i < sightings.size(); ++i) {
            if (!kept[i]) continue;
            const Sighting& s = sightings[i];
            const Vector3 c = plus(times(p.rotation, s.point), p.translation);
            if (!(c[2] > 0)) continue;
            const double x = c[0] / c[2], y = c[1] / c[2], w = 1 / c[2];
            // Derivatives of (fx·x + cx, fy·y + cy) by rotation of the camera frame, translation and lens.
            Vector<10> ju{p.fx * -x * y, p.fx * (1 + x * x), p.fx * -y, p.fx * w, 0, p.fx * -x * w, x, 0, 1, 0};
            Vector<10> jv{p.fy * -(1 + y * y), p.fy * x * y, p.fy * x, 0, p.fy * w, p.fy * -y * w, 0, y, 0, 1};
            if (!free_lens) {
                jv[6] = y * aspect;
                ju[8] = jv[7] = jv[9] = 0;
            }
            const double ru = p.fx * x + p.cx - s.u, rv = p.fy * y + p.cy - s.v;
            for (std::size_t r = 0; r < 10; ++r) {
                b[r] -= ju[r] * ru + jv[r] * rv;
                for (std::size_t k = 0; k <= r; ++k)
                    a[r][k] += ju[r] * ju[k] + jv[r] * jv[k];
            }
        }
        if (!free_lens) a[7][7] = a[8][8] = a[9][9] = 1;
        bool better = false;
        for (int attempt = 0; attempt < 8 && !better; ++attempt) {
            Matrix<10> damped = a;
            for (std::size_t r = 0; r < 10; ++r)
                damped[r][r] *= 1 + damping;
            Vector<10> d{};
            if (!solve(damped, b, d)) {
                damping = damping * 10 + 1e-12;
                continue;
            }
            const Pinhole q = step(p, d, free_lens, aspect);
            const double new_error = squared_error(q, sightings, kept);
            if (new_error < error) {
                better = true;
                const bool done = error - new_error < 1e-6 * error;
                p = q;
                error = new_error;
                damping = std::max(damping / 10, 1e-14);
                if (done) return;
            } else {
                damping *= 10;
            }
        }
        if (!better) return;
    }
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

Camera to_camera(const Pinhole& p, const Normalised& n) {
    Camera camera;
    const double fx = p.fx / n.pixel_scale, fy = p.fy / n.pixel_scale;
    const double cx = p.cx / n.pixel_scale + n.u0, cy = p.cy / n.pixel_scale + n.v0;
    camera.x_scale = 1 / fx;
    camera.x_offset = -cx / fx;
    camera.y_scale = -1 / fy;
    camera.y_offset = cy / fy;
    // World = Rᵀ(c − t), in the points' own scale; the camera's Y and Z point the other way than the pinhole's.
    const Matrix<3> back = transposed(p.rotation);
    Vector3 origin = scaled(times(back, p.translation), -1);
    if (n.mirrored) origin[2] = -origin[2];
    origin = plus(scaled(origin, 1 / n.point_scale), n.centre);
    for (std::size_t i = 0; i < 3; ++i) {
        const double mirror = n.mirrored && i == 2 ? -1 : 1;
        camera.camera_to_world[4 * i] = mirror * back[i][0];
        camera.camera_to_world[4 * i + 1] = -mirror * back[i][1];
        camera.camera_to_world[4 * i + 2] = -mirror * back[i][2];
        camera.camera_to_world[4 * i + 3] = origin[i];
    }
    return camera;
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
            for (std::size_t k = 0; k < 4; ++k)
                a[r][k] += row[r] * row[k];
        }
    }
    Vector<4> u{}, v{};
    if (!solve(a, bu, u) || !solve(a, bv, v)) return std::nullopt;
    const Vector3 across{u[0], u[1], u[2]}, down{v[0], v[1], v[2]};
    const double su = length(across), sv = length(down);
    if (!(su > 0) || !(sv > 0)) return std::nullopt;
    // Noise leaves the two axes a little askew: turn both by half the angle.
    Vector3 x = scaled(across, 1 / su), y = scaled(down, -1 / sv);
    const double askew = dot(x, y) / 2;
    const Vector3 x0 = x;
    x = minus(x, scaled(y, askew));
    y = minus(y, scaled(x0, askew));
    x = scaled(x, 1 / length(x));
    y = minus(y, scaled(x, dot(x, y)));
    y = scaled(y, 1 / length(y));
    // Parallel rays do not tell a left-handed world; what the linear fit thought of it does not count.
    if (n.mirrored) x[2] = -x[2], y[2] = -y[2];
    const Vector3 z = cross(x, y);
    // Behind all the points, so that their depths are positive.
    double top = -kInfinity;
    for (const Sighting& s : n.sightings) {
        top = std::max(top, z[0] * s.point[0] + z[1] * s.point[1] + (n.mirrored ? -z[2] : z[2]) * s.point[2]);
    }
    const double margin = 1.0;
    Vector3 origin = scaled(z, top + margin);
    Camera camera;
    camera.projection = Projection::orthographic;
    // X in world units from the origin's own ray: u' = su·(x·p') + u[3], with p' and u' as normalised.
    const double fx = su * n.point_scale / n.pixel_scale, fy = sv * n.point_scale / n.pixel_scale;
    const double cx = u[3] / n.pixel_scale + n.u0, cy = v[3] / n.pixel_scale + n.v0;
    camera.x_scale = 1 / fx;
    camera.x_offset = -cx / fx;
    camera.y_scale = -1 / fy;
    camera.y_offset = cy / fy;
    origin = plus(scaled(origin, 1 / n.point_scale), n.centre);
    for (std::size_t i = 0; i < 3; ++i) {
        camera.camera_to_world[4 * i] = x[i];
        camera.camera_to_world[4 * i + 1] = y[i];
        camera.camera_to_world[4 * i + 2] = z[i];
        camera.camera_to_world[4 * i + 3] = origin[i];
    }
    return camera;
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

/// Points on one plane, seen through a lens whose axis meets the middle of the display window and whose pixels have the
/// header's shape: the homography of the plane then gives the focal length (Zhang 2000, section 3.1).
std::optional<Pinhole> planar_fit(const Normalised& n, const Matrix<3>& axes, const Window& display, double aspect) {
    Matrix<9> normal{};
    const auto accumulate = [&](const std::array<double, 9>& row) {
        for (std::size_t i = 0; i < 9; ++i) {
            for (std::size_t j = 0; j < 9; ++j)
                normal[i][j] += row[i] * row[j];
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
    const Eigen<9> eigen = symmetric_eigen(normal);
    Matrix<3> h{};
    for (std::size_t i = 0; i < 9; ++i)
        h[i / 3][i % 3] = eigen.vectors[i][0];
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
    if (h3[2] * scale < 0) scale = -scale;
    Vector3 r1 = scaled(h1, 1 / length(h1));
    if (scale < 0) r1 = scaled(r1, -1);
    Vector3 r2 = scaled(h2, scale);
    r2 = minus(r2, scaled(r1, dot(r1, r2)));
    r2 = scaled(r2, 1 / length(r2));
    const Vector3 r3 = cross(r1, r2);
    Pinhole p;
    p.fx = f;
    p.fy = f * aspect;
    p.cx = cx;
    p.cy = cy;
    const Matrix<3> plane_to_camera{{{r1[0], r2[0], r3[0]}, {r1[1], r2[1], r3[1]}, {r1[2], r2[2], r3[2]}}};
    p.rotation = times(plane_to_camera, axes);
    p.translation = minus(scaled(h3, scale), scaled(r3, height));
    return p;
}

}  // namespace

std::array<double, 2> project(const Camera& camera, const Vector3& point) {
    const std::array<double, 16>& m = camera.camera_to_world;
    const Vector3 p{point[0] - m[3], point[1] - m[7], point[2] - m[11]};
    const double x = m[0] * p[0] + m[4] * p[1] + m[8] * p[2];
    const double y = m[1] * p[0] + m[5] * p[1] + m[9] * p[2];
    const double depth = -(m[2] * p[0] + m[6] * p[1] + m[10] * p[2]);
    double w = 1;
    if (camera.projection == Projection::perspective) {
        if (!(depth > 0)) return {kInfinity, kInfinity};
        w = depth;
    }
    return {(x / w - camera.x_offset) / camera.x_scale, (y / w - camera.y_offset) / camera.y_scale};
}

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

std::optional<Camera> camera_from_projection(const std::array<double, 12>& m) {
    std::optional<Pinhole> p =
        decompose({{{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}}}, {m[3], m[7], m[11]});
    if (!p) return std::nullopt;
    return to_camera(*p, Normalised{});
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
            for (std::size_t j = 0; j < 3; ++j)
                spread[i][j] += s.point[i] * s.point[j];
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
    if (pinhole) {
        refine(*pinhole, n.sightings, kept, !planar, pixel_aspect);
        for (int round = 0; round < 3 && keep_inliers(*pinhole, n.sightings, kept); ++round) {
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
