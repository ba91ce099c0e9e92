// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "relume/shading/distributions.h"
#include "relume/shading/fresnel.h"
#include "relume/shading/masking.h"
#include "relume/shading/phase.h"
#include "relume/shading/register.h"
#include "relume/shading/standard_parameters.h"
#include "relume/shading/table.h"

namespace relume::shaders {

struct CookTorrance {
    static constexpr std::string_view name = "cook_torrance";
    static constexpr std::string_view label = "Cook–Torrance";
    static constexpr std::string_view help =
        "The microfacet construction kit [CookTorrance1982]: f·NdotL = D·F·G/(4·NdotL·NdotV)·NdotL + (1−F)·(1−metallic)·base_color/π·NdotL, "
        "F of F0 = mix(0.08·specular, base_color, metallic), alpha = roughness².\n"
        "distribution: ggx [Walter2007, eq. 33], beckmann [Walter2007, eq. 25], gaussian (of the half angle, width alpha "
        "[TorranceSparrow1967]), blinn_phong (exponent 2/alpha²−2 [Walter2007, eq. 30]), texture.\n"
        "texture: a highlight that is painted. f·NdotL = specular_color·spec_power·F·G·T² + the diffuse part, T = distribution_table "
        "at (NdotH/2+½, roughness): from left to right NdotH from −1 to 1, of which a highlight sees the right half; from top to bottom "
        "roughness from 0 to 1. Nothing divides by the cosines, and nothing normalises: brightness is the painter's. Λ is ggx's. The "
        "built-in table is alpha²/(1−(1−alpha²)·NdotH²), whose square is ggx over its peak, 2048 × 128 texels, bilinear: sharper than "
        "roughness 0.4 it shows its texels. Customary with it: specular 0.625 (F0 = 0.05), masking v_cavity. Not reciprocal.\n"
        "masking: smith_correlated 1/(1+Λv+Λl) [Heitz2014, eq. 99], smith_separable 1/((1+Λv)(1+Λl)) [Walter2007, eq. 23], both with the "
        "distribution's own Λ (gaussian and blinn_phong take Beckmann's); smith_schlick, x/(x(1−k)+k) for v and l with k = "
        "(roughness+1)²/8 [Karis2013]; smith_schlick_hable, k = alpha/2 [Hable2014]; v_cavity, min(1, 2·NdotH·NdotV/VdotH, "
        "2·NdotH·NdotL/VdotH) [CookTorrance1982].\n"
        "fresnel: schlick [Schlick1994, eq. 15] at VdotH; dielectric, the exact law of F0 = 0.08·specular [CookTorrance1982], for metals its "
        "rise from F0; none, F = F0 at every angle and a diffuse part that nothing is taken from (Lambert + GGX as renderers mix them).\n"
        "Plain: the metal factor twice, (1−metallic)², as some textbooks have it. Reciprocal but for texture. The sum may pass 1: 1.84 at roughness 0.05; "
        "blinn_phong under Smith passes 1 on its own (1.09 at roughness 0.7, 1.64 at 1), gaussian too (1.05 at 0.8): choose v_cavity there.\n"
        "Option: sss_color·p·NdotL is added, p the phase function of lambert's option.";

    template <class T> struct Params {
        Color<T> base_color;
        T metallic;
        T specular;
        T roughness;
        Color<T> specular_color;
        T spec_power;
        Color<T> sss_color;
        T sss_anisotropy;
        Color<T> ambient;
        Color<T> emission;
    };
    struct Options {
        std::int32_t distribution;
        std::int32_t masking;
        std::int32_t fresnel;
        std::int32_t energy_conserving;
    };
    struct Tables {
        TableView distribution;
    };
    enum Distribution : std::int32_t { ggx, beckmann, gaussian, blinn_phong, texture };
    enum Masking : std::int32_t { smith_correlated, smith_schlick, smith_schlick_hable, cavity, smith_separable };
    enum Fresnel : std::int32_t { schlick, constant_f0, dielectric };

    static constexpr Parameter parameters[] = {
        row::base_color(RELUME_SLOT(base_color)),
        row::metallic(RELUME_SLOT(metallic)),
        row::specular(RELUME_SLOT(specular)),
        row::roughness(RELUME_SLOT(roughness)),
        row::color(
            "specular_color", RELUME_SLOT(specular_color), 1, 1, 1, "Specular color",
            "Factor of the highlight of distribution texture; that of the others is specular, metallic and base_color alone."),
        row::scalar("spec_power", RELUME_SLOT(spec_power), 2, 0, kUnbounded, "Specular power",
                    "Brightness of the highlight of distribution texture.", 0, 30),
        row::sss_color(RELUME_SLOT(sss_color)),
        row::sss_anisotropy(RELUME_SLOT(sss_anisotropy)),
        row::ambient(RELUME_SLOT(ambient)),
        row::emission(RELUME_SLOT(emission)),
        row::choice(
            "distribution", RELUME_OPTION(distribution), ggx, "ggx|beckmann|gaussian|blinn_phong|texture",
            "Distribution",
            "How the facets' normals are spread: ggx has the longest tail, texture is painted in distribution_table."),
        row::table(
            "distribution_table", RELUME_TABLE(distribution), "Distribution table",
            "Picture of distribution texture: across, NdotH/2+½ from left to right; down, roughness from 0 to 1. One channel or "
            "the luminance of three, as stored."),
        row::choice("masking", RELUME_OPTION(masking), smith_correlated,
                    "smith_correlated|smith_schlick|smith_schlick_hable|v_cavity|smith_separable", "Masking",
                    "Which share of the facets is in sight of both viewer and light."),
        row::choice("fresnel", RELUME_OPTION(fresnel), schlick, "schlick|none|dielectric", "Fresnel",
                    "How reflectance rises towards grazing angles; none: it does not, and the diffuse part is whole."),
        row::energy_conserving(RELUME_OPTION(energy_conserving)),
    };
    static constexpr bool needs_tangent = false;
    static constexpr bool lit_from_below = false;
    static constexpr Lobe terms[] = {Lobe::diffuse, Lobe::specular, Lobe::specular, Lobe::diffuse};

    template <class T> struct Prepared : PreparedTerms<T, 4> {
        T alpha, alpha2, inv_alpha2;
        T exponent;       // blinn_phong
        T normalisation;  // gaussian
        T k;              // Schlick's maskings
        T masking_v;      // of v, whatever the masking needs of it
        TableView table;  // texture
        TableRows<T> rows;
        DielectricRise<T> rise;
        HenyeyGreenstein<T> phase;
        bool any_sss;
    };

    template <class T>
    static RELUME_INLINE Prepared<T> prepare(const Params<T>& p, const Options& o, const Tables& tables,
                                             const Geometry<T>& g) {
        const T zero(0.f), one(1.f);
        Prepared<T> out;
        const T metallic = saturate(p.metallic), rest = one - metallic;
        const T f0_dielectric = min(constant<T>(0.08) * max(p.specular, zero), one);
        const Color<T> f0 = lerp(splat(f0_dielectric), p.base_color, metallic);
        const Color<T> cd = scale(p.base_color, rest);
        const bool normalised = o.energy_conserving != 0;
        Color<T> kd = scale(cd, constant<T>(kInvPi));
        if (!normalised) kd = scale(kd, rest);
        if (o.fresnel != constant_f0)
            kd = mul(kd, {max(one - f0.x, zero), max(one - f0.y, zero), max(one - f0.z, zero)});
        out.color[0] = kd;
        out.color[1] = f0;
        out.color[2] = splat(one);
        if (o.distribution == texture) {
            out.color[2] = scale(p.specular_color, max(p.spec_power, zero));
            out.color[1] = mul(f0, out.color[2]);
            out.table = tables.distribution;
            out.rows = table_rows(out.table, saturate(p.roughness));
        }
        out.color[3] = p.sss_color;
        out.ambient = normalised ? scale(cd, constant<T>(kInvPi)) : cd;
        out.emission = fma(mul(p.base_color, p.ambient), g.ambient_occlusion, p.emission);

        out.alpha = alpha_from_roughness(p.roughness);
        out.alpha2 = square(out.alpha);
        out.inv_alpha2 = rcp(out.alpha2);
        if (o.distribution == blinn_phong) out.exponent = exponent_from_alpha(out.alpha);
        if (o.distribution == gaussian) out.normalisation = gaussian_normalisation(out.alpha2);
        if (o.fresnel == dielectric) out.rise = dielectric_rise(f0_dielectric);
        if (o.masking == smith_schlick) out.k = square(saturate(p.roughness) + one) * constant<T>(0.125);
        if (o.masking == smith_schlick_hable) out.k = out.alpha * constant<T>(0.5);
        out.masking_v = masking(out, o, g.n_dot_v);
        out.any_sss = any(max_component(p.sss_color) > zero);
        if (out.any_sss) out.phase = henyey_greenstein(p.sss_anisotropy);
        return out;
    }

    static RELUME_INLINE bool ggx_masked(const Options& o) {
        return o.distribution == ggx || o.distribution == texture;
    }

    /// What one direction adds to the masking: Λ, G1/x, or G1/(2x), as visibility() takes it.
    template <class T> static RELUME_INLINE T masking(const Prepared<T>& m, const Options& o, T cosine) {
        switch (o.masking) {
            case smith_schlick:
            case smith_schlick_hable:
                return schlick_masking_over_cosine(m.k, cosine);
            case cavity:
                return T(0.f);
            case smith_separable:
                if (ggx_masked(o)) return ggx_half_masking(m.alpha2, cosine);
                break;
            default:
                if (ggx_masked(o)) return T(0.f);  // ggx_visibility() takes both directions at once
        }
        return beckmann_lambda(m.alpha, cosine);
    }

    /// V = G/(4·NdotL·NdotV), NdotL ≥ 1e-4.
    template <class T>
    static RELUME_INLINE T visibility(const Prepared<T>& m, const Options& o, const HalfVector<T>& h, T n_dot_v,
                                      T n_dot_l) {
        const T quarter = constant<T>(0.25), one(1.f);
        switch (o.masking) {
            case smith_schlick:
            case smith_schlick_hable:
                return quarter * m.masking_v * masking(m, o, n_dot_l);
            case cavity:
                return quarter * v_cavity(h.n_dot_h(), h.v_dot_h, n_dot_v, n_dot_l) * rcp(n_dot_v * n_dot_l);
            case smith_separable:
                if (ggx_masked(o)) return m.masking_v * masking(m, o, n_dot_l);
                return quarter * rcp(n_dot_v * n_dot_l * (one + m.masking_v) * (one + masking(m, o, n_dot_l)));
            default:
                if (ggx_masked(o)) return ggx_visibility(m.alpha2, n_dot_l, n_dot_v);
                return quarter * rcp(n_dot_v * n_dot_l * (one + m.masking_v + masking(m, o, n_dot_l)));
        }
    }

    template <class T>
    static RELUME_INLINE T distribution(const Prepared<T>& m, const Options& o, const HalfVector<T>& h, T n_dot_v) {
        switch (o.distribution) {
            case beckmann:
                return beckmann_distribution(m.inv_alpha2, h);
            case gaussian:
                return m.normalisation * gaussian_shape(m.inv_alpha2, h);
            case blinn_phong:
                return blinn_phong_distribution(m.exponent, h);
            case texture:  // NdotL·V times this is G·T²
                return T(4.f) * n_dot_v * square(sample(m.table, m.rows, fma(h.q, constant<T>(-0.25), T(1.f))));
            default:
                return ggx_distribution(m.alpha2, h.sin2_h());
        }
    }

    /// GGX's distribution over its peak, the root of it.
    static double default_table(std::int32_t, double u, double v) {
        const double cosine = 2 * u - 1 > 0 ? 2 * u - 1 : 0, alpha = v * v > kMinAlpha ? v * v : kMinAlpha;
        const double alpha2 = alpha * alpha;
        return alpha2 / (1 - (1 - alpha2) * cosine * cosine);
    }

    template <class T>
    static RELUME_INLINE void evaluate(const Prepared<T>& m, const Options& o, const Geometry<T>& g,
                                       const LightSample<T>& s, T (&w)[4]) {
        const T zero(0.f);
        const HalfVector<T> h = half_vector(g, s);
        const T n_dot_l = max(s.n_dot_l, zero);
        const T bounded = max(n_dot_l, constant<T>(kMinCosine));
        const T lobe = n_dot_l * distribution(m, o, h, g.n_dot_v) * visibility(m, o, h, g.n_dot_v, bounded);
        T rise = zero;
        if (o.fresnel == schlick) rise = schlick_weight(h.v_dot_h);
        if (o.fresnel == dielectric) rise = m.rise(h.v_dot_h);
        w[0] = fnma(rise, n_dot_l, n_dot_l);
        w[1] = fnma(rise, lobe, lobe);
        w[2] = rise * lobe;
        w[3] = zero;
        if (m.any_sss) w[3] = n_dot_l * m.phase(s.v_dot_l);
    }
};

}  // namespace relume::shaders
