// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "instance.h"
#include "relume/gbuffer.h"
#include "relume/rig.h"

namespace relume::ofx {

/// What the node says at one time: the rig file, the overrides and the knobs.
struct NodeRig {
    Rig rig;                   ///< of this frame; without the shader's knobs
    std::string gbuffer_file;  ///< of the parameter, this frame's; "" where clips or the rig decide
    std::string picture = "beauty";
    ShaderUse shader;  ///< `use` is "" where the rig's shaders stay as they are
    bool override_channels = false;
    bool varying = false;  ///< other frames may differ although no knob does
};

/// Errors: as Rig::load and Rig::set.
NodeRig node_rig(const Instance& instance, double time);

/// The rig with the shader's knobs: those for which the G-buffer has no channel, or all of them.
Rig complete_rig(const NodeRig& node, const GBuffer& gbuffer);

/// The frame that a time stands for.
std::int64_t frame_of(double time);

}  // namespace relume::ofx
