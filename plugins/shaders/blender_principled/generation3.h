// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "relume/shading/fresnel.h"
#include "relume/shading/kernel.h"
#include "relume/shading/principled_lobes.h"
#include "shaders/blender_principled/params.h"

namespace relume::shaders {

/// blender_principled of Blender 2.8 to 3.6.
struct BlenderPrincipled3 {
    template <class T> using Params = BlenderPrincipledParams<T>;
    using Options = BlenderPrincipledOptions;

    static constexpr bool needs_tangent = true;
    static constexpr int anisotropy_slot = RELUME_SLOT(anisotropic);
    static constexpr bool lit_from_below = false;
    static constexpr bool reads_slot(int slot) {
        const int specular = RELUME_SLOT(specular_tint), sheen = RELUME_SLOT(sheen_tint);  // shares: one number each
        return slot < RELUME_SLOT(ior) && (slot <= specular || slot > specular + 2) &&
               (slot <= sheen || slot > sheen + 2);
    }
    static constexpr Lobe terms[] = {Lobe::diffuse, Lobe::diffuse, Lobe::specular, Lobe::specular};

    template <class T> struct Prepared : PreparedTerms<T, 4> {
        T roughness;
        T fresnel_v;  // (1−NdotV)⁵
        DielectricRise<T> rise;
        SeparableGgx<T> highlight;
        Clearcoat<T> coat;
        bool any_coat, any_sheen;
    };

    /// A share of a hue, or what it is where none was given (below 0).
    template <class T> static RELUME_INLINE T given_or(T share, double otherwise) {
        return select(share < T(0.f), constant<T>(otherwise), share);
    }

    template <class T>
    static RELUME_INLINE Prepared<T> prepare(const Params<T>& p, const Options&, const Geometry<T>& g) {
        const T zero(0.f), one(1.f);
        Prepared<T> out;
        const T metallic = saturate(p.metallic);
        const T dielectric = one - metallic;
        const T f0 = constant<T>(0.08) * max(p.specular, zero);
        const Color<T> tint = tint_of(p.base_color, kLuminanceBurley);
        const T specular_tint = given_or(p.specular_tint.x, 0), sheen_tint = given_or(p.sheen_tint.x, 0.5);
        out.color[0] = scale(p.base_color, dielectric * constant<T>(kInvPi));
        out.color[1] = sheen_color(p.sheen, sheen_tint, tint, dielectric);
        out.color[2] = principled_f0(f0, specular_tint, tint, p.base_color, metallic);
        out.color[3] = splat(one);
        out.ambient = out.color[0];
        out.emission = p.emission;

        out.roughness = saturate(p.roughness);
        out.fresnel_v = schlick_weight(g.n_dot_v);
        const T alpha = square(out.roughness);
        out.rise = dielectric_rise(f0);
        SeparableGgx<T>& highlight = out.highlight;
        highlight.prepare_round(max(square(alpha), constant<T>(kPrincipledMirror)), g.n_dot_v);
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
        highlight.keep_where(square(alpha) > constant<T>(kPrincipledMirror));

        out.any_sheen = any(p.sheen > zero);
        out.any_coat = any(p.clearcoat > zero);
        if (out.any_coat) {
            const T coat_alpha = square(saturate(p.clearcoat_roughness));
            out.coat = clearcoat(p.clearcoat, max(coat_alpha, constant<T>(3.16e-4)), g.n_dot_v);
            out.coat.weight = select(square(coat_alpha) > constant<T>(kPrincipledMirror), out.coat.weight, zero);
        }
        return out;
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
