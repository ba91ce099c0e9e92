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
concept HasTerms = requires {
    S::terms[0];
};

template <class S> constexpr int term_count() {
    if constexpr (HasTerms<S>) return static_cast<int>(std::size(S::terms));
    else return 0;
}

/// A model that multiplies its terms by LightSample::arriving itself.
template <class S> constexpr bool scales_by_arriving() {
    if constexpr (requires { S::scales_by_arriving; }) return S::scales_by_arriving;
    else return false;
}

/// A model whose prepare() is dear (it looks things up) says `prepares_once = true`: its ambient and emission are kept
/// over the lights instead of being prepared anew.
template <class S> constexpr bool prepares_once() {
    if constexpr (requires { S::prepares_once; }) return S::prepares_once;
    else return false;
}

/// Calls f with a null pointer to the type that shades: S itself, or where one parameter table stands for several
/// models the one that S::with_variant() finds in the options. Variants share Params and Options with S.
template <class S, class F> RELUME_INLINE void with_variant(const typename S::Options& options, F&& f) {
    if constexpr (requires { S::has_variants; }) S::with_variant(options, f);
    else f(static_cast<S*>(nullptr));
}

/// Whether a model can have light in that lobe at all.
template <class S> constexpr bool has_lobe(Lobe lobe) {
    if constexpr (HasTerms<S>) {
        for (const Lobe term : S::terms)
            if (term == lobe) return true;
        return false;
    } else {
        return true;
    }
}

template <class S>
inline constexpr int kFloatSlots = static_cast<int>(sizeof(typename S::template Params<float>) / sizeof(float));
template <class S>
inline constexpr int kOptionSlots = std::is_empty_v<typename S::Options>
                                        ? 0
                                        : static_cast<int>(sizeof(typename S::Options) / sizeof(std::int32_t));

/// A model that looks things up has a struct Tables of TableViews, which its prepare() takes after the options.
struct NoTables {};
template <class S> struct TablesOf { using Type = NoTables; };
template <class S>
requires requires { typename S::Tables; }
struct TablesOf<S> {
    using Type = typename S::Tables;
};
template <class S> using Tables = typename TablesOf<S>::Type;
template <class S>
inline constexpr int kTableSlots = std::is_empty_v<Tables<S>> ? 0
                                                              : static_cast<int>(sizeof(Tables<S>) / sizeof(TableView));

/// Each parameter's slot lies in its struct, none overlap, and all are named: checked where the model is registered.
template <class S> constexpr bool table_matches_params() {
    bool floats[kFloatSlots<S> + 1] = {};
    bool options[kOptionSlots<S> + 1] = {};
    bool tables[kTableSlots<S> + 1] = {};
    for (const Parameter& p : S::parameters) {
        if (!p.is_number() && !p.is_option() && p.type != ParameterType::table) return false;
        const int limit = p.is_number() ? kFloatSlots<S> : p.is_option() ? kOptionSlots<S> : kTableSlots<S>;
        for (int k = 0; k < p.components(); ++k) {
            if (p.slot < 0 || p.slot + k >= limit) return false;
            bool& seen = (p.is_number() ? floats : p.is_option() ? options : tables)[p.slot + k];
            if (seen) return false;
            seen = true;
        }
    }
    for (int k = 0; k < kFloatSlots<S>; ++k)
        if (!floats[k]) return false;
    for (int k = 0; k < kOptionSlots<S>; ++k)
        if (!options[k]) return false;
    for (int k = 0; k < kTableSlots<S>; ++k)
        if (!tables[k]) return false;
    return true;
}

/// slot of a Params, Options or Tables member, for the parameter table.
#define RELUME_SLOT(member) static_cast<int>(offsetof(Params<float>, member) / sizeof(float))
#define RELUME_OPTION(member) static_cast<int>(offsetof(Options, member) / sizeof(std::int32_t))
#define RELUME_TABLE(member) static_cast<int>(offsetof(Tables, member) / sizeof(TableView))

/// f(std::integral_constant<int, 0>) … f(<N − 1>), unrolled before the optimiser splits arrays into registers, which a
/// loop is not.
template <int N, class F> RELUME_INLINE void static_for(F&& f) {
    [&]<int... K>(std::integer_sequence<int, K...>) RELUME_INLINE_LAMBDA { (f(std::integral_constant<int, K>{}), ...); }
    (std::make_integer_sequence<int, N>{});
}

/// The direction and the share of DirectLight::color that arrives, for one kind of light.
template <class T> RELUME_INLINE T spot_factor(const DirectLight& light, T cosine) {
    const T zero(0.f), one(1.f);
    const T outer(light.cone[0]), inv_width(light.cone[1]);
    switch (light.falloff) {
        case SpotFalloff::step:
            return select(cosine > outer, one, zero);
        case SpotFalloff::linear:  // in angle: Mitsuba's beam
            return saturate((T(light.cone[2]) - acos(clamp(cosine, -one, one))) * inv_width);
        default:
            break;
    }
    const T t = saturate((cosine - outer) * inv_width);
    const T smooth = t * t * fma(t, T(-2.f), T(3.f));
    return light.falloff == SpotFalloff::blender3 ? smooth * max(cosine, zero) : smooth;
}

template <class T> RELUME_INLINE Vec3<T> light_direction(const DirectLight& light, const Vec3<T>& p, T& falloff) {
    const Vec3<T> axis{T(light.to_light[0]), T(light.to_light[1]), T(light.to_light[2])};
    if (light.kind == LightKind::sun) {
        falloff = T(1.f);
        return axis;
    }
    const Vec3<T> d{T(light.position[0]) - p.x, T(light.position[1]) - p.y, T(light.position[2]) - p.z};
    const T r = rsqrt(fma(d.x, d.x, fma(d.y, d.y, fma(d.z, d.z, constant<T>(1e-24)))));
    const Vec3<T> l = scale(d, r);
    if (light.inverse_square) {
        falloff = r * r;
    } else {
        const T distance = rcp(r);
        falloff = rcp(
            fma(fma(T(light.attenuation[2]), distance, T(light.attenuation[1])), distance, T(light.attenuation[0])));
    }
    if (light.kind == LightKind::spot) falloff = falloff * spot_factor(light, dot(l, axis));
    return l;
}

/// A variant that shares its Params with others may leave some out: `static constexpr bool reads_slot(int slot)`.
template <class S> constexpr bool reads_slot(int slot) {
    if constexpr (requires { S::reads_slot(slot); }) return S::reads_slot(slot);
    else return slot >= 0;
}

/// Where a tile's parameters come from, without a branch: slot k of pixel i is at base[k] + (i & mask[k]), a constant's
/// mask is 0 and its base a batch of copies. `unread` lists those planes that the model leaves out.
template <class S, class T> struct SlotSources {
    static constexpr int kSlots = kFloatSlots<S>;
    const float* base[kSlots];
    std::ptrdiff_t mask[kSlots];
    int unread[kSlots];
    int unread_count = 0;
    alignas(64) float copies[kSlots][kWidth<T>];

    RELUME_INLINE explicit SlotSources(const ShaderTile& tile) {
        for (int k = 0; k < kSlots; ++k) {
            for (float& copy : copies[k]) copy = tile.constants[k];
            base[k] = tile.slots[k] != nullptr ? tile.slots[k] : copies[k];
            mask[k] = tile.slots[k] != nullptr ? -1 : 0;
            if (tile.slots[k] != nullptr && !reads_slot<S>(k)) unread[unread_count++] = k;
        }
    }
};

template <class S, class T>
RELUME_INLINE void load_params(typename S::template Params<T>& params, const SlotSources<S, T>& from, int i) {
    T* slots = reinterpret_cast<T*>(&params);
    static_for<kFloatSlots<S>>([&](auto k) RELUME_INLINE_LAMBDA {
        if constexpr (reads_slot<S>(k)) slots[k] = load<T>(from.base[k] + (i & from.mask[k]));
        else slots[k] = T(0.f);
    });
}

/// The model's uniform values, copied out of the tile or the evaluation.
template <class S, class From>
RELUME_INLINE void load_uniforms(const From& from, typename S::Options& options, Tables<S>& tables) {
    if constexpr (kOptionSlots<S> != 0) std::memcpy(&options, from.options, sizeof options);
    if constexpr (kTableSlots<S> != 0) std::memcpy(&tables, from.tables, sizeof tables);
}

template <class S, class T>
RELUME_INLINE auto prepare(const typename S::template Params<T>& params, const typename S::Options& options,
                           [[maybe_unused]] const Tables<S>& tables, const Geometry<T>& g) {
    if constexpr (kTableSlots<S> != 0) return S::prepare(params, options, tables, g);
    else return S::prepare(params, options, g);
}

/// The sum of a pixel's parameters, on two chains: one would be as long as the shading.
template <class S, class T> RELUME_INLINE T sum_of(const typename S::template Params<T>& params) {
    const T* slots = reinterpret_cast<const T*>(&params);
    T sum[2] = {T(0.f), T(0.f)};
    static_for<kFloatSlots<S>>([&](auto k) RELUME_INLINE_LAMBDA {
        if constexpr (reads_slot<S>(k)) sum[k % 2] = sum[k % 2] + slots[k];
    });
    return sum[0] + sum[1];
}

/// Fetches the line that the batch kPrefetchDistance pixels on will read: a CPU's own prefetching follows a dozen
/// planes too late. It may point past the plane, where nothing is fetched.
template <class T> RELUME_INLINE void prefetch_ahead(const float* p) {
    constexpr int kPrefetchDistance = 256, kLine = 16;
    if constexpr (kWidth<T> == 1) return;  // sixteen times a line, for nothing
    for (int k = 0; k < kWidth<T> || k == 0; k += kLine) __builtin_prefetch(p + kPrefetchDistance + k);
}

template <class S, class T>
RELUME_INLINE void prefetch_inputs(const ShaderTile& tile, const SlotSources<S, T>& from, int i) {
    for (int k = 0; k < 3; ++k) {
        prefetch_ahead<T>(tile.normal[k] + i);
        if (tile.position[0] != nullptr) prefetch_ahead<T>(tile.position[k] + i);
    }
    static_for<kFloatSlots<S>>([&](auto k) RELUME_INLINE_LAMBDA {
        if constexpr (reads_slot<S>(k)) prefetch_ahead<T>(from.base[k] + (i & from.mask[k]));
    });
}

template <class T> RELUME_INLINE Vec3<T> load3(const float* const (&planes)[3], int i) {
    return {load<T>(planes[0] + i), load<T>(planes[1] + i), load<T>(planes[2] + i)};
}

template <class T> RELUME_INLINE void accumulate(Color<T>& sum, const float (&color)[3], T weight) {
    sum.x = fma(T(color[0]), weight, sum.x);
    sum.y = fma(T(color[1]), weight, sum.y);
    sum.z = fma(T(color[2]), weight, sum.z);
}

template <class T> RELUME_INLINE void accumulate(Color<T>& sum, const Color<T>& f, const float (&color)[3], T weight) {
    sum.x = fma(f.x * weight, T(color[0]), sum.x);
    sum.y = fma(f.y * weight, T(color[1]), sum.y);
    sum.z = fma(f.z * weight, T(color[2]), sum.z);
}

/// Up to this many terms are summed apart over the lights; beyond, registers run out and each light's lobes are summed.
inline constexpr int kMaxSummedTerms = 4;

template <class S, class T>
RELUME_INLINE Lobes<T> evaluate_lobes(const typename S::template Prepared<T>& prepared,
                                      const typename S::Options& options, const Geometry<T>& g,
                                      const LightSample<T>& s) {
    if constexpr (HasTerms<S>) {
        T w[term_count<S>()];
        S::evaluate(prepared, options, g, s, w);
        Lobes<T> out{splat(T(0.f)), splat(T(0.f)), splat(T(0.f))};
        static_for<term_count<S>()>([&](auto k) RELUME_INLINE_LAMBDA {
            constexpr Lobe lobe = S::terms[k];
            Color<T>& sum = lobe == Lobe::diffuse    ? out.diffuse
                            : lobe == Lobe::specular ? out.specular
                                                     : out.transmission;
            sum = fma(prepared.color[k], w[k], sum);
        });
        return out;
    } else {
        return S::evaluate(prepared, options, g, s);
    }
}

template <class T>
RELUME_INLINE void put3(float* const (&planes)[3], int i, Color<T> value, const T* weight, bool accumulate) {
    if (weight != nullptr) value = scale(value, *weight);
    if (accumulate) value = add(value, {load<T>(planes[0] + i), load<T>(planes[1] + i), load<T>(planes[2] + i)});
    store(planes[0] + i, value.x);
    store(planes[1] + i, value.y);
    store(planes[2] + i, value.z);
}

/// Pixels [i, i + kWidth) of the tile. Returns how many of the first `lanes` read NaN or infinity.
template <class S, class T, bool kIsotropic>
RELUME_INLINE int shade_batch(const ShaderTile& tile, const SlotSources<S, T>& sources,
                              const typename S::Options& options, const Tables<S>& tables, int i, int mask_offset,
                              int lanes) {
    const T zero(0.f), one(1.f);
    prefetch_inputs<S, T>(tile, sources, i);
    Geometry<T> g;
    const Vec3<T> normal = load3<T>(tile.normal, i);
    const T length2 = dot(normal, normal);
    T poison = length2;  // the sum of all that is read: NaN or infinity where any of it is
    const MaskOf<T> surface = length2 > constant<T>(1e-12);
    g.n = scale(normal, rsqrt(max(length2, constant<T>(1e-12))));

    Vec3<T> p{zero, zero, zero};
    if (tile.position[0] != nullptr) {
        p = load3<T>(tile.position, i);
        poison = poison + (p.x + p.y + p.z);
    }
    const Vec3<T> eye{T(tile.eye[0]), T(tile.eye[1]), T(tile.eye[2])};
    if (tile.view[0] != nullptr) g.v = load3<T>(tile.view, i);
    else if (tile.constant_view) g.v = eye;
    else g.v = normalize(sub(eye, p));

    const T n_dot_v = dot(g.n, g.v);
    poison = poison + n_dot_v;
    g.n_dot_v = clamp(n_dot_v, constant<T>(kMinCosine), one);
    g.isotropic = kIsotropic;
    g.ambient_occlusion = one;
    if (tile.ambient_occlusion != nullptr) {
        g.ambient_occlusion = load<T>(tile.ambient_occlusion + i);
        poison = poison + g.ambient_occlusion;
    }
    g.tangent = splat(zero);
    if constexpr (S::needs_tangent) {
        if (tile.tangent[0] != nullptr) {
            g.tangent = load3<T>(tile.tangent, i);
            poison = poison + (g.tangent.x + g.tangent.y + g.tangent.z);
        }
    }

    if constexpr (requires { S::reads_slot(0); })  // NaN in what the model leaves out counts all the same
        for (int k = 0; k < sources.unread_count; ++k) poison = poison + load<T>(sources.base[sources.unread[k]] + i);
    typename S::template Params<T> params;
    load_params<S, T>(params, sources, i);
    if constexpr (prepares_once<S>()) poison = poison + sum_of<S, T>(params);
    const auto prepared = prepare<S, T>(params, options, tables, g);

    constexpr bool kSum = HasTerms<S> && term_count<S>() <= kMaxSummedTerms;
    constexpr int kSums = kSum ? term_count<S>() : 3;
    Color<T> sums[kSums];
    static_for<kSums>([&](auto k) RELUME_INLINE_LAMBDA { sums[k] = splat(zero); });

    for (const DirectLight* light = tile.lights; light != tile.lights + tile.light_count; ++light) {
        LightSample<T> s;
        s.l = light_direction(*light, p, s.arriving);
        s.n_dot_l = dot(g.n, s.l);
        if constexpr (!S::lit_from_below) {
            if (!any(s.n_dot_l > zero)) continue;
        }
        s.v_dot_l = dot(g.v, s.l);
        if (light->mask != nullptr) s.arriving = s.arriving * load_partial<T>(light->mask + mask_offset, lanes);
        if constexpr (kSum) {
            T w[kSums];
            S::evaluate(prepared, options, g, s, w);
            static_for<kSums>([&](auto k) RELUME_INLINE_LAMBDA {
                const T weight = scales_by_arriving<S>() ? w[k] : w[k] * s.arriving;
                accumulate(sums[k], light->color[static_cast<int>(S::terms[k])], weight);
            });
        } else {
            const Lobes<T> f = evaluate_lobes<S, T>(prepared, options, g, s);
            const T arriving = scales_by_arriving<S>() ? T(1.f) : s.arriving;
            accumulate(sums[0], f.diffuse, light->color[0], arriving);
            accumulate(sums[1], f.specular, light->color[1], arriving);
            accumulate(sums[2], f.transmission, light->color[2], arriving);
        }
    }

    // What the lights do not need is prepared only now, from the parameters read again (the cache has them): kept over
    // the loop it would be stored and loaded. What of the two prepare() is not used, the optimiser drops.
    const auto after = [&]() RELUME_INLINE_LAMBDA {
        if constexpr (prepares_once<S>()) {
            return prepared;
        } else {
            typename S::template Params<T> params_after;
            load_params<S, T>(params_after, sources, opaque(i));
            poison = poison + sum_of<S, T>(params_after);
            return prepare<S, T>(params_after, options, tables, g);
        }
    }();

    Color<T> lobes[3] = {splat(zero), splat(zero), splat(zero)};
    if constexpr (kSum) {
        static_for<kSums>([&](auto k) RELUME_INLINE_LAMBDA {
            Color<T>& lobe = lobes[static_cast<int>(S::terms[k])];
            // By name: of two products under a sum the compiler chooses one to fuse, and not always the same.
            const Color<T>&color = after.color[k], &sum = sums[k];
            lobe = {fma(color.x, sum.x, lobe.x), fma(color.y, sum.y, lobe.y), fma(color.z, sum.z, lobe.z)};
        });
    } else {
        static_for<3>([&](auto k) RELUME_INLINE_LAMBDA { lobes[k] = sums[k]; });
    }
    Color<T> reflected = splat(zero);  // of lights without a direction
    if (tile.ambient_count > 0) {
        Color<T> irradiance = splat(zero);
        for (const AmbientLight* light = tile.ambients; light != tile.ambients + tile.ambient_count; ++light) {
            const Vec3<T> axis{T(light->axis[0]), T(light->axis[1]), T(light->axis[2])};
            const T c = dot(g.n, axis);
            const T w = light->clamp ? max(c, zero) : fma(c, constant<T>(0.5), constant<T>(0.5));
            const T m = light->mask != nullptr ? load_partial<T>(light->mask + mask_offset, lanes) : one;
            irradiance.x = fma(m, lerp(T(light->low[0]), T(light->high[0]), w), irradiance.x);
            irradiance.y = fma(m, lerp(T(light->low[1]), T(light->high[1]), w), irradiance.y);
            irradiance.z = fma(m, lerp(T(light->low[2]), T(light->high[2]), w), irradiance.z);
        }
        reflected = scale(mul(after.ambient, irradiance), g.ambient_occlusion);
        poison = poison + (reflected.x + reflected.y + reflected.z);
    }

    // Catches what overflowed on the way as well. Selects, not products: an invalid lane may hold NaN.
    Color<T> sum = after.emission;
    static_for<3>([&](auto k) RELUME_INLINE_LAMBDA {
        if constexpr (has_lobe<S>(static_cast<Lobe>(int(k)))) sum = add(sum, lobes[k]);
    });
    poison = (poison + (sum.x + sum.y + sum.z)) * zero;
    const MaskOf<T> bad = is_nan(poison);
    const MaskOf<T> valid = surface && !bad;
    MaskOf<T> lit = valid;
    if constexpr (!S::lit_from_below) lit = valid && n_dot_v > zero;  // a lobe is 0 where the viewer is below
    static_for<3>([&](auto k) RELUME_INLINE_LAMBDA {
        if constexpr (has_lobe<S>(static_cast<Lobe>(int(k)))) lobes[k] = select(lit, lobes[k], splat(zero));
    });

    if (tile.ambient_count > 0) lobes[0] = add(lobes[0], select(valid, reflected, splat(zero)));

    T weight_value = one;
    const T* weight = nullptr;
    if (tile.weight != nullptr) {
        weight_value = load<T>(tile.weight + i);
        weight = &weight_value;
    }
    if (tile.total[0] != nullptr) {
        Color<T> total = lobes[0];
        if constexpr (has_lobe<S>(Lobe::specular)) total = add(total, lobes[1]);
        if constexpr (has_lobe<S>(Lobe::transmission)) total = add(total, lobes[2]);
        if (tile.emission) total = add(total, select(valid, after.emission, splat(zero)));
        put3(tile.total, i, total, weight, tile.accumulate != 0);
    }
    static_for<3>([&](auto k) RELUME_INLINE_LAMBDA {
        if (tile.lobe[k][0] != nullptr) put3(tile.lobe[k], i, lobes[k], weight, tile.accumulate != 0);
    });

    if (!any(bad)) [[likely]]
        return 0;
    alignas(64) float flags[kWidth<T>];
    store(flags, select(bad, one, zero));
    int count = 0;
    for (int k = 0; k < kWidth<T> && k < lanes; ++k) count += flags[k] != 0.f;
    return count;
}

/// Calls f on every input plane of the tile.
template <class S, class T, class F> void for_each_input(ShaderTile& tile, SlotSources<S, T>& sources, F&& f) {
    for (auto* group : {tile.normal, tile.position, tile.view, tile.tangent})
        for (int k = 0; k < 3; ++k) f(group[k]);
    f(tile.ambient_occlusion);
    f(tile.weight);
    for (int k = 0; k < kFloatSlots<S>; ++k)
        if (sources.mask[k] != 0) f(sources.base[k]);
}

/// The last count mod kWidth pixels, in padded copies: the same batch code as everywhere, so that a pixel's bits do not
/// depend on where the tile ends.
template <class T> struct Tail {
    static constexpr int kPlanes = 3 * 4 + 2 + 64;
    alignas(64) float inputs[kPlanes][kWidth<T>];
    alignas(64) float outputs[12][kWidth<T>];
};

// Internal linkage and flattened: see relume_isa_objects() in cmake/RelumeShader.cmake.
template <class S, class T> __attribute__((flatten)) static void shade_tile_with(ShaderTile* tile) {
    static_assert(kFloatSlots<S> <= 64, "Tail has room for 64 slots");
    typename S::Options options;
    Tables<S> tables;
    load_uniforms<S>(*tile, options, tables);
    const int whole = tile->count / kWidth<T> * kWidth<T>;
    const int rest = tile->count - whole;
    // A model with anisotropy names its slot, and has a kernel without it for where it is 0 all over.
    bool isotropic = true;
    if constexpr (requires { S::anisotropy_slot; })
        isotropic = tile->slots[S::anisotropy_slot] == nullptr && tile->constants[S::anisotropy_slot] == 0.f;
    std::int64_t nonfinite = 0;

    ShaderTile work = *tile;
    SlotSources<S, T> sources(*tile);
    Tail<T> tail;
    // Twice through one loop, the second time over the tail, so that the kernel is there once.
    for (int pass = 0, begin = 0, end = whole; pass<2; ++pass, end = rest> 0 ? kWidth<T> : 0) {
        if (pass == 1 && rest > 0) {
            int used = 0;
            for_each_input<S, T>(work, sources, [&](const float*& plane) {
                if (plane == nullptr) return;
                for (int k = 0; k < kWidth<T>; ++k) tail.inputs[used][k] = plane[whole + (k < rest ? k : rest - 1)];
                plane = tail.inputs[used++];
            });
            used = 0;
            const auto output = [&](float*& plane) {
                if (plane == nullptr) return;
                for (int k = 0; k < kWidth<T>; ++k)
                    tail.outputs[used][k] = k < rest && work.accumulate ? plane[whole + k] : 0.f;
                plane = tail.outputs[used++];
            };
            for (float*& plane : work.total) output(plane);
            for (auto& lobe : work.lobe)
                for (float*& plane : lobe) output(plane);
        }
        const int offset = pass == 0 ? 0 : whole;
        const auto shade = [&](auto without_anisotropy) RELUME_INLINE_LAMBDA {
            for (int i = begin; i < end; i += kWidth<T>)
                nonfinite += shade_batch<S, T, without_anisotropy>(work, sources, options, tables, i, offset + i,
                                                                   pass == 0 ? kWidth<T> : rest);
        };
        if constexpr (requires { S::anisotropy_slot; }) {
            if (isotropic) shade(std::true_type{});
            else shade(std::false_type{});
        } else {
            shade(std::true_type{});
        }
    }
    if (rest > 0) {
        int used = 0;
        const auto copy_back = [&](float* plane) {
            if (plane == nullptr) return;
            for (int k = 0; k < rest; ++k) plane[whole + k] = tail.outputs[used][k];
            ++used;
        };
        for (float* plane : tile->total) copy_back(plane);
        for (auto& lobe : tile->lobe)
            for (float* plane : lobe) copy_back(plane);
    }
    tile->nonfinite = nonfinite;
}

/// A model that is too large for pairs of batches says `single_batches = true`.
template <class S> constexpr bool single_batches() {
    if constexpr (requires { S::single_batches; }) return S::single_batches;
    else return false;
}

/// The number type for a tile: one batch or a pair of them, by the light count alone, so that all tiles of a frame
/// agree.
template <class S, class T> static void shade_tile_of(ShaderTile* tile) {
#if defined(RELUME_ISA_BATCH) && !defined(RELUME_SINGLE_BATCHES)
    if constexpr (!single_batches<S>()) {
#  if defined(__AVX512F__)
        // 32 registers hold one batch's pixel; a pair's spill, which pays from four lights on.
        if (tile->light_count < 4) return shade_tile_with<S, T>(tile);
#  endif
        return shade_tile_with<S, Pair<T>>(tile);
    }
#endif
    shade_tile_with<S, T>(tile);
}

template <class S, class T> static void shade_tile(ShaderTile* tile) {
    typename S::Options options;
    if constexpr (kOptionSlots<S> != 0) std::memcpy(&options, tile->options, sizeof options);
    with_variant<S>(options, [&](auto* variant) RELUME_INLINE_LAMBDA {
        shade_tile_of<std::remove_pointer_t<decltype(variant)>, T>(tile);
    });
}

/// f·NdotL on arrays, by the same code.
template <class S, class T> static void evaluate_arrays_of(const ShaderEvaluation<T>* e) {
    typename S::Options options;
    Tables<S> tables;
    load_uniforms<S>(*e, options, tables);
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
        g.isotropic = false;
        g.tangent = splat(T(0));
        if (e->tangent[0] != nullptr) g.tangent = {e->tangent[0][i], e->tangent[1][i], e->tangent[2][i]};
        LightSample<T> s;
        s.l = {e->l[0][i], e->l[1][i], e->l[2][i]};
        s.n_dot_l = dot(g.n, s.l);
        s.v_dot_l = dot(g.v, s.l);
        s.arriving = T(1);
        const auto prepared = prepare<S, T>(params, options, tables, g);
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

template <class S, class T> static void evaluate_arrays(const ShaderEvaluation<T>* e) {
    typename S::Options options;
    if constexpr (kOptionSlots<S> != 0) std::memcpy(&options, e->options, sizeof options);
    with_variant<S>(options, [&](auto* variant) RELUME_INLINE_LAMBDA {
        evaluate_arrays_of<std::remove_pointer_t<decltype(variant)>, T>(e);
    });
}

}  // namespace relume
