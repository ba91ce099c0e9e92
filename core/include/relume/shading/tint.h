// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "relume/shading/vec.h"

namespace relume {

/// What a colour's luminance is made of.
struct LuminanceWeights {
    double r, g, b;
};
inline constexpr LuminanceWeights kLuminanceRec709{0.2126, 0.7152, 0.0722};
inline constexpr LuminanceWeights kLuminanceBurley{0.3, 0.6, 0.1};  // disney.brdf's approximation, Blender 3's too

template <class T> RELUME_INLINE T luminance(const Color<T>& c, const LuminanceWeights& w) {
    return fma(c.x, constant<T>(w.r), fma(c.y, constant<T>(w.g), c.z * constant<T>(w.b)));
}

/// A colour's hue and saturation at luminance 1; white where the colour is black (Burley 2012). Components below 0 (a
/// denoiser's) count as 0, or a luminance near 0 would make the others huge.
template <class T> RELUME_INLINE Color<T> tint_of(const Color<T>& color, const LuminanceWeights& weights) {
    const T least = constant<T>(1e-12), zero(0.f);
    const Color<T> c{max(color.x, zero), max(color.y, zero), max(color.z, zero)};
    const T l = luminance(c, weights);
    return select(l > least, scale(c, rcp(max(l, least))), splat(T(1.f)));
}

/// White, tinted by that share.
template <class T> RELUME_INLINE Color<T> tinted(const Color<T>& tint, T share) {
    return lerp(splat(T(1.f)), tint, saturate(share));
}

}  // namespace relume
