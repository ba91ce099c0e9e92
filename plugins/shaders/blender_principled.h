// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "relume/shading/distributions.h"
#include "relume/shading/fresnel.h"
#include "relume/shading/masking.h"
#include "relume/shading/register.h"
#include "relume/shading/standard_parameters.h"
#include "relume/shading/tint.h"

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
        T alpha2;
        T weight;  // alpha²/π times the masking of v; 0 for a mirror
        DielectricRise<T> rise;
        T anisotropic, alpha_x, alpha_y, masking_v;
        Vec3<T> tangent, bitangent;
        T coat;  // clearcoat/4 times the masking of v; 0 for a mirror
        Gtr1<T> coat_distribution;
        bool any_anisotropic, any_coat, any_sheen;
    };

    template <class T>
    static RELUME_INLINE Prepared<T> prepare(const Params<T>& p, const Options&, const Geometry<T>& g) {
        const T zero(0.f), one(1.f);
        Prepared<T> out;
        const T metallic = saturate(p.metallic);
        const T dielectric = one - metallic;
        const T f0 = constant<T>(0.08) * max(p.specular, zero);
        const Color<T> tint = tint_of(p.base_color, kLuminanceBurley);
        const Color<T> c0 = scale(lerp(splat(one), tint, saturate(p.specular_tint)), f0);
        out.color[0] = scale(p.base_color, dielectric * constant<T>(kInvPi));
        out.color[1] = scale(lerp(splat(one), tint, saturate(p.sheen_tint)), saturate(p.sheen) * dielectric);
        out.color[2] = lerp(c0, p.base_color, metallic);
        out.color[3] = splat(one);
        out.ambient = out.color[0];
        out.emission = p.emission;

        out.roughness = saturate(p.roughness);
        out.fresnel_v = schlick_weight(g.n_dot_v);
        const T alpha = square(out.roughness);
        out.alpha2 = square(alpha);
        const MaskOf<T> rough = out.alpha2 > constant<T>(kMirror);
        out.alpha2 = max(out.alpha2, constant<T>(kMirror));
        out.weight = select(rough, constant<T>(kInvPi) * out.alpha2 * ggx_half_masking(out.alpha2, g.n_dot_v), zero);
        out.rise = dielectric_rise(f0);

        out.anisotropic = saturate(p.anisotropic);
        out.any_anisotropic = !g.isotropic && any(out.anisotropic > zero);
        if (out.any_anisotropic) {
            rotated_frame(g, p.anisotropic_rotation, out.tangent, out.bitangent);
            const T aspect = sqrt(fma(out.anisotropic, constant<T>(-0.9), one));
            const T bounded = max(alpha, constant<T>(3.16e-4));
            out.alpha_x = min(bounded * rcp(aspect), one);  // Cycles bounds both
            out.alpha_y = bounded * aspect;
            out.masking_v = select(rough,
                                   ggx_half_masking_anisotropic(out.alpha_x, out.alpha_y, dot(out.tangent, g.v),
                                                                dot(out.bitangent, g.v), g.n_dot_v),
                                   zero);
        }

        out.any_sheen = any(p.sheen > zero);
        out.any_coat = any(p.clearcoat > zero);
        if (out.any_coat) {
            const T coat_alpha = square(saturate(p.clearcoat_roughness));
            const MaskOf<T> coat_rough = square(coat_alpha) > constant<T>(kMirror);
            out.coat_distribution = gtr1(max(coat_alpha, constant<T>(3.16e-4)));
            out.coat = select(
                coat_rough,
                constant<T>(0.25) * saturate(p.clearcoat) * ggx_half_masking(constant<T>(0.0625), g.n_dot_v), zero);
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

        const T sin2_h = h.sin2_h();
        const T bracket = ggx_bracket(m.alpha2, sin2_h);
        T lobe = m.weight * n_dot_l * ggx_half_masking(m.alpha2, n_dot_l) * rcp(bracket * bracket);
        if (m.any_anisotropic) {
            const Vec3<T> hd = half_direction(g, s, h);
            const T d = ggx_distribution_anisotropic(m.alpha_x, m.alpha_y, dot(m.tangent, hd), dot(m.bitangent, hd),
                                                     square(h.n_dot_h()));
            const T masking = m.masking_v * ggx_half_masking_anisotropic(m.alpha_x, m.alpha_y, dot(m.tangent, s.l),
                                                                         dot(m.bitangent, s.l), n_dot_l);
            lobe = select(m.anisotropic > zero, d * masking * n_dot_l, lobe);
        }
        const T rise = m.rise(h.v_dot_h);
        w[2] = fma(-rise, lobe, lobe);
        w[3] = rise * lobe;
        if (m.any_coat) {
            const T coat =
                m.coat * n_dot_l * m.coat_distribution(sin2_h) * ggx_half_masking(constant<T>(0.0625), n_dot_l);
            w[3] = fma(coat, dielectric_fresnel(h.v_dot_h, constant<T>(1.5)), w[3]);
        }
    }
};

}  // namespace relume::shaders
