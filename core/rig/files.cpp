// SPDX-License-Identifier: Apache-2.0
#include "relume/frames.h"
#include "relume/rig.h"
#include "rig/sections.h"

namespace relume {

Rig Rig::of_frame(std::int64_t number) const {
    Rig rig = at(static_cast<double>(number));
    if (rig.gbuffer_file) rig.gbuffer_file = resolve_frame(*rig.gbuffer_file, number);
    for (auto& [name, rule] : rig.gbuffer.channels) {
        if (rule.channel && rigfile::names_a_file(*rule.channel)) rule.channel = resolve_frame(*rule.channel, number);
    }
    return rig;
}

std::optional<std::string> Rig::main_file() const {
    if (gbuffer_file) return gbuffer_file;
    const auto normal = gbuffer.channels.find("normal");
    if (normal == gbuffer.channels.end() || !normal->second.channel) return std::nullopt;
    return rigfile::names_a_file(*normal->second.channel) ? normal->second.channel : std::nullopt;
}

std::vector<std::filesystem::path> Rig::input_files() const {
    std::vector<std::filesystem::path> files;
    if (const auto main = main_file()) files.emplace_back(*main);
    for (const auto& [name, rule] : gbuffer.channels) {
        if (rule.channel && rigfile::names_a_file(*rule.channel)) files.emplace_back(*rule.channel);
    }
    for (const ShaderUse& shader : shaders) {
        for (const Parameter& row : shader_use_parameters(shader.use)) {
            const Value* value = row.type == ParameterType::table ? shader.values.find(row.name) : nullptr;
            const auto* file = value != nullptr ? std::get_if<std::string>(value) : nullptr;
            if (file != nullptr && !file->empty()) files.emplace_back(*file);
        }
    }
    return files;
}

}  // namespace relume
