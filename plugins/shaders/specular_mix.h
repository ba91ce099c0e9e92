// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "relume/shading/register.h"
#include "relume/shading/standard_parameters.h"

namespace relume::shaders {

struct SpecularMix {
    static constexpr std::string_view name = "specular_mix";
    static constexpr std::string_view label = "Specular mix";
    static constexpr std::string_view help =
        "The surface of many small path tracers: a share p = percent_specular of the light goes into a glossy reflection, the rest "
        "into Lambert; emission is added. f·NdotL = (1−p)·base_color/π·NdotL + p·specular_color·lobe.\n"
        "Such a tracer bounces along normalize((1−t)·rv + t·d), t = roughness², rv the mirrored view, d cosine-distributed about n. The lobe "
        "is exactly the density of that direction: with μ = l·rv, the sum over the roots s = (1−t)μ ± √((1−t)²μ² − (1−2t)) > 0 of "
        "max(0, n·d)·s²/(π·t²·abs(l·d)), d = (s·l − (1−t)·rv)/t. Its integral is 1. Below t = ½ it is a disk around the mirror direction, "
        "0 where μ < √(1−2t)/(1−t), brightest at its edge, where it has an integrable pole: abs(l·d) is taken to be at least 0.05, "
        "which loses 1 %, 3 % at grazing view. Roughness 1 is Lambert, 0 a mirror: no highlight of sun, point and spot lights below roughness 0.01. Not "
        "reciprocal; the albedo is at most mix(base_color, specular_color, p).";

    template <class T> struct Params {
        Color<T> base_color;
        T percent_specular;
        Color<T> specular_color;
        T roughness;
        Color<T> ambient;
        Color<T> emission;
    };
    struct Options {};
    static constexpr Parameter parameters[] = {
        row::base_color(RELUME_SLOT(base_color)),
        row::scalar("percent_specular", RELUME_SLOT(percent_specular), 0.5, 0, 1, "Percent specular",
                    "Share of the light that is reflected by the glossy lobe."),
        row::specular_color(RELUME_SLOT(specular_color), 1),
        row::roughness(RELUME_SLOT(roughness)),
        row::ambient(RELUME_SLOT(ambient)),
        row::emission(RELUME_SLOT(emission)),
    };
    static constexpr bool needs_tangent = false;
    static constexpr bool lit_from_below = false;
    static constexpr Lobe terms[] = {Lobe::diffuse, Lobe::specular};

    static constexpr double kMirror = 1e-4;      // t at and below which the lobe is a mirror
    static constexpr double kLeastSlope = 0.05;  // of abs(l·d), at the lobe's edge

    template <class T> struct Prepared : PreparedTerms<T, 2> {
        Vec3<T> mirrored;
        T t, one_minus_t;
        T weight;  // 1/(π·t³); 0 for a mirror
    };

    template <class T>
    static RELUME_INLINE Prepared<T> prepare(const Params<T>& p, const Options&, const Geometry<T>& g) {
        const T one(1.f), share = saturate(p.percent_specular);
        Prepared<T> out;
        out.color[0] = scale(p.base_color, (one - share) * constant<T>(kInvPi));
        out.color[1] = scale(p.specular_color, share);
        out.ambient = out.color[0];
        out.emission = fma(mul(p.base_color, p.ambient), g.ambient_occlusion, p.emission);
        const T t = square(saturate(p.roughness)), least = constant<T>(kMirror);
        out.t = max(t, least);
        out.one_minus_t = one - out.t;
        out.mirrored = mirrored_view(g);
        out.weight = select(t > least, constant<T>(kInvPi) * rcp(out.t * out.t * out.t), T(0.f));
        return out;
    }

    template <class T>
    static RELUME_INLINE void evaluate(const Prepared<T>& m, const Options&, const Geometry<T>& g,
                                       const LightSample<T>& s, T (&w)[2]) {
        const T zero(0.f), half = constant<T>(0.5), n_dot_l = max(s.n_dot_l, zero);
        // Everything from the small vector l − rv: as written in the help, both μ − … and n·d cancel at low roughness.
        const Vec3<T> e = sub(s.l, m.mirrored);
        const T q = dot(e, e);  // 2 − 2μ
        const T mu = fnma(half, q, T(1.f));
        const T sin2 = q * fma(q, constant<T>(-0.25), T(1.f));  // 1 − μ²
        const T disc = fnma(m.one_minus_t * m.one_minus_t, sin2, m.t * m.t);
        const T root = safe_sqrt(disc);  // = t·abs(l·d)
        const T far = m.one_minus_t * mu + root;
        const T near = m.one_minus_t * mu - root;
        const T across = m.one_minus_t * fnma(half * q, s.n_dot_l, dot(g.n, e));  // (1−t)·(μ·n·l − n·rv)
        const T along = root * s.n_dot_l;
        const T lobe_far = select(far > zero, max(across + along, zero) * far * far, zero);  // t·n·d·s²
        const T lobe_near = select(near > zero, max(across - along, zero) * near * near, zero);
        const T pole = rcp(max(root, constant<T>(kLeastSlope) * m.t)) * m.t;
        w[0] = n_dot_l;
        w[1] = select(disc > zero && s.n_dot_l > zero, m.weight * (lobe_far + lobe_near) * pole, zero);
    }
};

}  // namespace relume::shaders
