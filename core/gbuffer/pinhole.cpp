// SPDX-License-Identifier: Apache-2.0
#include "gbuffer/pinhole.h"

#include <cmath>
#include <limits>

namespace relume::gbuffer {

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
                               scaled(minus(s.point, n.centre), n.point_scale), s.depth * n.point_scale});
    }
    return n;
}

/// By a QR decomposition from the last row up; the sign is such that most of the
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

std::optional<Camera> orthographic(Vector3 across, Vector3 down, const Vector3& through, double u, double v) {
    const double su = length(across), sv = length(down);
    if (!(su > 0) || !(sv > 0) || !std::isfinite(su + sv)) return std::nullopt;
    // Noise leaves the two axes a little askew: turn both by half the angle.
    Vector3 x = scaled(across, 1 / su), y = scaled(down, -1 / sv);
    const double askew = dot(x, y) / 2;
    const Vector3 x0 = x;
    x = minus(x, scaled(y, askew));
    y = minus(y, scaled(x0, askew));
    x = scaled(x, 1 / length(x));
    y = minus(y, scaled(x, dot(x, y)));
    y = scaled(y, 1 / length(y));
    const Vector3 z = cross(x, y);
    if (!(length(z) > 0.5)) return std::nullopt;
    Camera camera;
    camera.projection = Projection::orthographic;
    camera.x_scale = 1 / su;
    camera.x_offset = -u / su;
    camera.y_scale = -1 / sv;
    camera.y_offset = v / sv;
    for (std::size_t i = 0; i < 3; ++i) {
        camera.camera_to_world[4 * i] = x[i];
        camera.camera_to_world[4 * i + 1] = y[i];
        camera.camera_to_world[4 * i + 2] = z[i];
        camera.camera_to_world[4 * i + 3] = through[i];
    }
    return camera;
}

double planar_depth(const Camera& camera, const Vector3& point) {
    const std::array<double, 16>& m = camera.camera_to_world;
    return -(m[2] * (point[0] - m[3]) + m[6] * (point[1] - m[7]) + m[10] * (point[2] - m[11]));
}

std::array<double, 2> project(const Camera& camera, const Vector3& point) {
    const std::array<double, 16>& m = camera.camera_to_world;
    const Vector3 p{point[0] - m[3], point[1] - m[7], point[2] - m[11]};
    const double x = m[0] * p[0] + m[4] * p[1] + m[8] * p[2];
    const double y = m[1] * p[0] + m[5] * p[1] + m[9] * p[2];
    const double depth = -(m[2] * p[0] + m[6] * p[1] + m[10] * p[2]);
    double w = 1;
    if (camera.projection == Projection::perspective) {
        if (!(depth > 0)) return {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
        w = depth;
    }
    return {(x / w - camera.x_offset) / camera.x_scale, (y / w - camera.y_offset) / camera.y_scale};
}

std::optional<Camera> camera_from_projection(const std::array<double, 12>& m) {
    std::optional<Pinhole> p =
        decompose({{{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}}}, {m[3], m[7], m[11]});
    if (!p) return std::nullopt;
    return to_camera(*p, Normalised{});
}

std::optional<Camera> camera_from_affine(const std::array<double, 12>& m) {
    const double w = m[11];
    if (!(std::abs(w) > 1e-30)) return std::nullopt;
    return orthographic({m[0] / w, m[1] / w, m[2] / w}, {m[4] / w, m[5] / w, m[6] / w}, {}, m[3] / w, m[7] / w);
}

}  // namespace relume::gbuffer
