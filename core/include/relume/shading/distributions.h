// SPDX-License-Identifier: Apache-2.0
#pragma once

// Microfacet distributions besides GGX (microfacet.h), and lobes that are powers of a cosine. ∫D·cosθ dω = 1. All of
// them are written in what HalfVector measures without cancellation, q = |h − n|² and sin²θh.

#include "relume/shading/microfacet.h"

namespace relume {

/// x^e for a cosine x given as 1 − x, which a narrow lobe needs: at e = 10⁴ the rounding of x alone is 6e-4. 0 where x
/// ≤ 0.
template <class T> RELUME_INLINE T cosine_power(T one_minus_cosine, T exponent) {
    const T most = constant<T>(0.999999);
    const T bounded = clamp(one_minus_cosine, T(0.f), most);
    return select(one_minus_cosine < most, exp(exponent * log1p(-bounded)), T(0.f));
}

/// e of Blinn and Phong lobes that are as wide as alpha: e = 2/alpha² − 2 (Walter 2007, section 5.2).
template <class T> RELUME_INLINE T exponent_from_alpha(T alpha) {
    return max(fma(T(2.f), rcp(alpha * alpha), T(-2.f)), T(0.f));
}

/// exp(−tan²θh/a²)/(π·a²·cos⁴θh) (Beckmann–Spizzichino 1963; Walter 2007, eq. 25). a ≤ 1: beyond tan²θh = 10⁴ it is 0
/// in float.
template <class T> RELUME_INLINE T beckmann_distribution(T inv_alpha2, const HalfVector<T>& h) {
    const T inv_cos2 = rcp(max(square(h.n_dot_h()), constant<T>(1e-4)));
    const T tan2 = max(h.sin2_h(), T(0.f)) * inv_cos2;
    return constant<T>(kInvPi) * inv_alpha2 * inv_cos2 * inv_cos2 * exp(-tan2 * inv_alpha2);
}

/// (e+2)/(2π)·NdotH^e (Blinn 1977, normalised as a distribution; Walter 2007, eq. 30).
template <class T> RELUME_INLINE T blinn_phong_distribution(T exponent, const HalfVector<T>& h) {
    const T norm = constant<T>(0.5 * kInvPi) * (exponent + T(2.f));
    return norm * cosine_power(h.q * constant<T>(0.5), exponent);
}

/// exp(−(θh/w)²), the bare Gaussian of the half angle.
template <class T> RELUME_INLINE T gaussian_shape(T inv_width2, const HalfVector<T>& h) {
    const T theta = T(2.f) * asin(min(constant<T>(0.5) * safe_sqrt(h.q), T(1.f)));
    return exp(-theta * theta * inv_width2);
}

/// 1/∫exp(−(θh/w)²)·cosθh dω, for w in (0, 1]: πw²/(1 + 0.6667w² + 0.2023w⁴ − 0.0417w⁶), relume's fit, 8e-4 off at most
/// (tests/cpp/physics).
template <class T> RELUME_INLINE T gaussian_normalisation(T width2) {
    const T bracket =
        fma(width2, fma(width2, fma(width2, constant<T>(-0.0417), constant<T>(0.2023)), constant<T>(0.6667)), T(1.f));
    return constant<T>(kInvPi) * bracket * rcp(width2);
}

/// What is constant over a pixel in GTR1, (a²−1)/(π·ln a²); the distribution is that over ggx_bracket(a², sin²θh), and
/// 1/π at a ≥ 1 (Burley 2012, eq. 4).
template <class T> struct Gtr1 {
    T alpha2, norm;
    RELUME_INLINE T operator()(T sin2_h) const { return norm * rcp(ggx_bracket(alpha2, sin2_h)); }
};

template <class T> RELUME_INLINE Gtr1<T> gtr1(T alpha) {
    const T alpha2 = min(alpha * alpha, T(1.f));
    const T below_one = min(alpha2, constant<T>(0.9999999));  // (x−1)/ln x → 1 at x = 1, which would be 0/0
    return {alpha2, (below_one - T(1.f)) * rcp(log(below_one)) * constant<T>(kInvPi)};
}

}  // namespace relume
