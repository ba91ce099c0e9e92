// SPDX-License-Identifier: Apache-2.0
// Compiled once per instruction set.
#include "relight/compose_kernel.h"

#include "relume/shading/register.h"

namespace relume {
namespace {

template <class T> RELUME_INLINE T finite_or_zero(T x, T& poison) {
    const T p = x * T(0.f);
    poison = poison + p;
    return select(is_nan(p), T(0.f), x);
}

template <class T> RELUME_INLINE int count_lanes(MaskOf<T> mask, int lanes) {
    alignas(64) float flags[kWidth<T>];
    store(flags, select(mask, T(1.f), T(0.f)));
    int n = 0;
    for (int k = 0; k < kWidth<T>; ++k) n += k < lanes && flags[k] != 0.f;
    return n;
}

/// `stream`: past the cache, where p is aligned to a batch.
template <class T> RELUME_INLINE void put(float* p, T x, int lanes, bool stream) {
    if (lanes >= kWidth<T>) [[likely]] {
        if (stream) store_streaming(p, x);
        else store(p, x);
        return;
    }
    alignas(64) float padded[kWidth<T>];
    store(padded, x);
    for (int k = 0; k < lanes; ++k) p[k] = padded[k];
}

template <class T> RELUME_INLINE Vec3<T> load3_or_zero(const float* const (&planes)[3], int i, int lanes) {
    if (planes[0] == nullptr) return splat(T(0.f));
    return {load_partial<T>(planes[0] + i, lanes), load_partial<T>(planes[1] + i, lanes),
            load_partial<T>(planes[2] + i, lanes)};
}

/// Pixels to the first at which all planes that are written lie at the start of a batch, or −1 where there is none.
template <class T> int pixels_to_alignment(const ComposeTile& tile) {
    constexpr std::uintptr_t kBytes = kWidth<T> * sizeof(float);
    const auto offset = [](const float* p) { return reinterpret_cast<std::uintptr_t>(p) % kBytes; };
    const std::uintptr_t first = offset(tile.rgba[0]);
    for (const float* plane : tile.rgba)
        if (plane != nullptr && offset(plane) != first) return -1;
    if (first % sizeof(float) != 0) return -1;
    return static_cast<int>((kBytes - first) % kBytes / sizeof(float));
}

/// kPlain: no coverage, alpha or beauty, so that nothing is beside the surface.
template <class T, bool kPlain> RELUME_INLINE void compose_with(ComposeTile* tile) {
    const T zero(0.f), one(1.f);
    tile->shaded = 0;
    tile->nonfinite = 0;
    bool stream = tile->stream != 0;
    int lanes = kWidth<T>;
    if (stream && !tile->interleaved) {
        const int head = pixels_to_alignment<T>(*tile);
        stream = head >= 0;
        if (head > 0) lanes = head;
    }
    for (int i = 0; i < tile->count; i += lanes, lanes = kWidth<T>) {
        lanes = tile->count - i < lanes ? tile->count - i : lanes;
        const Vec3<T> n = load3_or_zero<T>(tile->normal, i, lanes);
        // A normal of NaN is no background: the kernel has blacked the pixel and counted it.
        const MaskOf<T> background = dot(n, n) <= constant<T>(1e-12);
        const Vec3<T> light = load3_or_zero<T>(tile->light, i, lanes);
        T cover = select(background, zero, one), alpha = one;
        Vec3<T> rgb = light;  // 0 on background
        if constexpr (!kPlain) {
            T poison = zero;
            if (tile->coverage != nullptr)
                cover = select(background, zero,
                               saturate(finite_or_zero(load_partial<T>(tile->coverage + i, lanes), poison)));
            if (tile->alpha != nullptr) alpha = finite_or_zero(load_partial<T>(tile->alpha + i, lanes), poison);
            Vec3<T> beauty = load3_or_zero<T>(tile->beauty, i, lanes);
            beauty = {finite_or_zero(beauty.x, poison), finite_or_zero(beauty.y, poison),
                      finite_or_zero(beauty.z, poison)};
            // What shows beside the surface. Under a transparent film alpha is the coverage and nothing does; where the
            // film is opaque (alpha 1) the beauty stands for it, so that silhouettes before a bright background get no
            // dark fringe. A true division: the background passes through to the bit.
            const T beside =
                select(alpha > zero, max(alpha - cover, zero) / max(alpha, constant<T>(1e-20)), one - cover);
            const T keep = tile->add ? one : beside;
            rgb = {fma(light.x, cover, beauty.x * keep), fma(light.y, cover, beauty.y * keep),
                   fma(light.z, cover, beauty.z * keep)};
            if (any(is_nan(poison))) [[unlikely]]
                tile->nonfinite += count_lanes<T>(is_nan(poison), lanes);
        }

        if (tile->interleaved) {
            store_interleaved(tile->rgba[0] + 4 * i, rgb.x, rgb.y, rgb.z, alpha, lanes, stream);
        } else {
            put(tile->rgba[0] + i, rgb.x, lanes, stream);
            put(tile->rgba[1] + i, rgb.y, lanes, stream);
            put(tile->rgba[2] + i, rgb.z, lanes, stream);
            if (tile->rgba[3] != nullptr) put(tile->rgba[3] + i, alpha, lanes, stream);
        }
        if (tile->cover != nullptr) put(tile->cover + i, cover, lanes, false);
        const MaskOf<T> seen = cover > zero;
        if (lanes >= kWidth<T> && all(seen)) [[likely]]
            tile->shaded += kWidth<T>;
        else if (any(seen)) tile->shaded += count_lanes<T>(seen, lanes);
    }
}

template <class T> __attribute__((flatten)) void compose(ComposeTile* tile) {
    if (tile->coverage == nullptr && tile->alpha == nullptr && tile->beauty[0] == nullptr) compose_with<T, true>(tile);
    else compose_with<T, false>(tile);
}

}  // namespace
}  // namespace relume

#if defined(RELUME_ISA_BATCH)
extern "C" void RELUME_KERNEL(compose, RELUME_ISA_ID)(relume::ComposeTile* tile) {
    relume::compose<relume::Batch<RELUME_ISA_BATCH>>(tile);
}
#else
extern "C" void RELUME_KERNEL(compose, scalar)(relume::ComposeTile* tile) { relume::compose<float>(tile); }
#endif
