// SPDX-License-Identifier: Apache-2.0
#include "relume/rig.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "bindings.h"
#include "relume/error.h"
#include "relume/light.h"
#include "relume/relight.h"
#include "rig/sections.h"

namespace relume::python {

namespace {

// Keys and values pass through Rig::set and Rig::get, which check them against the tables; what is here adds and
// removes the things that the keys belong to.

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorKind::parameter, message); }

Light& require_light(Rig& rig, const std::string& name) {
    if (Light* light = rig.light(name)) return *light;
    std::vector<std::string_view> names;
    for (const Light& light : rig.lights) names.push_back(light.name);
    const std::string near = nearest_name(name, names);
    refuse("the rig has no light '" + name + "'" + (near.empty() ? "" : "; did you mean '" + near + "'?"));
}

void add_light(Rig& rig, const std::string& name, const std::string& type) {
    if (name.empty()) refuse("a light needs a name");
    if (rig.light(name)) refuse("the rig has a light '" + name + "' already");
    if (!find_light_type(type)) {
        std::vector<std::string_view> names;
        for (const LightType& known : light_types()) names.push_back(known.name);
        const std::string near = nearest_name(type, names);
        refuse("no light type '" + type + "'" + (near.empty() ? "" : "; did you mean '" + near + "'?"));
    }
    rig.lights.push_back({name, type, {}});
}

void rename_light(Rig& rig, const std::string& name, const std::string& to) {
    Light& light = require_light(rig, name);
    if (to.empty()) refuse("a light needs a name");
    if (to != name && rig.light(to)) refuse("the rig has a light '" + to + "' already");
    light.name = to;
}

ShaderUse& require_shader_use(Rig& rig, std::size_t index) {
    if (index < rig.shaders.size()) return rig.shaders[index];
    refuse("the rig has no shader " + std::to_string(index) + "; it has " + std::to_string(rig.shaders.size()));
}

std::vector<std::string> given(const ParameterValues& values) {
    std::vector<std::string> names;
    for (const auto& [name, value] : values.all()) names.push_back(name);
    return names;
}

}  // namespace

void bind_rig(py::module_& module) {
    py::class_<Rig>(module, "Rig", "The rig's data; relume.Rig is its face.")
        .def(py::init<>())
        .def(py::init<const Rig&>(), py::arg("other"))
        .def_static("load", &Rig::load, py::arg("path"))
        .def_static(
            "loads", [](const std::string& text, const std::string& name) { return Rig::loads(text, name); },
            py::arg("text"), py::arg("name"))
        .def_static(
            "builtin", [](const std::string& name) { return Rig::builtin(name); }, py::arg("name"))
        .def_readwrite("path", &Rig::path)
        .def(
            "set", [](Rig& rig, const std::string& key, const std::string& value) { rig.set(key, value); },
            py::arg("key"), py::arg("value"), "A dotted key; the value is TOML.")
        .def(
            "get", [](const Rig& rig, const std::string& key) { return rig.get(key); }, py::arg("key"),
            "The value of a dotted key as TOML.")
        .def("to_toml", &Rig::to_toml)
        .def("at", &Rig::at, py::arg("frame"))
        .def(
            "aovs",
            [](const Rig& rig) {
                std::vector<std::pair<std::string, int>> list;
                for (const AovInfo& aov : aovs(rig)) list.emplace_back(aov.name, aov.components);
                return list;
            },
            "Names and components of the pictures that the rig makes, beauty first.")

        .def_readwrite("gbuffer_file", &Rig::gbuffer_file)
        .def_readwrite("frame", &Rig::frame)
        .def("of_frame", &Rig::of_frame, py::arg("frame"), "at(frame), with its number in the names of files.")
        .def("main_file", &Rig::main_file, "The G-buffer's file, None when the rig names none.")
        .def("input_files", &Rig::input_files, "Every file that the rig names.")
        .def("resolve_files", &Rig::resolve_files, py::arg("folder"),
             "Relative names of files become those of that folder.")
        .def(
            "channel_sources",
            [](const Rig& rig) {
                std::map<std::string, std::optional<std::string>> sources;
                for (const auto& [name, rule] : rig.gbuffer.channels) sources.emplace(name, rule.channel);
                return sources;
            },
            "The channel, layer or file of each semantic name that [gbuffer.channels] says something of.")
        .def(
            "set_channel_source",
            [](Rig& rig, const std::string& name, const std::optional<std::string>& source) {
                rig.gbuffer.channels[name].channel = source;
            },
            py::arg("name"), py::arg("source"))
        .def(
            "remove_channel", [](Rig& rig, const std::string& name) { rig.gbuffer.channels.erase(name); },
            py::arg("name"))

        .def(
            "unset_gbuffer",
            [](Rig& rig, const std::string& key) {
                rigfile::for_each_gbuffer_member(rig, [&](std::string_view name, auto& member) {
                    if (name == key) member.reset();
                });
            },
            py::arg("key"))
        .def(
            "unset_camera",
            [](Rig& rig, const std::string& key) {
                rigfile::for_each_camera_member(rig.gbuffer, [&](std::string_view name, auto& member) {
                    if (name == key) member.reset();
                });
            },
            py::arg("key"))

        .def("light_names",
             [](const Rig& rig) {
                 std::vector<std::string> names;
                 for (const Light& light : rig.lights) names.push_back(light.name);
                 return names;
             })
        .def("add_light", &add_light, py::arg("name"), py::arg("type"))
        .def(
            "remove_light",
            [](Rig& rig, const std::string& name) {
                const Light& light = require_light(rig, name);
                rig.lights.erase(rig.lights.begin() + (&light - rig.lights.data()));
            },
            py::arg("name"))
        .def("rename_light", &rename_light, py::arg("name"), py::arg("to"))
        .def(
            "light_type", [](Rig& rig, const std::string& name) { return require_light(rig, name).type; },
            py::arg("name"))
        .def(
            "light_given", [](Rig& rig, const std::string& name) { return given(require_light(rig, name).values); },
            py::arg("name"), "Keys that are not left to their defaults.")
        .def(
            "light_unset",
            [](Rig& rig, const std::string& name, const std::string& key) {
                require_light(rig, name).values.unset(key);
            },
            py::arg("name"), py::arg("key"))

        .def("shader_uses",
             [](const Rig& rig) {
                 std::vector<std::string> uses;
                 for (const ShaderUse& shader : rig.shaders) uses.push_back(shader.use);
                 return uses;
             })
        .def(
            "add_shader",
            [](Rig& rig, std::size_t index, const std::string& use) {
                Rig trial;  // checks the name before anything is changed
                trial.shaders.emplace_back();
                trial.shaders.back().use = "lambert";
                trial.set("shader.0.use", '"' + use + '"');
                const auto place = static_cast<std::ptrdiff_t>(std::min(index, rig.shaders.size()));
                rig.shaders.insert(rig.shaders.begin() + place, trial.shaders.back());
            },
            py::arg("index"), py::arg("use"))
        .def(
            "remove_shader",
            [](Rig& rig, std::size_t index) {
                require_shader_use(rig, index);
                rig.shaders.erase(rig.shaders.begin() + static_cast<std::ptrdiff_t>(index));
            },
            py::arg("index"))
        .def(
            "shader_given", [](Rig& rig, std::size_t index) { return given(require_shader_use(rig, index).values); },
            py::arg("index"))
        .def(
            "shader_unset",
            [](Rig& rig, std::size_t index, const std::string& key) {
                require_shader_use(rig, index).values.unset(key);
            },
            py::arg("index"), py::arg("key"))

        .def("output_given", [](const Rig& rig) { return given(rig.output.values); })
        .def(
            "output_unset", [](Rig& rig, const std::string& key) { rig.output.values.unset(key); }, py::arg("key"));

    module.def(
        "builtin_rigs",
        [] {
            std::vector<std::string> names;
            for (const BuiltinRig& rig : builtin_rigs()) names.emplace_back(rig.name);
            return names;
        },
        "Names of the built-in rigs.");
}

}  // namespace relume::python
