// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "relume/shading/shading.h"

namespace relume {

/// Henyey–Greenstein phase function (1941, eq. 2), 1/sr: (1−g²)/(4π(1+g²−2g·c)^1.5), ∫ = 1 over the sphere; g in (−1,
/// 1), c the cosine between the two directions that g > 0 favours. Prepared once a pixel.
template <class T> struct HenyeyGreenstein {
    T one_plus_g2, two_g, norm;
    RELUME_INLINE T operator()(T cosine) const {
        const T r = rsqrt(max(fnma(two_g, cosine, one_plus_g2), constant<T>(1e-6)));
        return norm * r * r * r;
    }
};

template <class T> RELUME_INLINE HenyeyGreenstein<T> henyey_greenstein(T anisotropy) {
    const T g = clamp(anisotropy, constant<T>(-0.99), constant<T>(0.99));
    const T g2 = g * g;
    return {T(1.f) + g2, g + g, constant<T>(0.25 * kInvPi) * (T(1.f) - g2)};
}

}  // namespace relume
