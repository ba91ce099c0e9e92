// SPDX-License-Identifier: Apache-2.0
#include "relume/frames.h"
#include "relume/rig.h"
#include "rig/sections.h"
#include "rig/source.h"

namespace relume {

namespace {

/// f(name, file) for each parameter of the shader that is a table in a file.
template <class F> void for_each_table_file(const ShaderUse& shader, const F& f) {
    for (const Parameter& row : shader_use_parameters(shader.use)) {
        const Value* value = row.type == ParameterType::table ? shader.values.find(row.name) : nullptr;
        const auto* file = value != nullptr ? std::get_if<std::string>(value) : nullptr;
        if (file != nullptr && !file->empty()) f(row.name, *file);
    }
}

}  // namespace

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
    for (const ShaderUse& shader : shaders)
        for_each_table_file(shader, [&](std::string_view, const std::string& file) { files.emplace_back(file); });
    return files;
}

void Rig::resolve_files(const std::filesystem::path& folder) {
    if (gbuffer_file) gbuffer_file = rigfile::resolved(*gbuffer_file, folder);
    for (auto& [name, rule] : gbuffer.channels)
        if (rule.channel && rigfile::names_a_file(*rule.channel))
            rule.channel = rigfile::resolved(*rule.channel, folder);
    for (ShaderUse& shader : shaders) {
        std::vector<std::pair<std::string, std::string>> tables;
        for_each_table_file(shader, [&](std::string_view name, const std::string& file) {
            tables.emplace_back(name, rigfile::resolved(file, folder));
        });
        for (const auto& [name, file] : tables)
            shader.values.set(shader_use_parameters(shader.use), name, file, shader.use);
    }
}

}  // namespace relume
