// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

#include <string>

// relume._relume is a thin layer: names, defaults, documentation and everything that can be said in Python is said in
// python/relume. Each file here binds the header of its name.
namespace relume::python {

namespace py = pybind11;

/// A file's name as os.fsdecode has it: it need not be UTF-8.
inline py::str file_name(const std::string& name) {
    return py::reinterpret_steal<py::str>(
        PyUnicode_DecodeFSDefaultAndSize(name.data(), static_cast<py::ssize_t>(name.size())));
}

void bind_errors(py::module_& module);
void bind_parameters(py::module_& module);
void bind_shading(py::module_& module);
void bind_rig(py::module_& module);
void bind_gbuffer(py::module_& module);
void bind_relight(py::module_& module);
void bind_exr(py::module_& module);
void bind_display(py::module_& module);
void bind_scenes(py::module_& module);

}  // namespace relume::python
