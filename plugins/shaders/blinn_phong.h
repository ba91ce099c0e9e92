// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "relume/shading/distributions.h"
#include "relume/shading/register.h"
#include "relume/shading/standard_parameters.h"

namespace relume::shaders {

struct BlinnPhong {
    static constexpr std::string_view name = "blinn_phong";
    static constexpr std::string_view label = "Blinn–Phong";
    static constexpr std::string_view help =
        "Lambert with a highlight around the half vector [Blinn1977], which stretches at grazing view as real ones do. f·NdotL = "
        "base_color/π·NdotL + specular_color·B·NdotH^e·NdotL, B = (e+2)(e+4)/(8π(2^(−e/2)+e)) [Giesen2009], exact: the highlight's "
        "albedo is specular_color at normal view and less elsewhere. normalization s0: B = (e+8)/(8π), brighter by up to 7.5 %. Plain: "
        "base_color·NdotL + specular_color·NdotH^e. An exponent of four times Phong's looks alike; from roughness it is e = "
        "2/roughness⁴ − 2. Normalised it is reciprocal, plain not.";

    template <class T> struct Params {
        Color<T> base_color;
        Color<T> specular_color;
        T exponent;
        T roughness;
        Color<T> ambient;
        Color<T> emission;
    };
    struct Options {
        std::int32_t exponent_from;
        std::int32_t normalization;
        std::int32_t energy_conserving;
    };
    static constexpr Parameter parameters[] = {
        row::base_color(RELUME_SLOT(base_color)),
        row::specular_color(RELUME_SLOT(specular_color), 0.04),
        row::exponent(RELUME_SLOT(exponent), 32, 256, LobeWidth::half_exponent),
        row::roughness(RELUME_SLOT(roughness)),
        row::ambient(RELUME_SLOT(ambient)),
        row::emission(RELUME_SLOT(emission)),
        row::choice("exponent_from", RELUME_OPTION(exponent_from), 0, "exponent|roughness", "Exponent from",
                    "Whether exponent or roughness says how wide the highlight is."),
        row::choice("normalization", RELUME_OPTION(normalization), 0, "exact|s0", "Normalization",
                    "exact: (e+2)(e+4)/(8π(2^(−e/2)+e)); s0: the customary (e+8)/(8π)."),
        row::energy_conserving(RELUME_OPTION(energy_conserving)),
    };
    static constexpr bool needs_tangent = false;
    static constexpr bool lit_from_below = false;
    static constexpr Lobe terms[] = {Lobe::diffuse, Lobe::specular};

    template <class T> struct Prepared : PreparedTerms<T, 2> { T exponent; };

    template <class T> static RELUME_INLINE T normalization(T e, bool exact) {
        if (!exact) return constant<T>(0.125 * kInvPi) * (e + constant<T>(8));
        return constant<T>(0.125 * kInvPi) * (e + T(2.f)) * (e + T(4.f)) * rcp(exp2(constant<T>(-0.5) * e) + e);
    }

    template <class T>
    static RELUME_INLINE Prepared<T> prepare(const Params<T>& p, const Options& o, const Geometry<T>& g) {
        Prepared<T> out;
        const bool normalised = o.energy_conserving != 0;
        out.exponent =
            o.exponent_from == 1 ? exponent_from_alpha(alpha_from_roughness(p.roughness)) : max(p.exponent, T(0.f));
        out.color[0] = scale(p.base_color, constant<T>(normalised ? kInvPi : 1.0));
        out.color[1] =
            normalised ? scale(p.specular_color, normalization(out.exponent, o.normalization == 0)) : p.specular_color;
        out.ambient = out.color[0];
        out.emission = fma(mul(p.base_color, p.ambient), g.ambient_occlusion, p.emission);
        return out;
    }

    template <class T>
    static RELUME_INLINE void evaluate(const Prepared<T>& m, const Options& o, const Geometry<T>& g,
                                       const LightSample<T>& s, T (&w)[2]) {
        const T n_dot_l = max(s.n_dot_l, T(0.f));
        const T lobe = cosine_power(half_vector(g, s).q * constant<T>(0.5), m.exponent);
        w[0] = n_dot_l;
        w[1] = o.energy_conserving ? lobe * n_dot_l : select(s.n_dot_l > T(0.f), lobe, T(0.f));
    }
};

}  // namespace relume::shaders
