// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "relume/shading/register.h"
#include "relume/shading/standard_parameters.h"

namespace relume::shaders {

struct LambertWrapped {
    static constexpr std::string_view name = "lambert_wrapped";
    static constexpr std::string_view label = "Wrapped Lambert";
    static constexpr std::string_view help =
        "Lambert whose light reaches around the terminator, as if it scattered inside: soft, cheap skin, wax, clouds and stylised "
        "looks. With w = wrap and p = power, f·NdotL = base_color·(p+1)/(2π(1+w))·max(0, (n·l+w)/(1+w))^p, so that the albedo is "
        "base_color [McAuley2011]; plain: base_color·max(0, (n·l+w)/(1+w))^p. Wrap 1 is Half-Lambert, n·l·0.5+0.5, and with power 2 "
        "that of Valve's games [Mitchell2007]. Lit from below the horizon too, so it is not reciprocal: shadows that were cast "
        "there must not be expected.";

    template <class T> struct Params {
        Color<T> base_color;
        T wrap;
        T power;
        Color<T> ambient;
        Color<T> emission;
    };
    struct Options {
        std::int32_t energy_conserving;
    };
    static constexpr Parameter parameters[] = {
        row::base_color(RELUME_SLOT(base_color)),
        row::scalar("wrap", RELUME_SLOT(wrap), 0.5, 0, 1, "Wrap",
                    "How far light reaches around: 0 is Lambert, 1 lights all but the point opposite."),
        row::scalar("power", RELUME_SLOT(power), 1, 0, kUnbounded, "Power",
                    "Exponent of the wrapped cosine; 2 is softer at the terminator.", 1, 4),
        row::ambient(RELUME_SLOT(ambient)),
        row::emission(RELUME_SLOT(emission)),
        row::energy_conserving(RELUME_OPTION(energy_conserving)),
    };
    static constexpr bool needs_tangent = false;
    static constexpr bool lit_from_below = true;
    static constexpr Lobe terms[] = {Lobe::diffuse};

    template <class T> struct Prepared : PreparedTerms<T, 1> {
        T wrap, inv_range, power;  // inv_range = 1/(1+wrap)
        bool any_power;
    };

    template <class T>
    static RELUME_INLINE Prepared<T> prepare(const Params<T>& p, const Options& o, const Geometry<T>& g) {
        const T one(1.f);
        Prepared<T> out;
        out.wrap = saturate(p.wrap);
        out.inv_range = rcp(one + out.wrap);
        out.power = max(p.power, T(0.f));
        out.any_power = any(out.power != one);
        const bool normalised = o.energy_conserving != 0;
        out.color[0] = normalised ? scale(p.base_color, constant<T>(0.5 * kInvPi) * (out.power + one) * out.inv_range)
                                  : p.base_color;
        out.ambient = scale(p.base_color, constant<T>(normalised ? kInvPi : 1.0));
        out.emission = fma(mul(p.base_color, p.ambient), g.ambient_occlusion, p.emission);
        return out;
    }

    template <class T>
    static RELUME_INLINE void evaluate(const Prepared<T>& m, const Options&, const Geometry<T>&,
                                       const LightSample<T>& s, T (&w)[1]) {
        const T zero(0.f);
        const T x = max((s.n_dot_l + m.wrap) * m.inv_range, zero);
        w[0] = x;
        if (m.any_power) w[0] = select(m.power != T(1.f), select(x > zero, pow(x, m.power), zero), x);
    }
};

}  // namespace relume::shaders
