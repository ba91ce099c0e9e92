// SPDX-License-Identifier: Apache-2.0
#include "scenes/room.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace relume::scene {
namespace {

using glm::dvec3;

constexpr double kPi = std::numbers::pi;
/// How far a reflected ray starts above its surface, in the room's unit.
constexpr double kNudge = 0.01;

/// The smallest t > 0, or 0 for none. The discriminant comes from the distance of the ray to the centre, not from b² −
/// c: the two squares would cancel for spheres far away (Haines et al. 2019, "Precision improvements for ray/sphere
/// intersection", Ray Tracing Gems 7.1).
double intersect(const RoomSphere& sphere, const dvec3& origin, const dvec3& direction) {
    const dvec3 to_centre = sphere.centre - origin;
    const double b = glm::dot(to_centre, direction);
    const dvec3 across = to_centre - direction * b;
    const double discriminant = sphere.radius * sphere.radius - glm::dot(across, across);
    if (discriminant < 0) return 0;
    const double root = std::sqrt(discriminant);
    if (b - root > 0) return b - root;
    return b + root > 0 ? b + root : 0;
}

double intersect(const RoomRectangle& r, const dvec3& origin, const dvec3& direction) {
    const double t = (r.low[r.axis] - origin[r.axis]) / direction[r.axis];
    if (!(t > 0) || !std::isfinite(t)) return 0;
    for (int axis = 0; axis < 3; ++axis) {
        const double at = origin[axis] + t * direction[axis];
        if (axis != r.axis && (at < r.low[axis] || at > r.high[axis])) return 0;
    }
    return t;
}

/// Cosine-distributed about n: a uniform point on the unit sphere that rests on n's tip.
dvec3 cosine_direction(const dvec3& n, double u, double v) {
    const double z = 1 - 2 * u;
    const double r = std::sqrt(std::max(0.0, 1 - z * z));
    const dvec3 d = n + dvec3(r * std::cos(2 * kPi * v), r * std::sin(2 * kPi * v), z);
    const double length = glm::length(d);
    return length > 1e-9 ? d / length : n;
}

/// Near the light's own plane, where 1/r² has no bound, waiting to meet the light is better than aiming at it.
bool near_light(const RoomRectangle& light, const dvec3& p) {
    const dvec3 nearest = glm::clamp(p, light.low, light.high);
    return glm::dot(p - nearest, p - nearest) < 1;
}

}  // namespace

std::optional<RoomHit> Room::trace(const dvec3& origin, const dvec3& direction) const {
    RoomHit hit;
    const RoomSphere* sphere = nullptr;
    const RoomRectangle* rectangle = nullptr;
    for (const RoomSphere& candidate : spheres) {
        const double t = intersect(candidate, origin, direction);
        if (t > 0 && (!sphere || t < hit.t)) {
            hit.t = t;
            sphere = &candidate;
        }
    }
    for (const RoomRectangle& candidate : rectangles) {
        const double t = intersect(candidate, origin, direction);
        if (t > 0 && ((!sphere && !rectangle) || t < hit.t)) {
            hit.t = t;
            rectangle = &candidate;
        }
    }
    if (!sphere && !rectangle) return std::nullopt;

    hit.position = origin + direction * hit.t;
    if (rectangle) {
        hit.object = rectangle->object;
        hit.material = rectangle->material;
        hit.position[rectangle->axis] = rectangle->low[rectangle->axis];
        hit.normal[rectangle->axis] = direction[rectangle->axis] > 0 ? -1 : 1;
    } else {
        hit.object = sphere->object;
        hit.material = sphere->material;
        hit.normal = glm::normalize(hit.position - sphere->centre);
        if (glm::dot(hit.normal, direction) > 0) hit.normal = -hit.normal;
    }
    return hit;
}

bool Room::blocked(const dvec3& origin, const dvec3& direction, double distance) const {
    const auto in_the_way = [&](const auto& shape) {
        const double t = intersect(shape, origin, direction);
        return t > 0 && t < distance;
    };
    return std::any_of(spheres.begin(), spheres.end(), in_the_way) ||
           std::any_of(rectangles.begin(), rectangles.end(), in_the_way);
}

dvec3 Room::radiance(RoomHit hit, dvec3 direction, const PathRandom& random, const PathOptions& options) const {
    dvec3 sum(0);
    dvec3 throughput(1);
    bool aimed = false;  // the light was asked at the vertex before: meeting it now would count it twice
    for (int bounce = 0;; ++bounce) {
        const RoomMaterial& m = materials[static_cast<std::size_t>(hit.material)];
        if (!aimed || !light || hit.object != light->object) sum += throughput * m.emission;
        if (bounce == options.bounces) return sum;

        const std::array<double, 4> u = random.draw(static_cast<std::uint32_t>(2 * bounce));
        const dvec3 origin = hit.position + hit.normal * kNudge;
        const bool mirrored = u[0] < m.percent_specular;
        throughput *= mirrored ? m.specular_color : m.albedo;
        if (throughput == dvec3(0)) return sum;
        const dvec3 diffuse = cosine_direction(hit.normal, u[1], u[2]);

        aimed = options.aim_at_light && light && !mirrored && !near_light(*light, origin);
        if (aimed) {
            const std::array<double, 4> w = random.draw(static_cast<std::uint32_t>(2 * bounce + 1));
            dvec3 point;
            for (int axis = 0; axis < 3; ++axis) point[axis] = glm::mix(light->low[axis], light->high[axis], w[axis]);
            const dvec3 size = light->high - light->low;
            const double area = size[(light->axis + 1) % 3] * size[(light->axis + 2) % 3];
            const dvec3 way = point - origin;
            const double distance = glm::length(way);
            const dvec3 to_light = way / distance;
            const double cosines = glm::dot(hit.normal, to_light) * std::abs(to_light[light->axis]);
            // Short of the light by the nudge, or rounding would let the light shade itself.
            if (cosines > 0 && !blocked(origin, to_light, distance - kNudge)) {
                const dvec3& emission = materials[static_cast<std::size_t>(light->material)].emission;
                sum += throughput * emission * (cosines * area / (kPi * distance * distance));
            }
        }

        if (mirrored) {
            // The mirrored view and the diffuse direction blended by roughness², normalised: the lobe of specular_mix.
            const dvec3 mirror = glm::reflect(direction, hit.normal);
            const dvec3 blend = glm::mix(mirror, diffuse, m.roughness * m.roughness);
            const double length = glm::length(blend);
            direction = length > 1e-9 ? blend / length : mirror;
        } else {
            direction = diffuse;
        }
        const std::optional<RoomHit> next = trace(origin, direction);
        if (!next) return sum;
        hit = *next;
    }
}

}  // namespace relume::scene
