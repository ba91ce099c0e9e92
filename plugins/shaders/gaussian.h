// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "relume/shading/half_angle_highlight.h"
#include "relume/shading/register.h"

namespace relume::shaders {

struct Gaussian : HalfAngleHighlight<Gaussian> {
    static constexpr std::string_view name = "gaussian";
    static constexpr std::string_view label = "Gaussian";
    static constexpr std::string_view help =
        "Lambert with a highlight that is a Gaussian of the angle θh between normal and half vector, of width w, as Torrance and "
        "Sparrow took their facets to be spread [TorranceSparrow1967; Blinn1977]. f·NdotL = base_color/π·NdotL + specular_color·D·NdotL/4, D = exp(−(θh/w)²)/N, N = πw²/(1+0.6667w²+0.2023w⁴−0.0417w⁶), so "
        "that ∫D·cosθh = 1 (fit, 8e-4); as a microfacet lobe its masking is NdotL·NdotV. Plain: specular_color·exp(−(θh/w)²), no "
        "diffuse part. Normalised it is reciprocal, plain not; the bare highlight's albedo stays below specular_color.";

    template <class T> static RELUME_INLINE T lobe(T inv_width2, const HalfVector<T>& h) {
        return gaussian_shape(inv_width2, h);
    }
    template <class T> static RELUME_INLINE T specular_scale(T width2, bool normalised) {
        return normalised ? constant<T>(0.25) * gaussian_normalisation(width2) : T(1.f);
    }
};

}  // namespace relume::shaders
