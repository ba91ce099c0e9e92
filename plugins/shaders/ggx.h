// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "relume/shading/microfacet.h"
#include "relume/shading/register.h"
#include "relume/shading/standard_parameters.h"

namespace relume::shaders {

struct Ggx {
    static constexpr std::string_view name = "ggx";
    static constexpr std::string_view label = "GGX";
    static constexpr std::string_view help =
        "Lambert under a GGX highlight in Hable's cheap form [Hable2014]: D of Trowbridge–Reitz [Walter2007, eq. 33], "
        "V = G1(NdotL)·G1(NdotV)/4 with G1(x) = 1/(x(1−k)+k), k = alpha/2, Schlick's Fresnel at the half vector. f·NdotL = "
        "base_color/π·NdotL + D·F·V·NdotL. Plain: the highlight alone without the ¼ that makes it a BRDF, four times too bright. "
        "Reciprocal; the diffuse part is not reduced by the highlight.";

    template <class T> struct Params {
        Color<T> base_color;
        T roughness;
        Color<T> f0;
        Color<T> ambient;
        Color<T> emission;
    };
    struct Options {
        std::int32_t energy_conserving;
    };
    static constexpr Parameter parameters[] = {
        row::base_color(RELUME_SLOT(base_color)),
        row::roughness(RELUME_SLOT(roughness)),
        row::color("f0", RELUME_SLOT(f0), 0.04, 0.04, 0.04, "F0", "Reflectance at normal incidence.", 1),
        row::ambient(RELUME_SLOT(ambient)),
        row::emission(RELUME_SLOT(emission)),
        row::energy_conserving(RELUME_OPTION(energy_conserving)),
    };
    static constexpr bool needs_tangent = false;
    static constexpr bool lit_from_below = false;
    static constexpr Lobe terms[] = {Lobe::diffuse, Lobe::specular, Lobe::specular};

    template <class T> struct Prepared : PreparedTerms<T, 3> {
        T alpha2, k;
        T weight;  // alpha²/π · G1(NdotV) · ¼
    };

    template <class T>
    static RELUME_INLINE Prepared<T> prepare(const Params<T>& p, const Options& o, const Geometry<T>& g) {
        Prepared<T> out;
        const T alpha = alpha_from_roughness(p.roughness);
        const bool normalised = o.energy_conserving != 0;
        out.color[0] = scale(p.base_color, constant<T>(normalised ? kInvPi : 0.0));
        out.color[1] = p.f0;
        out.color[2] = splat(T(1.f));
        out.ambient = scale(p.base_color, constant<T>(normalised ? kInvPi : 1.0));
        out.emission = fma(mul(p.base_color, p.ambient), g.ambient_occlusion, p.emission);
        out.alpha2 = alpha * alpha;
        out.k = alpha * constant<T>(0.5);
        out.weight =
            out.alpha2 * constant<T>(kInvPi * (normalised ? 0.25 : 1.0)) * rcp(fma(g.n_dot_v, T(1.f) - out.k, out.k));
        return out;
    }

    template <class T>
    static RELUME_INLINE void evaluate(const Prepared<T>& m, const Options&, const Geometry<T>& g,
                                       const LightSample<T>& s, T (&w)[3]) {
        const HalfVector<T> h = half_vector(g, s);
        const T n_dot_l = max(s.n_dot_l, T(0.f));
        const T t = ggx_bracket(m.alpha2, h.sin2_h());
        const T lobe = m.weight * n_dot_l * rcp(t * t * fma(n_dot_l, T(1.f) - m.k, m.k));
        const T fresnel = schlick_weight(h.v_dot_h);
        w[0] = n_dot_l;
        w[1] = fma(-fresnel, lobe, lobe);
        w[2] = fresnel * lobe;
    }
};

}  // namespace relume::shaders
