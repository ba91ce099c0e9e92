// SPDX-License-Identifier: Apache-2.0
// What the rig may name: the parameters of a `use`, the shading models by ID, the channels.
#include <algorithm>

#include "gbuffer/channel_rules.h"
#include "relume/rig.h"
#include "relume/shader.h"
#include "rig/problem.h"

namespace relume {

namespace {

// In the engine's numbering.
constexpr std::string_view kShadingModels[] = {"unlit",
                                               "default_lit",
                                               "subsurface",
                                               "preintegrated_skin",
                                               "clear_coat",
                                               "subsurface_profile",
                                               "two_sided_foliage",
                                               "hair",
                                               "cloth",
                                               "eye",
                                               "single_layer_water",
                                               "thin_translucent"};

bool alike(const Parameter& a, const Parameter& b) { return a.type == b.type && a.choices == b.choices; }

/// Rows of all shading models that are there; those that two models take differently are left out.
std::vector<Parameter> common_parameters() {
    std::vector<Parameter> rows;
    std::vector<std::string_view> disputed;
    for (const std::string_view name : kShadingModels) {
        const ShaderInfo* shader = find_shader(name);
        if (shader == nullptr) continue;
        for (const Parameter& row : shader->parameters) {
            const Parameter* known = rigfile::find_row(rows, row.name);
            if (known == nullptr) rows.push_back(row);
            else if (!alike(*known, row)) disputed.push_back(row.name);
        }
    }
    std::erase_if(rows, [&](const Parameter& p) {
        return std::find(disputed.begin(), disputed.end(), p.name) != disputed.end();
    });
    return rows;
}

}  // namespace

std::span<const std::string_view> shading_model_names() { return kShadingModels; }

std::span<const Parameter> shader_use_parameters(std::string_view use) {
    if (use == kFromMaterialExpression) {
        static const std::vector<Parameter> rows = common_parameters();
        return rows;
    }
    if (const ShaderInfo* shader = find_shader(use)) return shader->parameters;
    std::vector<std::string_view> names;
    for (const ShaderInfo& s : shaders()) names.push_back(s.name);
    names.push_back(kFromMaterialExpression);
    throw rigfile::Problem(rigfile::Problem::Cause::name, "unknown shader " + rigfile::in_quotes(use),
                           rigfile::suggestion(use, names));
}

std::vector<std::string_view> channel_names() {
    static const std::vector<std::string_view> all = [] {
        std::vector<std::string_view> names;
        const auto add = [&](std::string_view name) {
            if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
        };
        for (const auto& semantic : gbuffer::semantic_names()) add(semantic.name);
        add("cryptomatte");  // a file that holds it
        for (const ShaderInfo& shader : shaders())
            for (const Parameter& p : shader.parameters)
                if (p.is_number()) add(p.name);
        return names;
    }();
    return all;
}

}  // namespace relume
