// SPDX-License-Identifier: Apache-2.0
// A shading model outside relume's tree; docs/howto-shader.md explains it.
#include "relume/shading/register.h"
#include "relume/shading/standard_parameters.h"

namespace {

using namespace relume;

struct Toon {
    static constexpr std::string_view name = "toon";
    static constexpr std::string_view label = "Toon";
    static constexpr std::string_view help =
        "Two tones and a hard line between them. f·NdotL = base_color/π where n·l is above the threshold, "
        "base_color·shade/π "
        "below it. Not reciprocal; in the light it is as bright as a matt surface that faces the light.";

    template <class T> struct Params {
        Color<T> base_color;
        T threshold;
        T shade;
        Color<T> emission;
    };
    struct Options {};
    static constexpr Parameter parameters[] = {
        row::base_color(RELUME_SLOT(base_color)),
        row::scalar("threshold", RELUME_SLOT(threshold), 0.3, 0, 1, "Threshold", "Cosine at which the light begins."),
        row::scalar("shade", RELUME_SLOT(shade), 0.25, 0, 1, "Shade", "Share of the light that the dark tone gets."),
        row::emission(RELUME_SLOT(emission)),
    };
    static constexpr bool needs_tangent = false;
    static constexpr bool lit_from_below = false;
    static constexpr Lobe terms[] = {Lobe::diffuse};

    template <class T> struct Prepared : PreparedTerms<T, 1> { T threshold, shade; };

    template <class T>
    static RELUME_INLINE Prepared<T> prepare(const Params<T>& p, const Options&, const Geometry<T>&) {
        Prepared<T> out;
        out.color[0] = scale(p.base_color, constant<T>(kInvPi));
        out.ambient = out.color[0];
        out.emission = p.emission;
        out.threshold = p.threshold;
        out.shade = p.shade;
        return out;
    }

    template <class T>
    static RELUME_INLINE void evaluate(const Prepared<T>& m, const Options&, const Geometry<T>&,
                                       const LightSample<T>& s, T (&w)[1]) {
        const T tone = select(s.n_dot_l > m.threshold, T(1.f), m.shade);
        w[0] = select(s.n_dot_l > T(0.f), tone, T(0.f));
    }
};

}  // namespace

RELUME_SHADER(toon, Toon)
