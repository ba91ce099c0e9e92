// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace relume {

/// The three pixel types of OpenEXR.
enum class PixelType : std::uint8_t { half, float32, uint32 };

constexpr std::size_t size_of(PixelType type) { return type == PixelType::half ? 2 : 4; }

/// A rectangle of pixels; x to the right, y down, as in OpenEXR. (x, y) is the top left pixel and may be negative.
struct Window {
    int x = 0;
    int y = 0;
    int width = 0;
    int height = 0;

    bool operator==(const Window&) const = default;
    bool empty() const { return width <= 0 || height <= 0; }
    int x_end() const { return x + width; }   ///< one past the last column
    int y_end() const { return y + height; }  ///< one past the last row
};

/// Whether every pixel of `part`, which may be any numbers, is one of `whole`.
constexpr bool contains(const Window& whole, const Window& part) {
    const auto inside = [](std::int64_t first, std::int64_t count, std::int64_t whole_first, std::int64_t whole_count) {
        return first >= whole_first && first + count <= whole_first + whole_count;
    };
    return inside(part.x, part.width, whole.x, whole.width) && inside(part.y, part.height, whole.y, whole.height);
}

/// One channel in somebody else's memory. Pixel (column i, row j), both counted from the top left of its window, is at
/// `data + j * y_stride + i * x_stride`. Strides are in bytes and may be negative. `data == nullptr` means "absent".
struct ConstPlane {
    const std::byte* data = nullptr;
    PixelType type = PixelType::float32;
    std::ptrdiff_t x_stride = 4;
    std::ptrdiff_t y_stride = 0;
};

/// The same, to be written to.
struct Plane {
    std::byte* data = nullptr;
    PixelType type = PixelType::float32;
    std::ptrdiff_t x_stride = 4;
    std::ptrdiff_t y_stride = 0;

    operator ConstPlane() const { return {data, type, x_stride, y_stride}; }
};

}  // namespace relume
