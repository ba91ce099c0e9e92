// SPDX-License-Identifier: Apache-2.0
#include "gbuffer/planes.h"

namespace relume::gbuffer {

void gather(const ConstPlane& plane, std::ptrdiff_t row, std::ptrdiff_t column, int count, float* out) {
    const std::byte* at = plane.data + row * plane.y_stride + column * plane.x_stride;
    io::convert_run({at, plane.type, plane.x_stride}, {reinterpret_cast<std::byte*>(out), PixelType::float32, 4},
                    static_cast<std::size_t>(count));
}

void gather(const ConstPlane& plane, std::ptrdiff_t row, std::ptrdiff_t column, int count, std::uint32_t* out) {
    if (plane.type == PixelType::uint32) {
        const std::byte* at = plane.data + row * plane.y_stride + column * plane.x_stride;
        io::convert_run({at, plane.type, plane.x_stride}, {reinterpret_cast<std::byte*>(out), PixelType::uint32, 4},
                        static_cast<std::size_t>(count));
        return;
    }
    for (int i = 0; i < count; ++i) out[i] = to_identifier(value_at(plane, row, column + i));
}

}  // namespace relume::gbuffer
