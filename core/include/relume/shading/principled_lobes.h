// SPDX-License-Identifier: Apache-2.0
#pragma once

// Lobes that Burley's principled surface and its descendants have in common; what depends on the pixel is prepared
// once. Fresnel is the model's own.

#include "relume/shading/distributions.h"
#include "relume/shading/masking.h"
#include "relume/shading/tint.h"

namespace relume {

/// D·V·NdotL of GGX under separable Smith masking, round or stretched along a tangent (Burley 2012; Walter 2007, eq. 33
/// and 34).
template <class T> struct SeparableGgx {
    T alpha2;
    T weight;  // alpha²/π times the masking of v
    T anisotropic, alpha_x, alpha_y;
    T masking_v;  // stretched
    Vec3<T> tangent, bitangent;
    bool any_anisotropic = false;

    RELUME_INLINE void prepare_round(T squared_alpha, T n_dot_v) {
        alpha2 = squared_alpha;
        weight = constant<T>(kInvPi) * alpha2 * ggx_half_masking(alpha2, n_dot_v);
    }
    /// alpha_x, alpha_y, tangent and bitangent are set.
    RELUME_INLINE void prepare_stretched(const Geometry<T>& g) {
        masking_v = ggx_half_masking_anisotropic(alpha_x, alpha_y, dot(tangent, g.v), dot(bitangent, g.v), g.n_dot_v);
    }
    /// A lane that is a mirror has no highlight of lights without extent.
    RELUME_INLINE void keep_where(MaskOf<T> rough) {
        weight = select(rough, weight, T(0.f));
        if (any_anisotropic) masking_v = select(rough, masking_v, T(0.f));
    }

    RELUME_INLINE T operator()(const Geometry<T>& g, const LightSample<T>& s, const HalfVector<T>& h, T n_dot_l) const {
        const T bracket = ggx_bracket(alpha2, h.sin2_h());
        T lobe = weight * n_dot_l * ggx_half_masking(alpha2, n_dot_l) * rcp(bracket * bracket);
        if (any_anisotropic) {
            const Vec3<T> hd = half_direction(g, s, h);
            const T d = ggx_distribution_anisotropic(alpha_x, alpha_y, dot(tangent, hd), dot(bitangent, hd),
                                                     square(h.n_dot_h()));
            const T masking = masking_v * ggx_half_masking_anisotropic(alpha_x, alpha_y, dot(tangent, s.l),
                                                                       dot(bitangent, s.l), n_dot_l);
            lobe = select(anisotropic > T(0.f), d * masking * n_dot_l, lobe);
        }
        return lobe;
    }
};

/// clearcoat/4·D·V·NdotL of a coat: GTR1 under the masking of GGX at alpha 0.25 (Burley 2012, section 5.5).
template <class T> struct Clearcoat {
    static constexpr double kMasking2 = 0.25 * 0.25;
    T weight;  // clearcoat/4 times the masking of v
    Gtr1<T> distribution;

    RELUME_INLINE T operator()(const HalfVector<T>& h, T n_dot_l) const {
        return weight * n_dot_l * distribution(h.sin2_h()) * ggx_half_masking(constant<T>(kMasking2), n_dot_l);
    }
};

template <class T> RELUME_INLINE Clearcoat<T> clearcoat(T strength, T alpha, T n_dot_v) {
    const T masking = ggx_half_masking(constant<T>(Clearcoat<T>::kMasking2), n_dot_v);
    return {constant<T>(0.25) * saturate(strength) * masking, gtr1(alpha)};
}

/// The factor of (1 − l·h)⁵·NdotL in Burley's sheen.
template <class T> RELUME_INLINE Color<T> sheen_color(T sheen, T sheen_tint, const Color<T>& tint, T dielectric) {
    return scale(tinted(tint, sheen_tint), saturate(sheen) * dielectric);
}

/// F0 of a blend of a dielectric, whose reflectance `f0` the base color may tint, and a metal.
template <class T>
RELUME_INLINE Color<T> principled_f0(T f0, T specular_tint, const Color<T>& tint, const Color<T>& base_color,
                                     T metallic) {
    return lerp(scale(tinted(tint, specular_tint), f0), base_color, metallic);
}

}  // namespace relume
