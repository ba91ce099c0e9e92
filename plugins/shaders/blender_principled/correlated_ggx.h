// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "relume/shading/microfacet.h"

namespace relume::shaders {

/// By how much anisotropy makes a lobe longer along the tangent, and narrower across it.
template <class T> RELUME_INLINE T stretch_of(T anisotropic) {
    return sqrt(fma(anisotropic, constant<T>(-0.9), T(1.f)));
}

/// D·V·NdotL of GGX under height-correlated Smith masking, round or stretched along a tangent (Burley 2012, eq. 13;
/// Heitz 2014, eq. 99). Prepared for a normal that need not be the pixel's.
template <class T> struct CorrelatedGgx {
    T alpha2, n_dot_v;
    T weight;     // alpha²/(2π)
    T masking_v;  // √(alpha² + (1 − alpha²)·NdotV²)
    T anisotropic, inv_x, inv_y, alpha_x, alpha_y;
    T stretched_weight, stretched_masking_v;
    Vec3<T> tangent, bitangent;
    bool any_anisotropic = false;

    RELUME_INLINE void prepare_round(T alpha, T cosine_v, double mirror) {
        const T least = constant<T>(mirror), squared = square(alpha);
        alpha2 = max(squared, least);
        n_dot_v = cosine_v;
        masking_v = sqrt(fma(cosine_v * cosine_v, T(1.f) - alpha2, alpha2));
        weight = select(squared > least, constant<T>(0.5 * kInvPi) * alpha2, T(0.f));
    }
    /// tangent and bitangent are set; after prepare_round().
    RELUME_INLINE void prepare_stretched(const Vec3<T>& v, T share) {
        anisotropic = share;
        const T aspect = stretch_of(share), alpha = sqrt(alpha2);
        alpha_x = min(alpha * rcp(aspect), T(1.f));  // as Cycles bounds it
        alpha_y = alpha * aspect;
        inv_x = rcp(alpha_x);
        inv_y = rcp(alpha_y);
        stretched_weight = select(weight > T(0.f), constant<T>(0.5 * kInvPi) * inv_x * inv_y, T(0.f));
        stretched_masking_v = stretched_masking(v, n_dot_v);
    }
    RELUME_INLINE T stretched_masking(const Vec3<T>& d, T cosine) const {
        const T x = alpha_x * dot(tangent, d), y = alpha_y * dot(bitangent, d);
        return sqrt(fma(x, x, fma(y, y, cosine * cosine)));
    }

    /// h: unit, q: |h − n|²; n_dot_l ≥ 0.
    RELUME_INLINE T operator()(const Vec3<T>& l, const Vec3<T>& h, T q, T n_dot_l) const {
        const T sin2 = max(q * fma(q, constant<T>(-0.25), T(1.f)), T(0.f));
        const T bracket = ggx_bracket(alpha2, sin2);
        const T masking_l = sqrt(fma(n_dot_l * n_dot_l, T(1.f) - alpha2, alpha2));
        const T sum = fma(n_dot_l, masking_v, n_dot_v * masking_l);
        T lobe = weight * n_dot_l * rcp(sum * bracket * bracket);
        if (any_anisotropic) {
            const T x = inv_x * dot(tangent, h), y = inv_y * dot(bitangent, h),
                    n_dot_h = fma(q, constant<T>(-0.5), T(1.f));
            const T wide = fma(x, x, fma(y, y, n_dot_h * n_dot_h));
            const T both = fma(n_dot_l, stretched_masking_v, n_dot_v * stretched_masking(l, n_dot_l));
            const T stretched = stretched_weight * n_dot_l * rcp(both * wide * wide);
            lobe = select(anisotropic > T(0.f), stretched, lobe);
        }
        return lobe;
    }
};

}  // namespace relume::shaders
