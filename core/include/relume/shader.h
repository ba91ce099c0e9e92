// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "relume/export.h"
#include "relume/parameter.h"

namespace relume {

struct ShaderAbi;  // relume/shader_abi.h: the table of entry points behind a shader

/// A registered shading model: built in (plugins/shaders) or loaded at run time from RELUME_SHADER_PATH.
struct ShaderInfo {
    std::string_view name;
    std::string_view label;
    std::string_view help;                  ///< the manual's text: what for, directions, limits, references
    std::span<const Parameter> parameters;  ///< slots included
    std::filesystem::path file;             ///< the plugin, empty for built-in ones
    const ShaderAbi* abi = nullptr;
};

/// All shaders, built-in ones first, each group by name. The first call loads the plugins on RELUME_SHADER_PATH.
RELUME_API std::span<const ShaderInfo> shaders();
/// nullptr when there is none of that name.
RELUME_API const ShaderInfo* find_shader(std::string_view name);
/// As find_shader; throws Error(parameter) with the nearest name.
RELUME_API const ShaderInfo& require_shader(std::string_view name);

/// What was found on RELUME_SHADER_PATH and why it did or did not load: `relume doctor` prints it.
struct PluginReport {
    std::filesystem::path file;
    bool loaded = false;
    std::string message;
};
RELUME_API std::span<const PluginReport> plugin_reports();

}  // namespace relume
