// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "relume/shader_abi.h"

namespace relume {

/// The models of plugins/shaders, sorted by name; the list is generated.
std::span<const ShaderAbi* const> builtin_shaders();

}  // namespace relume
