// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "scenes/random.h"

namespace relume::scene {

/// A surface that reflects a path into its mirror lobe with probability `percent_specular`, tinted by `specular_color`,
/// else diffusely, tinted by `albedo`. The shader `specular_mix` is the same surface as a BRDF.
struct RoomMaterial {
    glm::dvec3 albedo{0};
    glm::dvec3 specular_color{0};
    glm::dvec3 emission{0};  ///< radiance, from both sides
    double percent_specular = 0;
    double roughness = 1;  ///< 0: mirror, 1: Lambert
};

struct RoomSphere {
    glm::dvec3 centre;
    double radius;
    int object;    ///< from 1
    int material;  ///< index into Room::materials
};

/// A rectangle across one axis, seen from both sides.
struct RoomRectangle {
    int axis;        ///< the normal's: 0, 1, 2 for x, y, z
    glm::dvec3 low;  ///< corners; low[axis] == high[axis]
    glm::dvec3 high;
    int object;
    int material;
};

struct RoomHit {
    double t = 0;
    int object = 0;
    int material = 0;
    glm::dvec3 position{0};
    glm::dvec3 normal{0};  ///< unit, against the ray
};

struct PathOptions {
    int bounces = 8;
    /// Diffuse reflections aim at the light instead of waiting to meet it: the same mean, a fraction of the noise.
    bool aim_at_light = true;
};

/// Spheres and rectangles, intersected one by one, and the paths that light takes among them. The outside is black.
struct Room {
    std::vector<RoomMaterial> materials;
    std::vector<RoomSphere> spheres;
    std::vector<RoomRectangle> rectangles;
    std::optional<RoomRectangle> light;  ///< one of `rectangles`: what paths aim at

    /// The nearest surface along origin + t·direction (unit), t > 0.
    std::optional<RoomHit> trace(const glm::dvec3& origin, const glm::dvec3& direction) const;

    /// Whether a surface lies on the way before t = `distance`.
    bool blocked(const glm::dvec3& origin, const glm::dvec3& direction, double distance) const;

    /// One sample of the radiance that leaves `hit` against `direction` (that of the ray that found it).
    glm::dvec3 radiance(RoomHit hit, glm::dvec3 direction, const PathRandom& random, const PathOptions& options) const;
};

}  // namespace relume::scene
