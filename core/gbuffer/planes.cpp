// SPDX-License-Identifier: Apache-2.0
#include "gbuffer/planes.h"

namespace relume::gbuffer {

void gather(const ConstPlane& plane, std::ptrdiff_t row, std::ptrdiff_t column, int count, float* out) {
    const std::byte* at = plane.data + row * plane.y_stride + column * plane.x_stride;
    const std::ptrdiff_t step = plane.x_stride;
    switch (plane.type) {
        case PixelType::half:
            // Contiguous planes apart, so that the compiler sees the unit stride.
            if (step == 2) {
                for (int i = 0; i < count; ++i) {
                    std::uint16_t bits = 0;
                    std::memcpy(&bits, at + 2 * static_cast<std::ptrdiff_t>(i), sizeof bits);
                    out[i] = half_to_float(bits);
                }
            } else {
                for (int i = 0; i < count; ++i) {
                    std::uint16_t bits = 0;
                    std::memcpy(&bits, at + step * i, sizeof bits);
                    out[i] = half_to_float(bits);
                }
            }
            return;
        case PixelType::float32:
            if (step == 4) {
                std::memcpy(out, at, static_cast<std::size_t>(count) * sizeof(float));
            } else {
                for (int i = 0; i < count; ++i)
                    std::memcpy(out + i, at + step * i, sizeof(float));
            }
            return;
        case PixelType::uint32:
            break;
    }
    for (int i = 0; i < count; ++i) {
        std::uint32_t value = 0;
        std::memcpy(&value, at + step * i, sizeof value);
        out[i] = static_cast<float>(value);
    }
}

void gather(const ConstPlane& plane, std::ptrdiff_t row, std::ptrdiff_t column, int count, std::uint32_t* out) {
    if (plane.type == PixelType::uint32) {
        const std::byte* at = plane.data + row * plane.y_stride + column * plane.x_stride;
        for (int i = 0; i < count; ++i)
            std::memcpy(out + i, at + plane.x_stride * i, sizeof(std::uint32_t));
        return;
    }
    for (int i = 0; i < count; ++i)
        out[i] = to_identifier(value_at(plane, row, column + i));
}

}  // namespace relume::gbuffer
