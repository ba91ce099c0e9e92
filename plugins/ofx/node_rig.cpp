// SPDX-License-Identifier: Apache-2.0
#include "node_rig.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>

#include "relume/error.h"
#include "relume/frames.h"
#include "relume/light.h"
#include "relume/shader.h"
#include "rig/value_text.h"

namespace relume::ofx {

namespace {

std::string trimmed(std::string_view text) {
    constexpr std::string_view kBlank = " \t\r\n";
    const std::size_t first = text.find_first_not_of(kBlank);
    if (first == std::string_view::npos) return {};
    return std::string(text.substr(first, text.find_last_not_of(kBlank) - first + 1));
}

std::vector<std::string> patterns(const std::string& text) {
    std::vector<std::string> parts;
    std::istringstream stream(text);
    for (std::string part; std::getline(stream, part, ',');)
        if (part = trimmed(part); !part.empty()) parts.push_back(part);
    return parts;
}

std::vector<double> numbers(const std::string& name, std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c == ',' || c == '[' || c == ']'; }, ' ');
    std::istringstream stream(text);
    std::vector<double> values;
    for (std::string word; stream >> word;) {
        // Not strtod(): many a host has chosen a locale whose numbers have commas.
        const std::string_view digits = std::string_view(word).substr(word.starts_with('+') ? 1 : 0);
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), values.emplace_back());
        if (error != std::errc() || end != digits.data() + digits.size())
            throw Error(ErrorKind::parameter, name + ": '" + word + "' is not a number");
    }
    return values;
}

bool zero(std::span<const double> values) {
    return std::all_of(values.begin(), values.end(), [](double v) { return v == 0; });
}

/// A knob's value at a time; nothing where it says "not given", or no more than the row's default.
std::optional<Value> knob_value(const Instance& instance, const Knob& knob, double time) {
    switch (knob.type) {
        case ParameterType::scalar: {
            const double v = instance.number(knob.name, time, knob.value[0]);
            return v == knob.value[0] ? std::nullopt : std::optional<Value>(v);
        }
        case ParameterType::color:
        case ParameterType::vector: {
            const std::array<double, 3> v = instance.triple(knob.name, time, knob.value);
            // A place without a default has to be somewhere: the origin is as good as another.
            const bool place = knob.optional && knob.type == ParameterType::vector;
            return v == knob.value && !place ? std::nullopt : std::optional<Value>(v);
        }
        case ParameterType::number_list: {
            if (knob.count == 3) {
                const std::array<double, 3> v = instance.triple(knob.name, time, {});
                if (zero(v)) return std::nullopt;
                return std::vector<double>(v.begin(), v.end());
            }
            std::vector<double> v = numbers(knob.name, instance.text(knob.name, time));
            if (v.empty()) return std::nullopt;
            return v;
        }
        case ParameterType::boolean: {
            const int v = instance.integer(knob.name, time, knob.value[0] != 0);
            return (v != 0) == (knob.value[0] != 0) ? std::nullopt : std::optional<Value>(v != 0);
        }
        case ParameterType::integer: {
            const int v = instance.integer(knob.name, time, static_cast<int>(knob.value[0]));
            return v == static_cast<int>(knob.value[0]) ? std::nullopt : std::optional<Value>(std::int64_t{v});
        }
        case ParameterType::choice: {
            const int v = instance.integer(knob.name, time, static_cast<int>(knob.value[0]));
            if (v == static_cast<int>(knob.value[0]) || v < 0 || v >= static_cast<int>(knob.choices.size()))
                return std::nullopt;
            const std::string& word = knob.choices[static_cast<std::size_t>(v)];
            if (knob.optional && knob.choices.size() == 3 && knob.choices[1] == "no") return word == "yes";
            return word;
        }
        case ParameterType::text_list: {
            std::vector<std::string> v = patterns(instance.text(knob.name, time));
            if (v.empty()) return std::nullopt;
            return v;
        }
        case ParameterType::text:
        case ParameterType::table: {
            std::string v = trimmed(instance.text(knob.name, time));
            if (v.empty()) return std::nullopt;
            return v;
        }
    }
    return std::nullopt;
}

const Knob& knob_at(int index) { return layout().knobs[static_cast<std::size_t>(index)]; }

std::string free_name(const Rig& rig, const std::string& wanted) {
    std::string name = wanted;
    for (int k = 2; rig.light(name) != nullptr; ++k) name = wanted + "_" + std::to_string(k);
    return name;
}

void add_light(Rig& rig, const Instance& instance, const LightKnobs& knobs, double time) {
    const std::string type_name = instance.light_type(knobs, time);
    if (type_name.empty()) return;
    const LightType* type = find_light_type(type_name);
    if (type == nullptr) {
        throw Error(ErrorKind::parameter, knobs.prefix + own::kType + ": there is no light '" + type_name +
                                              "' in this version of Relume; choose another type");
    }
    const auto index = static_cast<std::size_t>(type - light_types().data());
    Light light;
    light.name = free_name(rig, knobs.prefix);
    light.type = type_name;
    rig.lights.push_back(light);
    Light& added = rig.lights.back();
    const std::string what = "light '" + light.name + "'";
    // Ways to say the same replace each other: what has to be asked for comes last.
    for (const bool optional : {false, true}) {
        for (std::size_t row = 0; row < type->parameters.size(); ++row) {
            const Knob& knob = knob_at(knobs.of_types[index][row]);
            if (knob.optional != optional) continue;
            const std::string key(type->parameters[row].name);
            std::optional<Value> value = knob_value(instance, knob, time);
            // A knob that several types share has the default of one of them.
            if (!value && !optional && knob.value != type->parameters[row].value && knob.choices.empty())
                value = knob.type == ParameterType::scalar ? Value(knob.value[0]) : Value(knob.value);
            if (!value) continue;
            if (optional && knob.type != ParameterType::vector)
                rig.set("light." + light.name + "." + key, rigfile::value_text(*value, knob.type));
            else added.values.set(type->parameters, key, *value, what);
        }
    }
}

/// The sun of a node that has no light at all.
void add_work_light(Rig& rig) {
    Light light;
    light.name = "work_light";
    light.type = "sun";
    const LightType& sun = *find_light_type("sun");
    light.values.set(sun.parameters, "space", std::string("camera"), light.name);
    light.values.set(sun.parameters, "direction", std::array<double, 3>{0.4, -0.6, -0.7}, light.name);
    light.values.set(sun.parameters, "irradiance", std::array<double, 3>{3, 3, 3}, light.name);
    rig.lights.push_back(std::move(light));
}

void apply_overrides(Rig& rig, const std::string& text) {
    std::istringstream stream(text);
    int number = 0;
    for (std::string line; std::getline(stream, line);) {
        ++number;
        line = trimmed(line);
        if (line.empty() || line.front() == '#') continue;
        const std::size_t equals = line.find('=');
        if (equals == std::string::npos) {
            throw Error(ErrorKind::parameter, "overrides, line " + std::to_string(number) + ": '" + line +
                                                  "' is not KEY = VALUE, as light.key.exposure = 1");
        }
        rig.set(trimmed(line.substr(0, equals)), trimmed(line.substr(equals + 1)));
    }
}

}  // namespace

std::int64_t frame_of(double time) {
    constexpr double kMost = 1e15;
    return std::isfinite(time) ? std::llround(std::clamp(time, -kMost, kMost)) : 0;
}

NodeRig node_rig(const Instance& instance, double time) {
    NodeRig node;
    const std::int64_t frame = frame_of(time);
    if (const std::string file = trimmed(instance.text(own::kRig, time)); !file.empty()) {
        const Rig loaded = Rig::load(resolve_frame(file, frame));
        node.rig = loaded.at(time);
        node.varying = is_pattern(file) || !(node.rig == loaded);
    }
    apply_overrides(node.rig, instance.text(own::kOverrides, time));
    for (const SectionKnobs& section : layout().sections)
        for (std::size_t k = 0; k < section.knobs.size(); ++k)
            if (const auto value = knob_value(instance, knob_at(section.knobs[k]), time))
                node.rig.set(section.path + "." + std::string(section.keys[k]),
                             rigfile::value_text(*value, knob_at(section.knobs[k]).type));
    for (const LightKnobs& light : layout().lights) add_light(node.rig, instance, light, time);
    if (node.rig.lights.empty() && instance.integer(own::kWorkLight, time, 1) != 0) add_work_light(node.rig);
    // At the time, which may lie between frames; names of files are the frame's.
    const Rig at_time = node.rig.at(time);
    node.rig = at_time.of_frame(frame);

    const std::string named = trimmed(instance.text(own::kGBuffer, time));
    node.varying = node.varying || is_pattern(named) || !(node.rig == at_time);
    node.gbuffer_file = resolve_frame(named, frame);

    if (const std::string picture = trimmed(instance.text(own::kPicture, time)); !picture.empty())
        node.picture = picture;
    if (node.picture != "beauty") {
        std::vector<std::string> aovs = node.rig.output.values.texts(output_parameters(), "aovs");
        if (std::find(aovs.begin(), aovs.end(), node.picture) == aovs.end()) {
            aovs.push_back(node.picture);
            node.rig.output.values.set(output_parameters(), "aovs", aovs, "output");
        }
    }

    node.shader.use = instance.shader(time);
    node.override_channels = instance.integer(own::kOverrideChannels, time, 0) != 0;
    for (const ShaderKnobs& knobs : layout().shaders) {
        if (knobs.use != node.shader.use) continue;
        const std::span<const Parameter> table = shader_use_parameters(knobs.use);
        for (std::size_t row = 0; row < table.size(); ++row) {
            const Knob& knob = knob_at(knobs.rows[row]);
            std::optional<Value> value = knob_value(instance, knob, time);
            // Said although it is the default: it is to win over a channel.
            if (!value && node.override_channels && table[row].is_number())
                value = table[row].components() == 3 ? Value(knob.value) : Value(knob.value[0]);
            if (value) node.shader.values.set(table, table[row].name, *value, "shader " + knobs.use);
        }
    }
    return node;
}

Rig complete_rig(const NodeRig& node, const GBuffer& gbuffer) {
    Rig rig = node.rig;
    if (node.shader.use.empty()) return rig;
    ShaderUse use = node.shader;
    if (!node.override_channels) {
        for (const Parameter& row : shader_use_parameters(use.use))
            if (row.is_number() && gbuffer.find(row.name) != nullptr) use.values.unset(row.name);
    }
    if (!rig.shaders.empty() && rig.shaders.back().matches_all()) rig.shaders.back() = std::move(use);
    else rig.shaders.push_back(std::move(use));
    return rig;
}

}  // namespace relume::ofx
