// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "relume/shading/microfacet.h"
#include "relume/shading/register.h"
#include "relume/shading/standard_parameters.h"

namespace relume::shaders {

struct DefaultLit {
    static constexpr std::string_view name = "default_lit";
    static constexpr std::string_view label = "Default lit";
    static constexpr std::string_view help =
        "The metallic/roughness surface of real-time engines [Karis2013]: Lambert diffuse on base_color·(1−metallic), GGX with "
        "the joint Smith approximation, Schlick's Fresnel whose grazing term fades out below F0 = 2 %. With anisotropy the exact "
        "anisotropic GGX and its height-correlated visibility [Heitz2014] along the tangent, alpha_x = alpha·(1+anisotropy), "
        "alpha_y = alpha·(1−anisotropy) [KullaConty2017]. Diffuse is not reduced by what the specular lobe reflects: the sum may "
        "pass 1 (1.8 at roughness 0.05). Reciprocal.";

    template <class T> struct Params {
        Color<T> base_color;
        T metallic;
        T specular;
        T roughness;
        T anisotropy;
        Color<T> emission;
    };
    struct Options {};
    static constexpr Parameter parameters[] = {
        row::base_color(RELUME_SLOT(base_color)), row::metallic(RELUME_SLOT(metallic)),
        row::specular(RELUME_SLOT(specular)),     row::roughness(RELUME_SLOT(roughness)),
        row::anisotropy(RELUME_SLOT(anisotropy)), row::emission(RELUME_SLOT(emission)),
    };
    static constexpr bool needs_tangent = true;
    static constexpr int anisotropy_slot = RELUME_SLOT(anisotropy);
    static constexpr bool lit_from_below = false;
    static constexpr bool scales_by_arriving = true;
    static constexpr Lobe terms[] = {Lobe::diffuse, Lobe::specular, Lobe::specular};

    template <class T> struct Prepared : PreparedTerms<T, 3> {
        GgxBracket<T> bracket;
        JointApproximation<T> joint;
        T anisotropy;
        T alpha_x, alpha_y;
        Vec3<T> tangent, bitangent;
        T length_v;  // len(ax·t·v, ay·b·v, n·v)
        bool any_anisotropic;
    };

    template <class T>
    static RELUME_INLINE Prepared<T> prepare(const Params<T>& p, const Options&, const Geometry<T>& g) {
        const T one(1.f);
        const T metallic = saturate(p.metallic);
        Prepared<T> out;
        const Color<T> f0 = lerp(splat(constant<T>(0.08) * max(p.specular, T(0.f))), p.base_color, metallic);
        out.color[0] = scale(p.base_color, (one - metallic) * constant<T>(kInvPi));
        const T f90 = saturate(constant<T>(50) * f0.y);  // Karis 2013
        out.ambient = out.color[0];
        out.emission = p.emission;
        const T alpha = alpha_from_roughness(p.roughness);
        const T alpha2 = alpha * alpha;
        out.bracket = ggx_bracket_polynomial(alpha2);
        T weight = alpha2 * constant<T>(0.5 * kInvPi);  // the numerators of D and V, which no light changes
        out.joint = joint_approximation(alpha, g.n_dot_v);
        out.anisotropy = clamp(p.anisotropy, -one, one);
        out.any_anisotropic = !g.isotropic && any(out.anisotropy != T(0.f));
        if (out.any_anisotropic) {
            tangent_frame(g, out.tangent, out.bitangent);
            const T least = constant<T>(kMinAlpha);
            out.alpha_x = max(alpha * (one + out.anisotropy), least);
            out.alpha_y = max(alpha * (one - out.anisotropy), least);
            out.length_v = stretched_length(out, g.v, g.n_dot_v);
            weight = select(out.anisotropy != T(0.f), one, weight);
        }
        // D·V·NdotL·(F0·(1 − x) + F90·x), x Schlick's weight: F0 times the lobe and F90 − F0 times the lobe·x.
        out.color[1] = scale(f0, weight);
        out.color[2] = scale(sub(splat(f90), f0), weight);
        return out;
    }

    template <class T> static RELUME_INLINE T stretched_length(const Prepared<T>& m, const Vec3<T>& d, T n_dot_d) {
        const T x = m.alpha_x * dot(m.tangent, d), y = m.alpha_y * dot(m.bitangent, d);
        return sqrt(fma(x, x, fma(y, y, n_dot_d * n_dot_d)));
    }

    template <class T>
    static RELUME_INLINE void evaluate(const Prepared<T>& m, const Options&, const Geometry<T>& g,
                                       const LightSample<T>& s, T (&w)[3]) {
        const HalfVector<T> h = half_vector(g, s);
        const T n_dot_l = max(s.n_dot_l, T(0.f));
        const T cosine = n_dot_l * s.arriving;
        // The division runs beside the multiplications; a reciprocal's Newton step would be three more of them.
        T lobe = cosine / (square(m.bracket(h.q)) * m.joint.denominator(n_dot_l));
        if (m.any_anisotropic) {
            const Vec3<T> hd = half_direction(g, s, h);
            const T d = ggx_distribution_anisotropic(m.alpha_x, m.alpha_y, dot(m.tangent, hd), dot(m.bitangent, hd),
                                                     square(h.n_dot_h()));
            const T v =
                constant<T>(0.5) *
                rcp(max(fma(n_dot_l, m.length_v, g.n_dot_v * stretched_length(m, s.l, n_dot_l)), constant<T>(1e-12)));
            lobe = select(m.anisotropy != T(0.f), d * v * cosine, lobe);
        }
        w[0] = cosine;
        w[1] = lobe;
        w[2] = schlick_weight(h.v_dot_h) * lobe;
    }
};

}  // namespace relume::shaders
