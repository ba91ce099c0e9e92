// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "io/exr.h"
#include "io/pixel_convert.h"

namespace relume::io {

/// A folder of its own under the system's temporary one, removed at the end.
class TemporaryFolder {
public:
    TemporaryFolder() {
        static std::atomic<int> counter{0};
        path_ = std::filesystem::temp_directory_path() /
                ("relume-io-" + std::to_string(::getpid()) + "-" + std::to_string(counter++));
        std::filesystem::create_directories(path_);
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

/// A planar image of 32-bit values: floats, or unsigned integers by their bits.
struct TestPlane {
    PixelType type = PixelType::float32;
    int width = 0;
    std::vector<std::byte> bytes;

    TestPlane(PixelType plane_type, const Window& window)
        : type(plane_type),
          width(window.width),
          bytes(static_cast<std::size_t>(window.width) * window.height * size_of(plane_type), std::byte{0xcd}) {}

    Plane plane() {
        const auto size = static_cast<std::ptrdiff_t>(size_of(type));
        return {bytes.data(), type, size, size * width};
    }
    template <typename T> T at(int column, int row) const {
        T value;
        std::memcpy(&value, bytes.data() + (static_cast<std::size_t>(row) * width + column) * sizeof(T), sizeof(T));
        return value;
    }
    template <typename T> void set(int column, int row, T value) {
        std::memcpy(bytes.data() + (static_cast<std::size_t>(row) * width + column) * sizeof(T), &value, sizeof(T));
    }
};

/// Value of channel `channel` at pixel (x, y), exact in half precision: waves of both signs with noise in the last bits
/// and a patch of zeros, or (`smooth`, for lossy compression) positive waves alone.
inline float test_value(int channel, int x, int y, bool smooth = false) {
    const float wave =
        24.0f * std::sin(0.11f * static_cast<float>(x + 9 * channel)) * std::cos(0.07f * static_cast<float>(y));
    if (smooth) {
        return half_to_float(float_to_half(30.0f + wave));
    }
    const float noise = static_cast<float>((x * 7919 + y * 104729 + channel * 31) % 17) / 64.0f;
    const bool zero = x / 8 == 2 && y / 8 == 1;
    return half_to_float(float_to_half(zero ? 0.0f : wave + noise));
}

inline std::uint32_t test_uint(int channel, int x, int y) {
    return static_cast<std::uint32_t>(x / 8 + 1000 * (y / 8)) * 2654435761u + static_cast<std::uint32_t>(channel);
}

/// The test image as planes of the part's own types.
inline std::vector<TestPlane> test_planes(const Part& part, bool smooth = false) {
    std::vector<TestPlane> planes;
    const Window& window = part.data_window;
    for (std::size_t c = 0; c < part.channels.size(); ++c) {
        const PixelType type = part.channels[c].type;
        TestPlane plane(type, window);
        for (int row = 0; row < window.height; ++row) {
            for (int column = 0; column < window.width; ++column) {
                const int x = window.x + column;
                const int y = window.y + row;
                const float value = test_value(static_cast<int>(c), x, y, smooth);
                if (type == PixelType::half) {
                    plane.set(column, row, float_to_half(value));
                } else if (type == PixelType::float32) {
                    plane.set(column, row, value * 1.0001f);
                } else {
                    plane.set(column, row, test_uint(static_cast<int>(c), x, y));
                }
            }
        }
        planes.push_back(std::move(plane));
    }
    return planes;
}

inline std::vector<ConstPlane> const_planes(std::vector<TestPlane>& planes, int row = 0) {
    std::vector<ConstPlane> result;
    for (TestPlane& plane : planes) {
        result.push_back(plane.plane());
        result.back().data += row * result.back().y_stride;
    }
    return result;
}

/// Writes all parts' test images whole.
inline void write_test_image(const std::filesystem::path& path, const Header& header, const WriteOptions& options = {},
                             bool smooth = false) {
    ExrWriter writer(path, header, options);
    for (std::size_t p = 0; p < header.parts.size(); ++p) {
        std::vector<TestPlane> planes = test_planes(header.parts[p], smooth);
        writer.write(static_cast<int>(p), header.parts[p].data_window.y, header.parts[p].data_window.height,
                     const_planes(planes));
    }
    writer.commit();
}

/// Reads every channel of a part over `region`, as `type` or (absent) in the file's own types.
inline std::vector<TestPlane> read_planes(const ExrReader& reader, int part, const Window& region,
                                          std::optional<PixelType> type = {}) {
    std::vector<TestPlane> planes;
    const std::vector<Channel>& channels = reader.header().parts[static_cast<std::size_t>(part)].channels;
    planes.reserve(channels.size());
    std::vector<ReadTarget> targets;
    for (std::size_t c = 0; c < channels.size(); ++c) {
        planes.emplace_back(type.value_or(channels[c].type), region);
        targets.push_back({part, static_cast<int>(c), planes.back().plane()});
    }
    reader.read(region, targets);
    return planes;
}

inline std::vector<char> file_bytes(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

inline void write_bytes(const std::filesystem::path& path, std::span<const char> bytes) {
    std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace relume::io
