// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "relume/shading/fresnel.h"
#include "relume/shading/principled_lobes.h"
#include "relume/shading/register.h"
#include "relume/shading/standard_parameters.h"

namespace relume::shaders {

struct BlenderPrincipled {
    static constexpr std::string_view name = "blender_principled";
    static constexpr std::string_view label = "Blender Principled";
    static constexpr std::string_view help =
        "Blender's Principled BSDF as Cycles evaluates it, so that a render and its relight agree. Generation 3 is that of Blender 2.8 "
        "to 3.6, distribution GGX.\n"
        "f·NdotL = diffuse + sheen (both in the diffuse lobe) + specular + clearcoat (both in the specular lobe).\n"
        "diffuse = base_color·(1−metallic)/π·NdotL·((1−FV/2)(1−FL/2) + R·(FL+FV+FL·FV·(R−1))), FL, FV = (1−NdotL)⁵, (1−NdotV)⁵, "
        "R = roughness·(1+l·v): Burley's [Burley2012, section 5.3], expanded.\n"
        "specular = D·G·F/(4·NdotV): GGX [Walter2007, eq. 33], alpha = roughness², separable Smith masking [Walter2007, eq. 34], "
        "F = c0 + (1−c0)·(Fd(l·h)−Fd(1))/(1−Fd(1)) with c0 = mix(0.08·specular·mix(1, tint, specular_tint), base_color, metallic) and Fd "
        "the exact Fresnel of ior = 2/(1−√(0.08·specular))−1 [CookTorrance1982].\n"
        "sheen = sheen·mix(1, tint, sheen_tint)·(1−metallic)·(1−l·h)⁵·NdotL; clearcoat = clearcoat/4·D·G·Fd/(4·NdotV), D of GTR1 with alpha "
        "= clearcoat_roughness², G of alpha 0.25, ior 1.5. tint = base_color over its luminance (weights 0.3, 0.6, 0.1).\n"
        "Anisotropic: alpha_x = min(1, roughness²/aspect), alpha_y = roughness²·aspect, aspect = √(1−0.9·anisotropic).\n"
        "Roughness below 0.018 (alpha² ≤ 1e-7) is a mirror, as in Cycles: no highlight of sun, point and spot lights. No energy is "
        "taken from the diffuse part by the highlight: the sum may pass 1 at grazing view. Reciprocal. Left out: subsurface and "
        "transmission, which need the scene, Multiscatter GGX, and the bump terminator, which needs the normal before the bump.";

    template <class T> struct Params {
        Color<T> base_color;
        T metallic;
        T specular;
        T specular_tint;
        T roughness;
        T anisotropic;
        T anisotropic_rotation;
        T sheen;
        T sheen_tint;
        T clearcoat;
        T clearcoat_roughness;
        Color<T> emission;
    };
    struct Options {
        std::int32_t generation;
    };
    static constexpr Parameter parameters[] = {
        row::base_color(RELUME_SLOT(base_color)),
        row::metallic(RELUME_SLOT(metallic)),
        row::specular(RELUME_SLOT(specular)),
        row::specular_tint(RELUME_SLOT(specular_tint)),
        row::roughness(RELUME_SLOT(roughness)),
        row::anisotropy(RELUME_SLOT(anisotropic), "anisotropic", 0),
        row::scalar("anisotropic_rotation", RELUME_SLOT(anisotropic_rotation), 0, 0, 1, "Anisotropic rotation",
                    "Turns the tangent about the normal; 1 is a full turn."),
        row::sheen(RELUME_SLOT(sheen)),
        row::sheen_tint(RELUME_SLOT(sheen_tint)),
        row::clearcoat(RELUME_SLOT(clearcoat)),
        row::wide(row::scalar("clearcoat_roughness", RELUME_SLOT(clearcoat_roughness), 0.03, 0, 1,
                              "Clearcoat roughness", "Perceptual roughness of the clearcoat."),
                  LobeWidth::roughness),
        row::emission(RELUME_SLOT(emission)),
        row::choice("generation", RELUME_OPTION(generation), 0, "3", "Generation",
                    "Which Principled BSDF: 3 is that of Blender 2.8 to 3.6."),
    };
    static constexpr bool needs_tangent = true;
    static constexpr int anisotropy_slot = RELUME_SLOT(anisotropic);
    static constexpr bool lit_from_below = false;
    static constexpr Lobe terms[] = {Lobe::diffuse, Lobe::diffuse, Lobe::specular, Lobe::specular};

    /// alpha² at and below which Cycles takes a lobe for a mirror (its product of both alphas).
    static constexpr double kMirror = 1e-7;

    template <class T> struct Prepared : PreparedTerms<T, 4> {
        T roughness;
        T fresnel_v;  // (1−NdotV)⁵
        DielectricRise<T> rise;
        SeparableGgx<T> highlight;
        Clearcoat<T> coat;
        bool any_coat, any_sheen;
    };

    template <class T>
    static RELUME_INLINE Prepared<T> prepare(const Params<T>& p, const Options&, const Geometry<T>& g) {
        const T zero(0.f), one(1.f);
        Prepared<T> out;
        const T metallic = saturate(p.metallic);
        const T dielectric = one - metallic;
        const T f0 = constant<T>(0.08) * max(p.specular, zero);
        const Color<T> tint = tint_of(p.base_color, kLuminanceBurley);
        out.color[0] = scale(p.base_color, dielectric * constant<T>(kInvPi));
        out.color[1] = sheen_color(p.sheen, p.sheen_tint, tint, dielectric);
        out.color[2] = principled_f0(f0, p.specular_tint, tint, p.base_color, metallic);
        out.color[3] = splat(one);
        out.ambient = out.color[0];
        out.emission = p.emission;

        out.roughness = saturate(p.roughness);
        out.fresnel_v = schlick_weight(g.n_dot_v);
        const T alpha = square(out.roughness);
        out.rise = dielectric_rise(f0);
        SeparableGgx<T>& highlight = out.highlight;
        highlight.prepare_round(max(square(alpha), constant<T>(kMirror)), g.n_dot_v);
        highlight.anisotropic = saturate(p.anisotropic);
        highlight.any_anisotropic = !g.isotropic && any(highlight.anisotropic > zero);
        if (highlight.any_anisotropic) {
            rotated_frame(g, p.anisotropic_rotation, highlight.tangent, highlight.bitangent);
            const T aspect = sqrt(fma(highlight.anisotropic, constant<T>(-0.9), one));
            const T bounded = max(alpha, constant<T>(3.16e-4));
            highlight.alpha_x = min(bounded * rcp(aspect), one);  // Cycles bounds both
            highlight.alpha_y = bounded * aspect;
            highlight.prepare_stretched(g);
        }
        highlight.keep_where(square(alpha) > constant<T>(kMirror));

        out.any_sheen = any(p.sheen > zero);
        out.any_coat = any(p.clearcoat > zero);
        if (out.any_coat) {
            const T coat_alpha = square(saturate(p.clearcoat_roughness));
            out.coat = clearcoat(p.clearcoat, max(coat_alpha, constant<T>(3.16e-4)), g.n_dot_v);
            out.coat.weight = select(square(coat_alpha) > constant<T>(kMirror), out.coat.weight, zero);
        }
        return out;
    }

    /// The tangent frame turned by `turns` about the normal.
    template <class T>
    static RELUME_INLINE void rotated_frame(const Geometry<T>& g, T turns, Vec3<T>& tangent, Vec3<T>& bitangent) {
        Vec3<T> t, b;
        tangent_frame(g, t, b);
        const T angle = constant<T>(2 * kPi) * turns;
        const T c = cos(angle), s = sin(angle);
        tangent = fma(b, s, scale(t, c));
        bitangent = fma(t, -s, scale(b, c));
    }

    template <class T>
    static RELUME_INLINE void evaluate(const Prepared<T>& m, const Options&, const Geometry<T>& g,
                                       const LightSample<T>& s, T (&w)[4]) {
        const T zero(0.f), one(1.f), half = constant<T>(0.5);
        const HalfVector<T> h = half_vector(g, s);
        const T n_dot_l = max(s.n_dot_l, zero);

        const T fl = schlick_weight(n_dot_l), fv = m.fresnel_v;
        const T r = fma(m.roughness, s.v_dot_l, m.roughness);
        const T retro = r * fma(fl * fv, r - one, fl + fv);
        w[0] = n_dot_l * fma(fma(fv, -half, one), fma(fl, -half, one), retro);
        w[1] = zero;
        if (m.any_sheen) w[1] = n_dot_l * max(schlick_weight(h.v_dot_h), zero);

        const T lobe = m.highlight(g, s, h, n_dot_l);
        const T rise = m.rise(h.v_dot_h);
        w[2] = fma(-rise, lobe, lobe);
        w[3] = rise * lobe;
        if (m.any_coat) {
            w[3] = fma(m.coat(h, n_dot_l), dielectric_fresnel(h.v_dot_h, constant<T>(1.5)), w[3]);
        }
    }
};

}  // namespace relume::shaders
