// SPDX-License-Identifier: Apache-2.0
#include "relume/display.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <optional>
#include <string>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "relume/error.h"
#include "relume/working_space.h"

namespace relume::python {

namespace {

ToneCurve tone_of(const std::string& name) {
    if (name == "none") return ToneCurve::none;
    if (name == "reinhard") return ToneCurve::reinhard;
    if (name == "aces") return ToneCurve::aces;
    throw Error(ErrorKind::value, "no tone curve '" + name + "'; there are none, reinhard, aces");
}

DisplayEncoding encoding_of(const std::string& name) {
    if (name == "srgb") return DisplayEncoding::srgb;
    if (name == "2.2") return DisplayEncoding::gamma22;
    if (name == "none") return DisplayEncoding::linear;
    throw Error(ErrorKind::value, "no gamma '" + name + "'; there are srgb, 2.2, none");
}

AlphaMode alpha_of(bool straight) { return straight ? AlphaMode::straight : AlphaMode::premultiplied; }

}  // namespace

void bind_display(py::module_& module) {
    module.def(
        "apply_display",
        [](const py::array& pixels, double exposure, const std::string& tone, const std::string& gamma,
           bool straight_out) {
            const DisplayTransform transform{exposure, tone_of(tone), encoding_of(gamma)};
            const ArrayPlanes view = planes_for_writing(pixels, "pixels");
            const py::gil_scoped_release release;
            transform.apply(view.planes, view.width, view.height, AlphaMode::premultiplied, alpha_of(straight_out));
        },
        py::arg("pixels"), py::arg("exposure"), py::arg("tone"), py::arg("gamma"), py::arg("straight_out"),
        "In place, (H, W, 3) or premultiplied (H, W, 4); the latter leaves premultiplied or straight.");
    module.def("srgb_encode", py::vectorize(&srgb_encode<double>), py::arg("linear"));
    module.def("srgb_decode", py::vectorize(&srgb_decode<double>), py::arg("code"));
    module.def("quantize8", py::vectorize(&quantize8), py::arg("value"), "0…1 to the nearest of 256 codes.");
    module.def("quantize16", py::vectorize(&quantize16), py::arg("value"), "0…1 to the nearest of 65536 codes.");

    module.def(
        "space_chromaticities",
        [](const std::string& name) -> std::optional<Chromaticities> {
            const WorkingSpace* space = find_working_space(name);
            return space ? std::optional(space->chromaticities) : std::nullopt;
        },
        py::arg("name"), "x, y of red, green, blue and white of a linear space, None when relume does not know it.");
    module.def(
        "space_name",
        [](const Chromaticities& chromaticities) -> std::optional<std::string> {
            const WorkingSpace* space = find_working_space(chromaticities);
            return space ? std::optional(std::string(space->name)) : std::nullopt;
        },
        py::arg("chromaticities"), "The linear space of these chromaticities, None when it is none that relume knows.");
    module.def("space_names", [] {
        std::vector<std::string> names;
        for (const WorkingSpace& space : working_spaces()) names.emplace_back(space.name);
        return names;
    });
    module.def(
        "rgb_to_rgb", [](const Chromaticities& from, const Chromaticities& to) { return rgb_to_rgb(from, to); },
        py::arg("from_chromaticities"), py::arg("to_chromaticities"), "Row-major 3×3, for column vectors.");
}

}  // namespace relume::python
