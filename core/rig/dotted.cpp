// SPDX-License-Identifier: Apache-2.0
// Rig::set and Rig::get: one key by its dotted path.
#include <algorithm>
#include <charconv>

#include "relume/light.h"
#include "rig/document.h"
#include "rig/problem.h"
#include "rig/sections.h"

namespace relume {

namespace {

using rigfile::in_quotes;
using rigfile::Problem;

constexpr std::string_view kSections[] = {"gbuffer", "camera", "light", "shader", "output"};

[[noreturn]] void refuse_path(std::string_view dotted, const std::string& why) {
    throw Problem(Problem::Cause::name, in_quotes(dotted) + " " + why);
}

/// The parts of "light.\"a.b\".exposure"; quotes are single or double, without escapes.
std::vector<std::string> split(std::string_view dotted) {
    std::vector<std::string> parts;
    std::size_t at = 0;
    while (true) {
        std::string part;
        if (at < dotted.size() && (dotted[at] == '"' || dotted[at] == '\'')) {
            const std::size_t end = dotted.find(dotted[at], at + 1);
            if (end == std::string_view::npos) refuse_path(dotted, "has a quote that does not end");
            part = dotted.substr(at + 1, end - at - 1);
            at = end + 1;
            if (at < dotted.size() && dotted[at] != '.') refuse_path(dotted, "goes on after a quote without a dot");
        } else {
            const std::size_t end = std::min(dotted.find('.', at), dotted.size());
            part = dotted.substr(at, end - at);
            at = end;
        }
        if (part.empty()) refuse_path(dotted, "has an empty part; write it as light.key.exposure or output.type");
        parts.push_back(std::move(part));
        if (at >= dotted.size()) return parts;
        ++at;
    }
}

std::optional<std::size_t> index_of(std::string_view text) {
    std::size_t index = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), index);
    if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return index;
}

void require_parts(const std::vector<std::string>& parts, std::size_t count, std::string_view dotted,
                   const char* form) {
    if (parts.size() != count) refuse_path(dotted, std::string("is not a key; write ") + form);
}

/// A light by name, else by index.
std::size_t light_index(const Rig& rig, const std::string& name) {
    for (std::size_t k = 0; k < rig.lights.size(); ++k)
        if (rig.lights[k].name == name) return k;
    if (const auto index = index_of(name); index && *index < rig.lights.size()) return *index;
    std::vector<std::string_view> names;
    for (const Light& light : rig.lights) names.push_back(light.name);
    throw Problem(Problem::Cause::name, "the rig has no light " + in_quotes(name),
                  names.empty() ? "; it has no lights" : rigfile::suggestion(name, names));
}

/// By index; on a rig without shaders 0 is the default one.
std::size_t shader_index(const Rig& rig, const std::string& text) {
    const std::size_t count = std::max<std::size_t>(rig.shaders.size(), 1);
    if (const auto index = index_of(text); index && *index < count) return *index;
    throw Problem(
        Problem::Cause::name, "the rig has no shader " + in_quotes(text),
        count == 1 ? "; its one shader is shader.0" : "; they are shader.0 to shader." + std::to_string(count - 1));
}

ShaderUse default_shader() {
    ShaderUse shader;
    shader.use = "principled";
    return shader;
}

/// A bare word is a string where the row takes strings, whatever else TOML would read in it.
Value for_row(const Parameter* row, const rigfile::Node& node, std::string_view text, std::string_view what) {
    const auto* value = std::get_if<Value>(&node.data);
    const bool wants_text =
        row != nullptr && (row->type == ParameterType::text || row->type == ParameterType::choice ||
                           row->type == ParameterType::text_list || row->type == ParameterType::table);
    const bool is_text =
        value != nullptr &&
        (std::holds_alternative<std::string>(*value) || std::holds_alternative<std::vector<std::string>>(*value) ||
         std::holds_alternative<std::vector<double>>(*value) || std::holds_alternative<LookupTable>(*value));
    const bool list = value == nullptr && text.find_first_not_of(" \t") == text.find('[');
    if (wants_text && !is_text && !list && node.table() == nullptr) return std::string(text);
    if (value == nullptr) throw Problem(Problem::Cause::type, std::string(what) + " cannot be " + node.describe());
    return *value;
}

std::string as_text(const Value& value, std::string_view what) {
    const auto* text = std::get_if<std::string>(&value);
    if (text == nullptr || text->empty())
        throw Problem(Problem::Cause::type, std::string(what) + " takes a name, not " + rigfile::describe(value));
    return *text;
}

class Setter {
public:
    Setter(Rig& rig, std::string_view dotted, std::string_view text)
        : rig_(rig), dotted_(dotted), text_(text), parts_(split(dotted)), node_(rigfile::parse_value(text, dotted)) {}

    void set() {
        const std::string& section = parts_.front();
        if (section == "gbuffer") set_gbuffer();
        else if (section == "camera") set_camera();
        else if (section == "light") set_light();
        else if (section == "shader") set_shader();
        else if (section == "output") set_output();
        else if (section == "version" || section == "include")
            refuse_path(dotted_, "cannot be set; it belongs to the file");
        else
            throw Problem(Problem::Cause::name, "unknown section " + in_quotes(section) + " in " + in_quotes(dotted_),
                          rigfile::suggestion(section, kSections));
    }

private:
    Value value(std::span<const Parameter> table, const std::string& name) const {
        return for_row(rigfile::find_row(table, name), node_, text_, in_quotes(dotted_));
    }

    void set_gbuffer() {
        if (parts_.size() < 3 || parts_[1] != "channels") {
            require_parts(parts_, 2, dotted_, "gbuffer.KEY or gbuffer.channels.NAME");
            return rigfile::set_gbuffer(rig_, parts_[1], value(gbuffer_parameters(), parts_[1]));
        }
        const std::string& name = parts_[2];
        rigfile::require_channel_name(name);
        const std::string what = "channel " + in_quotes(name);
        if (parts_.size() == 3) {
            ChannelRule rule;
            if (const auto* table = node_.table()) {
                for (const rigfile::Entry& entry : table->entries)
                    rigfile::set_channel_rule(rule, entry.key, for_row(nullptr, entry.node, {}, in_quotes(dotted_)),
                                              what);
            } else {
                rigfile::set_channel_rule(rule, "channel", value(channel_rule_parameters(), "channel"), what);
            }
            rig_.gbuffer.channels[name] = std::move(rule);
            return;
        }
        require_parts(parts_, 4, dotted_, "gbuffer.channels.NAME.KEY");
        ChannelRule rule;
        if (const auto known = rig_.gbuffer.channels.find(name); known != rig_.gbuffer.channels.end())
            rule = known->second;
        rigfile::set_channel_rule(rule, parts_[3], value(channel_rule_parameters(), parts_[3]), what);
        rig_.gbuffer.channels[name] = std::move(rule);
    }

    void set_camera() {
        require_parts(parts_, 2, dotted_, "camera.KEY");
        rigfile::set_camera(rig_.gbuffer, parts_[1], value(camera_parameters(), parts_[1]));
    }

    void set_light() {
        require_parts(parts_, 3, dotted_, "light.NAME.KEY");
        Light& light = rig_.lights[light_index(rig_, parts_[1])];
        const std::string& key = parts_[2];
        if (key == "name") {
            const std::string name = as_text(value(light_key_parameters(), key), in_quotes(dotted_));
            const Light* other = rig_.light(name);
            if (other != nullptr && other != &light)
                throw Problem(Problem::Cause::name, "the rig has a light " + in_quotes(name) + " already");
            light.name = name;
        } else if (key == "type") {
            rigfile::set_light_type(light, as_text(value(light_key_parameters(), key), in_quotes(dotted_)));
        } else {
            const LightType* type = find_light_type(light.type);
            rigfile::set_light(light, key,
                               value(type == nullptr ? std::span<const Parameter>{} : type->parameters, key));
        }
    }

    void set_shader() {
        require_parts(parts_, 3, dotted_, "shader.INDEX.KEY");
        const std::size_t index = shader_index(rig_, parts_[1]);
        ShaderUse shader = rig_.shaders.empty() ? default_shader() : rig_.shaders[index];
        const std::string& key = parts_[2];
        if (key == "use") {
            rigfile::set_shader_use(shader, as_text(value(shader_key_parameters(), key), in_quotes(dotted_)));
        } else if (const auto* table = node_.table()) {
            const std::string what = rigfile::shader_label(shader) + ": " + rigfile::one_line(key);
            ParameterValues values;
            for (const rigfile::Entry& entry : table->entries)
                values.set(channel_ref_parameters(), entry.key, for_row(nullptr, entry.node, {}, in_quotes(dotted_)),
                           what);
            rigfile::set_shader(shader, key, rigfile::channel_ref(values, what));
        } else {
            const bool match = rigfile::find_row(shader_key_parameters(), key) != nullptr;
            rigfile::set_shader(shader, key,
                                value(match ? shader_key_parameters() : shader_use_parameters(shader.use), key));
        }
        if (rig_.shaders.empty()) rig_.shaders.emplace_back();
        rig_.shaders[index] = std::move(shader);
    }

    void set_output() {
        require_parts(parts_, 2, dotted_, "output.KEY");
        rigfile::set_output(rig_.output, parts_[1], value(output_parameters(), parts_[1]));
    }

    Rig& rig_;
    std::string_view dotted_;
    std::string_view text_;
    std::vector<std::string> parts_;
    rigfile::Node node_;
};

/// The value of a key and its row.
using Found = std::pair<const Parameter*, std::optional<Value>>;

Found find_value(std::span<const Parameter> table, const ParameterValues& values, const std::string& name,
                 const std::string& what) {
    const Parameter& row = rigfile::require_row(table, name, what);
    const Value* value = values.find(name);
    return {&row, value == nullptr ? std::nullopt : std::optional<Value>(*value)};
}

Found find_gbuffer(const Rig& rig, const std::vector<std::string>& parts, std::string_view dotted) {
    if (parts.size() < 3 || parts[1] != "channels") {
        require_parts(parts, 2, dotted, "gbuffer.KEY or gbuffer.channels.NAME");
        const Parameter& row = rigfile::require_row(gbuffer_parameters(), parts[1], "[gbuffer]");
        return {&row, rigfile::get_gbuffer(rig, row)};
    }
    rigfile::require_channel_name(parts[2]);
    const std::string key = parts.size() == 3 ? "channel" : parts[3];
    if (parts.size() > 4) refuse_path(dotted, "is not a key; write gbuffer.channels.NAME.KEY");
    const Parameter& row = rigfile::require_row(channel_rule_parameters(), key, "channel " + in_quotes(parts[2]));
    const auto known = rig.gbuffer.channels.find(parts[2]);
    return {&row, known == rig.gbuffer.channels.end() ? std::nullopt : rigfile::get_channel_rule(known->second, row)};
}

Found find_light(const Rig& rig, const std::vector<std::string>& parts, std::string_view dotted) {
    require_parts(parts, 3, dotted, "light.NAME.KEY");
    const Light& light = rig.lights[light_index(rig, parts[1])];
    if (parts[2] == "name") return {&light_key_parameters()[0], light.name};
    if (parts[2] == "type") return {&light_key_parameters()[1], light.type};
    const LightType* type = find_light_type(light.type);
    return find_value(type == nullptr ? std::span<const Parameter>{} : type->parameters, light.values, parts[2],
                      rigfile::light_label(light));
}

Found find_shader_value(const Rig& rig, const std::vector<std::string>& parts, std::string_view dotted) {
    require_parts(parts, 3, dotted, "shader.INDEX.KEY");
    const std::size_t index = shader_index(rig, parts[1]);
    const ShaderUse shader = rig.shaders.empty() ? default_shader() : rig.shaders[index];
    if (const Parameter* row = rigfile::find_row(shader_key_parameters(), parts[2]))
        return {row,
                row->name == "use" ? std::optional<Value>(shader.use) : rigfile::get_shader_match(shader, row->name)};
    return find_value(shader_use_parameters(shader.use), shader.values, parts[2], rigfile::shader_label(shader));
}

Found find(const Rig& rig, const std::vector<std::string>& parts, std::string_view dotted) {
    const std::string& section = parts.front();
    if (section == "version") {
        require_parts(parts, 1, dotted, "version");
        return {&rig_parameters()[0], std::int64_t{rig.version}};
    }
    if (section == "gbuffer") return find_gbuffer(rig, parts, dotted);
    if (section == "light") return find_light(rig, parts, dotted);
    if (section == "shader") return find_shader_value(rig, parts, dotted);
    if (section == "camera") {
        require_parts(parts, 2, dotted, "camera.KEY");
        const Parameter& row = rigfile::require_row(camera_parameters(), parts[1], "[camera]");
        return {&row, rigfile::get_camera(rig.gbuffer, row)};
    }
    if (section == "output") {
        require_parts(parts, 2, dotted, "output.KEY");
        return find_value(output_parameters(), rig.output.values, parts[1], "[output]");
    }
    throw Problem(Problem::Cause::name, "unknown section " + in_quotes(section) + " in " + in_quotes(dotted),
                  rigfile::suggestion(section, kSections));
}

/// The default as a value; absent rows have none.
std::optional<Value> default_value(const Parameter& row) {
    if (!row.has_default) return std::nullopt;
    const Parameter table[] = {row};
    const ParameterValues none;
    switch (row.type) {
        case ParameterType::scalar:
            return none.number(table, row.name);
        case ParameterType::color:
        case ParameterType::vector:
            return none.triple(table, row.name);
        case ParameterType::boolean:
            return none.boolean(table, row.name);
        case ParameterType::integer:
            return static_cast<std::int64_t>(none.number(table, row.name));
        case ParameterType::choice:
        case ParameterType::text:
        case ParameterType::table:
            return none.text(table, row.name);
        case ParameterType::text_list:
            return none.texts(table, row.name);
        case ParameterType::number_list:
            return none.numbers(table, row.name);
    }
    return std::nullopt;
}

}  // namespace

void Rig::set(std::string_view dotted, std::string_view value) { Setter(*this, dotted, value).set(); }

std::string Rig::get(std::string_view dotted) const {
    const auto [row, given] = find(*this, split(dotted), dotted);
    const std::optional<Value> value = given ? given : default_value(*row);
    if (!value) refuse_path(dotted, "is not given and has no default");
    return rigfile::value_text(*value, row->type);
}

}  // namespace relume
