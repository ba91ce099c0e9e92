// SPDX-License-Identifier: Apache-2.0
#pragma once

// Fresnel of a dielectric seen from outside. eta = inside/outside ≥ 1. Schlick's approximation is in microfacet.h.

#include "relume/shading/shading.h"

namespace relume {

/// Unpolarised reflectance at cosine x ≥ 0 between the direction and the (half) normal:
/// F = ½·((g−x)/(g+x))²·(1 + ((x(g+x)−1)/(x(g−x)+1))²), g² = eta² − 1 + x² (Cook–Torrance 1982, eq. for F; Walter 2007,
/// eq. 22). With g − x = (eta² − 1)/(g + x), and eta² − 1 as a product, nothing cancels near eta 1 or grazing, where
/// the formula as it stands gave all for nothing.
template <class T> RELUME_INLINE T dielectric_fresnel(T cosine, T eta) {
    const T one(1.f);
    const T excess = max((eta - one) * (eta + one), T(0.f));
    const T g = sqrt(fma(cosine, cosine, max(excess, constant<T>(1e-24))));
    const T sum = g + cosine, inv_sum = rcp(sum);
    const T difference = excess * inv_sum;
    const T a = difference * inv_sum;
    const T b = fma(cosine, sum, -one) * rcp(fma(cosine, difference, one));
    return constant<T>(0.5) * a * a * fma(b, b, one);
}

/// eta of a dielectric from its reflectance at normal incidence, F0 = ((eta−1)/(eta+1))² solved; F0 at most 0.99. 1 at
/// F0 = 0, whatever the reciprocal's last bit.
template <class T> RELUME_INLINE T eta_from_f0(T f0) {
    const T root = safe_sqrt(min(f0, constant<T>(0.99)));
    return max((T(1.f) + root) * rcp(T(1.f) - root), T(1.f));
}

/// The rise of the exact dielectric law from normal incidence (0) to grazing (1), which takes the place of Schlick's
/// (1−x)⁵: (F(x) − F(1))/(1 − F(1)), not below 0: it never falls, but for eta > 3.7 (F0 > 33 %), of which no dielectric
/// is. Prepared once a pixel.
template <class T> struct DielectricRise {
    T eta, f0, scale;  // scale = 1/(1 − F(1))
    RELUME_INLINE T operator()(T cosine) const { return max((dielectric_fresnel(cosine, eta) - f0) * scale, T(0.f)); }
};

template <class T> RELUME_INLINE DielectricRise<T> dielectric_rise(T f0) {
    const T bounded = clamp(f0, T(0.f), constant<T>(0.99));
    return {eta_from_f0(bounded), bounded, rcp(T(1.f) - bounded)};
}

}  // namespace relume
