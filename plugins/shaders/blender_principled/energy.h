// SPDX-License-Identifier: Apache-2.0
#pragma once

// What a GGX lobe takes from the light that falls on it, and what its single scattering loses: look-ups in tables whose
// nodes lie from 0 to 1, linear in between.

#include "relume/shading/vec.h"
#include "shaders/blender_principled/ggx_tables.h"

namespace relume::shaders {

/// x among `count` nodes: the one before it and how far it is on. In range whatever x is, NaN included, for no gather
/// may read elsewhere.
template <class T> struct Between { T first, weight; };

template <class T> RELUME_INLINE Between<T> between(T x, int count) {
    const T last = constant<T>(count - 1), position = x * last;
    const T bounded = select(position > T(0.f), min(position, last), T(0.f));
    const T first = min(floor(bounded), constant<T>(count - 2));
    return {first, bounded - first};
}

/// table[row][column], `columns` of them.
template <class T>
RELUME_INLINE T bilinear(const float* table, int columns, const Between<T>& row, const Between<T>& column) {
    const T index = fma(row.first, constant<T>(columns), column.first);
    const T here = lerp(gather(table, index), gather(table + 1, index), column.weight);
    const T next = lerp(gather(table + columns, index), gather(table + columns + 1, index), column.weight);
    return lerp(here, next, row.weight);
}

/// Mean of the rise (F − F0)/(1 − F0) of a dielectric over the facets that a viewer at cosine mu sees; `root` = √F0.
template <class T> RELUME_INLINE T mean_rise(T root, T mu, T roughness) {
    constexpr int kNodes = 16;
    const Between<T> z = between(safe_sqrt(root), kNodes), row = between(mu, kNodes),
                     column = between(roughness, kNodes);
    const Between<T> plane{z.first * constant<T>(kNodes), T(0.f)};
    const Between<T> at{plane.first + row.first, row.weight};
    const T low = bilinear(table::kRise, kNodes, at, column);
    const T high = bilinear(table::kRise + kNodes * kNodes, kNodes, at, column);
    return lerp(low, high, z.weight);
}

/// A GGX lobe's albedo where nothing is absorbed, and what is wanting for its scattering between the facets (Kulla and
/// Conty 2017).
template <class T> struct Compensation {
    T albedo, mean;
    T loss;  // (1 − albedo)/albedo

    /// Factor on the lobe of facets that reflect `fss` of diffuse light.
    RELUME_INLINE T operator()(T fss) const {
        const T f = saturate(fss);
        return fma(f * mean * rcp(fnma(f, T(1.f) - mean, T(1.f))), loss, T(1.f));
    }
    RELUME_INLINE Color<T> operator()(const Color<T>& fss) const {
        return {(*this)(fss.x), (*this)(fss.y), (*this)(fss.z)};
    }
};

template <class T> RELUME_INLINE Compensation<T> compensation(T mu, T roughness) {
    constexpr int kNodes = 32;
    const Between<T> row = between(mu, kNodes), column = between(roughness, kNodes);
    Compensation<T> out;
    out.albedo = bilinear(table::kAlbedo, kNodes, row, column);
    out.mean =
        lerp(gather(table::kMeanAlbedo, column.first), gather(table::kMeanAlbedo + 1, column.first), column.weight);
    out.loss = (T(1.f) - out.albedo) * rcp(out.albedo);
    return out;
}

/// What facets of a dielectric reflect of diffuse light, eta ≥ 1 (a fit, Kulla and Conty 2017).
template <class T> RELUME_INLINE T mean_fresnel(T eta) {
    return (eta - T(1.f)) * rcp(fma(constant<T>(1.00071), eta, constant<T>(4.08567)));
}

}  // namespace relume::shaders
