// SPDX-License-Identifier: Apache-2.0
#include "relight/plan.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "relight/blender_generation.h"
#include "relume/error.h"
#include "relume/light.h"
#include "shading/builtin_table.h"
#include "shading/evaluate.h"

namespace relume {

namespace {

/// The table that a rig gives: numbers of its own, a file, or none, which is the shader's built-in one.
std::shared_ptr<const LookupTable> table_of(const ShaderInfo& shader, const Parameter& row, const Value* given) {
    if (given != nullptr)
        if (const auto* numbers = std::get_if<LookupTable>(given)) return std::make_shared<const LookupTable>(*numbers);
    const auto* file = given == nullptr ? nullptr : std::get_if<std::string>(given);
    if (file == nullptr || file->empty()) return builtin_table(shader, row.name);
    try {
        return load_table(*file);
    } catch (const Error& error) {
        throw Error(error.kind(),
                    "shader '" + std::string(shader.name) + "': " + std::string(row.name) + ": " + error.what());
    }
}

std::string names_of(const std::vector<Light>& lights) {
    std::string out;
    for (const Light& light : lights) out += (out.empty() ? "" : ", ") + light.name;
    return out.empty() ? "none" : out;
}

/// A number to the last bit, for keys.
std::string bits_text(double value) { return std::to_string(std::bit_cast<std::uint64_t>(value)); }

constexpr std::string_view kLobeNames[] = {"diffuse", "specular", "transmission"};

}  // namespace

std::vector<AovInfo> aovs(const Rig& rig) {
    std::vector<AovInfo> out{{"beauty", 4}};
    for (const std::string& name : rig.output.values.texts(output_parameters(), "aovs")) {
        const bool lobe = std::find(std::begin(kLobeNames), std::end(kLobeNames), name) != std::end(kLobeNames);
        if (!lobe) {
            constexpr std::string_view kPrefix = "light:";
            std::vector<std::string_view> candidates(std::begin(kLobeNames), std::end(kLobeNames));
            std::vector<std::string> light_names;
            for (const Light& light : rig.lights) light_names.push_back(std::string(kPrefix) + light.name);
            candidates.insert(candidates.end(), light_names.begin(), light_names.end());
            if (std::find(light_names.begin(), light_names.end(), name) == light_names.end()) {
                const std::string nearest = nearest_name(name, candidates);
                throw Error(
                    ErrorKind::rig,
                    "output.aovs: '" + name + "' is neither diffuse, specular, transmission nor light:NAME (lights: " +
                        names_of(rig.lights) + ")" + (nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
            }
        }
        if (std::any_of(out.begin(), out.end(), [&](const AovInfo& a) { return a.name == name; }))
            throw Error(ErrorKind::rig, "output.aovs: '" + name + "' is there twice");
        out.push_back({name, 3});
    }
    return out;
}

int Plan::request(ChannelRequest wanted) {
    std::string key = std::to_string(static_cast<int>(wanted.kind)) + '/' + wanted.name + '/' +
                      std::to_string(wanted.components) + '/' + std::to_string(static_cast<int>(wanted.widen)) + '/' +
                      bits_text(wanted.scale) + '/' + bits_text(wanted.offset);
    for (const auto& pattern : wanted.patterns) key += '\n' + pattern;
    const auto [it, added] = known_.try_emplace(key, plane_count);
    if (added) {
        const std::string name = wanted.kind == ChannelRequest::Kind::matte ? "cryptomatte" : wanted.name;
        for (int k = 0; k < wanted.components; ++k) plane_names.push_back(name);
        plane_count += wanted.components;
        requests.push_back(std::move(wanted));
    }
    return it->second;
}

int Plan::request_semantic(const GBuffer& gbuffer, const std::string& name, int components, LobeWidth widen) {
    if (gbuffer.find(name) == nullptr) return -1;
    return request({.kind = ChannelRequest::Kind::semantic,
                    .name = name,
                    .components = components,
                    .patterns = {},
                    .widen = widen});
}

int Plan::request_matte(const std::vector<std::string>& patterns) {
    return request({.kind = ChannelRequest::Kind::matte, .name = {}, .components = 1, .patterns = patterns});
}

int Plan::add_mask(const BakedLight& light) {
    if (light.include.empty() && light.exclude.empty()) return -1;
    MaskPlan mask;
    if (!light.include.empty()) mask.include_plane = request_matte(light.include);
    if (!light.exclude.empty()) mask.exclude_plane = request_matte(light.exclude);
    const auto found = std::find(masks.begin(), masks.end(), mask);
    if (found != masks.end()) return static_cast<int>(found - masks.begin());
    masks.push_back(mask);
    return static_cast<int>(masks.size()) - 1;
}

void Plan::add_lights(const GBuffer& gbuffer, const Rig& rig) {
    LightGroup rest;
    bool local = false;
    int enabled = 0;
    for (const Light& light : rig.lights) {
        const LightType* type = find_light_type(light.type);
        if (type != nullptr && !light.values.boolean(type->parameters, "enabled")) continue;
        ++enabled;
        const BakedLight baked = bake_light(light, gbuffer.camera(), warnings);
        if (baked.needs_position()) {
            if (gbuffer.find("position") == nullptr)
                throw Error(ErrorKind::channel,
                            "light '" + light.name + "' is a " + light.type +
                                " light and needs positions: the G-buffer has neither a position channel nor "
                                "depth with a camera; give [camera] fov, a position channel, or use a sun");
            local = true;
        }
        const auto aov =
            std::find_if(aovs.begin(), aovs.end(), [&](const AovInfo& a) { return a.name == "light:" + light.name; });
        LightGroup own;
        LightGroup& group = aov == aovs.end() ? rest : own;
        const int mask = add_mask(baked);
        if (baked.direct) {
            group.direct.push_back(*baked.direct);
            group.direct_masks.push_back(mask);
        } else {
            group.ambient.push_back(*baked.ambient);
            group.ambient_masks.push_back(mask);
        }
        if (aov != aovs.end()) {
            own.aov = static_cast<int>(aov - aovs.begin());
            groups.push_back(std::move(own));
        }
    }
    if (rig.lights.empty()) throw Error(ErrorKind::rig, "the rig has no lights; add a [[light]]");
    if (enabled == 0) warnings.push_back("every light of the rig is disabled: emission alone is left");
    // First, and always there: it carries the emission.
    groups.insert(groups.begin(), std::move(rest));
    add_view(gbuffer, local);
}

void Plan::add_view(const GBuffer& gbuffer, bool local_lights) {
    const auto& camera = gbuffer.camera();
    const bool positions = gbuffer.find("position") != nullptr;
    if (camera && camera->projection == Projection::orthographic) {
        constant_view = true;
        const auto forward = camera->forward();
        for (std::size_t k = 0; k < 3; ++k) eye[k] = static_cast<float>(-forward[k]);
    } else if (camera && positions) {
        const auto at = camera->position();
        for (std::size_t k = 0; k < 3; ++k) eye[k] = static_cast<float>(at[k]);
    } else {
        view = request({.kind = ChannelRequest::Kind::semantic, .name = "view", .components = 3, .patterns = {}});
    }
    if (local_lights || (camera && positions && !constant_view)) position = request_semantic(gbuffer, "position", 3);
}

int Plan::bind(const GBuffer& gbuffer, const ShaderInfo& shader, const ShaderUse& use) {
    ShaderBinding binding;
    binding.shader = &shader;
    binding.kernel = kernel_of(shader);
    binding.options = default_options(shader);
    binding.slot_planes.assign(static_cast<std::size_t>(shader.abi->float_slots), -1);
    binding.constants.resize(static_cast<std::size_t>(shader.abi->float_slots));
    binding.tables.resize(static_cast<std::size_t>(shader.abi->table_slots));
    binding.table_views.resize(binding.tables.size());
    for (const Parameter& p : shader.parameters) {
        if (p.type == ParameterType::table) {
            const auto slot = static_cast<std::size_t>(p.slot);
            binding.tables[slot] = table_of(shader, p, use.values.find(p.name));
            binding.table_views[slot] = view_of(*binding.tables[slot]);
            continue;
        }
        if (p.is_option()) {
            const auto slot = static_cast<std::size_t>(p.slot);
            if (p.type == ParameterType::choice) binding.options[slot] = use.values.choice(shader.parameters, p.name);
            else if (p.type == ParameterType::boolean)
                binding.options[slot] = use.values.boolean(shader.parameters, p.name);
            else
                binding.options[slot] =
                    static_cast<std::int32_t>(std::lround(use.values.number(shader.parameters, p.name)));
            continue;
        }
        const int components = p.components();
        const Value* given = use.values.find(p.name);
        const LobeWidth widen = gbuffer.normal_variance() ? p.lobe_width : LobeWidth::none;
        int plane = -1;
        bool grey = false;  // one channel for all three components
        if (given != nullptr && std::holds_alternative<ChannelRef>(*given)) {
            const auto& ref = std::get<ChannelRef>(*given);
            plane = request({.kind = ChannelRequest::Kind::raw,
                             .name = ref.channel,
                             .components = components,
                             .patterns = {},
                             .scale = ref.scale,
                             .offset = ref.offset,
                             .widen = widen});
        } else if (given == nullptr) {
            const ChannelInfo* channel = gbuffer.find(p.name);
            if (channel != nullptr && channel->components == components)
                plane = request_semantic(gbuffer, std::string(p.name), components, widen);
            else if (channel != nullptr && channel->components == 1 && p.type == ParameterType::color) {
                plane = request_semantic(gbuffer, std::string(p.name), 1, widen);
                grey = true;
            }
        }
        std::array<double, 3> constant = p.value;
        if (given != nullptr && plane < 0) {
            if (components == 3) constant = use.values.triple(shader.parameters, p.name);
            else constant[0] = use.values.number(shader.parameters, p.name);
        }
        if (plane < 0 && widen != LobeWidth::none)
            plane = request({.kind = ChannelRequest::Kind::constant,
                             .name = std::string(p.name),
                             .patterns = {},
                             .offset = constant[0],
                             .widen = widen});
        for (int k = 0; k < components; ++k) {
            const auto slot = static_cast<std::size_t>(p.slot + k);
            binding.slot_planes[slot] = plane < 0 ? -1 : grey ? plane : plane + k;
            binding.constants[slot] = static_cast<float>(constant[static_cast<std::size_t>(k)]);
        }
    }
    settle_blender_principled(gbuffer, shader, use, binding.options, notes);
    if (shader.abi->needs_tangent != 0 && tangent < 0) tangent = request_semantic(gbuffer, "tangent", 3);
    bindings.push_back(std::move(binding));
    return static_cast<int>(bindings.size()) - 1;
}

void Plan::add_unreal_models(const GBuffer& gbuffer, const ShaderUse& use, const ShaderRule& base) {
    if (gbuffer.find("shading_model_id") == nullptr)
        throw Error(ErrorKind::channel,
                    "shader 'from_material_expression' needs a shading_model_id channel, and the G-buffer has none; "
                    "name it under [gbuffer.channels]");
    const int plane =
        request({.kind = ChannelRequest::Kind::id, .name = "shading_model_id", .components = 1, .patterns = {}});
    for (std::uint32_t id = 0; id < shading_model_names().size(); ++id) {
        const ShaderInfo* model = find_shader(shading_model_names()[id]);
        if (model == nullptr) {
            warnings.push_back("shading model " + std::to_string(id) + " (" + std::string(shading_model_names()[id]) +
                               ") is shaded as default_lit");
            model = &require_shader("default_lit");
        }
        ShaderRule rule = base;
        rule.ids.push_back({plane, {id}});
        rule.binding = bind(gbuffer, *model, use);
        rules.push_back(std::move(rule));
    }
    ShaderRule others = base;  // ids that name no model: emission only
    others.binding = bind(gbuffer, require_shader("unlit"), use);
    rules.push_back(std::move(others));
}

void Plan::add_shader(const GBuffer& gbuffer, const ShaderUse& use) {
    ShaderRule rule;
    const auto match_ids = [&](const char* name, const std::vector<std::int64_t>& wanted) {
        if (wanted.empty()) return;
        if (gbuffer.find(name) == nullptr)
            throw Error(ErrorKind::channel, std::string("a [[shader]] chooses pixels by ") + name +
                                                ", and the G-buffer has no such channel");
        ShaderRule::IdMatch match;
        match.plane = request({.kind = ChannelRequest::Kind::id, .name = name, .components = 1, .patterns = {}});
        for (const std::int64_t id : wanted) match.values.push_back(static_cast<std::uint32_t>(id));
        std::sort(match.values.begin(), match.values.end());
        rule.ids.push_back(std::move(match));
    };
    match_ids("object_id", use.object_id);
    match_ids("material_id", use.material_id);
    match_ids("shading_model_id", use.shading_model_id);
    if (!use.cryptomatte.empty()) rule.matte_plane = request_matte(use.cryptomatte);

    if (use.use == "from_material_expression") return add_unreal_models(gbuffer, use, rule);
    rule.binding = bind(gbuffer, require_shader(use.use), use);
    rules.push_back(std::move(rule));
}

Plan::Plan(const GBuffer& gbuffer, const Rig& rig) : aovs(relume::aovs(rig)) {
    mode = static_cast<OutputMode>(rig.output.values.choice(output_parameters(), "mode"));
    for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t a = 0; a < aovs.size(); ++a)
            if (aovs[a].name == kLobeNames[k]) lobe_aovs[k] = static_cast<int>(a);

    normal = request_semantic(gbuffer, "normal", 3);
    if (normal < 0)
        throw Error(ErrorKind::channel, "the G-buffer has no normal channel; name it under [gbuffer.channels] normal");
    coverage = request_semantic(gbuffer, "coverage", 1);
    alpha = request_semantic(gbuffer, "alpha", 1);
    beauty = request_semantic(gbuffer, "beauty", 3);
    ambient_occlusion = request_semantic(gbuffer, "ambient_occlusion", 1);
    if (mode == OutputMode::add && beauty < 0)
        throw Error(ErrorKind::channel, "output.mode is \"add\" and the G-buffer has no beauty to add to");

    add_lights(gbuffer, rig);
    // Those that match come first; of those without a match the last is the default, whatever stands where.
    ShaderUse rest;
    rest.use = "principled";
    for (const ShaderUse& use : rig.shaders) {
        if (use.matches_all()) rest = use;
        else add_shader(gbuffer, use);
    }
    add_shader(gbuffer, rest);
}

}  // namespace relume
