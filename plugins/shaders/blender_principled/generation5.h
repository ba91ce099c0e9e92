// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "relume/shading/fresnel.h"
#include "relume/shading/kernel.h"
#include "shaders/blender_principled/correlated_ggx.h"
#include "shaders/blender_principled/energy.h"
#include "shaders/blender_principled/params.h"
#include "shaders/blender_principled/rough_diffuse.h"
#include "shaders/blender_principled/sheen.h"

namespace relume::shaders {

/// blender_principled of Blender 4 and 5. Each layer lets through to the next what it does not reflect, which depends
/// on the view alone.
struct BlenderPrincipled5 {
    template <class T> using Params = BlenderPrincipledParams<T>;
    using Options = BlenderPrincipledOptions;

    static constexpr bool needs_tangent = true;
    static constexpr bool lit_from_below = true;  // a coat has a normal of its own; what is below is made 0 here
    static constexpr bool reads_slot(int slot) { return slot < RELUME_SLOT(sheen) || slot >= RELUME_SLOT(ior); }
    static constexpr bool prepares_once = true;
    static constexpr bool single_batches = true;

    /// alpha² (the product of both alphas) at and below which Cycles takes a lobe for a mirror.
    static constexpr double kMirror = 2e-10;

    /// Factors of the lobes, what the layers above let through included.
    template <class T> struct Stack {
        Color<T> sheen, coat, emission, metal, dielectric, diffuse;
        T coat_weight, base_weight;  // of the closures that lie on the smooth and on the bumped normal, sheen apart
        MicrofiberSheen<T> fibers;
    };

    /// What the stack takes from the parameters, whatever the normal is.
    template <class T> struct Inputs {
        Color<T> base, metal_f0, metal_dip, sheen_tint, f0;
        T metallic, roughness, mean_roughness, anisotropic, eta, root, at_normal;
        T sheen_weight, sheen_roughness;
        T coat_weight, coat_roughness, coat_ior, coat_root;
        Color<T> coat_tint;
        bool any_sheen, any_coat, any_metal, any_dielectric, any_anisotropic;
    };

    template <class T> struct Prepared {
        Color<T> ambient, emission;
        Vec3<T> n, smooth;
        CorrelatedGgx<T> base, coat;
        Color<T> metal, metal_f0, metal_dip;
        Color<T> dielectric_f0, dielectric_rise;
        DielectricRise<T> rise;
        Color<T> coat_color;
        T coat_ior;
        Color<T> sheen;
        MicrofiberSheen<T> fibers;
        Color<T> diffuse, diffuse_scattered;
        RoughDiffuse<T> rough;
        T terminator, sheen_terminator;
        bool any_sheen, any_coat, any_metal, any_dielectric, any_rough, any_apart;
    };

    template <class T> static RELUME_INLINE T mean(const Color<T>& c) {
        return (c.x + c.y + c.z) * constant<T>(1 / 3.);
    }

    template <class T> static RELUME_INLINE Inputs<T> inputs(const Params<T>& p) {
        const T zero(0.f), one(1.f);
        Inputs<T> in;
        in.base = clamped(p.base_color);
        in.metallic = saturate(p.metallic);
        in.roughness = in.mean_roughness = saturate(p.roughness);
        in.anisotropic = saturate(p.anisotropic);
        in.any_anisotropic = any(in.anisotropic > zero);
        if (in.any_anisotropic) {
            // alpha_x stops at 1. What is looked up is that of a round lobe of alpha² = alpha_x·alpha_y.
            const T aspect = stretch_of(in.anisotropic), alpha = square(in.roughness);
            in.mean_roughness = select(alpha > aspect, sqrt(sqrt(alpha * aspect)), in.roughness);
        }
        in.any_metal = any(in.metallic > zero);
        in.any_dielectric = any(in.metallic < one);

        // IOR level: F0 in units of that of the IOR, twice. A level of 0.5 leaves the IOR as it is.
        const T ior = max(p.ior, one);
        const T root_of_ior = (ior - one) * rcp(ior + one);
        const T level = max(p.specular, zero);
        const MaskOf<T> plain = level == constant<T>(0.5);
        const T asked = square(root_of_ior) * (level + level), most = constant<T>(0.99);
        in.root = select(plain, root_of_ior, sqrt(min(asked, most)));
        in.at_normal = square(in.root);
        in.eta = select(plain, ior, eta_from_f0(in.at_normal));
        const Color<T> tint = given_or_white(p.specular_tint);
        in.f0 = scale(tint, select(asked > most, min(asked, one), in.at_normal));  // which bounds the IOR alone

        // F82: what the tint takes at 82°, as a factor of c·(1 − c)⁶ (Hoffman 2019).
        const T six_sevenths5 = constant<T>(7776. / 16807);  // (6/7)⁵
        const T seventh = constant<T>(7 * 117649. / 46656);  // 7/(6/7)⁶
        in.metal_f0 = {min(in.base.x, one), min(in.base.y, one), min(in.base.z, one)};
        const Color<T> schlick = fma(one_minus(in.metal_f0), six_sevenths5, in.metal_f0);
        in.metal_dip = mul(scale(schlick, seventh), one_minus(tint));

        in.sheen_weight = max(p.sheen_weight, zero);  // neither has an upper bound in Cycles
        in.sheen_roughness = saturate(p.sheen_roughness);
        in.sheen_tint = given_or_white(p.sheen_tint);
        in.any_sheen = any(in.sheen_weight > zero);
        in.coat_weight = max(p.coat_weight, zero);
        in.any_coat = any(in.coat_weight > zero);
        in.coat_roughness = saturate(p.coat_roughness);
        in.coat_ior = max(p.coat_ior, one);
        in.coat_root = (in.coat_ior - one) * rcp(in.coat_ior + one);
        in.coat_tint = clamped(p.coat_tint);
        return in;
    }
    template <class T> static RELUME_INLINE Color<T> clamped(const Color<T>& c) {
        const T zero(0.f);
        return {max(c.x, zero), max(c.y, zero), max(c.z, zero)};
    }
    /// A tint that was not given is below 0, all of it.
    template <class T> static RELUME_INLINE Color<T> given_or_white(const Color<T>& tint) {
        return select(max_component(tint) < T(0.f), splat(T(1.f)), clamped(tint));
    }

    /// Sheen, coat, metal, dielectric, diffuse, from above.
    template <class T>
    static RELUME_INLINE Stack<T> stack(const Inputs<T>& in, const Options& o, const Vec3<T>& n, const Vec3<T>& smooth,
                                        const Vec3<T>& v) {
        const T zero(0.f), one(1.f), least = constant<T>(kMinCosine);
        Stack<T> out;
        Color<T> w = splat(one);
        out.sheen = out.coat = out.metal = out.dielectric = splat(zero);
        out.coat_weight = out.base_weight = zero;
        if (in.any_sheen) {
            const Vec3<T> axis = normalize(fma(sub(smooth, n), min(in.coat_weight, one), n));
            out.fibers = microfiber_sheen(axis, v, in.sheen_roughness);
            out.sheen = scale(in.sheen_tint, in.sheen_weight * out.fibers.albedo);
            w = scale(w, max(one - max_component(out.sheen), zero));
        }
        if (in.any_coat) {
            const T mu = clamp(dot(smooth, v), least, one);
            const Compensation<T> lost = compensation(mu, in.coat_roughness);
            const T factor = lost(mean_fresnel(in.coat_ior));
            out.coat = scale(w, in.coat_weight * factor);
            out.coat_weight = mean(out.coat) * lost.albedo;
            const T r0 = square(in.coat_root);
            const T single = fma(one - r0, mean_rise(in.coat_root, mu, in.coat_roughness), r0);
            w = scale(w, max(fnma(in.coat_weight, factor * lost.albedo * single, one), zero));
            // Its tint is that of the path down to the base and back, which is 1/cos as long.
            const T sin2 = one - mu * mu, inv = rcp(in.coat_ior);
            const T path = rsqrt(max(fnma(sin2 * inv, inv, one), constant<T>(1e-8)));
            const Color<T>& tint = in.coat_tint;
            if (any(tint.x < one || tint.y < one || tint.z < one || max_component(tint) > one)) {
                w = mul(w, {tinted_share(tint.x, path, in.coat_weight), tinted_share(tint.y, path, in.coat_weight),
                            tinted_share(tint.z, path, in.coat_weight)});
            }
        }
        out.emission = w;
        const T mu = clamp(dot(n, v), least, one);
        const bool scattered = o.distribution == Options::multi_ggx;
        Compensation<T> lost{one, one, zero};
        if (scattered) lost = compensation(mu, in.mean_roughness);
        if (in.any_metal) {
            out.metal = scale(w, in.metallic);
            if (scattered) {
                const Color<T> rest = one_minus(in.metal_f0);
                const Color<T> fss =
                    fma(in.metal_dip, constant<T>(-1 / 126.), fma(rest, constant<T>(1 / 21.), in.metal_f0));
                out.metal = mul(out.metal, lost(fss));
            }
            out.base_weight = mean(out.metal) * lost.albedo;
            w = scale(w, one - in.metallic);
        }
        if (in.any_dielectric) {
            out.dielectric = w;
            const T rise = mean_rise(in.root, mu, in.mean_roughness);
            Color<T> albedo = fma(one_minus(in.f0), rise, in.f0);
            if (scattered) {
                const T of_white = (mean_fresnel(in.eta) - in.at_normal) * rcp(one - in.at_normal);
                const Color<T> factor = lost(fma(one_minus(in.f0), of_white, in.f0));
                out.dielectric = mul(w, factor);
                albedo = scale(mul(albedo, factor), lost.albedo);
            }
            // Where the IOR comes out as 1 there is no lobe, and no closure that would have a part in the Normal pass.
            const T there = select(in.root > zero, lost.albedo, zero);
            out.base_weight = fma(mean(out.dielectric), there, out.base_weight);
            w = scale(w, max(one - max_component(albedo), zero));
        }
        out.diffuse = mul(w, in.base);
        out.base_weight = out.base_weight + mean(out.diffuse);
        return out;
    }
    /// 1 + (tint^path − 1)·share, the same bits for white whatever the neighbours are.
    template <class T> static RELUME_INLINE T tinted_share(T tint, T path, T share) {
        const T power = select(tint == T(1.f), T(1.f), pow(tint, path));
        return max(fma(power - T(1.f), share, T(1.f)), T(0.f));  // a share above 1 takes all of it
    }

    /// The bumped normal from Cycles' Normal pass, in which each closure's normal has the weight of its closure (that
    /// of a compensated one times its albedo): the length that the mean had is what makes the base's normal unit.
    template <class T>
    static RELUME_INLINE Vec3<T> unmixed(const Stack<T>& w, T coat_weight, const Vec3<T>& pass, const Vec3<T>& smooth) {
        const T one(1.f), sheen = mean(w.sheen), share = min(coat_weight, one);
        const T above = fma(sheen, share, w.coat_weight);
        const T below = fma(sheen, one - share, w.base_weight);
        const T cosine = dot(pass, smooth), sine2 = max(fnma(cosine, cosine, one), T(0.f));
        const T length = fma(above, cosine, safe_sqrt(fnma(above * above, sine2, below * below)));
        return normalize(fma(smooth, -above, scale(pass, length)));
    }

    /// tan² of the angle between a closure's normal and the smooth one, over 8 (Estevez et al. 2019).
    template <class T> static RELUME_INLINE T terminator(const Vec3<T>& n, const Vec3<T>& smooth) {
        const T one(1.f);
        const Vec3<T> bump = sub(n, smooth);
        const T q = dot(bump, bump), cosine = max(fma(q, constant<T>(-0.5), one), constant<T>(kMinCosine));
        return min(q * fma(q, constant<T>(-0.25), one) * rcp(cosine * cosine) * constant<T>(0.125), one);
    }
    /// What Smith's shadowing leaves of the light on a bump; tangent2 is that of the light to the smooth normal.
    template <class T> static RELUME_INLINE T unshadowed(T terminator, T tangent2, T s_dot_l) {
        const T zero(0.f), one(1.f);
        const T factor = T(2.f) * rcp(one + sqrt(fma(terminator, tangent2, one)));
        return select(terminator > zero, select(s_dot_l > zero, factor, zero), one);
    }

    template <class T>
    static RELUME_INLINE Prepared<T> prepare(const Params<T>& p, const Options& o, const Geometry<T>& g) {
        const T zero(0.f), one(1.f), least = constant<T>(kMinCosine);
        Prepared<T> out;
        const Inputs<T> in = inputs(p);

        // Before the bump: where the AOV has it. As half it is 5e-4 off, which a bump that small is not worth; a mean
        // over an edge, shorter than 1, is no surface's.
        const T length2 = dot(p.geometric_normal, p.geometric_normal);
        out.smooth = scale(p.geometric_normal, rsqrt(max(length2, constant<T>(1e-12))));
        const Vec3<T> moved = sub(out.smooth, g.n);
        const MaskOf<T> apart = length2 > constant<T>(0.98) && dot(moved, moved) > constant<T>(2.5e-7);
        out.any_apart = any(apart);
        out.smooth = select(apart, out.smooth, g.n);
        out.n = g.n;

        const bool mixed = out.any_apart && in.any_coat;
        Stack<T> w;
        for (int pass = 0, last = mixed ? 2 : 0;; ++pass) {  // each a hundredth of the error of the one before
            w = stack(in, o, out.n, out.smooth, g.v);
            if (pass == last) break;
            out.n = select(apart && in.coat_weight > zero, unmixed(w, in.coat_weight, g.n, out.smooth), g.n);
        }

        const T seen = select(dot(g.n, g.v) > zero, one, zero);
        const T n_dot_v = clamp(dot(out.n, g.v), least, one);
        out.any_sheen = in.any_sheen;
        out.any_coat = in.any_coat;
        out.any_metal = in.any_metal;
        out.any_dielectric = in.any_dielectric;
        out.emission = p.emission;
        if (o.emission_is != Options::seen) out.emission = mul(p.emission, w.emission);

        out.base.prepare_round(square(in.roughness), n_dot_v, kMirror);
        out.base.any_anisotropic = in.any_anisotropic;
        if (out.base.any_anisotropic) {
            Geometry<T> bumped = g;
            bumped.n = out.n;
            rotated_frame(bumped, p.anisotropic_rotation, out.base.tangent, out.base.bitangent);
            out.base.prepare_stretched(g.v, in.anisotropic);
        }
        out.metal = scale(w.metal, seen);
        out.metal_f0 = in.metal_f0;
        out.metal_dip = in.metal_dip;
        const Color<T> dielectric = scale(w.dielectric, seen);
        out.dielectric_f0 = mul(dielectric, in.f0);
        out.dielectric_rise = mul(dielectric, one_minus(in.f0));
        out.rise = {in.eta, in.at_normal, rcp(one - in.at_normal)};

        if (in.any_coat) {
            const T s_dot_v = dot(out.smooth, g.v);
            out.coat.prepare_round(square(in.coat_roughness), clamp(s_dot_v, least, one), kMirror);
            out.coat_color = select(s_dot_v > zero, w.coat, splat(zero));
            out.coat_ior = in.coat_ior;
        }
        out.fibers = w.fibers;
        out.sheen = scale(w.sheen, seen);

        out.ambient = scale(w.diffuse, constant<T>(kInvPi));
        out.diffuse = scale(w.diffuse, seen);
        const T sigma = saturate(p.diffuse_roughness);
        out.any_rough = any(sigma > zero);
        out.rough = rough_diffuse(sigma, n_dot_v);
        if (out.any_rough) {
            out.rough.missing_v = out.rough.missing(n_dot_v);
            out.diffuse_scattered = mul(out.diffuse, out.rough.scattered(in.base));
        }

        out.terminator = out.sheen_terminator = zero;
        if (out.any_apart) {
            out.terminator = select(apart, terminator(out.n, out.smooth), zero);
            if (in.any_sheen) out.sheen_terminator = select(apart, terminator(out.fibers.axis, out.smooth), zero);
        }
        return out;
    }

    template <class T>
    static RELUME_INLINE Lobes<T> evaluate(const Prepared<T>& m, const Options&, const Geometry<T>& g,
                                           const LightSample<T>& s) {
        const T zero(0.f), one(1.f);
        Lobes<T> out{splat(zero), splat(zero), splat(zero)};
        const T n_dot_l = max(dot(m.n, s.l), zero);
        T s_dot_l = n_dot_l;
        if (m.any_apart) s_dot_l = max(dot(m.smooth, s.l), zero);
        if (!any(max(n_dot_l, s_dot_l) > zero)) return out;

        const HalfVector<T> half = half_vector(g, s);
        const Vec3<T> h = half_direction(g, s, half);
        const T c = min(half.v_dot_h, one);

        const Vec3<T> from_n = sub(h, m.n);
        T lobe = m.base(s.l, h, dot(from_n, from_n), n_dot_l);
        // A facet reflects nothing that comes from behind the surface, however the bump turns it.
        if (m.any_apart) lobe = select(s_dot_l > zero, lobe, zero);
        Color<T> f = splat(zero);
        if (m.any_dielectric) f = fma(m.dielectric_rise, m.rise(c), m.dielectric_f0);
        if (m.any_metal) {
            const T rest = one - c, fifth = pow5(rest), dip = c * (fifth * rest);
            Color<T> metal = fma(one_minus(m.metal_f0), fifth, m.metal_f0);
            metal = fma(m.metal_dip, -dip, metal);
            metal = {saturate(metal.x), saturate(metal.y), saturate(metal.z)};
            f = {fma(m.metal.x, metal.x, f.x), fma(m.metal.y, metal.y, f.y), fma(m.metal.z, metal.z, f.z)};
        }
        out.specular = scale(f, lobe);
        if (m.any_coat) {
            const Vec3<T> from_smooth = sub(h, m.smooth);
            const T coat = m.coat(s.l, h, dot(from_smooth, from_smooth), s_dot_l);
            out.specular = fma(m.coat_color, coat * dielectric_fresnel(c, m.coat_ior), out.specular);
        }

        T lit = n_dot_l, sheen_lit = one;
        if (m.any_apart) {
            const T inv = rcp(max(s_dot_l, constant<T>(kMinCosine)));
            const T tangent2 = max(fma(inv, inv, -one), zero);
            lit = n_dot_l * unshadowed(m.terminator, tangent2, s_dot_l);
            if (m.any_sheen) sheen_lit = unshadowed(m.sheen_terminator, tangent2, s_dot_l);
        }
        T even = m.rough.even;
        if (m.any_rough) even = fma(m.rough.sheared, m.rough.shear(s.v_dot_l, n_dot_l), even);
        out.diffuse = scale(m.diffuse, lit * even);
        if (m.any_rough) out.diffuse = fma(m.diffuse_scattered, lit * m.rough.missing(n_dot_l), out.diffuse);
        if (m.any_sheen) out.diffuse = fma(m.sheen, m.fibers(s.l) * sheen_lit, out.diffuse);
        return out;
    }
};

}  // namespace relume::shaders
