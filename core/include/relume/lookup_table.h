// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>
#include <vector>

#include "relume/export.h"

namespace relume {

struct ShaderInfo;

/// A picture of numbers that a shader looks things up in: what a parameter of type table holds.
struct LookupTable {
    int width = 0;
    int height = 0;
    std::vector<float> texels;  ///< row 0 first, the picture's top

    bool operator==(const LookupTable&) const = default;
};

/// Throws Error(value) where the table is empty, too large (kMostTexels), or holds NaN or infinity; `what` names it.
RELUME_API void check_table(const LookupTable& table, std::string_view what);

/// A table from an EXR, or by set_image_reader() from another image: its channel Y, its only channel, or the luminance
/// (Rec.709 weights) of R, G, B, as stored: integers as 0..1, no curve taken off. The last few that were read are kept
/// until their file changes, so that a sequence reads each once. Thread-safe. Errors: file; format (no image, channels
/// that are neither, too large, a texel that is not finite). All name the file.
RELUME_API std::shared_ptr<const LookupTable> load_table(const std::filesystem::path& path);

/// What a shader's parameter of type table is where no file is given. Throws Error(parameter) when it has none of that
/// name.
RELUME_API std::shared_ptr<const LookupTable> builtin_table(const ShaderInfo& shader, std::string_view parameter);

}  // namespace relume
