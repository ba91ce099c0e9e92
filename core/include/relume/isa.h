// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

#include "relume/export.h"

namespace relume {

/// Instruction sets that this build has kernels for and this CPU can run, the scalar reference first, the best last.
RELUME_API std::vector<std::string_view> available_isas();

/// The one in use: the best available, or what the environment variable RELUME_ISA names (scalar, x86-64-v2, x86-64-v3,
/// x86-64-v4, neon). Throws Error(value) when that is unknown or cannot run here. Read once, at the first call.
RELUME_API std::string_view active_isa();

/// For tests and benchmarks: from now on use this one. Not thread-safe against relight() calls under way.
RELUME_API void use_isa(std::string_view isa);

}  // namespace relume
