// SPDX-License-Identifier: Apache-2.0
#include "relume/gbuffer.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>

#include "arrays.h"
#include "bindings.h"
#include "relume/error.h"
#include "relume/image_reader.h"
#include "relume/rig.h"

namespace relume::python {

namespace {

GBuffer from_arrays(const std::map<std::string, py::array>& arrays, const Rig& rig) {
    std::map<std::string, MemoryChannel> channels;
    std::string first;
    ArrayPlanes size;
    for (const auto& [name, array] : arrays) {
        ArrayPlanes view = planes_for_reading(array, name);
        if (first.empty()) {
            first = name;
            size = view;
        } else if (view.height != size.height || view.width != size.width) {
            throw Error(ErrorKind::value, name + " is " + std::to_string(view.height) + " × " +
                                              std::to_string(view.width) + " (height × width), " + first + " is " +
                                              std::to_string(size.height) + " × " + std::to_string(size.width) +
                                              "; all channels must have the same size");
        }
        MemoryChannel channel;
        channel.planes.assign(view.planes.begin(), view.planes.end());
        if (const auto rule = rig.gbuffer.channels.find(name); rule != rig.gbuffer.channels.end())
            channel.rule = rule->second;
        channels.emplace(name, std::move(channel));
    }
    return GBuffer::from_memory(size.width, size.height, channels, rig.gbuffer);
}

/// Into arrays of (H, W, C), one for each request.
void load(const GBuffer& gbuffer, const std::vector<ChannelRequest>& requests, const std::vector<py::array>& out,
          int threads) {
    std::vector<Plane> planes;
    if (requests.size() != out.size()) throw Error(ErrorKind::value, "an array is needed for each channel");
    for (std::size_t k = 0; k < out.size(); ++k) {
        const std::string& name = requests[k].name;
        const ArrayPlanes view = planes_for_writing(out[k], name);
        const Window& window = gbuffer.data_window();
        if (view.height != window.height || view.width != window.width ||
            view.planes.size() != static_cast<std::size_t>(requests[k].components))
            throw Error(ErrorKind::value,
                        name + ": the array is " + std::to_string(view.height) + " × " + std::to_string(view.width) +
                            " × " + std::to_string(view.planes.size()) + "; the channel is " +
                            std::to_string(window.height) + " × " + std::to_string(window.width) + " × " +
                            std::to_string(requests[k].components) + " (height × width × components)");
        planes.insert(planes.end(), view.planes.begin(), view.planes.end());
    }
    const py::gil_scoped_release release;
    read_channels(gbuffer, requests, planes, threads);
}

/// Calls a Python function of one path that returns (float32 (H, W, C), names of the channels, bits of integers or 0).
StoredImage read_stored(const py::function& reader, const std::filesystem::path& path) {
    const py::gil_scoped_acquire acquire;
    const py::tuple result = reader(path);
    const auto pixels = py::array_t<float, py::array::c_style>::ensure(result[0]);
    if (!pixels || pixels.ndim() != 3) throw Error(ErrorKind::value, "an image reader returns an array of (H, W, C)");
    StoredImage image;
    image.height = static_cast<int>(pixels.shape(0));
    image.width = static_cast<int>(pixels.shape(1));
    image.channels = result[1].cast<std::vector<std::string>>();
    image.pixels.assign(pixels.data(), pixels.data() + pixels.size());
    image.integer_bits = result[2].cast<int>();
    return image;
}

py::array_t<double> matrix_of(const Camera& camera) {
    py::array_t<double> matrix({4, 4});
    std::copy(camera.camera_to_world.begin(), camera.camera_to_world.end(), matrix.mutable_data());
    return matrix;
}

py::tuple window_tuple(const Window& w) { return py::make_tuple(w.x, w.y, w.width, w.height); }

}  // namespace

void bind_gbuffer(py::module_& module) {
    using Triple = py::typing::Tuple<double, double, double>;
    using WindowTuple = py::typing::Tuple<int, int, int, int>;
    py::class_<Camera>(module, "Camera",
                       "The camera of a G-buffer: camera space has +X right, +Y up, and looks down −Z.\n\n"
                       "For the pixel in column i and row j, X = (i + ½)·x_scale + x_offset and\n"
                       "Y = (j + ½)·y_scale + y_offset; a perspective ray leaves the origin towards (X, Y, −1),\n"
                       "an orthographic one (X, Y, 0) towards (0, 0, −1).")
        .def_property_readonly(
            "projection",
            [](const Camera& c) { return c.projection == Projection::perspective ? "perspective" : "orthographic"; },
            "perspective or orthographic")
        .def_property_readonly("matrix", &matrix_of, "(4, 4) float64, camera to world, for column vectors.")
        .def_readonly("x_scale", &Camera::x_scale)
        .def_readonly("x_offset", &Camera::x_offset)
        .def_readonly("y_scale", &Camera::y_scale, "Negative: rows run down.")
        .def_readonly("y_offset", &Camera::y_offset)
        .def_property_readonly(
            "position",
            [](const Camera& c) -> Triple { return py::make_tuple(c.position()[0], c.position()[1], c.position()[2]); },
            "In world space.")
        .def_property_readonly(
            "forward",
            [](const Camera& c) -> Triple { return py::make_tuple(c.forward()[0], c.forward()[1], c.forward()[2]); },
            "Unit vector that it looks along, in world space.")
        .def("__repr__", [](const Camera& c) {
            const auto p = c.position();
            return "<Camera at (" + std::to_string(p[0]) + ", " + std::to_string(p[1]) + ", " + std::to_string(p[2]) +
                   ")>";
        });

    py::class_<ChannelInfo>(module, "ChannelInfo", "What was understood of one channel of a G-buffer.")
        .def_readonly("name", &ChannelInfo::name, "\"normal\", \"base_color\", or any shader parameter's name.")
        .def_readonly("components", &ChannelInfo::components)
        .def_readonly("sources", &ChannelInfo::sources, "The file's channels.")
        .def_property_readonly(
            "file", [](const ChannelInfo& c) { return file_name(c.file); }, "The file they stand in; empty for arrays.")
        .def_readonly("part", &ChannelInfo::part)
        .def_readonly("interpretation", &ChannelInfo::interpretation, "\"world space, -1..1\"")
        .def_readonly("reason", &ChannelInfo::reason, "Why it is taken so.")
        .def("__repr__", [](const ChannelInfo& c) { return "<ChannelInfo " + c.name + ": " + c.interpretation + ">"; });

    py::class_<ChannelRequest>(module, "ChannelRequest", "What is wanted of a G-buffer.")
        .def_static(
            "semantic",
            [](const std::string& name, int components) {
                return ChannelRequest{ChannelRequest::Kind::semantic, name, components, {}, 1, 0};
            },
            py::arg("name"), py::arg("components"), "A semantic channel, decoded, in world and working space.")
        .def_static(
            "id", [](const std::string& name) { return ChannelRequest{ChannelRequest::Kind::id, name, 1, {}, 1, 0}; },
            py::arg("name"), "IDs: uint32.")
        .def_static(
            "raw",
            [](const std::string& name, int components) {
                return ChannelRequest{ChannelRequest::Kind::raw, name, components, {}, 1, 0};
            },
            py::arg("name"), py::arg("components"), "A channel or layer of the file.")
        .def_static(
            "matte",
            [](const std::vector<std::string>& patterns) {
                return ChannelRequest{ChannelRequest::Kind::matte, "matte", 1, patterns, 1, 0};
            },
            py::arg("patterns"), "Coverage of the Cryptomatte names that match.");

    py::class_<GBuffer>(module, "GBuffer", "An understood G-buffer; relume.GBuffer is its face.")
        .def_static(
            "read",
            [](const std::filesystem::path& path, const Rig& rig, int threads) {
                const GBufferOptions options = rig.gbuffer;
                const py::gil_scoped_release release;
                return GBuffer::read(path, options, threads);
            },
            py::arg("path"), py::arg("rig"), py::arg("threads"),
            "With the options of the rig's [gbuffer] and [camera].")
        .def_static("from_arrays", &from_arrays, py::arg("arrays"), py::arg("rig"),
                    "The arrays are not copied: keep them.")
        .def_property_readonly("data_window",
                               [](const GBuffer& g) -> WindowTuple { return window_tuple(g.data_window()); })
        .def_property_readonly("display_window",
                               [](const GBuffer& g) -> WindowTuple { return window_tuple(g.display_window()); })
        .def_property_readonly("pixel_aspect", &GBuffer::pixel_aspect)
        .def_property_readonly("producer", [](const GBuffer& g) { return std::string(g.producer()); })
        .def_property_readonly("working_space", [](const GBuffer& g) { return std::string(g.working_space()); })
        .def_property_readonly("channels", &GBuffer::channels)
        .def_property_readonly("camera", &GBuffer::camera)
        .def_property_readonly("camera_reason", [](const GBuffer& g) { return std::string(g.camera_reason()); })
        .def_property_readonly("camera_error", &GBuffer::camera_error)
        .def_property_readonly("notes", &GBuffer::notes)
        .def_property_readonly("cryptomatte", &GBuffer::cryptomatte)
        .def("keep_channels", &GBuffer::keep_channels, py::arg("bytes"),
             "Keep what relights ask for, up to so many bytes.")
        .def("load", &load, py::arg("requests"), py::arg("out"), py::arg("threads"),
             "Channels in canonical form, in one pass over the file, into arrays of (H, W, C).");

    module.def(
        "set_image_reader",
        [](const py::function& reader) {
            // Held for the life of the process: the library may outlive the interpreter.
            auto* const held = new py::function(reader);
            set_image_reader([held](const std::filesystem::path& path) { return read_stored(*held, path); });
        },
        py::arg("reader"), "Who reads files that are not EXR.");
}

}  // namespace relume::python
