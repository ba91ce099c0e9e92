// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "relume/rig.h"

namespace relume::oiio {

/// A rig file and what is changed in it, as an image's name says: "shot.relume?light.key.exposure=1&frame=1003".
struct RigName {
    std::filesystem::path path;
    std::vector<std::pair<std::string, std::string>> settings;  ///< dotted key and TOML value, in order
};

/// Nothing when the name is no rig file's, by its ending alone: no file is touched. %20 and its like in keys and values
/// are decoded; "+" is a plus.
std::optional<RigName> parse_name(const std::string& name);

/// The rig with the settings, of the frame that they, else the rig, say; "frame" is a setting beside the rig's keys.
/// Errors: those of Rig::load and Rig::set; value where the G-buffer is a sequence and no frame is said, or the rig
/// names no G-buffer.
Rig load_rig(const RigName& name);

}  // namespace relume::oiio
