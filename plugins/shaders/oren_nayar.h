// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "relume/shading/register.h"
#include "relume/shading/standard_parameters.h"

namespace relume::shaders {

struct OrenNayar {
    static constexpr std::string_view name = "oren_nayar";
    static constexpr std::string_view label = "Oren–Nayar";
    static constexpr std::string_view help =
        "A rough matt surface: matt facets that shade and light one another, flatter than Lambert and brighter towards the light; "
        "plaster, clay, concrete, the full moon. sigma is the standard deviation of the facets' slope angle in radians; 0 is Lambert. "
        "With s = l·v − n·l·n·v, form 1994: f·NdotL = base_color/π·NdotL·(A + B·max(0, s)/max(NdotL, NdotV)), A = 1 − "
        "0.5σ²/(σ²+0.33), B = 0.45σ²/(σ²+0.09) [OrenNayar1994, eq. 30]; its albedo passes base_color by up to 1.4 % (sigma 0.2, grazing view). Form fujii: "
        "base_color·NdotL·(A + B·s/t), t = max(NdotL, NdotV) where s > 0 and 1 elsewhere, A = 1/(π+(π/2−2/3)σ), B = σA [Fujii2012]: no "
        "dark ring, sigma 0 to 1, albedo at most base_color. Both are reciprocal.";

    template <class T> struct Params {
        Color<T> base_color;
        T sigma;
        Color<T> ambient;
        Color<T> emission;
    };
    struct Options {
        std::int32_t form;
    };
    enum Form : std::int32_t { oren_nayar_1994, fujii };

    static constexpr Parameter parameters[] = {
        row::base_color(RELUME_SLOT(base_color)),
        row::scalar("sigma", RELUME_SLOT(sigma), 0.5, 0, kPi / 2, "Sigma",
                    "Roughness: spread of the facets' slopes. Form fujii takes it up to 1.", 0, 1, "radians"),
        row::ambient(RELUME_SLOT(ambient)),
        row::emission(RELUME_SLOT(emission)),
        row::choice("form", RELUME_OPTION(form), 0, "1994|fujii", "Form",
                    "The fit as published or Fujii's improved one."),
    };
    static constexpr bool needs_tangent = false;
    static constexpr bool lit_from_below = false;
    static constexpr Lobe terms[] = {Lobe::diffuse};

    template <class T> struct Prepared : PreparedTerms<T, 1> { T a, b; };

    template <class T>
    static RELUME_INLINE Prepared<T> prepare(const Params<T>& p, const Options& o, const Geometry<T>& g) {
        const T one(1.f), sigma = max(p.sigma, T(0.f));
        Prepared<T> out;
        if (o.form == fujii) {
            const T bounded = min(sigma, one);
            out.a = rcp(fma(bounded, constant<T>(kPi / 2 - 2.0 / 3), constant<T>(kPi)));
            out.b = bounded * out.a;
        } else {
            const T sigma2 = sigma * sigma, inv_pi = constant<T>(kInvPi);
            out.a = inv_pi * fnma(constant<T>(0.5) * sigma2, rcp(sigma2 + constant<T>(0.33)), one);
            out.b = inv_pi * constant<T>(0.45) * sigma2 * rcp(sigma2 + constant<T>(0.09));
        }
        out.color[0] = p.base_color;
        out.ambient = scale(p.base_color, constant<T>(kInvPi));
        out.emission = fma(mul(p.base_color, p.ambient), g.ambient_occlusion, p.emission);
        return out;
    }

    template <class T>
    static RELUME_INLINE void evaluate(const Prepared<T>& m, const Options& o, const Geometry<T>& g,
                                       const LightSample<T>& s, T (&w)[1]) {
        const T zero(0.f);
        const T n_dot_l = max(s.n_dot_l, zero);
        const T plane = fnma(n_dot_l, g.n_dot_v, s.v_dot_l);  // sinθl·sinθv·cos(φl − φv)
        const T over = plane * rcp(max(n_dot_l, g.n_dot_v));
        const T term = o.form == fujii ? select(plane > zero, over, plane) : max(over, zero);
        w[0] = n_dot_l * max(fma(m.b, term, m.a), zero);
    }
};

}  // namespace relume::shaders
