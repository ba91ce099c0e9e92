// SPDX-License-Identifier: Apache-2.0
#pragma once

// Look-ups in a parameter of type table: bilinear between the texels' centres, clamped at the edges. u runs along a
// row, v from row 0 on, both from 0 to 1 over the whole picture, as on a GPU: texel k of n has its centre at (k + ½)/n.

#include "relume/shader_abi.h"
#include "relume/shading/simd.h"

namespace relume {

/// Where x in [0, 1] lies among `size` texels: in [0, size − 1] whatever x is, NaN included, for no gather may read
/// elsewhere.
template <class T> RELUME_INLINE T texel_coordinate(T x, std::int32_t size) {
    const T position = fma(x, constant<T>(size), constant<T>(-0.5));
    return select(position > T(0.f), min(position, constant<T>(size - 1)), T(0.f));
}

/// The two rows around v, for who looks up more than once at one v.
template <class T> struct TableRows {
    T first, second;  ///< index of the row's first texel
    T weight;         ///< of the second
};

template <class T> RELUME_INLINE TableRows<T> table_rows(const TableView& table, T v) {
    const T y = texel_coordinate(v, table.height), row = floor(y);
    const T width = constant<T>(table.width);
    return {row * width, min(row + T(1.f), constant<T>(table.height - 1)) * width, y - row};
}

template <class T> RELUME_INLINE T sample(const TableView& table, const TableRows<T>& rows, T u) {
    const T x = texel_coordinate(u, table.width), left = floor(x), weight = x - left;
    const T right = min(left + T(1.f), constant<T>(table.width - 1));
    const T upper = lerp(gather(table.texels, rows.first + left), gather(table.texels, rows.first + right), weight);
    const T lower = lerp(gather(table.texels, rows.second + left), gather(table.texels, rows.second + right), weight);
    return lerp(upper, lower, rows.weight);
}

template <class T> RELUME_INLINE T sample(const TableView& table, T u, T v) {
    return sample(table, table_rows(table, v), u);
}

}  // namespace relume
