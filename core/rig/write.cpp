// SPDX-License-Identifier: Apache-2.0
#include "relume/light.h"
#include "rig/sections.h"

namespace relume {

namespace {

using rigfile::key_text;
using rigfile::value_text;

void write_key(std::string& out, std::string_view key, const std::string& value) {
    out += key_text(key) + " = " + value + "\n";
}

/// The values of `table` that `get` has, in the table's order.
template <class Get> void write_rows(std::string& out, std::span<const Parameter> table, Get get) {
    for (const Parameter& row : table)
        if (const std::optional<Value> value = get(row)) write_key(out, row.name, value_text(*value, row.type));
}

void write_values(std::string& out, std::span<const Parameter> table, const ParameterValues& values) {
    write_rows(out, table, [&](const Parameter& row) {
        const Value* value = values.find(row.name);
        return value == nullptr ? std::nullopt : std::optional<Value>(*value);
    });
}

std::string rule_text(const ChannelRule& rule) {
    std::string out;
    for (const Parameter& row : channel_rule_parameters())
        if (const auto value = rigfile::get_channel_rule(rule, row))
            out += (out.empty() ? "" : ", ") + std::string(row.name) + " = " + value_text(*value, row.type);
    return out.empty() ? "{}" : "{ " + out + " }";
}

void write_gbuffer(std::string& out, const Rig& rig) {
    std::string keys;
    write_rows(keys, gbuffer_parameters(), [&](const Parameter& row) { return rigfile::get_gbuffer(rig, row); });
    if (!keys.empty()) out += "\n[gbuffer]\n" + keys;
    if (rig.gbuffer.channels.empty()) return;
    out += "\n[gbuffer.channels]\n";
    for (const auto& [name, rule] : rig.gbuffer.channels) {
        ChannelRule rest = rule;
        rest.channel.reset();
        const bool plain = rule.channel && rest == ChannelRule{};
        write_key(out, name, plain ? rigfile::string_text(*rule.channel) : rule_text(rule));
    }
}

void write_shader(std::string& out, const ShaderUse& shader) {
    out += "\n[[shader]]\n";
    write_key(out, "use", rigfile::string_text(shader.use));
    write_rows(out, shader_key_parameters(),
               [&](const Parameter& row) { return rigfile::get_shader_match(shader, row.name); });
    write_values(out, shader_use_parameters(shader.use), shader.values);
}

}  // namespace

std::string Rig::to_toml() const {
    std::string out = "version = " + std::to_string(version) + "\n";
    write_gbuffer(out, *this);
    std::string keys;
    write_rows(keys, camera_parameters(), [&](const Parameter& row) { return rigfile::get_camera(gbuffer, row); });
    if (!keys.empty()) out += "\n[camera]\n" + keys;
    for (const Light& light : lights) {
        out += "\n[[light]]\n";
        write_key(out, "name", rigfile::string_text(light.name));
        write_key(out, "type", rigfile::string_text(light.type));
        if (const LightType* type = find_light_type(light.type)) write_values(out, type->parameters, light.values);
    }
    for (const ShaderUse& shader : shaders) write_shader(out, shader);
    keys.clear();
    write_values(keys, output_parameters(), output.values);
    if (!keys.empty()) out += "\n[output]\n" + keys;
    return out;
}

}  // namespace relume
