// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>

#include "relume/image.h"

namespace relume::gbuffer {

/// IEEE half to float, without branches, so that loops over it become SIMD code. Subnormals come out exactly: their
/// bits, read as a float with a biased exponent, differ from the value by a constant factor of two and a constant.
inline float half_to_float(std::uint16_t bits) {
    constexpr std::uint32_t kMagnitude = 0x7fffu << 13;
    constexpr std::uint32_t kExponent = 0x7c00u << 13;
    constexpr std::uint32_t kRebias = (127u - 15u) << 23;
    const std::uint32_t sign = static_cast<std::uint32_t>(bits & 0x8000u) << 16;
    const std::uint32_t magnitude = (static_cast<std::uint32_t>(bits) << 13) & kMagnitude;
    const std::uint32_t exponent = magnitude & kExponent;
    const std::uint32_t normal = magnitude + kRebias;
    const std::uint32_t special = normal + kRebias;  // infinity and NaN take the top exponent
    const float subnormal = std::bit_cast<float>(normal + (1u << 23)) - std::bit_cast<float>(113u << 23);
    const std::uint32_t finite = exponent == 0 ? std::bit_cast<std::uint32_t>(subnormal) : normal;
    return std::bit_cast<float>(sign | (exponent == kExponent ? special : finite));
}

/// One pixel of a plane, as float.
inline float value_at(const ConstPlane& plane, std::ptrdiff_t row, std::ptrdiff_t column) {
    const std::byte* at = plane.data + row * plane.y_stride + column * plane.x_stride;
    switch (plane.type) {
        case PixelType::half: {
            std::uint16_t bits = 0;
            std::memcpy(&bits, at, sizeof bits);
            return half_to_float(bits);
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
