// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scenes/room.h"
#include "scenes/scene.h"

namespace relume::scene {

/// A box with a red and a green side, a light under its ceiling, three glossy spheres on the floor and five shiny ones
/// in a row before the back wall, rougher from one to the next. Open towards the eye, which is at the origin and looks
/// along +z with a horizontal field of view of 90°; +x is on the right of the picture and +y up.
class CornellScene final : public Scene {
public:
    CornellScene(int width, int height, int bounces);

    Camera camera() const override;
    Surface trace(glm::dvec2 film) const override;
    glm::dvec3 radiance(const Surface& surface, const PathRandom& random) const override;
    glm::dvec3 background(const glm::dvec3&) const override { return glm::dvec3(0); }
    bool random() const override { return true; }
    std::span<const ChannelSpec> channels() const override;
    std::span<const std::string_view> objects() const override;

private:
    int width_;
    int height_;
    PathOptions paths_;
    Room room_;
};

Room cornell_room();

}  // namespace relume::scene
