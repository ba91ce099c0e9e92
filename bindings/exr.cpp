// SPDX-License-Identifier: Apache-2.0
#include "io/exr.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>

#include "bindings.h"
#include "relume/error.h"
#include "threads/workers.h"

namespace relume::python {

namespace {

using io::ExrReader;
using io::Part;

py::tuple window_tuple(const Window& w) { return py::make_tuple(w.x, w.y, w.width, w.height); }

const char* name_of(PixelType type) {
    switch (type) {
        case PixelType::half:
            return "float16";
        case PixelType::float32:
            return "float32";
        case PixelType::uint32:
            return "uint32";
    }
    return "?";
}

/// Headers hold whatever their writer put there: what is not UTF-8 must not stop anyone from looking at the file.
py::object text_object(const std::string& text) {
    return py::reinterpret_steal<py::object>(
        PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "replace"));
}

py::dict attributes(const Part& part) {
    py::dict result;
    for (const io::Attribute& attribute : part.attributes) {
        py::object value;
        if (const auto* bytes = std::get_if<std::vector<std::byte>>(&attribute.value)) {
            value = py::bytes(reinterpret_cast<const char*>(bytes->data()), bytes->size());
        } else if (const auto* text = std::get_if<std::string>(&attribute.value)) {
            value = text_object(*text);
        } else if (const auto* texts = std::get_if<std::vector<std::string>>(&attribute.value)) {
            py::list list;
            for (const std::string& entry : *texts) list.append(text_object(entry));
            value = std::move(list);
        } else {
            value = py::cast(std::get<std::vector<double>>(attribute.value));
        }
        result[text_object(attribute.name)] = value;
    }
    return result;
}

int channel_index(const ExrReader& reader, const Part& part, const std::string& name) {
    for (std::size_t k = 0; k < part.channels.size(); ++k)
        if (part.channels[k].name == name) return static_cast<int>(k);
    throw Error(ErrorKind::channel, reader.path().string() + ": no channel '" + name + "'");
}

/// (H, W, C) of the named channels over the part's data window, T = float or std::uint32_t.
template <class T> py::array_t<T> read(const ExrReader& reader, int part_index, const std::vector<std::string>& names) {
    const auto& parts = reader.header().parts;
    if (part_index < 0 || part_index >= static_cast<int>(parts.size()))
        throw Error(ErrorKind::value, reader.path().string() + ": no part " + std::to_string(part_index));
    const Part& part = parts[static_cast<std::size_t>(part_index)];
    const Window window = part.data_window;
    const auto count = static_cast<py::ssize_t>(names.size());
    py::array_t<T> result({py::ssize_t{window.height}, py::ssize_t{window.width}, count});
    auto* const data = reinterpret_cast<std::byte*>(result.mutable_data());
    constexpr auto type = std::is_same_v<T, float> ? PixelType::float32 : PixelType::uint32;
    const std::ptrdiff_t x_stride = count * 4;
    const std::ptrdiff_t y_stride = x_stride * window.width;

    const py::gil_scoped_release release;
    std::vector<io::ReadTarget> targets;
    for (std::size_t k = 0; k < names.size(); ++k)
        targets.push_back(
            {part_index, channel_index(reader, part, names[k]), {data + 4 * k, type, x_stride, y_stride}});

    // A band of chunks at a time.
    const int step = std::max(part.rows_per_chunk, 1);
    parallel_for((window.height + step - 1) / step, default_threads(), nullptr, [&](int, int index) {
        const int row = index * step;
        auto band = targets;
        for (auto& target : band) target.plane.data += row * y_stride;
        reader.read({window.x, window.y + row, window.width, std::min(step, window.height - row)}, band);
    });
    return result;
}

}  // namespace

void bind_exr(py::module_& module) {
    using WindowTuple = py::typing::Tuple<int, int, int, int>;
    py::class_<Part>(module, "ExrPart", "One part of an EXR file.")
        .def_readonly("name", &Part::name)
        .def_readonly("view", &Part::view)
        .def_property_readonly(
            "data_window", [](const Part& p) -> WindowTuple { return window_tuple(p.data_window); },
            "x, y, width, height")
        .def_property_readonly(
            "display_window", [](const Part& p) -> WindowTuple { return window_tuple(p.display_window); },
            "x, y, width, height")
        .def_readonly("pixel_aspect", &Part::pixel_aspect)
        .def_property_readonly("compression", [](const Part& p) { return std::string(io::name_of(p.compression)); })
        .def_readonly("tiled", &Part::tiled)
        .def_readonly("deep", &Part::deep)
        .def_property_readonly(
            "channels",
            [](const Part& p) {
                std::vector<std::pair<std::string, std::string>> list;
                for (const io::Channel& channel : p.channels) list.emplace_back(channel.name, name_of(channel.type));
                return list;
            },
            "Names and numpy types, in the file's order.")
        .def_property_readonly("attributes",
                               [](const Part& p) -> py::typing::Dict<py::str, py::object> { return attributes(p); })
        .def("__repr__", [](const Part& p) {
            return "<ExrPart '" + p.name + "': " + std::to_string(p.channels.size()) + " channels>";
        });

    py::class_<ExrReader>(module, "ExrFile", "An open EXR; channels are read when asked for.")
        .def(py::init([](const std::filesystem::path& path) { return ExrReader(path); }), py::arg("path"))
        .def_property_readonly("path", &ExrReader::path)
        .def_property_readonly("parts", [](const ExrReader& r) { return r.header().parts; })
        .def("read", &read<float>, py::arg("part"), py::arg("channels"),
             "(H, W, C) float32 over the part's data window.")
        .def("is_whole", &ExrReader::is_whole, "Whether every chunk is in the file, without decoding any.")
        .def("read_uint32", &read<std::uint32_t>, py::arg("part"), py::arg("channels"), "(H, W, C) uint32: IDs.");
}

}  // namespace relume::python
