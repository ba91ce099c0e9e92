// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "relume/lookup_table.h"
#include "relume/shader_abi.h"

namespace relume {

/// Texels of a built-in table: enough that a lobe of NdotH is smooth down to roughness 0.4.
inline constexpr int kBuiltinTableWidth = 2048, kBuiltinTableHeight = 128;

/// For kernels; the table must outlive it.
inline TableView view_of(const LookupTable& table) { return {table.texels.data(), table.width, table.height}; }

}  // namespace relume
