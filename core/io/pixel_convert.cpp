// SPDX-License-Identifier: Apache-2.0
#include "io/pixel_convert.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>

#if defined(__x86_64__) && !defined(RELUME_NO_SIMD)
#  include <immintrin.h>
#endif

namespace relume::io {

namespace {

template <typename T> T load(const std::byte* from) {
    T value;
    std::memcpy(&value, from, sizeof value);
    return value;
}

template <typename T> void store(std::byte* to, T value) { std::memcpy(to, &value, sizeof value); }

std::uint32_t float_to_uint(float value) {
    constexpr float kLimit = 4294967296.0f;
    if (!(value > 0)) {
        return 0;
    }
    return value >= kLimit ? 0xffffffffu : static_cast<std::uint32_t>(value);
}

#if defined(__x86_64__) && !defined(RELUME_NO_SIMD)
#  define RELUME_IO_F16C 1

// Every processor with AVX2 has F16C, which not every compiler knows how to ask for.
const bool has_f16c = __builtin_cpu_supports("avx2") != 0;

__attribute__((target("avx2,f16c"))) std::size_t halves_to_floats_f16c(const std::byte* halves, std::byte* floats,
                                                                       std::size_t count) {
    std::size_t i = 0;
    for (; i + 16 <= count; i += 16) {
        const __m128i a = _mm_loadu_si128(reinterpret_cast<const __m128i*>(halves + 2 * i));
        const __m128i b = _mm_loadu_si128(reinterpret_cast<const __m128i*>(halves + 2 * i + 16));
        _mm256_storeu_ps(reinterpret_cast<float*>(floats + 4 * i), _mm256_cvtph_ps(a));
        _mm256_storeu_ps(reinterpret_cast<float*>(floats + 4 * i + 32), _mm256_cvtph_ps(b));
    }
    return i;
}

__attribute__((target("avx2,f16c"))) std::size_t floats_to_halves_f16c(const std::byte* floats, std::byte* halves,
                                                                       std::size_t count) {
    const __m256 sign = _mm256_set1_ps(-0.0f), most = _mm256_set1_ps(65504.0f);
    const __m256 infinity = _mm256_set1_ps(std::numeric_limits<float>::infinity());
    std::size_t i = 0;
    for (; i + 8 <= count; i += 8) {
        __m256 a = _mm256_loadu_ps(reinterpret_cast<const float*>(floats + 4 * i));
        const __m256 magnitude = _mm256_andnot_ps(sign, a);
        const __m256 over =
            _mm256_and_ps(_mm256_cmp_ps(magnitude, most, _CMP_GT_OQ), _mm256_cmp_ps(magnitude, infinity, _CMP_LT_OQ));
        a = _mm256_blendv_ps(a, _mm256_or_ps(_mm256_and_ps(sign, a), most), over);
        _mm_storeu_si128(reinterpret_cast<__m128i*>(halves + 2 * i),
                         _mm256_cvtps_ph(a, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC));
    }
    return i;
}

// Every third of 24 values (every fourth of 32) stands in a lane of its own: blends and one permutation collect them.
// Loads reach up to three values past the last one wanted, so the end of a run is left to the caller.
__attribute__((target("avx2"))) std::size_t gather_triples_avx2(const std::byte* from, std::byte* to,
                                                                std::size_t count) {
    const __m256i order = _mm256_setr_epi32(0, 3, 6, 1, 4, 7, 2, 5);
    std::size_t i = 0;
    for (; i + 9 <= count; i += 8, from += 96) {
        const auto* at = reinterpret_cast<const float*>(from);
        const __m256 two = _mm256_blend_ps(_mm256_loadu_ps(at), _mm256_loadu_ps(at + 8), 0b10010010);
        const __m256 all = _mm256_blend_ps(two, _mm256_loadu_ps(at + 16), 0b00100100);
        _mm256_storeu_ps(reinterpret_cast<float*>(to + 4 * i), _mm256_permutevar8x32_ps(all, order));
    }
    return i;
}

__attribute__((target("avx2"))) std::size_t gather_quads_avx2(const std::byte* from, std::byte* to, std::size_t count) {
    const __m256i order = _mm256_setr_epi32(0, 4, 1, 5, 2, 6, 3, 7);
    std::size_t i = 0;
    for (; i + 9 <= count; i += 8, from += 128) {
        const auto* at = reinterpret_cast<const float*>(from);
        const __m256 low = _mm256_shuffle_ps(_mm256_loadu_ps(at), _mm256_loadu_ps(at + 8), 0);
        const __m256 high = _mm256_shuffle_ps(_mm256_loadu_ps(at + 16), _mm256_loadu_ps(at + 24), 0);
        const __m256 all = _mm256_shuffle_ps(low, high, _MM_SHUFFLE(2, 0, 2, 0));
        _mm256_storeu_ps(reinterpret_cast<float*>(to + 4 * i), _mm256_permutevar8x32_ps(all, order));
    }
    return i;
}
#endif

// Blocks of strided runs pass through a buffer of this many values, so that the conversions above always see
// contiguous memory.
constexpr std::size_t kBlock = 256;

template <typename T> void gather(const std::byte* from, std::ptrdiff_t stride, std::byte* to, std::size_t count) {
    std::size_t i = 0;
#if RELUME_IO_F16C
    if constexpr (sizeof(T) == 4) {
        if (has_f16c && stride == 12) i = gather_triples_avx2(from, to, count);
        if (has_f16c && stride == 16) i = gather_quads_avx2(from, to, count);
        from += static_cast<std::ptrdiff_t>(i) * stride;
    }
#endif
    for (; i < count; ++i, from += stride) {
        store(to + i * sizeof(T), load<T>(from));
    }
}

template <typename T> void scatter(const std::byte* from, std::byte* to, std::ptrdiff_t stride, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i, to += stride) {
        store(to, load<T>(from + i * sizeof(T)));
    }
}

void convert_contiguous(const std::byte* from, PixelType from_type, std::byte* to, PixelType to_type,
                        std::size_t count) {
    using enum PixelType;
    if (from_type == to_type) {
        std::memcpy(to, from, count * size_of(to_type));
    } else if (from_type == half && to_type == float32) {
        halves_to_floats(from, to, count);
    } else if (from_type == float32 && to_type == half) {
        floats_to_halves(from, to, count);
    } else if (from_type == half) {
        for (std::size_t i = 0; i < count; ++i) {
            store(to + 4 * i, float_to_uint(half_to_float(load<std::uint16_t>(from + 2 * i))));
        }
    } else if (from_type == float32) {
        for (std::size_t i = 0; i < count; ++i) {
            store(to + 4 * i, float_to_uint(load<float>(from + 4 * i)));
        }
    } else if (to_type == float32) {
        for (std::size_t i = 0; i < count; ++i) {
            store(to + 4 * i, static_cast<float>(load<std::uint32_t>(from + 4 * i)));
        }
    } else {
        for (std::size_t i = 0; i < count; ++i) {
            store(to + 2 * i, float_to_half(static_cast<float>(load<std::uint32_t>(from + 4 * i))));
        }
    }
}

}  // namespace

float half_to_float(std::uint16_t half) {
    const std::uint32_t sign = static_cast<std::uint32_t>(half & 0x8000u) << 16;
    const std::uint32_t magnitude = half & 0x7fffu;
    if (magnitude >= 0x7c00u) {  // infinity, NaN
        const std::uint32_t quiet = magnitude > 0x7c00u ? 0x400000u : 0u;
        return std::bit_cast<float>(sign | 0x7f800000u | quiet | ((magnitude & 0x3ffu) << 13));
    }
    if (magnitude < 0x400u) {  // zero, subnormal: units of 2^-24
        const float value = static_cast<float>(magnitude) * 0x1p-24f;
        return std::bit_cast<float>(sign | std::bit_cast<std::uint32_t>(value));
    }
    return std::bit_cast<float>(sign | ((magnitude << 13) + ((127u - 15u) << 23)));
}

std::uint16_t float_to_half(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    const auto sign = static_cast<std::uint16_t>((bits >> 16) & 0x8000u);
    const std::uint32_t magnitude = bits & 0x7fffffffu;
    if (magnitude > 0x7f800000u) {
        return static_cast<std::uint16_t>(sign | 0x7e00u | ((magnitude >> 13) & 0x3ffu));
    }
    if (magnitude >= 0x477fe000u) {  // 65504, the largest half
        return static_cast<std::uint16_t>(sign | (magnitude == 0x7f800000u ? 0x7c00u : 0x7bffu));
    }
    if (magnitude < 0x38800000u) {  // below 2^-14: adding 0.5 makes the float's last bit worth 2^-24
        const float shifted = std::bit_cast<float>(magnitude) + 0.5f;
        return static_cast<std::uint16_t>(sign | (std::bit_cast<std::uint32_t>(shifted) - 0x3f000000u));
    }
    const std::uint32_t rebased = magnitude - ((127u - 15u) << 23);
    const std::uint32_t odd = (rebased >> 13) & 1u;
    return static_cast<std::uint16_t>(sign | ((rebased + 0xfffu + odd) >> 13));
}

void halves_to_floats(const std::byte* halves, std::byte* floats, std::size_t count, bool scalar) {
    std::size_t i = 0;
#if RELUME_IO_F16C
    if (has_f16c && !scalar) {
        i = halves_to_floats_f16c(halves, floats, count);
    }
#else
    static_cast<void>(scalar);
#endif
    for (; i < count; ++i) {
        store(floats + 4 * i, half_to_float(load<std::uint16_t>(halves + 2 * i)));
    }
}

void floats_to_halves(const std::byte* floats, std::byte* halves, std::size_t count, bool scalar) {
    std::size_t i = 0;
#if RELUME_IO_F16C
    if (has_f16c && !scalar) {
        i = floats_to_halves_f16c(floats, halves, count);
    }
#else
    static_cast<void>(scalar);
#endif
    for (; i < count; ++i) {
        store(halves + 2 * i, float_to_half(load<float>(floats + 4 * i)));
    }
}

void convert_run(ConstRun from, Run to, std::size_t count) {
    const auto from_size = static_cast<std::ptrdiff_t>(size_of(from.type));
    const auto to_size = static_cast<std::ptrdiff_t>(size_of(to.type));
    const bool gathers = from.stride != from_size;
    const bool scatters = to.stride != to_size;
    if (!gathers && !scatters) {
        convert_contiguous(from.data, from.type, to.data, to.type, count);
        return;
    }
    if (!scatters && from.type == to.type) {
        from_size == 2 ? gather<std::uint16_t>(from.data, from.stride, to.data, count)
                       : gather<std::uint32_t>(from.data, from.stride, to.data, count);
        return;
    }
    alignas(32) std::array<std::byte, kBlock * 4> source;
    alignas(32) std::array<std::byte, kBlock * 4> converted;
    for (std::size_t done = 0; done < count; done += kBlock) {
        const std::size_t block = std::min(kBlock, count - done);
        const std::byte* in = from.data + static_cast<std::ptrdiff_t>(done) * from.stride;
        std::byte* out = to.data + static_cast<std::ptrdiff_t>(done) * to.stride;
        if (gathers) {
            from_size == 2 ? gather<std::uint16_t>(in, from.stride, source.data(), block)
                           : gather<std::uint32_t>(in, from.stride, source.data(), block);
            in = source.data();
        }
        if (!scatters) {
            convert_contiguous(in, from.type, out, to.type, block);
            continue;
        }
        convert_contiguous(in, from.type, converted.data(), to.type, block);
        to_size == 2 ? scatter<std::uint16_t>(converted.data(), out, to.stride, block)
                     : scatter<std::uint32_t>(converted.data(), out, to.stride, block);
    }
}

}  // namespace relume::io
