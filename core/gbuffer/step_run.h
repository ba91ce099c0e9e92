// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "gbuffer/pixel_steps.h"
#include "gbuffer/planes.h"

namespace relume::gbuffer {

/// A step with everything that it runs on.
struct Run {
    const Step& step;
    const float* const* registers;
    float* const* results;
    int count;
    int x;
    const RunGeometry& geometry;
    const RowPlanes& rows;

    const float* in(std::size_t k) const { return step.in[k] < 0 ? nullptr : registers[step.in[k]]; }
    float* out(std::size_t k) const { return results[step.out[k]]; }
    const std::int32_t* offsets(std::size_t k) const { return reinterpret_cast<const std::int32_t*>(in(k)); }
    ConstPlane plane(std::size_t k, int dy) const {
        ConstPlane plane = rows.planes[step.in[k]];
        const int row = rows.row + dy;
        if (row < 0 || row >= rows.rows) return rows.beyond->row(step.in[k], dy);
        plane.data += row * plane.y_stride;
        return plane;
    }
    /// A pixel of a raw plane near the run: `column` counts from the run's first pixel, `dy` from its row.
    float raw(std::size_t k, int column, int dy) const { return value_at(plane(k, dy), 0, rows.first_column + column); }
};

/// A vector as stored, decoded and turned to world space.
inline std::array<float, 3> decoded(const Step& s, float x, float y, float z) {
    x = x * s.multiply[0] + s.add[0];
    y = y * s.multiply[1] + s.add[1];
    z = z * s.multiply[2] + s.add[2];
    if (!s.transform) return {x, y, z};
    const std::array<float, 12>& m = s.matrix;
    return {m[0] * x + m[1] * y + m[2] * z + m[3], m[4] * x + m[5] * y + m[6] * z + m[7],
            m[8] * x + m[9] * y + m[10] * z + m[11]};
}

/// The vector of a pixel near by, decoded.
inline std::array<float, 3> vector_at(const Run& r, int column, int dy) {
    return decoded(r.step, r.raw(0, column, dy), r.raw(1, column, dy), r.raw(2, column, dy));
}

inline float length_of(const std::array<float, 3>& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

// Steps that take normals for means over the pixel (variance_steps.cpp).
void variance(const Run& r);
void face(const Run& r);
void widen(const Run& r);

}  // namespace relume::gbuffer
