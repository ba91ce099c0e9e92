// SPDX-License-Identifier: Apache-2.0
#pragma once

// The tile kernel: any shading model × all lights over a run of pixels, instantiated per model and number type.
//
// A pixel's result must not depend on its neighbours in the batch (tiles, crops and threads give the same bits), so a
// branch on any()/all() may only skip work whose result every lane would discard.

#include <cstddef>
#include <type_traits>
#include <utility>

#include "relume/shader_abi.h"
#include "relume/shading/shading.h"

namespace relume {

/// A model whose evaluate() fills scalar terms; the others return Lobes.
template <class S>
concept HasTerms = requires { S::terms[0]; };

template <class S>
constexpr int term_count() {
    if constexpr (HasTerms<S>) return static_cast<int>(std::size(S::terms));
    else return 0;
}

template <class S> inline constexpr int kFloatSlots = static_cast<int>(sizeof(typename S::template Params<float>) / sizeof(float));
template <class S> inline constexpr int kOptionSlots =
    std::is_empty_v<typename S::Options> ? 0 : static_cast<int>(sizeof(typename S::Options) / sizeof(std::int32_t));

/// Each parameter's slot lies in its struct, none overlap, and all are named: checked where the model is registered.
template <class S>
constexpr bool table_matches_params() {
    bool floats[kFloatSlots<S> + 1] = {};
    bool options[kOptionSlots<S> + 1] = {};
    for (const Parameter& p : S::parameters) {
        const bool is_option = p.type == ParameterType::boolean || p.type == ParameterType::integer || p.type == ParameterType::choice;
        const int n = is_option ? 1 : p.components();
        const int limit = is_option ? kOptionSlots<S> : kFloatSlots<S>;
        for (int k = 0; k < n; ++k) {
            if (p.slot < 0 || p.slot + k >= limit) return false;
            bool& seen = (is_option ? options : floats)[p.slot + k];
            if (seen) return false;
            seen = true;
        }
    }
    for (int k = 0; k < kFloatSlots<S>; ++k)
        if (!floats[k]) return false;
    for (int k = 0; k < kOptionSlots<S>; ++k)
        if (!options[k]) return false;
    return true;
}

/// slot of a Params or Options member, for the parameter table.
#define RELUME_SLOT(member) static_cast<int>(offsetof(Params<float>, member) / sizeof(float))
#define RELUME_OPTION(member) static_cast<int>(offsetof(Options, member) / sizeof(std::int32_t))

/// The direction and the share of DirectLight::color that arrives, for one kind of light.
template <class T>
RELUME_INLINE T spot_factor(const DirectLight& light, T cosine) {
    const T zero(0.f), one(1.f);
    const T outer(light.cone[0]), inv_width(light.cone[1]);
    switch (light.falloff) {
        case SpotFalloff::step: return select(cosine > outer, one, zero);
        case SpotFalloff::linear:  // in angle: Mitsuba's beam
            return saturate((T(light.cone[2]) - acos(clamp(cosine, -one, one))) * inv_width);
        default: break;
    }
    const T t = saturate((cosine - outer) * inv_width);
    const T smooth = t * t * fma(t, T(-2.f), T(3.f));
    return light.falloff == SpotFalloff::blender3 ? smooth * max(cosine, zero) : smooth;
}

template <class T>
RELUME_INLINE Vec3<T> light_direction(const DirectLight& light, const Vec3<T>& p, T& falloff) {
    const Vec3<T> axis{T(light.to_light[0]), T(light.to_light[1]), T(light.to_light[2])};
    if (light.kind == LightKind::sun) {
        falloff = T(1.f);
        return axis;
    }
    const Vec3<T> d{T(light.position[0]) - p.x, T(light.position[1]) - p.y, T(light.position[2]) - p.z};
    const T r = rsqrt(max(dot(d, d), constant<T>(1e-24)));
    const Vec3<T> l = scale(d, r);
    if (light.inverse_square) {
        falloff = r * r;
    } else {
        const T distance = rcp(r);
        falloff = rcp(fma(fma(T(light.attenuation[2]), distance, T(light.attenuation[1])), distance, T(light.attenuation[0])));
    }
    if (light.kind == LightKind::spot) falloff = falloff * spot_factor(light, dot(l, axis));
    return l;
}

template <class S, class T, std::size_t... K>
RELUME_INLINE void load_params(typename S::template Params<T>& params, const ShaderTile& tile, int i, int lanes, T& poison,
                               std::index_sequence<K...>) {
    T* slots = reinterpret_cast<T*>(&params);
    const auto one = [&](std::size_t k) {
        const float* plane = tile.slots[k];
        if (plane == nullptr) {
            slots[k] = T(tile.constants[k]);
        } else {
            slots[k] = load<T>(plane + i, lanes);
            poison = fma(slots[k], T(0.f), poison);
        }
    };
    (one(K), ...);
}

template <class T>
RELUME_INLINE Vec3<T> load3(const float* const (&planes)[3], int i, int lanes) {
    return {load<T>(planes[0] + i, lanes), load<T>(planes[1] + i, lanes), load<T>(planes[2] + i, lanes)};
}

template <class T>
RELUME_INLINE void accumulate(Color<T>& sum, const float (&color)[3], T weight) {
    sum.x = fma(T(color[0]), weight, sum.x);
    sum.y = fma(T(color[1]), weight, sum.y);
    sum.z = fma(T(color[2]), weight, sum.z);
}

/// Up to this many terms are summed apart over the lights; beyond, registers run out and each light's lobes are summed.
inline constexpr int kMaxSummedTerms = 4;

template <class S, class T>
RELUME_INLINE Lobes<T> evaluate_lobes(const typename S::template Prepared<T>& prepared, const typename S::Options& options,
                                      const Geometry<T>& g, const LightSample<T>& s) {
    if constexpr (HasTerms<S>) {
        T w[term_count<S>()];
        S::evaluate(prepared, options, g, s, w);
        Lobes<T> out{splat(T(0.f)), splat(T(0.f)), splat(T(0.f))};
        Color<T>* lobes[3] = {&out.diffuse, &out.specular, &out.transmission};
        for (int k = 0; k < term_count<S>(); ++k)
            *lobes[static_cast<int>(S::terms[k])] = fma(prepared.color[k], w[k], *lobes[static_cast<int>(S::terms[k])]);
        return out;
    } else {
        return S::evaluate(prepared, options, g, s);
    }
}

/// The surface frame that evaluation and shading share. `tangent` need not be orthogonal or unit.
template <class S, class T>
RELUME_INLINE void finish_geometry(Geometry<T>& g, const Vec3<T>* tangent) {
    if constexpr (S::needs_tangent) {
        orthonormal_frame(g.n, g.tangent, g.bitangent);
        if (tangent != nullptr) {
            const Vec3<T> t = fma(g.n, -dot(g.n, *tangent), *tangent);
            const T length2 = dot(t, t);
            const MaskOf<T> usable = length2 > constant<T>(1e-12);
            g.tangent = select(usable, scale(t, rsqrt(max(length2, constant<T>(1e-12)))), g.tangent);
            g.bitangent = select(usable, cross(g.n, g.tangent), g.bitangent);
        }
    }
}

template <class S, class T>
RELUME_INLINE void write_outputs(const ShaderTile& tile, int i, int lanes, const Color<T> (&lobes)[3], const Color<T>& emission, T weight) {
    const auto put = [&](float* plane, T value) {
        if (tile.accumulate) value = value + load<T>(plane + i, lanes);
        store(plane + i, value, lanes);
    };
    if (tile.total[0] != nullptr) {
        const Color<T> total = add(add(lobes[0], lobes[1]), add(lobes[2], emission));
        put(tile.total[0], total.x * weight);
        put(tile.total[1], total.y * weight);
        put(tile.total[2], total.z * weight);
    }
    for (int k = 0; k < 3; ++k) {
        if (tile.lobe[k][0] == nullptr) continue;
        put(tile.lobe[k][0], lobes[k].x * weight);
        put(tile.lobe[k][1], lobes[k].y * weight);
        put(tile.lobe[k][2], lobes[k].z * weight);
    }
}

// Internal linkage and flattened: see relume_isa_objects() in cmake/RelumeShader.cmake.
template <class S, class T>
__attribute__((flatten)) static void shade_tile(ShaderTile* tile_ptr) {
    ShaderTile& tile = *tile_ptr;
    const T zero(0.f), one(1.f);
    typename S::Options options;
    if constexpr (kOptionSlots<S> > 0) std::memcpy(&options, tile.options, sizeof options);
    std::int64_t nonfinite = 0;

    for (int i = 0; i < tile.count; i += kWidth<T>) {
        const int lanes = tile.count - i;
        T poison = zero;  // becomes NaN in lanes that read NaN or infinity
        Geometry<T> g;
        const Vec3<T> normal = load3<T>(tile.normal, i, lanes);
        const T length2 = dot(normal, normal);
        poison = fma(length2, zero, poison);
        const MaskOf<T> surface = length2 > constant<T>(1e-12);
        g.n = scale(normal, rsqrt(max(length2, constant<T>(1e-12))));

        Vec3<T> p{zero, zero, zero};
        if (tile.position[0] != nullptr) {
            p = load3<T>(tile.position, i, lanes);
            poison = fma(p.x + p.y + p.z, zero, poison);
        }
        const Vec3<T> eye{T(tile.eye[0]), T(tile.eye[1]), T(tile.eye[2])};
        if (tile.view[0] != nullptr) g.v = load3<T>(tile.view, i, lanes);
        else if (tile.constant_view) g.v = eye;
        else g.v = normalize(sub(eye, p));

        const T n_dot_v = dot(g.n, g.v);
        poison = fma(n_dot_v, zero, poison);
        g.n_dot_v = clamp(n_dot_v, constant<T>(kMinCosine), one);
        g.ambient_occlusion = one;
        if (tile.ambient_occlusion != nullptr) {
            g.ambient_occlusion = load<T>(tile.ambient_occlusion + i, lanes);
            poison = fma(g.ambient_occlusion, zero, poison);
        }
        if (S::needs_tangent && tile.tangent[0] != nullptr) {
            const Vec3<T> tangent = load3<T>(tile.tangent, i, lanes);
            poison = fma(tangent.x + tangent.y + tangent.z, zero, poison);
            finish_geometry<S, T>(g, &tangent);
        } else {
            finish_geometry<S, T>(g, nullptr);
        }

        typename S::template Params<T> params;
        load_params<S, T>(params, tile, i, lanes, poison, std::make_index_sequence<kFloatSlots<S>>{});
        const auto prepared = S::prepare(params, options, g);

        constexpr bool kSum = HasTerms<S> && term_count<S>() <= kMaxSummedTerms;
        Color<T> sums[kSum ? term_count<S>() : 3];
        for (Color<T>& sum : sums) sum = splat(zero);

        for (int k = 0; k < tile.light_count; ++k) {
            const DirectLight& light = tile.lights[k];
            T falloff;
            LightSample<T> s;
            s.l = light_direction(light, p, falloff);
            s.n_dot_l = dot(g.n, s.l);
            if constexpr (!S::lit_from_below) {
                if (!any(s.n_dot_l > zero)) continue;
            }
            s.v_dot_l = dot(g.v, s.l);
            if (light.mask != nullptr) falloff = falloff * load<T>(light.mask + i, lanes);
            if constexpr (kSum) {
                T w[term_count<S>()];
                S::evaluate(prepared, options, g, s, w);
                for (int t = 0; t < term_count<S>(); ++t)
                    accumulate(sums[t], light.color[static_cast<int>(S::terms[t])], w[t] * falloff);
            } else {
                const Lobes<T> f = evaluate_lobes<S, T>(prepared, options, g, s);
                const Color<T>* lobes[3] = {&f.diffuse, &f.specular, &f.transmission};
                for (int t = 0; t < 3; ++t) {
                    sums[t].x = fma(lobes[t]->x * falloff, T(light.color[t][0]), sums[t].x);
                    sums[t].y = fma(lobes[t]->y * falloff, T(light.color[t][1]), sums[t].y);
                    sums[t].z = fma(lobes[t]->z * falloff, T(light.color[t][2]), sums[t].z);
                }
            }
        }

        Color<T> lobes[3] = {splat(zero), splat(zero), splat(zero)};
        if constexpr (kSum) {
            for (int t = 0; t < term_count<S>(); ++t) {
                Color<T>& lobe = lobes[static_cast<int>(S::terms[t])];
                lobe = add(lobe, mul(prepared.color[t], sums[t]));
            }
        } else {
            for (int t = 0; t < 3; ++t) lobes[t] = sums[t];
        }
        if constexpr (!S::lit_from_below) {  // a lobe is 0 where the viewer is below
            const T front = select(n_dot_v > zero, one, zero);
            for (Color<T>& lobe : lobes) lobe = scale(lobe, front);
        }

        if (tile.ambient_count > 0) {
            Color<T> irradiance = splat(zero);
            for (int k = 0; k < tile.ambient_count; ++k) {
                const AmbientLight& light = tile.ambients[k];
                const Vec3<T> axis{T(light.axis[0]), T(light.axis[1]), T(light.axis[2])};
                const T c = dot(g.n, axis);
                const T w = light.clamp ? max(c, zero) : fma(c, constant<T>(0.5), constant<T>(0.5));
                const T m = light.mask != nullptr ? load<T>(light.mask + i, lanes) : one;
                irradiance.x = fma(m, lerp(T(light.low[0]), T(light.high[0]), w), irradiance.x);
                irradiance.y = fma(m, lerp(T(light.low[1]), T(light.high[1]), w), irradiance.y);
                irradiance.z = fma(m, lerp(T(light.low[2]), T(light.high[2]), w), irradiance.z);
            }
            lobes[0] = fma(mul(prepared.ambient, irradiance), g.ambient_occlusion, lobes[0]);
        }

        // Catches what overflowed on the way as well. A select, not a product: an invalid lane may hold NaN.
        for (const Color<T>& lobe : lobes) poison = fma(lobe.x + lobe.y + lobe.z, zero, poison);
        const MaskOf<T> valid = surface && !is_nan(poison);
        const T weight = tile.weight != nullptr ? load<T>(tile.weight + i, lanes) : one;
        for (Color<T>& lobe : lobes) lobe = select(valid, lobe, splat(zero));
        const Color<T> emission = select(valid, tile.emission ? prepared.emission : splat(zero), splat(zero));
        write_outputs<S, T>(tile, i, lanes, lobes, emission, weight);

        if (any(is_nan(poison))) [[unlikely]] {
            alignas(64) float flags[64] = {};
            store(flags, select(is_nan(poison), one, zero), kWidth<T>);
            for (int k = 0; k < kWidth<T> && k < lanes; ++k) nonfinite += flags[k] != 0.f;
        }
    }
    tile.nonfinite = nonfinite;
}

/// f·NdotL on arrays, by the same code.
template <class S, class T>
static void evaluate_arrays(const ShaderEvaluation<T>* e) {
    typename S::Options options;
    if constexpr (kOptionSlots<S> > 0) std::memcpy(&options, e->options, sizeof options);
    for (std::int64_t i = 0; i < e->count; ++i) {
        typename S::template Params<T> params;
        T* slots = reinterpret_cast<T*>(&params);
        for (int k = 0; k < kFloatSlots<S>; ++k) slots[k] = e->params[k][i];
        Geometry<T> g;
        g.n = {e->n[0][i], e->n[1][i], e->n[2][i]};
        g.v = {e->v[0][i], e->v[1][i], e->v[2][i]};
        const T n_dot_v = dot(g.n, g.v);
        g.n_dot_v = clamp(n_dot_v, constant<T>(kMinCosine), T(1));
        g.ambient_occlusion = T(1);
        const bool has_tangent = e->tangent[0] != nullptr;
        Vec3<T> tangent{T(0), T(0), T(0)};
        if (has_tangent) tangent = {e->tangent[0][i], e->tangent[1][i], e->tangent[2][i]};
        finish_geometry<S, T>(g, has_tangent ? &tangent : nullptr);
        LightSample<T> s;
        s.l = {e->l[0][i], e->l[1][i], e->l[2][i]};
        s.n_dot_l = dot(g.n, s.l);
        s.v_dot_l = dot(g.v, s.l);
        const auto prepared = S::prepare(params, options, g);
        Lobes<T> f = evaluate_lobes<S, T>(prepared, options, g, s);
        const bool lit = S::lit_from_below || (s.n_dot_l > 0 && n_dot_v > 0);
        Color<T>* lobes[3] = {&f.diffuse, &f.specular, &f.transmission};
        T* const* outputs[3] = {e->diffuse, e->specular, e->transmission};
        for (int k = 0; k < 3; ++k) {
            outputs[k][0][i] = lit ? lobes[k]->x : T(0);
            outputs[k][1][i] = lit ? lobes[k]->y : T(0);
            outputs[k][2][i] = lit ? lobes[k]->z : T(0);
        }
    }
}

}  // namespace relume
