// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>

#include "io/pixel_convert.h"
#include "relume/image.h"

namespace relume::gbuffer {

/// One pixel of a plane, as float.
inline float value_at(const ConstPlane& plane, std::ptrdiff_t row, std::ptrdiff_t column) {
    const std::byte* at = plane.data + row * plane.y_stride + column * plane.x_stride;
    switch (plane.type) {
        case PixelType::half: {
            std::uint16_t bits = 0;
            std::memcpy(&bits, at, sizeof bits);
            return io::half_to_float(bits);
        }
        case PixelType::float32: {
            float value = 0;
            std::memcpy(&value, at, sizeof value);
            return value;
        }
        case PixelType::uint32:
            break;
    }
    std::uint32_t value = 0;
    std::memcpy(&value, at, sizeof value);
    return static_cast<float>(value);
}

/// `count` pixels of a row from `column` on, as contiguous floats.
void gather(const ConstPlane& plane, std::ptrdiff_t row, std::ptrdiff_t column, int count, float* out);
/// The same as unsigned integers; fractions are rounded, what is negative or not a number becomes 0.
void gather(const ConstPlane& plane, std::ptrdiff_t row, std::ptrdiff_t column, int count, std::uint32_t* out);

/// A float as an identifier.
inline std::uint32_t to_identifier(float value) {
    return value > 0.0f ? value >= 4294967040.0f ? 4294967040u : static_cast<std::uint32_t>(value + 0.5f) : 0u;
}

}  // namespace relume::gbuffer
