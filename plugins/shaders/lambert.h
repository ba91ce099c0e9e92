// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "relume/shading/phase.h"
#include "relume/shading/register.h"
#include "relume/shading/standard_parameters.h"

namespace relume::shaders {

struct Lambert {
    static constexpr std::string_view name = "lambert";
    static constexpr std::string_view label = "Lambert";
    static constexpr std::string_view help =
        "A perfectly matt surface: the same radiance in every direction [Lambert1760]. f·NdotL = base_color/π·NdotL; plain: "
        "base_color·NdotL. Reciprocal; the albedo is base_color.\n"
        "Option: sss_color·p·NdotL is added, p = (1−g²)/(4π(1+g²−2g·v·l)^1.5) [HenyeyGreenstein1941, eq. 2] with g = sss_anisotropy, a "
        "stand-in for light that scattered below the surface. It adds energy. Left out is the factor clamp(1−4·Σ max(0, h−d(P+h·l))) that dims it where little of the body lies behind "
        "the surface: it probes the scene's distance field d inside the object, and a G-buffer holds the first surface alone.";

    template <class T> struct Params {
        Color<T> base_color;
        Color<T> sss_color;
        T sss_anisotropy;
        Color<T> ambient;
        Color<T> emission;
    };
    struct Options {
        std::int32_t energy_conserving;
    };
    static constexpr Parameter parameters[] = {
        row::base_color(RELUME_SLOT(base_color)),
        row::sss_color(RELUME_SLOT(sss_color)),
        row::sss_anisotropy(RELUME_SLOT(sss_anisotropy)),
        row::ambient(RELUME_SLOT(ambient)),
        row::emission(RELUME_SLOT(emission)),
        row::energy_conserving(RELUME_OPTION(energy_conserving)),
    };
    static constexpr bool needs_tangent = false;
    static constexpr bool lit_from_below = false;
    static constexpr Lobe terms[] = {Lobe::diffuse, Lobe::diffuse};

    template <class T> struct Prepared : PreparedTerms<T, 2> {
        HenyeyGreenstein<T> phase;
        bool any_sss;
    };

    template <class T>
    static RELUME_INLINE Prepared<T> prepare(const Params<T>& p, const Options& o, const Geometry<T>& g) {
        Prepared<T> out;
        out.color[0] = scale(p.base_color, constant<T>(o.energy_conserving ? kInvPi : 1.0));
        out.color[1] = p.sss_color;
        out.ambient = out.color[0];
        out.emission = fma(mul(p.base_color, p.ambient), g.ambient_occlusion, p.emission);
        out.any_sss = any(max_component(p.sss_color) > T(0.f));
        if (out.any_sss) out.phase = henyey_greenstein(p.sss_anisotropy);
        return out;
    }

    template <class T>
    static RELUME_INLINE void evaluate(const Prepared<T>& m, const Options&, const Geometry<T>&,
                                       const LightSample<T>& s, T (&w)[2]) {
        w[0] = max(s.n_dot_l, T(0.f));
        w[1] = T(0.f);
        if (m.any_sss) w[1] = w[0] * m.phase(s.v_dot_l);
    }
};

}  // namespace relume::shaders
