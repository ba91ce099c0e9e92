// SPDX-License-Identifier: Apache-2.0
#pragma once

// Where a tile's parameters come from: planes of the G-buffer and constants, loaded into a model's Params.

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "relume/shader_abi.h"
#include "relume/shading/simd.h"

namespace relume {

template <class S>
inline constexpr int kFloatSlots = static_cast<int>(sizeof(typename S::template Params<float>) / sizeof(float));
template <class S>
inline constexpr int kOptionSlots = std::is_empty_v<typename S::Options>
                                        ? 0
                                        : static_cast<int>(sizeof(typename S::Options) / sizeof(std::int32_t));

/// f(std::integral_constant<int, 0>) … f(<N − 1>), unrolled before the optimiser splits arrays into registers, which a
/// loop is not.
template <int N, class F> RELUME_INLINE void static_for(F&& f) {
    [&]<int... K>(std::integer_sequence<int, K...>) RELUME_INLINE_LAMBDA { (f(std::integral_constant<int, K>{}), ...); }
    (std::make_integer_sequence<int, N>{});
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

}  // namespace relume
