// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scenes/scene.h"

namespace relume::scene {

/// A sphere of radius 1 at the origin on a checkered ground at y = −1, sphere-traced. Y is up.
class SdfScene final : public Scene {
public:
    SdfScene(int width, int height, double time);

    Camera camera() const override;
    Surface trace(glm::dvec2 film) const override;
    glm::dvec3 radiance(const Surface& surface, const PathRandom& random) const override;
    glm::dvec3 background(const glm::dvec3& direction) const override;
    bool random() const override { return false; }
    std::span<const ChannelSpec> channels() const override;
    std::span<const std::string_view> objects() const override;

private:
    int width_;
    int height_;
    glm::dvec3 eye_;
    glm::dvec3 right_;
    glm::dvec3 up_;
    glm::dvec3 forward_;
};

/// Distance to the nearest surface; negative inside.
double sdf_distance(const glm::dvec3& p);

/// 1 − 3·Σ 0.95^i (h_i − distance(p + h_i·n)) over five taps h_i = 0.01 + 0.12·i/4, clamped to [0, 1]: how much the
/// surroundings fall short of the open half space's distances.
double sdf_ambient_occlusion(const glm::dvec3& p, const glm::dvec3& n);

/// Light from direction `l` (unit) that reaches p: the least of clamp(8·distance/t) on the way, over at most 24 steps
/// of 0.02 to 0.2 from t = 0.02 to t = 5.
double sdf_shadow(const glm::dvec3& p, const glm::dvec3& l);

/// The lights of the beauty, which examples/rigs/sdf.relume repeats.
struct SdfLights {
    glm::dvec3 to_sun;   ///< unit
    glm::dvec3 sun;      ///< irradiance
    glm::dvec3 sky;      ///< irradiance from straight above, over π
    glm::dvec3 to_back;  ///< unit, horizontal, away from the sun
    glm::dvec3 back;     ///< irradiance over π
};
SdfLights sdf_lights();

}  // namespace relume::scene
