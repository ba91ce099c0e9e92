// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "relume/shading/vec.h"

namespace relume::shaders {

/// Oren–Nayar as Fujii (2012) fitted it, A + B·s with A = 1/(π + sigma·(π/2 − 2/3)), and what it loses between the
/// facets given back (Portsmouth, Kutz, Hill 2025). Roughness 0 is Lambert to the bit.
///
/// 1 − E, E its albedo at a cosine, is A·sigma·(π/2 − 2/3 − q): written so, nothing cancels near roughness 0.
template <class T> struct RoughDiffuse {
    static constexpr double kMost = kPi / 2 - 2. / 3;     // q at grazing 0
    static constexpr double kMean = (2 * kPi - 5.6) / 3;  // 2·∫q·µ dµ
    T n_dot_v;
    T even, sheared;  // A, B
    T missing_v;      // (1 − E(v))/(A·sigma)

    /// s of the fit.
    RELUME_INLINE T shear(T v_dot_l, T n_dot_l) const {
        const T s = fnma(n_dot_l, n_dot_v, v_dot_l);
        return select(s > T(0.f), s * rcp(max(max(n_dot_l, n_dot_v), constant<T>(1e-4))), s);
    }
    /// (1 − E)/(A·sigma) at a cosine ≥ 0.
    RELUME_INLINE T missing(T cosine) const {
        const T one(1.f), c = min(cosine, one), s = safe_sqrt(fnma(c, c, one));
        const T third = c * s * fma(s, s, one + s) * rcp(one + s);  // (s/c)·(1 − s³)
        const T q = fma(s, fnma(s, c, acos(c) - constant<T>(2. / 3)), constant<T>(2. / 3) * third);
        return max(constant<T>(kMost) - q, T(0.f));
    }
    /// Colour of the light that is given back, over base, for each missing(NdotL). As Cycles has it, which multiplies
    /// by the base color once more than the papers do, and by 1 at most.
    RELUME_INLINE Color<T> scattered(const Color<T>& base) const {
        const T one(1.f), missing_mean = sheared * constant<T>(kMost - kMean);  // 1 − mean E
        const T weight = sheared * missing_v * constant<T>(kInvPi / (kMost - kMean)) * (one - missing_mean);
        const auto channel = [&](T b) RELUME_INLINE_LAMBDA {
            const T bounded = min(b, one);
            return weight * bounded * bounded * rcp(fnma(bounded, missing_mean, one));
        };
        return {channel(base.x), channel(base.y), channel(base.z)};
    }
};

template <class T> RELUME_INLINE RoughDiffuse<T> rough_diffuse(T sigma, T n_dot_v) {
    RoughDiffuse<T> out;
    out.n_dot_v = n_dot_v;
    const T even = rcp(fma(sigma, constant<T>(RoughDiffuse<T>::kMost), constant<T>(kPi)));
    out.even = select(sigma > T(0.f), even, constant<T>(kInvPi));
    out.sheared = sigma * out.even;
    out.missing_v = out.missing(n_dot_v);
    return out;
}

}  // namespace relume::shaders
