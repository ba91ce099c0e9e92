// SPDX-License-Identifier: Apache-2.0
#include "relume/relight.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "arrays.h"
#include "background.h"
#include "bindings.h"
#include "relume/error.h"

namespace relume::python {

namespace {

RelightOptions options_of(int threads, Task& task) {
    RelightOptions options;
    options.threads = threads;
    options.cancel = &task.cancel;
    options.progress = [&task](double share) { task.progress = share; };
    return options;
}

RelightReport relight_arrays(const GBuffer& gbuffer, const Rig& rig, const std::map<std::string, py::array>& out,
                             int threads, const py::object& progress, int step) {
    if (step < 1) throw Error(ErrorKind::value, "step is " + std::to_string(step) + "; give 1 (every pixel) or more");
    std::map<std::string, std::vector<Plane>> planes;
    for (const auto& [name, array] : out) {
        const std::string what = "out[\"" + name + "\"]";
        if (array.dtype().kind() != 'f')
            throw Error(ErrorKind::value,
                        what + ": results are float32 or float16, not " + py::str(array.dtype()).cast<std::string>());
        ArrayPlanes view = planes_for_writing(array, what);
        const Window& window = gbuffer.data_window();
        const int height = (window.height + step - 1) / step, width = (window.width + step - 1) / step;
        if (view.height != height || view.width != width)
            throw Error(ErrorKind::value, what + " is " + std::to_string(view.height) + " × " +
                                              std::to_string(view.width) + " (height × width); the picture is " +
                                              std::to_string(height) + " × " + std::to_string(width));
        planes.emplace(name, std::move(view.planes));
    }
    const Rig copy = rig;  // Python may change the original meanwhile, in another thread
    RelightReport report;
    run_in_background(
        [&](Task& task) {
            RelightOptions options = options_of(threads, task);
            options.step = step;
            report = relight(gbuffer, copy, planes, options);
        },
        progress);
    return report;
}

RelightReport relight_file(const GBuffer& gbuffer, const Rig& rig, const std::filesystem::path& path, int threads,
                           const py::object& progress) {
    const Rig copy = rig;
    RelightReport report;
    run_in_background([&](Task& task) { report = relight_to_file(gbuffer, copy, path, options_of(threads, task)); },
                      progress);
    return report;
}

}  // namespace

void bind_relight(py::module_& module) {
    py::class_<RelightReport>(module, "Report", "What happened to the pixels of a relight.")
        .def_readonly("pixels", &RelightReport::pixels, "Pixels of the data window.")
        .def_readonly("shaded", &RelightReport::shaded)
        .def_readonly("background", &RelightReport::background, "Pixels that were passed through.")
        .def_readonly("nonfinite", &RelightReport::nonfinite,
                      "Pixels with NaN or infinity, by channel; they are left black.")
        .def_readonly("warnings", &RelightReport::warnings)
        .def_readonly("notes", &RelightReport::notes, "What was decided where the rig left it open.")
        .def_readonly("seconds", &RelightReport::seconds)
        .def("__repr__", [](const RelightReport& r) {
            return "<Report: " + std::to_string(r.shaded) + " of " + std::to_string(r.pixels) + " pixels shaded>";
        });
    module.def("relight", &relight_arrays, py::arg("gbuffer"), py::arg("rig"), py::arg("out"), py::arg("threads"),
               py::arg("progress"), py::arg("step") = 1, "Into the arrays of `out`, by AOV name.");
    module.def("relight_file", &relight_file, py::arg("gbuffer"), py::arg("rig"), py::arg("path"), py::arg("threads"),
               py::arg("progress"), "Into an EXR.");
}

}  // namespace relume::python
