// SPDX-License-Identifier: Apache-2.0
#include "io/zip_rows.h"

#include <cstring>

#include "io/pixel_convert.h"

#if defined(__x86_64__) && !defined(RELUME_NO_SIMD)
#  include <immintrin.h>
#  define RELUME_IO_AVX2 1
#endif

namespace relume::io {

namespace {

/// Where a walk stands, as the loops below take and leave it.
struct Cursor {
    const std::uint8_t* even;
    const std::uint8_t* odd;
    std::uint8_t even_sum, odd_sum;
    std::uint8_t even_flip, odd_flip;
};

std::uint8_t sum_bytes_scalar(const std::uint8_t* bytes, std::size_t count) {
    std::uint8_t sum = 0;
    for (std::size_t i = 0; i < count; ++i) sum = static_cast<std::uint8_t>(sum + bytes[i]);
    return sum;
}

/// `count` pairs of an even and an odd byte.
void read_pairs_scalar(Cursor& at, std::byte* out, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
        at.even_sum = static_cast<std::uint8_t>(at.even_sum + *at.even++);
        at.odd_sum = static_cast<std::uint8_t>(at.odd_sum + *at.odd++);
        out[2 * i] = static_cast<std::byte>(at.even_sum ^ at.even_flip);
        out[2 * i + 1] = static_cast<std::byte>(at.odd_sum ^ at.odd_flip);
        at.even_flip = static_cast<std::uint8_t>(at.even_flip ^ 0x80);
        at.odd_flip = static_cast<std::uint8_t>(at.odd_flip ^ 0x80);
    }
}

#if RELUME_IO_AVX2
const bool has_avx2 = __builtin_cpu_supports("avx2") != 0;

__attribute__((target("avx2"))) std::uint8_t sum_bytes_avx2(const std::uint8_t* bytes, std::size_t count) {
    const __m256i zero = _mm256_setzero_si256();
    __m256i sum = zero;
    std::size_t i = 0;
    for (; i + 32 <= count; i += 32)
        sum = _mm256_add_epi64(sum,
                               _mm256_sad_epu8(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(bytes + i)), zero));
    alignas(32) std::uint64_t lanes[4];
    _mm256_store_si256(reinterpret_cast<__m256i*>(lanes), sum);
    return static_cast<std::uint8_t>(lanes[0] + lanes[1] + lanes[2] + lanes[3] +
                                     sum_bytes_scalar(bytes + i, count - i));
}

/// Sixteen pairs at a time: the even bytes' sums in the lower half of a register, the odd ones' in the upper.
template <bool kHalves>
__attribute__((target("avx2,f16c"))) std::size_t read_pairs_avx2(Cursor& at, std::byte* out, std::size_t count) {
    const __m256i last = _mm256_set1_epi8(15);
    const auto flips = [](std::uint8_t flip) {
        return _mm_set1_epi16(flip != 0 ? std::int16_t{0x0080} : static_cast<std::int16_t>(0x8000));
    };
    const __m256i flip = _mm256_set_m128i(flips(at.odd_flip), flips(at.even_flip));
    __m256i carry =
        _mm256_set_m128i(_mm_set1_epi8(static_cast<char>(at.odd_sum)), _mm_set1_epi8(static_cast<char>(at.even_sum)));
    std::size_t i = 0;
    for (; i + 16 <= count; i += 16) {
        __m256i x = _mm256_set_m128i(_mm_loadu_si128(reinterpret_cast<const __m128i*>(at.odd + i)),
                                     _mm_loadu_si128(reinterpret_cast<const __m128i*>(at.even + i)));
        x = _mm256_add_epi8(x, _mm256_slli_si256(x, 1));
        x = _mm256_add_epi8(x, _mm256_slli_si256(x, 2));
        x = _mm256_add_epi8(x, _mm256_slli_si256(x, 4));
        x = _mm256_add_epi8(x, _mm256_slli_si256(x, 8));
        const __m256i bytes = _mm256_xor_si256(_mm256_add_epi8(x, carry), flip);
        carry = _mm256_add_epi8(carry, _mm256_shuffle_epi8(x, last));
        const __m128i even = _mm256_castsi256_si128(bytes), odd = _mm256_extracti128_si256(bytes, 1);
        const __m128i low = _mm_unpacklo_epi8(even, odd), high = _mm_unpackhi_epi8(even, odd);
        if constexpr (kHalves) {
            _mm256_storeu_ps(reinterpret_cast<float*>(out + 4 * i), _mm256_cvtph_ps(low));
            _mm256_storeu_ps(reinterpret_cast<float*>(out + 4 * i + 32), _mm256_cvtph_ps(high));
        } else {
            _mm_storeu_si128(reinterpret_cast<__m128i*>(out + 2 * i), low);
            _mm_storeu_si128(reinterpret_cast<__m128i*>(out + 2 * i + 16), high);
        }
    }
    at.even += i;
    at.odd += i;
    at.even_sum = static_cast<std::uint8_t>(_mm256_extract_epi8(carry, 0));
    at.odd_sum = static_cast<std::uint8_t>(_mm256_extract_epi8(carry, 16));
    return i;  // an even number: the flips are as they were
}
#endif

std::uint8_t sum_bytes(const std::uint8_t* bytes, std::size_t count, bool scalar) {
#if RELUME_IO_AVX2
    if (has_avx2 && !scalar) return sum_bytes_avx2(bytes, count);
#endif
    static_cast<void>(scalar);
    return sum_bytes_scalar(bytes, count);
}

}  // namespace

ZipRows::ZipRows(const std::byte* bytes, std::size_t size, bool scalar)
    : even_(reinterpret_cast<const std::uint8_t*>(bytes)), odd_(even_ + size / 2), scalar_(scalar) {
    // The odd bytes go on where the even ones end.
    odd_sum_ = sum_bytes(even_, size / 2, scalar);
    if (size / 2 % 2 != 0) {
        odd_flip_ = 0x80;
    }
}

void ZipRows::skip(std::size_t size) {
    const std::size_t count = size / 2;
    even_sum_ = static_cast<std::uint8_t>(even_sum_ + sum_bytes(even_, count, scalar_));
    odd_sum_ = static_cast<std::uint8_t>(odd_sum_ + sum_bytes(odd_, count, scalar_));
    even_ += count;
    odd_ += count;
    if (count % 2 != 0) {
        even_flip_ = static_cast<std::uint8_t>(even_flip_ ^ 0x80);
        odd_flip_ = static_cast<std::uint8_t>(odd_flip_ ^ 0x80);
    }
}

void ZipRows::read(std::byte* out, std::size_t size) {
    Cursor at{even_, odd_, even_sum_, odd_sum_, even_flip_, odd_flip_};
    std::size_t done = 0;
#if RELUME_IO_AVX2
    if (has_avx2 && !scalar_) done = read_pairs_avx2<false>(at, out, size / 2);
#endif
    read_pairs_scalar(at, out + 2 * done, size / 2 - done);
    even_ = at.even, odd_ = at.odd;
    even_sum_ = at.even_sum, odd_sum_ = at.odd_sum;
    even_flip_ = at.even_flip, odd_flip_ = at.odd_flip;
}

void ZipRows::read_halves(std::byte* floats, std::size_t count) {
#if RELUME_IO_AVX2
    if (has_avx2 && !scalar_) {
        Cursor at{even_, odd_, even_sum_, odd_sum_, even_flip_, odd_flip_};
        const std::size_t done = read_pairs_avx2<true>(at, floats, count);
        even_ = at.even, odd_ = at.odd;
        even_sum_ = at.even_sum, odd_sum_ = at.odd_sum;
        floats += 4 * done;
        count -= done;
    }
#endif
    constexpr std::size_t kBlock = 256;
    std::byte halves[2 * kBlock];
    while (count > 0) {
        const std::size_t block = count < kBlock ? count : kBlock;
        read(halves, 2 * block);
        halves_to_floats(halves, floats, block, scalar_);
        floats += 4 * block;
        count -= block;
    }
}

}  // namespace relume::io
