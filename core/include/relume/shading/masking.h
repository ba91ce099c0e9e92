// SPDX-License-Identifier: Apache-2.0
#pragma once

// Masking and shadowing beside GGX's own (microfacet.h). x is NdotV or NdotL, in [1e-4, 1].

#include "relume/shading/microfacet.h"

namespace relume {

/// Half of Smith's G1 of GGX over the cosine, G1(x)/(2x) = 1/(x + √(a² + (1−a²)x²)): the product for l and v is the
/// separable V = G1(l)·G1(v)/(4·NdotL·NdotV) (Walter 2007, eq. 34; Burley 2012).
template <class T> RELUME_INLINE T ggx_half_masking(T alpha2, T cosine) {
    return rcp(cosine + sqrt(fma(cosine * cosine, T(1.f) - alpha2, alpha2)));
}

/// The same for anisotropic GGX: 1/(n·x + √((ax·t·x)² + (ay·b·x)² + (n·x)²)).
template <class T> RELUME_INLINE T ggx_half_masking_anisotropic(T ax, T ay, T t_dot_x, T b_dot_x, T n_dot_x) {
    const T x = ax * t_dot_x, y = ay * b_dot_x;
    return rcp(n_dot_x + sqrt(fma(x, x, fma(y, y, n_dot_x * n_dot_x))));
}

/// Λ of Beckmann, and near enough of a Gaussian and of Blinn–Phong with a = √(2/(e+2)): Walter's fit in q = 1/(a·tanθ),
/// off by 3e-3 in G1 (Walter 2007, eq. 27 and section 5.2, as Λ = 1/G1 − 1).
template <class T> RELUME_INLINE T beckmann_lambda(T alpha, T cosine) {
    const T tangent = safe_sqrt(T(1.f) - cosine * cosine);
    const T q = cosine * rcp(max(alpha * tangent, constant<T>(1e-12)));
    const T near = min(q, constant<T>(1.6));
    const T above = fma(near, fma(near, constant<T>(0.396), constant<T>(-1.259)), T(1.f));
    const T below = near * fma(near, constant<T>(2.181), constant<T>(3.535));
    return select(q < constant<T>(1.6), above * rcp(below), T(0.f));
}

/// G1(x)/x = 1/(x(1−k)+k) (Schlick 1994). V is the product for l and v over 4.
template <class T> RELUME_INLINE T schlick_masking_over_cosine(T k, T cosine) {
    return rcp(fma(cosine, T(1.f) - k, k));
}

/// The V-shaped cavity, G = min(1, 2·NdotH·NdotV/VdotH, 2·NdotH·NdotL/VdotH) (Torrance–Sparrow 1967; Cook–Torrance
/// 1982).
template <class T> RELUME_INLINE T v_cavity(T n_dot_h, T v_dot_h, T n_dot_v, T n_dot_l) {
    const T twice = T(2.f) * n_dot_h * rcp(max(v_dot_h, constant<T>(kMinCosine)));
    return min(T(1.f), twice * min(n_dot_v, n_dot_l));
}

}  // namespace relume
