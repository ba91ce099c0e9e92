// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <string>
#include <vector>

#include "bindings.h"
#include "relume/frames.h"
#include "relume/isa.h"
#include "relume/version.h"
#include "text/printable.h"

PYBIND11_MODULE(_relume, module) {
    namespace py = pybind11;
    using namespace relume::python;

    module.doc() = "The compiled half of the package relume; python/relume is its documented face.";
    bind_errors(module);
    bind_parameters(module);
    bind_shading(module);
    bind_rig(module);
    bind_gbuffer(module);
    bind_relight(module);
    bind_exr(module);
    bind_display(module);
    bind_scenes(module);

    module.def(
        "version", [] { return std::string(relume::version()); }, "Version of the library.");
    module.def(
        "openexr_build", [] { return std::string(relume::openexr_build()); }, "The OpenEXRCore that is linked in.");
    module.def(
        "available_isas",
        [] {
            const auto isas = relume::available_isas();
            return std::vector<std::string>(isas.begin(), isas.end());
        },
        "Instruction sets that can run here, the scalar reference first.");
    module.def(
        "active_isa", [] { return std::string(relume::active_isa()); }, "The instruction set in use (RELUME_ISA).");
    module.def(
        "use_isa", [](const std::string& isa) { relume::use_isa(isa); }, py::arg("isa"),
        "From now on use this instruction set; not while relight() runs in another thread.");
    module.def(
        "is_pattern", [](const std::filesystem::path& name) { return relume::is_pattern(name.string()); },
        py::arg("name"), "Whether the name has a place for the frame number: ####, %04d or {frame}.");
    module.def(
        "resolve_frame",
        [](const std::filesystem::path& pattern, std::int64_t frame) {
            return file_name(relume::resolve_frame(pattern.string(), frame));
        },
        py::arg("pattern"), py::arg("frame"), "The name of one frame.");
    module.def(
        "printable", [](const py::bytes& text) { return relume::printable(text); }, py::arg("text"),
        "The text as UTF-8 on one line: control characters escaped, bytes that are not UTF-8 read as Latin-1.");
    module.def(
        "parse_frames", [](const std::string& text) { return relume::parse_frames(text); }, py::arg("text"),
        "The frames of \"1001-1100x2,1200\".");
}
