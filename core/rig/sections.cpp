// SPDX-License-Identifier: Apache-2.0
#include "rig/sections.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "relume/light.h"

namespace relume::rigfile {

namespace {

/// Keys of a light that say the same in different ways.
constexpr std::string_view kStrength[] = {"intensity", "power", "radiance"};

/// Light types that rigs may name and this version does not shade.
constexpr std::string_view kLaterLights[] = {"rect", "disk", "sphere", "environment"};

/// What other programs call them.
constexpr std::pair<std::string_view, std::string_view> kOtherLightNames[] = {
    {"directional", "sun"}, {"distant", "sun"},    {"omni", "point"}, {"dome", "sky"},
    {"hemi", "sky"},        {"hemisphere", "sky"}, {"area", "rect"}};
constexpr std::string_view kOtherStrengthNames[] = {"intensity", "power",  "radiance",  "irradiance",
                                                    "strength",  "energy", "brightness"};

/// "irradiance", "intensity or power": how the type says how bright it is.
std::string strength_of(const LightType& type) {
    std::string out;
    for (const std::string_view name : {"irradiance", "intensity", "power", "radiance", "sky_color"})
        if (find_row(type.parameters, name) != nullptr) out += (out.empty() ? "" : " or ") + std::string(name);
    return out;
}

/// The mistakes that a matrix is given with: columns for rows, or all of it flat.
void check_matrix(const Value& value) {
    const auto& m = std::get<std::vector<double>>(value);
    const auto wrong = [](const char* why, const char* hint) {
        throw Problem(Problem::Cause::range, std::string("[camera]: matrix ") + why, hint);
    };
    const auto near = [](double a, double b) { return std::abs(a - b) < 1e-6; };
    if (!near(m[12], 0) || !near(m[13], 0) || !near(m[14], 0) || !near(m[15], 1))
        wrong(
            "does not end in 0, 0, 0, 1",
            "; it is row-major camera-to-world for column vectors: the camera's position is its 4th, 8th and 12th number");
    const double determinant =
        m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) + m[2] * (m[4] * m[9] - m[5] * m[8]);
    if (!(std::abs(determinant) > 1e-12))
        wrong("cannot be inverted", "; its first three columns are the camera's axes in the world");
}

void check_flip(const Value& value, std::string_view what) {
    const auto& axes = std::get<std::string>(value);
    const bool known = !axes.empty() && axes.find_first_not_of("xyz") == std::string::npos;
    bool twice = false;
    for (const char axis : axes) twice = twice || std::count(axes.begin(), axes.end(), axis) > 1;
    if (!known || twice)
        throw Problem(Problem::Cause::range, std::string(what) + ": flip is " + in_quotes(axes),
                      "; it is made of x, y and z, each once, as \"y\" or \"xy\"");
}

std::vector<std::int64_t>* ids_of(ShaderUse& shader, std::string_view name) {
    if (name == "object_id") return &shader.object_id;
    if (name == "material_id") return &shader.material_id;
    if (name == "shading_model_id") return &shader.shading_model_id;
    return nullptr;
}

std::vector<std::int64_t> whole_numbers(const Value& value, std::string_view name, std::string_view what) {
    std::vector<std::int64_t> out;
    for (const double number : std::get<std::vector<double>>(value)) {
        if (std::trunc(number) != number)
            throw Problem(Problem::Cause::type,
                          std::string(what) + ": " + std::string(name) + " holds " + short_number_text(number),
                          "; IDs are whole numbers");
        out.push_back(static_cast<std::int64_t>(number));
    }
    return out;
}

/// One number stands for a list of one.
Value listed(const Value& value) {
    if (const auto* i = std::get_if<std::int64_t>(&value)) return std::vector<double>{static_cast<double>(*i)};
    if (const auto* d = std::get_if<double>(&value)) return std::vector<double>{*d};
    return value;
}

}  // namespace

void set_gbuffer(Rig& rig, std::string_view name, const Value& value) {
    if (const auto names = channel_names();
        find_row(gbuffer_parameters(), name) == nullptr && std::find(names.begin(), names.end(), name) != names.end())
        throw Problem(Problem::Cause::name, "unknown key " + in_quotes(name) + " in [gbuffer]",
                      "; channels stand under [gbuffer.channels]");
    set_member(gbuffer_parameters(), name, value, "[gbuffer]",
               [&](auto visit) { for_each_gbuffer_member(rig, visit); });
}

std::optional<Value> get_gbuffer(const Rig& rig, const Parameter& row) {
    return get_member(row, [&](auto visit) { for_each_gbuffer_member(rig, visit); });
}

void set_channel_rule(ChannelRule& rule, std::string_view name, const Value& value, std::string_view what) {
    ChannelRule changed = rule;
    set_member(channel_rule_parameters(), name, value, what, [&](auto visit) { for_each_member(changed, visit); });
    if (name == "flip") check_flip(value, what);
    rule = std::move(changed);
}

std::optional<Value> get_channel_rule(const ChannelRule& rule, const Parameter& row) {
    return get_member(row, [&](auto visit) { for_each_member(rule, visit); });
}

void set_camera(GBufferOptions& options, std::string_view name, const Value& value) {
    GBufferOptions changed = options;
    set_member(camera_parameters(), name, value, "[camera]",
               [&](auto visit) { for_each_camera_member(changed, visit); });
    if (name == "matrix") check_matrix(canonical(require_row(camera_parameters(), name, {}), value, {}));
    if (name == "fov") {
        changed.focal_length.reset();
        changed.horizontal_aperture.reset();
    } else if (name == "focal_length" || name == "horizontal_aperture") {
        changed.fov.reset();
    }
    options = std::move(changed);
}

std::optional<Value> get_camera(const GBufferOptions& options, const Parameter& row) {
    return get_member(row, [&](auto visit) { for_each_camera_member(options, visit); });
}

std::string light_label(const Light& light) { return "light " + in_quotes(light.name); }

void set_light(Light& light, std::string_view name, const Value& value) {
    const LightType* type = find_light_type(light.type);
    const bool strength = std::find(std::begin(kOtherStrengthNames), std::end(kOtherStrengthNames), name) !=
                          std::end(kOtherStrengthNames);
    if (strength && find_row(type->parameters, name) == nullptr)
        throw Problem(Problem::Cause::name, "unknown key " + in_quotes(name) + " in " + light_label(light),
                      "; a " + light.type + " light has " + strength_of(*type));
    light.values.set(type->parameters, name, value, light_label(light));
    if (std::find(std::begin(kStrength), std::end(kStrength), name) == std::end(kStrength)) return;
    for (const std::string_view other : kStrength)
        if (other != name) light.values.unset(other);
}

void set_light_type(Light& light, std::string_view type_name) {
    const LightType* type = find_light_type(type_name);
    if (type == nullptr) {
        std::vector<std::string_view> names;
        for (const LightType& t : light_types()) names.push_back(t.name);
        const auto other = std::find_if(std::begin(kOtherLightNames), std::end(kOtherLightNames),
                                        [&](const auto& n) { return n.first == type_name; });
        const std::string_view meant = other == std::end(kOtherLightNames) ? type_name : other->second;
        if (std::find(std::begin(kLaterLights), std::end(kLaterLights), meant) != std::end(kLaterLights))
            throw Problem(Problem::Cause::name,
                          light_label(light) + " is of type " + in_quotes(type_name) +
                              ", which this version of relume does not have",
                          suggestion({}, names));
        throw Problem(Problem::Cause::name, light_label(light) + " has the unknown type " + in_quotes(type_name),
                      suggestion(meant, names));
    }
    ParameterValues kept;
    const LightType* before = find_light_type(light.type);
    for (const auto& [name, value] : light.values.all()) {
        const Parameter* row = find_row(type->parameters, name);
        const Parameter* old = before == nullptr ? nullptr : find_row(before->parameters, name);
        if (row != nullptr && old != nullptr && row->type == old->type)
            kept.set(type->parameters, name, value, light_label(light));
    }
    light.type = type->name;
    light.values = std::move(kept);
}

std::string shader_label(const ShaderUse& shader) { return "shader " + in_quotes(shader.use); }

void set_shader(ShaderUse& shader, std::string_view name, const Value& value) {
    const std::string what = shader_label(shader);
    if (name == "cryptomatte") {
        shader.cryptomatte = std::get<std::vector<std::string>>(
            canonical(require_row(shader_key_parameters(), name, what), value, what));
    } else if (auto* ids = ids_of(shader, name)) {
        *ids =
            whole_numbers(canonical(require_row(shader_key_parameters(), name, what), listed(value), what), name, what);
    } else {
        const auto parameters = shader_use_parameters(shader.use);
        if (find_row(parameters, name) == nullptr) {
            std::vector<std::string_view> names;
            for (const Parameter& p : parameters) names.push_back(p.name);
            for (const Parameter& p : shader_key_parameters()) names.push_back(p.name);
            throw Problem(Problem::Cause::name, "unknown key " + in_quotes(name) + " in " + what,
                          suggestion(name, names));
        }
        shader.values.set(parameters, name, value, what);
    }
}

std::optional<Value> get_shader_match(const ShaderUse& shader, std::string_view name) {
    if (name == "cryptomatte" && !shader.cryptomatte.empty()) return shader.cryptomatte;
    ShaderUse copy = shader;
    const auto* ids = ids_of(copy, name);
    if (ids == nullptr || ids->empty()) return std::nullopt;
    return std::vector<double>(ids->begin(), ids->end());
}

void set_shader_use(ShaderUse& shader, std::string_view use) {
    const auto parameters = shader_use_parameters(use);
    const auto before = shader.use.empty() ? parameters : shader_use_parameters(shader.use);
    ShaderUse changed = shader;
    changed.use = use;
    changed.values = {};
    for (const auto& [name, value] : shader.values.all()) {
        const Parameter* row = find_row(parameters, name);
        const Parameter* old = find_row(before, name);
        const bool same = row != nullptr && old != nullptr && row->type == old->type && row->choices == old->choices;
        if (same) changed.values.set(parameters, name, value, shader_label(changed));
    }
    shader = std::move(changed);
}

ChannelRef channel_ref(const ParameterValues& values, const std::string& what) {
    const auto table = channel_ref_parameters();
    if (!values.given("channel"))
        throw Problem(Problem::Cause::name, what + " is a table without channel",
                      "; write { channel = \"coat.X\", scale = 1.0, offset = 0.0 }");
    for (const auto& [name, value] : values.all())
        if (std::holds_alternative<Keys>(value))
            throw Problem(Problem::Cause::type, what + ": " + name + " cannot be keyed",
                          "; a channel changes by itself");
    return {values.text(table, "channel"), values.number(table, "scale"), values.number(table, "offset")};
}

void set_output(Output& output, std::string_view name, const Value& value) {
    if (name == "mode")
        if (const auto* word = std::get_if<std::string>(&value); word != nullptr && *word == "ratio")
            throw Problem(Problem::Cause::name, "[output]: mode \"ratio\" is not in this version of relume",
                          "; it has \"replace\" and \"add\"");
    output.values.set(output_parameters(), name, value, "[output]");
}

void require_channel_name(std::string_view name, const Value* source) {
    const auto names = channel_names();
    if (std::find(names.begin(), names.end(), name) != names.end()) return;
    const std::string near = nearest_name(name, names);
    // N = "normal", the wrong way round.
    const auto* text = source == nullptr ? nullptr : std::get_if<std::string>(source);
    if (text != nullptr && name.size() <= kLongestHint && std::find(names.begin(), names.end(), *text) != names.end())
        throw Problem(Problem::Cause::name, "unknown channel " + in_quotes(name) + " in [gbuffer.channels]",
                      "; what it is stands first: " + *text + " = " + string_text(name));
    throw Problem(Problem::Cause::name, "unknown channel " + in_quotes(name) + " in [gbuffer.channels]",
                  near.empty()
                      ? "; it names a semantic channel (normal, base_color, depth, …) or a parameter of a shader"
                      : "; did you mean '" + near + "'?");
}

bool names_a_file(std::string_view source) {
    constexpr std::string_view kEndings[] = {".exr",  ".png", ".jpg", ".jpeg", ".tif",
                                             ".tiff", ".hdr", ".tga", ".bmp",  ".webp"};
    std::string ending = std::filesystem::path(source).extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
    return std::find(std::begin(kEndings), std::end(kEndings), ending) != std::end(kEndings);
}

}  // namespace relume::rigfile
