// SPDX-License-Identifier: Apache-2.0
#include "relight/blender_generation.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>

namespace relume {

namespace {

std::int32_t& option(const ShaderInfo& shader, std::vector<std::int32_t>& options, std::string_view name) {
    const auto row = std::find_if(shader.parameters.begin(), shader.parameters.end(),
                                  [&](const Parameter& p) { return p.name == name; });
    return options[static_cast<std::size_t>(row->slot)];
}

std::int32_t index_of(const ShaderInfo& shader, std::string_view name, std::string_view choice) {
    const auto row = std::find_if(shader.parameters.begin(), shader.parameters.end(),
                                  [&](const Parameter& p) { return p.name == name; });
    const std::string_view before = row->choices.substr(0, row->choices.find(choice));
    return static_cast<std::int32_t>(std::count(before.begin(), before.end(), '|'));
}

/// 5 of "Blender 5.0.1"; none where the file doesn't say, as those of Blender 3 don't.
std::optional<int> version_of(std::string_view producer) {
    constexpr std::string_view kBlender = "Blender ";
    if (!producer.starts_with(kBlender)) return std::nullopt;
    producer.remove_prefix(kBlender.size());
    int major = 0;
    const auto [end, error] = std::from_chars(producer.data(), producer.data() + producer.size(), major);
    return error == std::errc() ? std::optional(major) : std::nullopt;
}

/// One of these channels, "" where there is none.
std::string_view first_of(const GBuffer& gbuffer, std::initializer_list<std::string_view> names) {
    for (const std::string_view name : names)
        if (gbuffer.find(name) != nullptr) return name;
    return {};
}

std::pair<std::string_view, std::string> generation_for(const GBuffer& gbuffer) {
    const std::string producer(gbuffer.producer());
    if (const auto version = version_of(producer)) return {*version <= 3 ? "3" : "5", producer + " wrote the G-buffer"};
    if (const auto name =
            first_of(gbuffer, {"coat_weight", "coat_roughness", "sheen_weight", "diffuse_roughness", "ior"});
        !name.empty())
        return {"5", "the G-buffer has a channel '" + std::string(name) + "'"};
    if (const auto name = first_of(gbuffer, {"clearcoat", "clearcoat_roughness", "sheen"}); !name.empty())
        return {"3", "the G-buffer has a channel '" + std::string(name) + "'"};
    if (producer == "Blender") return {"3", "the G-buffer is of a Blender that didn't write its version yet"};
    return {"5", "the G-buffer is not Blender's"};
}

/// Cycles' pass, which holds what is seen of the emission; an AOV of the same name is in lower case.
bool is_emission_pass(const ChannelInfo* emission) {
    if (emission == nullptr || emission->sources.empty()) return false;
    const std::string& source = emission->sources.front();
    return source.find("Emission.") != source.npos || source.find("Emit.") != source.npos;
}

}  // namespace

void settle_blender_principled(const GBuffer& gbuffer, const ShaderInfo& shader, const ShaderUse& use,
                               std::vector<std::int32_t>& options, std::vector<std::string>& notes) {
    if (shader.name != "blender_principled" || !shader.file.empty()) return;
    std::int32_t& generation = option(shader, options, "generation");
    if (generation == index_of(shader, "generation", "auto")) {
        const auto [choice, reason] = generation_for(gbuffer);
        generation = index_of(shader, "generation", choice);
        const std::string note = "blender_principled is of generation " + std::string(choice) + ": " + reason;
        if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(note);
    }
    std::int32_t& emission = option(shader, options, "emission_is");
    if (emission == index_of(shader, "emission_is", "auto")) {
        const bool seen = use.values.find("emission") == nullptr && is_emission_pass(gbuffer.find("emission"));
        emission = index_of(shader, "emission_is", seen ? "seen" : "emitted");
    }
}

}  // namespace relume
