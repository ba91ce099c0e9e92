// SPDX-License-Identifier: Apache-2.0
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "bindings.h"
#include "parameters.h"
#include "relume/error.h"
#include "relume/lookup_table.h"
#include "relume/shader.h"
#include "relume/shader_abi.h"

namespace relume::python {

namespace {

template <class T> using Array = py::array_t<T, py::array::c_style>;

template <class T> void run(const ShaderInfo& shader, const ShaderEvaluation<T>& evaluation) {
    if constexpr (std::is_same_v<T, float>) shader.abi->evaluate_float(&evaluation);
    else shader.abi->evaluate_double(&evaluation);
}

/// A column of the inputs: `count` values, or one that stands for all.
template <class T> struct Column {
    const T* data = nullptr;
    bool constant = false;
};

template <class T> Column<T> column_of(const Array<T>& array, py::ssize_t count) {
    if (array.ndim() != 1 || (array.shape(0) != count && array.shape(0) != 1))
        throw Error(ErrorKind::value, "evaluate: every array must have one value, or one for each of the " +
                                          std::to_string(count) + " samples");
    return {array.data(), array.shape(0) == 1};
}

py::array_t<float> array_of(const LookupTable& table) {
    py::array_t<float> out({table.height, table.width});
    std::copy(table.texels.begin(), table.texels.end(), out.mutable_data());
    return out;
}

/// Views of the tables by slot; where none is given, of the built-in one.
std::vector<TableView> views_of(const ShaderInfo& shader, const std::vector<std::optional<Array<float>>>& tables) {
    std::vector<TableView> views(static_cast<std::size_t>(shader.abi->table_slots));
    if (tables.size() != views.size())
        throw Error(ErrorKind::value, "evaluate: wrong number of tables for '" + std::string(shader.name) + "'");
    for (const Parameter& p : shader.parameters) {
        if (p.type != ParameterType::table) continue;
        const auto slot = static_cast<std::size_t>(p.slot);
        if (!tables[slot]) {
            const auto builtin = builtin_table(shader, p.name);  // lives on
            views[slot] = {builtin->texels.data(), builtin->width, builtin->height};
            continue;
        }
        const Array<float>& array = *tables[slot];
        const std::string what = "evaluate: " + std::string(p.name);
        if (array.ndim() != 2)
            throw Error(ErrorKind::value, what + " is an array of " + std::to_string(array.ndim()) +
                                              " dimensions; a table is (height, width)");
        if (array.size() > kMostTexels)
            throw Error(ErrorKind::value, what + " has " + std::to_string(array.size()) +
                                              " texels; a table has at most " + std::to_string(kMostTexels));
        check_table({static_cast<int>(array.shape(1)), static_cast<int>(array.shape(0)),
                     std::vector<float>(array.data(), array.data() + array.size())},
                    what);
        views[slot] = {array.data(), static_cast<std::int32_t>(array.shape(1)),
                       static_cast<std::int32_t>(array.shape(0))};
    }
    return views;
}

/// Inputs come as columns; constants are spread over a block, so that broadcasting costs no memory.
template <class T>
py::array_t<T> evaluate(const ShaderInfo& shader, py::ssize_t count, const std::vector<Array<T>>& directions,
                        const std::vector<Array<T>>& params, const std::vector<std::int32_t>& options,
                        const std::vector<std::optional<Array<float>>>& tables) {
    constexpr py::ssize_t kBlock = 4096;
    const ShaderAbi& abi = *shader.abi;
    if ((directions.size() != 9 && directions.size() != 12) ||
        params.size() != static_cast<std::size_t>(abi.float_slots) ||
        options.size() != static_cast<std::size_t>(abi.option_slots))
        throw Error(ErrorKind::value, "evaluate: wrong number of columns for '" + std::string(shader.name) + "'");

    const std::vector<TableView> views = views_of(shader, tables);
    std::vector<Column<T>> columns;
    for (const auto& array : directions) columns.push_back(column_of(array, count));
    for (const auto& array : params) columns.push_back(column_of(array, count));
    py::array_t<T> result({py::ssize_t{9}, count});
    T* const out = result.mutable_data();

    const py::gil_scoped_release release;
    std::vector<std::vector<T>> spread(columns.size());
    for (std::size_t c = 0; c < columns.size(); ++c)
        if (columns[c].constant) spread[c].assign(static_cast<std::size_t>(std::min(count, kBlock)), *columns[c].data);
    std::vector<const T*> inputs(columns.size());
    for (py::ssize_t start = 0; start < count; start += kBlock) {
        for (std::size_t c = 0; c < columns.size(); ++c)
            inputs[c] = columns[c].constant ? spread[c].data() : columns[c].data + start;
        ShaderEvaluation<T> block{};
        block.size = sizeof block;
        block.count = std::min(kBlock, count - start);
        block.params = inputs.data() + directions.size();
        block.options = options.data();
        block.tables = views.data();
        for (std::size_t k = 0; k < 3; ++k) {
            block.n[k] = inputs[k];
            block.v[k] = inputs[3 + k];
            block.l[k] = inputs[6 + k];
            block.tangent[k] = directions.size() == 12 ? inputs[9 + k] : nullptr;
            const auto row = static_cast<py::ssize_t>(k);
            block.diffuse[k] = out + row * count + start;
            block.specular[k] = out + (3 + row) * count + start;
            block.transmission[k] = out + (6 + row) * count + start;
        }
        run(shader, block);
    }
    return result;
}

}  // namespace

void bind_shading(py::module_& module) {
    py::class_<ShaderInfo>(module, "ShaderInfo", "A registered shading model, built in or from a plugin.")
        .def_property_readonly("name", [](const ShaderInfo& s) { return std::string(s.name); })
        .def_property_readonly("label", [](const ShaderInfo& s) { return std::string(s.label); })
        .def_property_readonly("help", [](const ShaderInfo& s) { return std::string(s.help); })
        .def_property_readonly("parameters",
                               [](const ShaderInfo& s) -> py::typing::Tuple<Parameter, py::ellipsis> {
                                   return parameter_tuple(s.parameters);
                               })
        .def_readonly("file", &ShaderInfo::file, "The plugin; empty for a built-in shader.")
        .def_property_readonly("float_slots", [](const ShaderInfo& s) { return s.abi->float_slots; })
        .def_property_readonly("option_slots", [](const ShaderInfo& s) { return s.abi->option_slots; })
        .def_property_readonly("table_slots", [](const ShaderInfo& s) { return s.abi->table_slots; })
        .def_property_readonly("needs_tangent", [](const ShaderInfo& s) { return s.abi->needs_tangent != 0; })
        .def_property_readonly(
            "isas",
            [](const ShaderInfo& s) {
                std::vector<std::string> isas;
                for (int k = 0; k < s.abi->kernel_count; ++k) isas.emplace_back(s.abi->kernels[k].isa);
                return isas;
            },
            "Instruction sets that it has kernels for.")
        .def("__repr__", [](const ShaderInfo& s) { return "<ShaderInfo " + std::string(s.name) + ">"; });

    py::class_<PluginReport>(module, "PluginReport", "A file on RELUME_SHADER_PATH, and why it did or did not load.")
        .def_readonly("file", &PluginReport::file)
        .def_readonly("loaded", &PluginReport::loaded)
        .def_readonly("message", &PluginReport::message)
        .def("__repr__", [](const PluginReport& r) {
            return "<PluginReport " + r.file.string() + (r.loaded ? ": loaded>" : ": not loaded>");
        });

    module.def(
        "shaders",
        [] {
            const auto all = shaders();
            return std::vector<ShaderInfo>(all.begin(), all.end());
        },
        "All shaders, built-in ones first.");
    module.def("plugin_reports", [] {
        const auto all = plugin_reports();
        return std::vector<PluginReport>(all.begin(), all.end());
    });
    module.def("evaluate_float", &evaluate<float>, py::arg("shader"), py::arg("count"), py::arg("directions"),
               py::arg("params"), py::arg("options"), py::arg("tables"),
               "(9, count) float32: diffuse, specular, transmission.");
    module.def("evaluate_double", &evaluate<double>, py::arg("shader"), py::arg("count"), py::arg("directions"),
               py::arg("params"), py::arg("options"), py::arg("tables"),
               "(9, count) float64: diffuse, specular, transmission.");
    module.def(
        "load_table",
        [](const std::filesystem::path& path) {
            std::shared_ptr<const LookupTable> table;
            {
                const py::gil_scoped_release
                    release;  // a Python reader may be asked, from a thread that holds what this waits for
                table = load_table(path);
            }
            return array_of(*table);
        },
        py::arg("path"), "A table from a file, (height, width).");
    module.def(
        "builtin_table",
        [](const ShaderInfo& shader, const std::string& name) { return array_of(*builtin_table(shader, name)); },
        py::arg("shader"), py::arg("parameter"), "The table that a shader has where none is given, (height, width).");
}

}  // namespace relume::python
