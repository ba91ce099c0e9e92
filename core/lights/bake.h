// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "relume/camera.h"
#include "relume/rig.h"
#include "relume/shader_abi.h"

namespace relume {

/// A rig's light as the kernel takes it. One of the two is set.
struct BakedLight {
    std::string name;
    std::optional<DirectLight> direct;
    std::optional<AmbientLight> ambient;
    std::vector<std::string> include;  ///< light linking: the caller fills the mask
    std::vector<std::string> exclude;

    bool needs_position() const { return direct && direct->kind != LightKind::sun; }
};

/// World-space constants of a light. `camera` places lights with space = "camera"; where it is absent the camera is
/// taken to be at the world's origin. `warnings` gets a sentence for what the light asks and shading leaves out.
/// Errors: parameter (zero direction; power and intensity both given; no position; brighter than float holds).
BakedLight bake_light(const Light& light, const std::optional<Camera>& camera, std::vector<std::string>& warnings);

}  // namespace relume
