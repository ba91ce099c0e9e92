// SPDX-License-Identifier: Apache-2.0
#pragma once

// Microfacet terms. alpha = roughness² is GGX's; D integrates to 1 with the cosine (∫D·cosθ dω = 1); a "visibility" V
// is G/(4·NdotL·NdotV), so a lobe is D·V·F·NdotL.

#include "relume/shading/shading.h"

namespace relume {

/// Below this a highlight is narrower than float resolves (and than any pixel sees).
inline constexpr double kMinAlpha = 1e-3;

/// The one conversion from perceptual roughness, clamped to [0, 1], to alpha.
template <class T> RELUME_INLINE T alpha_from_roughness(T roughness) {
    const T r = saturate(roughness);
    return max(r * r, constant<T>(kMinAlpha));
}

/// Schlick 1994: the weight (1 − x)⁵ of F90 against F0. The cosine lies in [0, 1] up to rounding, for which the
/// absolute value is cheaper than a clamp.
template <class T> RELUME_INLINE T schlick_weight(T cosine) { return pow5(abs(T(1.f) - cosine)); }

/// The bracket of GGX: D = a²/(π·t²) with t = sin²θh + a²·cos²θh (Walter et al. 2007, eq. 33).
template <class T> RELUME_INLINE T ggx_bracket(T alpha2, T sin2_h) { return fma(sin2_h, T(1.f) - alpha2, alpha2); }

/// The same bracket as a polynomial in q = |h − n|², one operation less: a² + (1 − a²)·q − ¼(1 − a²)·q².
template <class T> struct GgxBracket {
    T alpha2, linear, quadratic;
    RELUME_INLINE T operator()(T q) const { return fma(q, fma(q, quadratic, linear), alpha2); }
};

template <class T> RELUME_INLINE GgxBracket<T> ggx_bracket_polynomial(T alpha2) {
    const T linear = T(1.f) - alpha2;
    return {alpha2, linear, linear * constant<T>(-0.25)};
}

/// D of GGX.
template <class T> RELUME_INLINE T ggx_distribution(T alpha2, T sin2_h) {
    const T t = ggx_bracket(alpha2, sin2_h);
    return alpha2 * constant<T>(kInvPi) * rcp(t * t);
}

/// D of anisotropic GGX (Burley 2012, eq. 13): 1/(π·ax·ay·((t·h/ax)² + (b·h/ay)² + NdotH²)²).
template <class T> RELUME_INLINE T ggx_distribution_anisotropic(T ax, T ay, T t_dot_h, T b_dot_h, T n_dot_h2) {
    const T x = t_dot_h * rcp(ax), y = b_dot_h * rcp(ay);
    const T bracket = fma(x, x, fma(y, y, n_dot_h2));
    return constant<T>(kInvPi) * rcp(ax * ay * bracket * bracket);
}

/// V of GGX, height-correlated (Heitz 2014, eq. 99): 0.5/(NdotL·√(NdotV²(1−a²)+a²) + NdotV·√(NdotL²(1−a²)+a²)).
template <class T> RELUME_INLINE T ggx_visibility(T alpha2, T n_dot_l, T n_dot_v) {
    const T one_minus = T(1.f) - alpha2;
    const T lv = n_dot_l * sqrt(fma(n_dot_v * n_dot_v, one_minus, alpha2));
    const T ll = n_dot_v * sqrt(fma(n_dot_l * n_dot_l, one_minus, alpha2));
    return constant<T>(0.5) * rcp(max(lv + ll, constant<T>(1e-12)));
}

/// The joint approximation V = 0.5/(NdotL(NdotV(1−a)+a) + NdotV(NdotL(1−a)+a)) (Karis 2013) has a denominator that is
/// linear in NdotL: slope·NdotL + offset, both of the pixel alone.
template <class T> struct JointApproximation {
    T slope, offset;
    RELUME_INLINE T denominator(T n_dot_l) const { return fma(n_dot_l, slope, offset); }
};

template <class T> RELUME_INLINE JointApproximation<T> joint_approximation(T alpha, T n_dot_v) {
    return {fma(n_dot_v + n_dot_v, T(1.f) - alpha, alpha), alpha * n_dot_v};
}

/// Λ of GGX for a direction at cosine x, from a²: (√(1 + a²(1/x² − 1)) − 1)/2 (Walter 2007; Heitz 2014).
template <class T> RELUME_INLINE T ggx_lambda(T alpha2, T cosine) {
    const T inv2 = rcp(max(cosine * cosine, constant<T>(1e-12)));
    return constant<T>(0.5) * (sqrt(fma(alpha2, inv2 - T(1.f), T(1.f))) - T(1.f));
}

}  // namespace relume
