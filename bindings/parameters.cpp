// SPDX-License-Identifier: Apache-2.0
#include "parameters.h"

#include <pybind11/stl.h>

#include <vector>

#include "relume/light.h"
#include "relume/rig.h"

namespace relume::python {

namespace {

const char* name_of(ParameterType type) {
    switch (type) {
        case ParameterType::scalar:
            return "scalar";
        case ParameterType::color:
            return "color";
        case ParameterType::vector:
            return "vector";
        case ParameterType::boolean:
            return "boolean";
        case ParameterType::integer:
            return "integer";
        case ParameterType::choice:
            return "choice";
        case ParameterType::text:
            return "text";
        case ParameterType::text_list:
            return "text_list";
        case ParameterType::number_list:
            return "number_list";
        case ParameterType::table:
            return "table";
    }
    return "?";
}

std::vector<std::string> split(std::string_view text) {
    std::vector<std::string> parts;
    while (!text.empty()) {
        const auto bar = text.find('|');
        parts.emplace_back(text.substr(0, bar));
        text = bar == std::string_view::npos ? std::string_view{} : text.substr(bar + 1);
    }
    return parts;
}

py::object default_of(const Parameter& p) {
    if (!p.has_default) return py::none();
    switch (p.type) {
        case ParameterType::scalar:
            return py::float_(p.value[0]);
        case ParameterType::color:
        case ParameterType::vector:
            return py::make_tuple(p.value[0], p.value[1], p.value[2]);
        case ParameterType::boolean:
            return py::bool_(p.value[0] != 0);
        case ParameterType::integer:
            return py::int_(static_cast<long long>(p.value[0]));
        case ParameterType::choice:
            return py::str(split(p.choices).at(static_cast<std::size_t>(p.value[0])));
        case ParameterType::text:
        case ParameterType::table:
            return py::str(std::string(p.text));
        case ParameterType::text_list:
            return py::cast(split(p.text));
        case ParameterType::number_list: {
            py::list list;
            for (int k = 0; k < p.count && k < 3; ++k) list.append(p.value[static_cast<std::size_t>(k)]);
            return list;
        }
    }
    return py::none();
}

template <std::string_view Parameter::*member> std::string text_of(const Parameter& p) {
    return std::string(p.*member);
}

}  // namespace

py::tuple parameter_tuple(std::span<const Parameter> table) {
    py::tuple rows(table.size());
    for (std::size_t i = 0; i < table.size(); ++i) rows[i] = py::cast(table[i]);
    return rows;
}

void bind_parameters(py::module_& module) {
    py::class_<Parameter>(module, "Parameter",
                          "One row of a parameter table: what a shader, a light or a section of the rig takes.")
        .def_property_readonly("name", &text_of<&Parameter::name>)
        .def_property_readonly(
            "type", [](const Parameter& p) { return std::string(name_of(p.type)); },
            "scalar, color, vector, boolean, integer, choice, text, text_list, number_list or table.")
        .def_property_readonly("default", &default_of, "None where the key has no default.")
        .def_readonly("min", &Parameter::min, "Hard range, inclusive; infinite where there is none.")
        .def_readonly("max", &Parameter::max, "Hard range, inclusive; infinite where there is none.")
        .def_readonly("soft_min", &Parameter::soft_min, "Range of a slider.")
        .def_readonly("soft_max", &Parameter::soft_max, "Range of a slider.")
        .def_property_readonly("unit", &text_of<&Parameter::unit>, "Empty when dimensionless.")
        .def_property_readonly("label", &text_of<&Parameter::label>)
        .def_property_readonly("help", &text_of<&Parameter::help>)
        .def_property_readonly(
            "choices", [](const Parameter& p) { return split(p.choices); }, "Names of a choice, in order.")
        .def_readonly("count", &Parameter::count, "number_list: required length, 0 for any.")
        .def_readonly("slot", &Parameter::slot, "Shaders: first float of the parameter, or its option.")
        .def_property_readonly("components", &Parameter::components, "3 for color and vector, else 1.")
        .def("__repr__",
             [](const Parameter& p) { return "<Parameter " + std::string(p.name) + ": " + name_of(p.type) + ">"; });

    py::class_<LightType>(module, "LightType", "One kind of light, as the rig names it.")
        .def_property_readonly("name", [](const LightType& t) { return std::string(t.name); })
        .def_property_readonly("label", [](const LightType& t) { return std::string(t.label); })
        .def_property_readonly("help", [](const LightType& t) { return std::string(t.help); })
        .def_property_readonly(
            "parameters",
            [](const LightType& t) -> py::typing::Tuple<Parameter, py::ellipsis> {
                return parameter_tuple(t.parameters);
            },
            "All keys: those common to every light, then the type's own.")
        .def("__repr__", [](const LightType& t) { return "<LightType " + std::string(t.name) + ">"; });

    module.def("light_types", [] {
        const auto types = light_types();
        return std::vector<LightType>(types.begin(), types.end());
    });
    using Rows = py::typing::Tuple<Parameter, py::ellipsis>;
    module.def("output_parameters", []() -> Rows { return parameter_tuple(output_parameters()); });
    module.def("camera_parameters", []() -> Rows { return parameter_tuple(camera_parameters()); });
    module.def("gbuffer_parameters", []() -> Rows { return parameter_tuple(gbuffer_parameters()); });
    module.def("channel_rule_parameters", []() -> Rows { return parameter_tuple(channel_rule_parameters()); });
    module.def("shader_key_parameters", []() -> Rows { return parameter_tuple(shader_key_parameters()); });
    module.def(
        "nearest_name",
        [](const std::string& word, const std::vector<std::string>& candidates) {
            const std::vector<std::string_view> views(candidates.begin(), candidates.end());
            return nearest_name(word, views);
        },
        py::arg("word"), py::arg("candidates"), "The candidate nearest to the word, or \"\" when none is near.");
}

}  // namespace relume::python
