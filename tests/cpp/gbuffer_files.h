// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "exr_test_image.h"
#include "gbuffer/band_reader.h"
#include "io/exr.h"
#include "relume/gbuffer.h"

namespace relume::test {

/// A channel of a G-buffer made for a test: its value at absolute pixel coordinates.
struct MadeChannel {
    std::string name;
    std::function<double(int, int)> value = [](int, int) { return 0.0; };
    PixelType type = PixelType::float32;
};

struct MadePart {
    std::vector<MadeChannel> channels;
    std::string name;
    std::string view;
    std::vector<io::Attribute> attributes;
};

inline io::Attribute text(const std::string& name, const std::string& value) { return {name, "string", value}; }
inline io::Attribute number(const std::string& name, double value) {
    return {name, "float", std::vector<double>{value}};
}
inline io::Attribute matrix(const std::string& name, const std::array<double, 16>& rows) {
    return {name, "m44f", std::vector<double>(rows.begin(), rows.end())};
}
inline io::Attribute chromaticities(const std::array<double, 8>& xy) {
    return {"chromaticities", "chromaticities", std::vector<double>(xy.begin(), xy.end())};
}

struct MadeWindows {
    Window data{0, 0, 48, 32};
    Window display{0, 0, 48, 32};
    float pixel_aspect = 1;
};

/// Writes the parts as an EXR. Channels are sorted by name, as the format wants them.
inline void write_exr(const std::filesystem::path& path, std::vector<MadePart> parts, const MadeWindows& windows = {},
                      io::Compression compression = io::Compression::zip) {
    io::Header header;
    for (MadePart& part : parts) {
        std::sort(part.channels.begin(), part.channels.end(),
                  [](const auto& a, const auto& b) { return a.name < b.name; });
        io::Part& out = header.parts.emplace_back();
        out.name = part.name;
        out.view = part.view;
        out.data_window = windows.data;
        out.display_window = windows.display;
        out.pixel_aspect = windows.pixel_aspect;
        out.attributes = part.attributes;
        for (const MadeChannel& channel : part.channels) {
            io::Channel& c = out.channels.emplace_back();
            c.name = channel.name;
            c.type = channel.type;
        }
    }
    io::ExrWriter writer(path, header, {.compression = compression});
    for (std::size_t p = 0; p < parts.size(); ++p) {
        const auto count = static_cast<std::size_t>(windows.data.width) * static_cast<std::size_t>(windows.data.height);
        std::vector<std::vector<float>> pixels;
        std::vector<std::vector<std::uint32_t>> identifiers;
        std::vector<ConstPlane> planes;
        for (const MadeChannel& channel : parts[p].channels) {
            const bool integer = channel.type == PixelType::uint32;
            std::vector<float>& floats = pixels.emplace_back(count);
            std::vector<std::uint32_t>& integers = identifiers.emplace_back(count);
            for (std::size_t i = 0; i < count; ++i) {
                const int x = windows.data.x + static_cast<int>(i % static_cast<std::size_t>(windows.data.width));
                const int y = windows.data.y + static_cast<int>(i / static_cast<std::size_t>(windows.data.width));
                const double value = channel.value(x, y);
                floats[i] = static_cast<float>(value);
                integers[i] = integer ? static_cast<std::uint32_t>(value) : 0u;
            }
        }
        for (std::size_t c = 0; c < parts[p].channels.size(); ++c) {
            const bool integer = parts[p].channels[c].type == PixelType::uint32;
            const auto* data = integer ? reinterpret_cast<const std::byte*>(identifiers[c].data())
                                       : reinterpret_cast<const std::byte*>(pixels[c].data());
            planes.push_back({data, integer ? PixelType::uint32 : PixelType::float32, 4, windows.data.width * 4});
        }
        const int rows = writer.rows_per_chunk();
        for (int y = 0; y < windows.data.height; y += rows) {
            std::vector<ConstPlane> band = planes;
            for (ConstPlane& plane : band) plane.data += y * plane.y_stride;
            writer.write(static_cast<int>(p), windows.data.y + y, std::min(rows, windows.data.height - y), band);
        }
    }
    writer.commit();
}

/// The folder of the renderer's files that are not part of the repository; empty when it is not there.
inline std::filesystem::path test_data() {
    const char* given = std::getenv("RELUME_TEST_DATA");
    const std::filesystem::path folder =
        given ? std::filesystem::path(given) : std::filesystem::path(RELUME_SOURCE_DIR) / ".." / "shared" / "data";
    std::error_code ignored;
    return std::filesystem::exists(folder / "blender", ignored) ? folder : std::filesystem::path();
}

/// All pixels of one request, component by component: answer[component][row][column].
using Answer = std::vector<std::vector<std::vector<float>>>;

/// Reads a request in bands of `rows` and segments of `step` pixels (0: what the reader likes best, whole rows).
inline Answer ask(const GBuffer& gbuffer, const ChannelRequest& request, int rows = 0, int step = 0) {
    const BandReader reader(gbuffer, {&request, 1});
    BandReader::Scratch scratch;
    const Window& window = gbuffer.data_window();
    Answer answer;
    const int band = rows > 0 ? rows : reader.band_rows();
    for (int top = window.y; top < window.y_end(); top += band) {
        const int height = std::min(band, window.y_end() - top);
        reader.load(top, height, scratch);
        for (int y = top; y < top + height; ++y) {
            for (int x = window.x; x < window.x_end();) {
                const int count = std::min(step > 0 ? step : window.width, window.x_end() - x);
                const std::span<const float* const> planes = reader.segment(y, x, count, scratch);
                answer.resize(planes.size());
                for (std::size_t k = 0; k < planes.size(); ++k) {
                    answer[k].resize(static_cast<std::size_t>(window.height));
                    auto& row = answer[k][static_cast<std::size_t>(y - window.y)];
                    row.insert(row.end(), planes[k], planes[k] + count);
                }
                x += count;
            }
        }
    }
    return answer;
}

inline ChannelRequest semantic(const std::string& name, int components = 1) {
    ChannelRequest request;
    request.name = name;
    request.components = components;
    return request;
}

inline bool mentions(const std::vector<std::string>& notes, std::string_view words) {
    return std::any_of(notes.begin(), notes.end(),
                       [&](const std::string& n) { return n.find(words) != std::string::npos; });
}

}  // namespace relume::test
