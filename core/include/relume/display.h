// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>

#include "relume/export.h"
#include "relume/gbuffer.h"
#include "relume/image.h"

namespace relume {

// From scene-linear light to the numbers of a screen. For looking and for PNGs: a relit EXR stays scene-linear.
// The curves are for T = float and double; each says what it does with negative values and NaN.

/// Linear to sRGB code (IEC 61966-2-1, with the toe of 12.92 below 0.0031308). Negative values go down the toe, so that
/// srgb_decode() gives them back; above 1 the curve goes on. NaN stays.
template <class T> T srgb_encode(T linear) {
    return linear <= T(0.0031308) ? T(12.92) * linear : T(1.055) * std::pow(linear, T(1) / T(2.4)) - T(0.055);
}

/// sRGB code to linear, the inverse of srgb_encode() (up to the standard's rounding of the toe: 4e-8 where the two
/// meet).
template <class T> T srgb_decode(T code) {
    return code <= T(0.04045) ? code / T(12.92) : std::pow((code + T(0.055)) / T(1.055), T(2.4));
}

/// x^(1/2.2) and back; negative values are 0.
template <class T> T gamma22_encode(T linear) { return linear > T(0) ? std::pow(linear, T(1) / T(2.2)) : T(0); }
template <class T> T gamma22_decode(T code) { return code > T(0) ? std::pow(code, T(2.2)) : T(0); }

/// x/(1 + x): 0…∞ to 0…1 (Reinhard et al. 2002, eq. 3). Negative values and NaN are 0, infinity is 1.
template <class T> T reinhard(T linear) {
    if (!(linear > T(0))) return T(0);
    return T(1) - T(1) / (T(1) + linear);
}

/// Inverse of reinhard() on 0…1; 1 and more are infinity.
template <class T> T reinhard_inverse(T shown) {
    if (!(shown > T(0))) return T(0);
    return shown < T(1) ? shown / (T(1) - shown) : std::numeric_limits<T>::infinity();
}

/// Fit of the ACES film curve, x(2.51x + 0.03)/(x(2.43x + 0.59) + 0.14), clamped to 0…1 (Narkowicz 2016). Reaches 1 at
/// x = 7.24. Negative values and NaN are 0, infinity is 1.
template <class T> T aces_film(T linear) {
    if (!(linear > T(0))) return T(0);
    const T x = std::min(linear, T(1e6));  // far above 1, and x² stays finite
    return std::min(x * (T(2.51) * x + T(0.03)) / (x * (T(2.43) * x + T(0.59)) + T(0.14)), T(1));
}

/// Changes the colours of a picture in place: `change` is given them a row at a time, R, G, B interleaved and not
/// multiplied by alpha, and leaves the new ones there. `planes`: R, G, B, and A if there is one, half or float32,
/// interleaved or planar by their strides, `width` × `height`. `in` says whether the colours come multiplied by alpha,
/// `out` whether they leave so. Where alpha is 0 (or NaN) the colour is light without a surface, a glow: it is handed
/// over and stored as it is. Alpha itself is left alone. Errors: value (not 3 or 4 planes, a plane without pixels or of
/// integers).
RELUME_API void change_colors(std::span<const Plane> planes, int width, int height, AlphaMode in, AlphaMode out,
                              const std::function<void(std::span<float>)>& change);

enum class ToneCurve : std::uint8_t { none, reinhard, aces };
enum class DisplayEncoding : std::uint8_t { srgb, gamma22, linear };

/// What a picture is seen through: exposure, then the tone curve, then the code of the screen, then clamped to 0…1.
struct DisplayTransform {
    double exposure = 0;  ///< stops: colours are multiplied by 2^exposure
    ToneCurve tone = ToneCurve::none;
    DisplayEncoding encoding = DisplayEncoding::srgb;

    /// One value. NaN and negative values give 0, infinity 1.
    RELUME_API float operator()(float linear) const;

    /// A picture in place; planes and alpha as change_colors() has them.
    RELUME_API void apply(std::span<const Plane> planes, int width, int height, AlphaMode in = AlphaMode::premultiplied,
                          AlphaMode out = AlphaMode::premultiplied) const;
};

/// The nearest of 2^bits codes, ties up; below 0 and NaN give 0, above 1 the highest. Exact: computed in double, where
/// the product has no rounding.
inline std::uint8_t quantize8(float value) {
    return !(value > 0) ? 0 : value >= 1 ? 255 : static_cast<std::uint8_t>(static_cast<double>(value) * 255 + 0.5);
}
inline std::uint16_t quantize16(float value) {
    return !(value > 0) ? 0 : value >= 1 ? 65535 : static_cast<std::uint16_t>(static_cast<double>(value) * 65535 + 0.5);
}

/// The value of a code, correctly rounded; quantizing it gives the code again.
constexpr float dequantize8(std::uint8_t code) { return static_cast<float>(code) / 255.0f; }
constexpr float dequantize16(std::uint16_t code) { return static_cast<float>(code) / 65535.0f; }

}  // namespace relume
