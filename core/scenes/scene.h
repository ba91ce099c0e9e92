// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "relume/camera.h"
#include "scenes/random.h"

namespace relume::scene {

/// What a camera ray sees. All of it is 0 where that is the background (`object` 0).
struct Surface {
    int object = 0;    ///< from 1, in the order of Scene::objects()
    int material = 0;  ///< from 1
    double depth = 0;  ///< along the view axis
    glm::dvec3 position{0};
    glm::dvec3 normal{0};     ///< unit, to the viewer
    glm::dvec3 direction{0};  ///< of the ray, unit; given for the background too
    glm::dvec3 base_color{0};
    glm::dvec3 specular_color{0};
    glm::dvec3 emission{0};
    double roughness = 0;
    double metallic = 0;
    double specular = 0;
    double percent_specular = 0;
    double ambient_occlusion = 0;  ///< 1 in the open
    double sun_shadow = 0;         ///< 1 in the light
};

/// One channel of a scene's G-buffer, without the view layer's name.
struct ChannelSpec {
    std::string_view name;
    double (*value)(const Surface&);
    bool centre_only = false;  ///< from the ray through the pixel's centre instead of the mean over the pixel
};

class Scene {
public:
    virtual ~Scene() = default;

    virtual Camera camera() const = 0;
    /// `film`: absolute pixel coordinates, pixel centres at ½.
    virtual Surface trace(glm::dvec2 film) const = 0;
    /// Radiance along the camera ray that saw `surface`; without the background's where there is no surface.
    virtual glm::dvec3 radiance(const Surface& surface, const PathRandom& random) const = 0;
    virtual glm::dvec3 background(const glm::dvec3& direction) const = 0;
    /// Whether radiance() needs many paths: else it does not use its random numbers.
    virtual bool random() const = 0;
    virtual std::span<const ChannelSpec> channels() const = 0;
    virtual std::span<const std::string_view> objects() const = 0;
};

}  // namespace relume::scene
