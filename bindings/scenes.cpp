// SPDX-License-Identifier: Apache-2.0
#include "relume/scenes.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "background.h"
#include "bindings.h"

namespace relume::python {

void bind_scenes(py::module_& module) {
    py::class_<SceneInfo>(module, "SceneInfo", "One of the built-in scenes.")
        .def_property_readonly("name", [](const SceneInfo& s) { return std::string(s.name); })
        .def_property_readonly("help", [](const SceneInfo& s) { return std::string(s.help); })
        .def_readonly("width", &SceneInfo::width, "Its own size, pixels.")
        .def_readonly("height", &SceneInfo::height, "Its own size, pixels.")
        .def_readonly("samples", &SceneInfo::samples, "Its own number of camera rays per pixel.")
        .def("__repr__", [](const SceneInfo& s) { return "<SceneInfo " + std::string(s.name) + ">"; });
    module.def("scenes", [] {
        const auto all = scenes();
        return std::vector<SceneInfo>(all.begin(), all.end());
    });
    module.def(
        "write_scene",
        [](const std::string& name, const std::filesystem::path& path, int width, int height, int samples, int paths,
           int bounces, double time, bool opaque, std::uint64_t seed, int threads) {
            SceneOptions options;
            options.width = width;
            options.height = height;
            options.samples = samples;
            options.paths = paths;
            options.bounces = bounces;
            options.time = time;
            options.opaque = opaque;
            options.seed = seed;
            options.threads = threads;
            const py::gil_scoped_release release;
            write_scene(name, path, options);
        },
        py::arg("name"), py::arg("path"), py::arg("width"), py::arg("height"), py::arg("samples"), py::arg("paths"),
        py::arg("bounces"), py::arg("time"), py::arg("opaque"), py::arg("seed"), py::arg("threads"));
}

}  // namespace relume::python
