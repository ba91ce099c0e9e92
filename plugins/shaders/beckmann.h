// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "relume/shading/half_angle_highlight.h"
#include "relume/shading/register.h"

namespace relume::shaders {

struct Beckmann : HalfAngleHighlight<Beckmann> {
    static constexpr std::string_view name = "beckmann";
    static constexpr std::string_view label = "Beckmann";
    static constexpr std::string_view help =
        "Lambert with a highlight of Beckmann's distribution [BeckmannSpizzichino1963] of width w: D = exp(−tan²θh/w²)/(π·w²·cos⁴θh) "
        "[Walter2007, eq. 25]. f·NdotL = base_color/π·NdotL + specular_color·D·NdotL/4; as a microfacet lobe its masking is "
        "NdotL·NdotV. Plain: specular_color·D, no diffuse part, four times too bright. For masking and Fresnel see "
        "cook_torrance. Normalised it is reciprocal, plain not; the bare highlight's albedo stays below specular_color.";

    template <class T> static RELUME_INLINE T lobe(T inv_width2, const HalfVector<T>& h) {
        return beckmann_distribution(inv_width2, h);
    }
    template <class T> static RELUME_INLINE T specular_scale(T, bool normalised) {
        return constant<T>(normalised ? 0.25 : 1.0);
    }
};

}  // namespace relume::shaders
