// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "relume/gbuffer.h"
#include "relume/rig.h"
#include "relume/shader.h"

namespace relume {

/// What blender_principled leaves to the G-buffer, decided: options of value "auto" become the one that fits the
/// Blender that wrote the file and the channels that it has. `notes` tells the user.
void settle_blender_principled(const GBuffer& gbuffer, const ShaderInfo& shader, const ShaderUse& use,
                               std::vector<std::int32_t>& options, std::vector<std::string>& notes);

}  // namespace relume
