// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>

#include "host.h"

namespace relume::ofx {

inline constexpr const char* kIdentifier = "org.relume.relight";

/// A clip of the General context beside Source, and the channels of the G-buffer that it brings.
struct DataClip {
    const char* name;
    const char* label;
    std::array<std::string_view, 3> semantics;  ///< one of 1 or 3 components, or three of 1
    int components;                             ///< of the first semantic
};
inline constexpr DataClip kDataClips[] = {
    {"Normal", "Normal", {"normal"}, 3},
    {"BaseColor", "Base color", {"base_color"}, 3},
    {"Roughness", "Roughness", {"roughness"}, 1},
    {"Metallic", "Metallic", {"metallic"}, 1},
    {"Position", "Position", {"position"}, 3},
    {"Depth", "Depth", {"depth"}, 1},
    {"IDs", "IDs", {"object_id", "material_id", "shading_model_id"}, 1},
};

void describe(OfxImageEffectHandle effect);
void describe_in_context(OfxImageEffectHandle effect, std::string_view context);

}  // namespace relume::ofx
