// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <set>

#include "lights/bake.h"
#include "relume/light.h"
#include "rig/document.h"
#include "rig/problem.h"
#include "rig/sections.h"
#include "rig/source.h"

namespace relume {

namespace rigfile {
namespace {

// Includes that include each other twice over grow without end.
constexpr int kMostFiles = 256;

constexpr std::string_view kSections[] = {"version", "include", "gbuffer", "camera", "light", "shader", "output"};

const BuiltinRig* find_builtin(std::string_view name) {
    const auto all = builtin_rigs();
    const auto found = std::find_if(all.begin(), all.end(), [&](const BuiltinRig& b) { return b.name == name; });
    return found == all.end() ? nullptr : &*found;
}

std::vector<std::string_view> builtin_names() {
    std::vector<std::string_view> names;
    for (const BuiltinRig& b : builtin_rigs()) names.push_back(b.name);
    return names;
}

/// Reads files into one rig, each over what those before it left.
class Loader {
public:
    explicit Loader(Rig& rig) : rig_(rig) {}

    /// A file, or a built-in rig where no file has the name. `from` says who asks, for messages.
    void load_name(const std::string& name, const std::filesystem::path& folder, const std::string& from) {
        const std::filesystem::path path = resolved(name, folder);
        std::error_code error;
        const bool there = std::filesystem::exists(path, error);
        const BuiltinRig* builtin = there && !std::filesystem::is_directory(path, error) ? nullptr : find_builtin(name);
        if (builtin != nullptr)
            return load_text({"built-in rig '" + name + "'", std::string(builtin->toml)}, {}, "builtin:" + name);
        if (!there) {
            const std::string near = nearest_name(name, builtin_names());
            throw Error(ErrorKind::file, shown(path) + ": no such rig file" + from +
                                             (near.empty() ? "" : "; did you mean the built-in rig '" + near + "'?"));
        }
        const std::string text = read_text(path);
        const std::filesystem::path full = std::filesystem::absolute(path, error).lexically_normal();
        const std::filesystem::path canonical = std::filesystem::weakly_canonical(path, error);
        load_text({shown(path), text}, full.parent_path(), (error ? full : canonical).string());
    }

    /// `identity` tells one file from another, "" for text.
    void load_text(const Source& source, const std::filesystem::path& folder, const std::string& identity) {
        if (!identity.empty() && std::find(open_.begin(), open_.end(), identity) != open_.end()) {
            std::string chain;
            for (const std::string& name : open_names_) chain += name + " → ";
            throw Error(ErrorKind::rig, "rigs include each other in a circle: " + chain + source.name);
        }
        if (++files_ > kMostFiles)
            throw Error(ErrorKind::rig, "more than " + std::to_string(kMostFiles) + " includes, at " + source.name);
        open_.push_back(identity);
        open_names_.push_back(source.name);
        read(source, parse(source), folder);
        open_.pop_back();
        open_names_.pop_back();
    }

    /// What can only be said when everything is read.
    void finish() {
        for (const Light& light : rig_.lights)
            for (const Parameter& p : find_light_type(light.type)->parameters)
                if (!p.has_default && p.type == ParameterType::vector && !light.values.given(p.name))
                    throw Error(ErrorKind::rig, light_label(light) + " has no " + std::string(p.name) + " at " +
                                                    places_[light.name] + "; a " + light.type +
                                                    " light needs one: " + std::string(p.name) + " = [x, y, z]");
        for (const Light& light : rig_.lights) refuse_impossible(light);
        const auto& camera = rig_.gbuffer;
        if (camera.focal_length.has_value() != camera.horizontal_aperture.has_value())
            throw Error(ErrorKind::rig, std::string("[camera] has ") +
                                            (camera.focal_length ? "focal_length without horizontal_aperture"
                                                                 : "horizontal_aperture without focal_length") +
                                            at(camera_place_) + "; give both, or fov");
    }

private:
    /// What each value allows and all together do not: a direction of length 0, an attenuation of 0 everywhere.
    void refuse_impossible(const Light& light) {
        try {
            std::vector<std::string> warnings;
            bake_light(light, std::nullopt, warnings);
        } catch (const Error& error) {
            throw Error(ErrorKind::rig, error.what() + at(places_[light.name]));
        }
    }

    static std::string at(const std::string& place) { return place.empty() ? "" : " at " + place; }

    void read(const Source& source, const Node::Table& document, const std::filesystem::path& folder) {
        read_includes(source, document, folder);
        for (const Entry& entry : document.entries) {
            if (entry.key == "version") check_version(source, entry);
            else if (entry.key == "gbuffer") read_gbuffer(source, table_of(source, entry, "[gbuffer]"), folder);
            else if (entry.key == "camera") read_camera(source, entry);
            else if (entry.key == "output") read_output(source, table_of(source, entry, "[output]"));
            else if (entry.key == "light") read_lights(source, tables_of(source, entry));
            else if (entry.key == "shader") read_shaders(source, tables_of(source, entry), folder);
            else if (entry.key != "include") refuse_section(source, entry);
        }
    }

    [[noreturn]] static void refuse_section(const Source& source, const Entry& entry) {
        if (entry.key == "original_light")
            throw Error(ErrorKind::rig, "[[original_light]] at " + source.place(entry.at) +
                                            " is not in this version of relume; remove it");
        const bool list = std::holds_alternative<Node::Tables>(entry.node.data);
        const std::string what = entry.node.table() != nullptr ? "section [" + one_line(entry.key) + "]"
                                 : list                        ? "section [[" + one_line(entry.key) + "]]"
                                                               : "key " + in_quotes(entry.key);
        throw Problem(Problem::Cause::name, "unknown " + what, suggestion(entry.key, kSections))
            .at(source.place(entry.at));
    }

    /// Calls what sets a key; a Problem gets the key's place.
    template <class Set> static void apply(const Source& source, const Entry& entry, std::string_view what, Set set) {
        const auto* value = std::get_if<Value>(&entry.node.data);
        try {
            if (value == nullptr)
                throw Problem(Problem::Cause::type,
                              std::string(what) + ": " + one_line(entry.key) + " cannot be " + entry.node.describe());
            set(*value);
        } catch (const Problem& problem) {
            throw problem.at(source.place(entry.at));
        }
    }

    static const Node::Table& table_of(const Source& source, const Entry& entry, const std::string& section) {
        if (const auto* table = entry.node.table()) return *table;
        throw Problem(Problem::Cause::type, in_quotes(entry.key) + " is " + entry.node.describe(),
                      "; it is a section: write " + section)
            .at(source.place(entry.at));
    }

    static const Node::Tables& tables_of(const Source& source, const Entry& entry) {
        static const Node::Tables none;
        if (const auto* tables = std::get_if<Node::Tables>(&entry.node.data)) return *tables;
        const auto* value = std::get_if<Value>(&entry.node.data);
        const auto* list = value == nullptr ? nullptr : std::get_if<std::vector<double>>(value);
        if (list != nullptr && list->empty()) return none;
        throw Problem(Problem::Cause::type, in_quotes(entry.key) + " is " + entry.node.describe(),
                      "; write [[" + entry.key + "]], once for each")
            .at(source.place(entry.at));
    }

    static void check_version(const Source& source, const Entry& entry) {
        apply(source, entry, "the rig", [&](const Value& value) {
            const auto* version = std::get_if<std::int64_t>(&value);
            if (version == nullptr)
                throw Problem(Problem::Cause::type, "version takes the number 1, not " + describe(value));
            if (*version != 1)
                throw Problem(Problem::Cause::name, "version is " + std::to_string(*version),
                              "; this relume reads version 1");
        });
    }

    void read_includes(const Source& source, const Node::Table& document, const std::filesystem::path& folder) {
        const Entry* entry = document.find("include");
        if (entry == nullptr) return;
        std::vector<std::string> names;
        apply(source, *entry, "the rig", [&](const Value& value) {
            names = std::get<std::vector<std::string>>(
                canonical(require_row(rig_parameters(), "include", "the rig"), value, "the rig"));
        });
        for (const std::string& name : names) load_name(name, folder, " (included at " + source.place(entry->at) + ")");
    }

    void read_gbuffer(const Source& source, const Node::Table& table, const std::filesystem::path& folder) {
        for (const Entry& entry : table.entries) {
            if (entry.key == "channels") {
                for (const Entry& channel : table_of(source, entry, "[gbuffer.channels]").entries)
                    read_channel(source, channel, folder);
                continue;
            }
            apply(source, entry, "[gbuffer]", [&](const Value& value) { set_gbuffer(rig_, entry.key, value); });
            if (entry.key == "file") rig_.gbuffer_file = resolved(*rig_.gbuffer_file, folder);
        }
    }

    void read_channel(const Source& source, const Entry& entry, const std::filesystem::path& folder) {
        const std::string what = "channel " + in_quotes(entry.key);
        ChannelRule rule;
        try {
            require_channel_name(entry.key, std::get_if<Value>(&entry.node.data));
        } catch (const Problem& problem) {
            throw problem.at(source.place(entry.at));
        }
        if (const auto* table = entry.node.table()) {
            for (const Entry& key : table->entries)
                apply(source, key, what, [&](const Value& value) { set_channel_rule(rule, key.key, value, what); });
        } else {
            apply(source, entry, "[gbuffer.channels]",
                  [&](const Value& value) { set_channel_rule(rule, "channel", value, what); });
        }
        if (rule.channel && names_a_file(*rule.channel)) rule.channel = resolved(*rule.channel, folder);
        rig_.gbuffer.channels[entry.key] = std::move(rule);
    }

    void read_camera(const Source& source, const Entry& section) {
        const Node::Table& table = table_of(source, section, "[camera]");
        camera_place_ = source.place(section.at);
        const Entry* fov = table.find("fov");
        for (const std::string_view other : {"focal_length", "horizontal_aperture"})
            if (fov != nullptr && table.find(other) != nullptr)
                throw Error(ErrorKind::rig, "[camera] has fov and " + std::string(other) + " at " +
                                                source.place(fov->at) + "; give one of the two");
        for (const Entry& entry : table.entries)
            apply(source, entry, "[camera]", [&](const Value& value) { set_camera(rig_.gbuffer, entry.key, value); });
    }

    void read_output(const Source& source, const Node::Table& table) {
        for (const Entry& entry : table.entries)
            apply(source, entry, "[output]", [&](const Value& value) { set_output(rig_.output, entry.key, value); });
    }

    static std::string text_of(const Source& source, const Entry& entry, std::string_view what) {
        std::string text;
        apply(source, entry, what, [&](const Value& value) {
            const auto* string = std::get_if<std::string>(&value);
            if (string == nullptr)
                throw Problem(Problem::Cause::type,
                              std::string(what) + ": " + entry.key + " takes a string, not " + describe(value));
            text = *string;
            if (text.empty()) throw Problem(Problem::Cause::type, std::string(what) + ": " + entry.key + " is empty");
        });
        return text;
    }

    void read_lights(const Source& source, const Node::Tables& tables) {
        std::map<std::string, Place, std::less<>> own;  // the names that this file gives
        for (const Node& node : tables)
            if (const Entry* name = node.table()->find("name")) {
                const std::string text = text_of(source, *name, "[[light]]");
                const auto [first, fresh] = own.try_emplace(text, name->at);
                if (!fresh)
                    throw Error(ErrorKind::rig, "two lights are named " + in_quotes(text) + " at " +
                                                    source.place(name->at) + "; the first is at " +
                                                    source.place(first->second) + ": names are unique");
            }
        for (const Node& node : tables) read_light(source, node, own);
    }

    template <class Names> void read_light(const Source& source, const Node& node, const Names& own) {
        const Node::Table& table = *node.table();
        const Entry* name = table.find("name");
        const Entry* type = table.find("type");
        const std::string place = source.place(node.at);
        Light* light = name == nullptr ? nullptr : find_light(text_of(source, *name, "[[light]]"));
        if (light == nullptr) {
            const std::string label =
                name == nullptr ? "a light" : "light " + in_quotes(text_of(source, *name, "[[light]]"));
            if (type == nullptr) {
                std::string list;
                for (const LightType& t : light_types()) list += (list.empty() ? "" : ", ") + std::string(t.name);
                throw Error(ErrorKind::rig, label + " has no type at " + place + "; give type, one of " + list);
            }
            const std::string kind = text_of(source, *type, label);
            rig_.lights.push_back({name == nullptr ? free_name(kind, own) : text_of(source, *name, label), {}, {}});
            light = &rig_.lights.back();
            index_.emplace(light->name, rig_.lights.size() - 1);
        }
        places_[light->name] = place;
        if (type != nullptr)
            apply(source, *type, light_label(*light),
                  [&](const Value&) { set_light_type(*light, text_of(source, *type, light_label(*light))); });
        refuse_both(source, *light, table, "power", "intensity");
        for (const Entry& entry : table.entries)
            if (&entry != name && &entry != type)
                apply(source, entry, light_label(*light),
                      [&](const Value& value) { set_light(*light, entry.key, value); });
    }

    static void refuse_both(const Source& source, const Light& light, const Node::Table& table, std::string_view a,
                            std::string_view b) {
        const Entry* first = table.find(a);
        if (first != nullptr && table.find(b) != nullptr)
            throw Error(ErrorKind::rig, light_label(light) + " has both " + std::string(a) + " and " + std::string(b) +
                                            " at " + source.place(first->at) + "; give one of the two");
    }

    Light* find_light(const std::string& name) {
        const auto found = index_.find(name);
        return found == index_.end() ? nullptr : &rig_.lights[found->second];
    }

    template <class Names> std::string free_name(const std::string& type, const Names& own) {
        const auto taken = [&](const std::string& name) { return index_.contains(name) || own.contains(name); };
        if (!taken(type)) return type;
        std::size_t& number = numbers_.try_emplace(type, 1).first->second;
        std::string name;
        do name = type + "_" + std::to_string(++number);
        while (taken(name));
        return name;
    }

    void read_shaders(const Source& source, const Node::Tables& tables, const std::filesystem::path& folder) {
        std::vector<ShaderUse> read;
        for (const Node& node : tables) {
            const Node::Table& table = *node.table();
            const Entry* use = table.find("use");
            if (use == nullptr)
                throw Error(ErrorKind::rig, "a [[shader]] has no use at " + source.place(node.at) +
                                                "; give use, the name of a shading model");
            ShaderUse shader;
            apply(source, *use, "[[shader]]",
                  [&](const Value&) { set_shader_use(shader, text_of(source, *use, "[[shader]]")); });
            for (const Entry& entry : table.entries)
                if (&entry != use) read_shader_key(source, entry, shader, folder);
            read.push_back(std::move(shader));
        }
        // The first that matches wins and the last without a match is the default: to override what was included, these
        // go before it where they match something, and after it where they do not.
        if (rig_.shaders.empty()) {
            rig_.shaders = std::move(read);
            return;
        }
        const auto defaults =
            std::stable_partition(read.begin(), read.end(), [](const ShaderUse& s) { return !s.matches_all(); });
        rig_.shaders.insert(rig_.shaders.begin(), read.begin(), defaults);
        rig_.shaders.insert(rig_.shaders.end(), defaults, read.end());
    }

    /// The value of a shader's key, the name of a table's file resolved.
    static Value from_folder(const ShaderUse& shader, std::string_view key, const Value& value,
                             const std::filesystem::path& folder) {
        const Parameter* row = find_row(shader_use_parameters(shader.use), key);
        const auto* name = std::get_if<std::string>(&value);
        if (row == nullptr || row->type != ParameterType::table || name == nullptr) return value;
        return resolved(*name, folder);
    }

    static void read_shader_key(const Source& source, const Entry& entry, ShaderUse& shader,
                                const std::filesystem::path& folder) {
        const auto* table = entry.node.table();
        if (table == nullptr) {
            apply(source, entry, shader_label(shader), [&](const Value& value) {
                set_shader(shader, entry.key, from_folder(shader, entry.key, value, folder));
            });
            return;
        }
        const std::string what = shader_label(shader) + ": " + one_line(entry.key);
        ParameterValues values;
        for (const Entry& key : table->entries)
            apply(source, key, what,
                  [&](const Value& value) { values.set(channel_ref_parameters(), key.key, value, what); });
        try {
            set_shader(shader, entry.key, channel_ref(values, what));
        } catch (const Problem& problem) {
            throw problem.at(source.place(entry.at));
        }
    }

    Rig& rig_;
    std::vector<std::string> open_, open_names_;
    int files_ = 0;
    std::map<std::string, std::size_t, std::less<>> index_;  // lights by name
    std::map<std::string, std::size_t, std::less<>> numbers_;
    std::map<std::string, std::string, std::less<>> places_;  // where each light was last spoken of
    std::string camera_place_;
};

}  // namespace
}  // namespace rigfile

Rig Rig::load(const std::filesystem::path& path) {
    Rig rig;
    rigfile::Loader loader(rig);
    loader.load_name(path.string(), {}, {});
    loader.finish();
    std::error_code error;
    if (std::filesystem::exists(path, error)) rig.path = path;
    return rig;
}

Rig Rig::loads(std::string_view toml, std::string_view name) {
    Rig rig;
    rigfile::Loader loader(rig);
    loader.load_text({std::string(name), std::string(toml)}, {}, {});
    loader.finish();
    return rig;
}

Rig Rig::builtin(std::string_view name) {
    const auto* found = rigfile::find_builtin(name);
    if (found == nullptr)
        throw Error(ErrorKind::rig, "no built-in rig " + rigfile::in_quotes(name) +
                                        rigfile::suggestion(name, rigfile::builtin_names()));
    return loads(found->toml, "built-in rig '" + std::string(name) + "'");
}

}  // namespace relume
