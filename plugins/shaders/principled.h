// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "relume/shading/fresnel.h"
#include "relume/shading/principled_lobes.h"
#include "relume/shading/register.h"
#include "relume/shading/standard_parameters.h"

namespace relume::shaders {

struct Principled {
    static constexpr std::string_view name = "principled";
    static constexpr std::string_view label = "Disney Principled";
    static constexpr std::string_view help =
        "Disney's principled surface [Burley2012], as in the public reference disney.brdf, which decodes 2.2 gamma of the base color; "
        "here it arrives linear. Eleven parameters, all but the colour from 0 to 1; the right first choice for most materials.\n"
        "f·NdotL = NdotL·((mix(Fd, ss, subsurface)·base_color/π + FH·sheen·mix(1, tint, sheen_tint))·(1−metallic) + Gs·Fs·Ds + "
        "clearcoat/4·Gr·Fr·Dr), FL, FV, FH = (1−x)⁵ of NdotL, NdotV, l·h.\n"
        "Fd = mix(1, F90, FL)·mix(1, F90, FV), F90 = ½ + 2·roughness·(l·h)²; ss = 1.25·(Fss·(1/(NdotL+NdotV)−½)+½), Fss as Fd with "
        "roughness·(l·h)². Ds: anisotropic GGX [Burley2012, eq. 13], alpha_x, alpha_y = roughness²/aspect, roughness²·aspect (at least "
        "0.001), aspect = √(1−0.9·anisotropic). Gs = g(l)·g(v), g(x) = 1/(n·x+√((ax·t·x)²+(ay·b·x)²+(n·x)²)). Fs = mix(c0, 1, FH), c0 = "
        "mix(0.08·specular·mix(1, tint, specular_tint), base_color, metallic). Clearcoat: GTR1 [Burley2012, eq. 4] of alpha mix(0.1, "
        "0.001, clearcoat_gloss), masking of alpha 0.25, F0 = 0.04. tint = base_color over its luminance (weights 0.3, 0.6, 0.1).\n"
        "Diffuse lobe: base and sheen; specular lobe: highlight and clearcoat. Reciprocal. Not energy conserving: albedo to 1.67, with subsurface to 1.83. "
        "Subsurface is a shape of the diffuse lobe, no light travels between pixels.\n"
        "variant mitsuba, as Mitsuba 3's principled: exact dielectric Fresnel of eta = 2/(1−√(0.08·specular))−1, clearcoat masking "
        "without the 1/(4·NdotL·NdotV), Rec.709 weights in the tint, no highlight of a dielectric at specular 0.";

    template <class T> struct Params {
        Color<T> base_color;
        T metallic;
        T subsurface;
        T specular;
        T roughness;
        T specular_tint;
        T anisotropic;
        T sheen;
        T sheen_tint;
        T clearcoat;
        T clearcoat_gloss;
        Color<T> emission;
    };
    struct Options {
        std::int32_t variant;
    };
    enum Variant : std::int32_t { burley, mitsuba };

    static constexpr Parameter parameters[] = {
        row::base_color(RELUME_SLOT(base_color), 0.82, 0.67, 0.16),
        row::metallic(RELUME_SLOT(metallic)),
        row::scalar("subsurface", RELUME_SLOT(subsurface), 0, 0, 1, "Subsurface",
                    "Blends the diffuse shape towards a flatter one, as of wax or skin."),
        row::scalar("specular", RELUME_SLOT(specular), 0.5, 0, kUnbounded, "Specular",
                    "Reflectance of a dielectric at normal incidence in units of 8 %: 0.5 is 4 %."),
        row::roughness(RELUME_SLOT(roughness)),
        row::specular_tint(RELUME_SLOT(specular_tint)),
        row::anisotropy(RELUME_SLOT(anisotropic), "anisotropic", 0),
        row::sheen(RELUME_SLOT(sheen)),
        row::sheen_tint(RELUME_SLOT(sheen_tint)),
        row::clearcoat(RELUME_SLOT(clearcoat)),
        row::wide(row::scalar("clearcoat_gloss", RELUME_SLOT(clearcoat_gloss), 1, 0, 1, "Clearcoat gloss",
                              "0: satin; 1: glossy."),
                  LobeWidth::gloss),
        row::emission(RELUME_SLOT(emission)),
        row::choice("variant", RELUME_OPTION(variant), 0, "burley|mitsuba", "Variant",
                    "Whose principled: Burley's own or Mitsuba 3's."),
    };
    static constexpr bool needs_tangent = true;
    static constexpr int anisotropy_slot = RELUME_SLOT(anisotropic);
    static constexpr bool lit_from_below = false;
    static constexpr Lobe terms[] = {Lobe::diffuse, Lobe::diffuse, Lobe::specular, Lobe::specular};

    template <class T> struct Prepared : PreparedTerms<T, 4> {
        T roughness, subsurface;
        T fresnel_v, n_dot_v;
        T eta, exact, white;  // mitsuba: weights of the exact Fresnel and of Schlick's grazing term
        SeparableGgx<T> highlight;
        Clearcoat<T> coat;
        bool any_subsurface, any_sheen, any_coat;
    };

    template <class T>
    static RELUME_INLINE Prepared<T> prepare(const Params<T>& p, const Options& o, const Geometry<T>& g) {
        const T zero(0.f), one(1.f), least = constant<T>(kMinAlpha);
        Prepared<T> out;
        const T metallic = saturate(p.metallic), dielectric = one - metallic;
        const T f0 = constant<T>(0.08) * max(p.specular, zero);
        const Color<T> tint =
            o.variant == mitsuba ? tint_of(p.base_color, kLuminanceRec709) : tint_of(p.base_color, kLuminanceBurley);
        out.color[0] = scale(p.base_color, dielectric * constant<T>(kInvPi));
        out.color[1] = sheen_color(p.sheen, p.sheen_tint, tint, dielectric);
        const T specular_tint = saturate(p.specular_tint);
        if (o.variant == mitsuba) {
            // F = (1−m)·(1−t)·Fd + m·mix(base, 1, FH) + (1−m)·t·mix(tint·F0, 1, FH).
            const T bounded = min(f0, constant<T>(0.99));
            const T tinted = select(f0 > zero, dielectric * specular_tint, zero);
            out.color[2] = fma(tint, tinted * bounded, scale(p.base_color, metallic));
            out.color[3] = splat(one);
            out.eta = eta_from_f0(f0);
            out.exact = dielectric * (one - specular_tint);
            out.white = metallic + tinted;
        } else {
            out.color[2] = principled_f0(f0, specular_tint, tint, p.base_color, metallic);
            out.color[3] = splat(one);
        }
        out.ambient = out.color[0];
        out.emission = p.emission;

        out.roughness = saturate(p.roughness);
        out.subsurface = saturate(p.subsurface);
        out.any_subsurface = any(out.subsurface > zero);
        out.n_dot_v = g.n_dot_v;
        out.fresnel_v = schlick_weight(g.n_dot_v);
        SeparableGgx<T>& highlight = out.highlight;
        highlight.prepare_round(square(alpha_from_roughness(p.roughness)), g.n_dot_v);
        highlight.anisotropic = saturate(p.anisotropic);
        highlight.any_anisotropic = !g.isotropic && any(highlight.anisotropic > zero);
        if (highlight.any_anisotropic) {
            tangent_frame(g, highlight.tangent, highlight.bitangent);
            const T aspect = sqrt(fma(highlight.anisotropic, constant<T>(-0.9), one));
            const T rough2 = square(out.roughness);
            highlight.alpha_x = max(rough2 * rcp(aspect), least);
            highlight.alpha_y = max(rough2 * aspect, least);
            highlight.prepare_stretched(g);
        }
        out.any_sheen = any(p.sheen > zero);
        out.any_coat = any(p.clearcoat > zero);
        if (out.any_coat) {
            out.coat = clearcoat(p.clearcoat, lerp(constant<T>(0.1), constant<T>(0.001), saturate(p.clearcoat_gloss)),
                                 g.n_dot_v);
            if (o.variant == mitsuba) out.coat.weight = out.coat.weight * T(2.f) * g.n_dot_v;
        }
        return out;
    }

    template <class T>
    static RELUME_INLINE void evaluate(const Prepared<T>& m, const Options& o, const Geometry<T>& g,
                                       const LightSample<T>& s, T (&w)[4]) {
        const T zero(0.f), one(1.f), half = constant<T>(0.5);
        const HalfVector<T> h = half_vector(g, s);
        const T n_dot_l = max(s.n_dot_l, zero);

        const T fl = schlick_weight(n_dot_l), fh = schlick_weight(h.v_dot_h);
        const T ss90 = m.roughness * fma(s.v_dot_l, half, half);  // (l·h)² = (1 + l·v)/2
        const T d90 = fma(ss90, T(2.f), -half);                   // F90 − 1
        T diffuse = fma(d90, fl, one) * fma(d90, m.fresnel_v, one);
        if (m.any_subsurface) {
            const T fss = fma(ss90 - one, fl, one) * fma(ss90 - one, m.fresnel_v, one);
            const T ss = fma(fss, rcp(n_dot_l + m.n_dot_v) - half, half);
            // lerp(diffuse, 1.25·ss, subsurface), fused by name: of two products the compiler takes now one, now the
            // other.
            const T change = fma(constant<T>(1.25), ss, -diffuse);
            diffuse = select(m.subsurface > zero, fma(m.subsurface, change, diffuse), diffuse);
        }
        w[0] = n_dot_l * diffuse;
        w[1] = m.any_sheen ? n_dot_l * max(fh, zero) : zero;

        const T lobe = m.highlight(g, s, h, n_dot_l);
        w[2] = fma(-fh, lobe, lobe);
        w[3] =
            o.variant == mitsuba ? lobe * fma(m.exact, dielectric_fresnel(h.v_dot_h, m.eta), fh * m.white) : fh * lobe;
        if (m.any_coat) {
            T coat = m.coat(h, n_dot_l);
            if (o.variant == mitsuba) coat = coat * T(2.f) * n_dot_l;
            w[3] = fma(coat, lerp(constant<T>(0.04), one, fh), w[3]);
        }
    }
};

}  // namespace relume::shaders
