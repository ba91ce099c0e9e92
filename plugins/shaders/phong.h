// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "relume/shading/distributions.h"
#include "relume/shading/register.h"
#include "relume/shading/standard_parameters.h"

namespace relume::shaders {

struct Phong {
    static constexpr std::string_view name = "phong";
    static constexpr std::string_view label = "Phong";
    static constexpr std::string_view help =
        "Lambert with a highlight around the mirrored light [Phong1975]. With r = reflect(−l, n), e = exponent, f·NdotL = "
        "base_color/π·NdotL + specular_color·(e+2)/(2π)·max(0, r·v)^e·NdotL, whose highlight has albedo specular_color at normal "
        "view and less elsewhere [Lafortune1994]; plain: base_color·NdotL + specular_color·max(0, r·v)^e, as first published. "
        "Highlights stay round at grazing view, where real ones stretch: see blinn_phong. Normalised it is reciprocal, plain not. The "
        "albedo stays below 1 where base_color + specular_color does.";

    template <class T> struct Params {
        Color<T> base_color;
        Color<T> specular_color;
        T exponent;
        Color<T> ambient;
        Color<T> emission;
    };
    struct Options {
        std::int32_t energy_conserving;
    };
    static constexpr Parameter parameters[] = {
        row::base_color(RELUME_SLOT(base_color)),
        row::specular_color(RELUME_SLOT(specular_color), 0.04),
        row::exponent(RELUME_SLOT(exponent), 32, 128, LobeWidth::mirror_exponent),
        row::ambient(RELUME_SLOT(ambient)),
        row::emission(RELUME_SLOT(emission)),
        row::energy_conserving(RELUME_OPTION(energy_conserving)),
    };
    static constexpr bool needs_tangent = false;
    static constexpr bool lit_from_below = false;
    static constexpr Lobe terms[] = {Lobe::diffuse, Lobe::specular};

    template <class T> struct Prepared : PreparedTerms<T, 2> {
        Vec3<T> mirrored;  // reflect(−v, n): r·v = l·mirrored
        T exponent;
    };

    template <class T>
    static RELUME_INLINE Prepared<T> prepare(const Params<T>& p, const Options& o, const Geometry<T>& g) {
        Prepared<T> out;
        const bool normalised = o.energy_conserving != 0;
        out.exponent = max(p.exponent, T(0.f));
        out.mirrored = mirrored_view(g);
        out.color[0] = scale(p.base_color, constant<T>(normalised ? kInvPi : 1.0));
        out.color[1] = normalised ? scale(p.specular_color, constant<T>(0.5 * kInvPi) * (out.exponent + T(2.f)))
                                  : p.specular_color;
        out.ambient = out.color[0];
        out.emission = fma(mul(p.base_color, p.ambient), g.ambient_occlusion, p.emission);
        return out;
    }

    template <class T>
    static RELUME_INLINE void evaluate(const Prepared<T>& m, const Options& o, const Geometry<T>&,
                                       const LightSample<T>& s, T (&w)[2]) {
        const T n_dot_l = max(s.n_dot_l, T(0.f));
        const Vec3<T> d = sub(s.l, m.mirrored);
        const T lobe = cosine_power(constant<T>(0.5) * dot(d, d), m.exponent);  // |l − mirrored|² = 2 − 2·r·v
        w[0] = n_dot_l;
        w[1] = o.energy_conserving ? lobe * n_dot_l : select(s.n_dot_l > T(0.f), lobe, T(0.f));
    }
};

}  // namespace relume::shaders
