// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "relume/shading/distributions.h"
#include "relume/shading/kernel.h"
#include "relume/shading/standard_parameters.h"

namespace relume {

/// A Lambert surface under a highlight that hangs on the half angle and a width alone: f·NdotL = base_color/π·NdotL +
/// specular_color·D·NdotL/4, D normalised; plain: specular_color·D, no diffuse part. A model derives from this and has
/// `lobe(inv_width2, h)` and `specular_scale(width2, normalised)`, whose product is D/4, or plain D.
template <class Model> struct HalfAngleHighlight {
    template <class T> struct Params {
        Color<T> base_color;
        Color<T> specular_color;
        T width;
        Color<T> ambient;
        Color<T> emission;
    };
    struct Options {
        std::int32_t energy_conserving;
    };
    static constexpr Parameter parameters[] = {
        row::base_color(RELUME_SLOT(base_color)), row::specular_color(RELUME_SLOT(specular_color), 1),
        row::width(RELUME_SLOT(width)),           row::ambient(RELUME_SLOT(ambient)),
        row::emission(RELUME_SLOT(emission)),     row::energy_conserving(RELUME_OPTION(energy_conserving)),
    };
    static constexpr bool needs_tangent = false;
    static constexpr bool lit_from_below = false;
    static constexpr Lobe terms[] = {Lobe::diffuse, Lobe::specular};

    template <class T> struct Prepared : PreparedTerms<T, 2> { T inv_width2; };

    template <class T>
    static RELUME_INLINE Prepared<T> prepare(const Params<T>& p, const Options& o, const Geometry<T>& g) {
        Prepared<T> out;
        const bool normalised = o.energy_conserving != 0;
        const T width2 = square(clamp(p.width, constant<T>(kMinAlpha), T(1.f)));
        out.inv_width2 = rcp(width2);
        out.color[0] = scale(p.base_color, constant<T>(normalised ? kInvPi : 0.0));
        out.color[1] = scale(p.specular_color, Model::specular_scale(width2, normalised));
        out.ambient = scale(p.base_color, constant<T>(normalised ? kInvPi : 1.0));
        out.emission = fma(mul(p.base_color, p.ambient), g.ambient_occlusion, p.emission);
        return out;
    }

    template <class T>
    static RELUME_INLINE void evaluate(const Prepared<T>& m, const Options& o, const Geometry<T>& g,
                                       const LightSample<T>& s, T (&w)[2]) {
        const T n_dot_l = max(s.n_dot_l, T(0.f));
        const T lobe = Model::lobe(m.inv_width2, half_vector(g, s));
        w[0] = n_dot_l;
        w[1] = o.energy_conserving ? lobe * n_dot_l : select(s.n_dot_l > T(0.f), lobe, T(0.f));
    }
};

}  // namespace relume
