// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "relume/shading/register.h"
#include "relume/shading/standard_parameters.h"

namespace relume::shaders {

struct Lambert {
    static constexpr std::string_view name = "lambert";
    static constexpr std::string_view label = "Lambert";
    static constexpr std::string_view help =
        "A perfectly matt surface: the same radiance in every direction [Lambert1760]. f·NdotL = base_color/π·NdotL; plain: "
        "base_color·NdotL. Reciprocal; albedo is base_color.";

    template <class T>
    struct Params {
        Color<T> base_color;
        Color<T> ambient;
        Color<T> emission;
    };
    struct Options {
        std::int32_t energy_conserving;
    };
    static constexpr Parameter parameters[] = {
        row::base_color(RELUME_SLOT(base_color)),
        row::ambient(RELUME_SLOT(ambient)),
        row::emission(RELUME_SLOT(emission)),
        row::energy_conserving(RELUME_OPTION(energy_conserving)),
    };
    static constexpr bool needs_tangent = false;
    static constexpr bool lit_from_below = false;
    static constexpr Lobe terms[] = {Lobe::diffuse};

    template <class T>
    using Prepared = PreparedTerms<T, 1>;

    template <class T>
    static RELUME_INLINE Prepared<T> prepare(const Params<T>& p, const Options& o, const Geometry<T>& g) {
        const T norm = constant<T>(o.energy_conserving ? kInvPi : 1.0);
        Prepared<T> out;
        out.color[0] = scale(p.base_color, norm);
        out.ambient = out.color[0];
        out.emission = fma(mul(p.base_color, p.ambient), g.ambient_occlusion, p.emission);
        return out;
    }

    template <class T>
    static RELUME_INLINE void evaluate(const Prepared<T>&, const Options&, const Geometry<T>&, const LightSample<T>& s, T (&w)[1]) {
        w[0] = max(s.n_dot_l, T(0.f));
    }
};

}  // namespace relume::shaders
