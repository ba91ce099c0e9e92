// SPDX-License-Identifier: Apache-2.0
#pragma once

// The number type T of shading code and everything that may be done with it. T is float (the reference), double (tests
// and fitting), an xsimd batch of floats or a pair of them (pair.h), one pixel a lane. Shading code is written once
// against this header; nothing else in relume names an intrinsic. Straight-line code: comparisons give masks, select()
// chooses.

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>

#if defined(RELUME_ISA_BATCH)
#  include <xsimd/xsimd.hpp>
#endif

#define RELUME_INLINE inline __attribute__((always_inline))
#define RELUME_INLINE_LAMBDA __attribute__((always_inline))

namespace relume {

// ---- scalars: T = float, double -----------------------------------------------------------------------------------

template <class T>
concept Scalar = std::is_same_v<T, float> || std::is_same_v<T, double>;

template <class T> struct NumberTraits {
    using Mask = bool;
    static constexpr int width = 1;
};

template <class T> using MaskOf = typename NumberTraits<T>::Mask;

/// Lanes of T.
template <class T> inline constexpr int kWidth = NumberTraits<T>::width;

template <Scalar T> RELUME_INLINE T select(bool mask, T a, T b) { return mask ? a : b; }
template <Scalar T> RELUME_INLINE T min(T a, T b) { return b < a ? b : a; }
template <Scalar T> RELUME_INLINE T max(T a, T b) { return a < b ? b : a; }
template <Scalar T> RELUME_INLINE T abs(T x) { return std::fabs(x); }
template <Scalar T> RELUME_INLINE T sqrt(T x) { return std::sqrt(x); }
/// a·b + c. The scalar reference leaves contraction to the compiler.
template <Scalar T> RELUME_INLINE T fma(T a, T b, T c) { return a * b + c; }
/// c − a·b
template <Scalar T> RELUME_INLINE T fnma(T a, T b, T c) { return c - a * b; }
/// 1/x and 1/√x, to 2 ulp in a batch and correctly rounded operations in the reference. x must not be 0.
template <Scalar T> RELUME_INLINE T rcp(T x) { return T(1) / x; }
template <Scalar T> RELUME_INLINE T rsqrt(T x) { return T(1) / std::sqrt(x); }
/// 1/√x for who has x/2 as well: one operation less in a batch.
template <Scalar T> RELUME_INLINE T rsqrt(T x, T) { return T(1) / std::sqrt(x); }
template <Scalar T> RELUME_INLINE T floor(T x) { return std::floor(x); }
template <Scalar T> RELUME_INLINE T exp(T x) { return std::exp(x); }
template <Scalar T> RELUME_INLINE T exp2(T x) { return std::exp2(x); }
template <Scalar T> RELUME_INLINE T log(T x) { return std::log(x); }
template <Scalar T> RELUME_INLINE T log1p(T x) { return std::log1p(x); }
template <Scalar T> RELUME_INLINE T sin(T x) { return std::sin(x); }
template <Scalar T> RELUME_INLINE T cos(T x) { return std::cos(x); }
template <Scalar T> RELUME_INLINE T acos(T x) { return std::acos(x); }
template <Scalar T> RELUME_INLINE T asin(T x) { return std::asin(x); }
template <Scalar T> RELUME_INLINE T atan2(T y, T x) { return std::atan2(y, x); }
/// x^y for x ≥ 0; 0^0 is 1.
template <Scalar T> RELUME_INLINE T pow(T x, T y) { return std::pow(x, y); }
RELUME_INLINE bool any(bool mask) { return mask; }
RELUME_INLINE bool all(bool mask) { return mask; }
template <Scalar T> RELUME_INLINE bool is_nan(T x) { return x != x; }

/// kWidth<T> values from contiguous memory, of any alignment.
template <Scalar T> RELUME_INLINE T load(const float* p) { return T(*p); }
template <Scalar T> RELUME_INLINE void store(float* p, T x) { *p = static_cast<float>(x); }

/// p[index], for an index ≥ 0 that is a whole number below 2²⁴.
template <Scalar T> RELUME_INLINE T gather(const float* p, T index) { return T(p[static_cast<std::int32_t>(index)]); }

/// Past the cache; p is aligned to a batch.
template <Scalar T> RELUME_INLINE void store_streaming(float* p, T x) { store(p, x); }

/// Four values by pixel, x y z w x y z w …, of the first `lanes` pixels; `stream` bypasses the cache (16-byte
/// alignment).
template <Scalar T> RELUME_INLINE void store_interleaved(float* p, T x, T y, T z, T w, int, bool) {
    p[0] = static_cast<float>(x);
    p[1] = static_cast<float>(y);
    p[2] = static_cast<float>(z);
    p[3] = static_cast<float>(w);
}

#if defined(RELUME_ISA_BATCH)

// ---- batches ------------------------------------------------------------------------------------------------------

template <class A> using Batch = xsimd::batch<float, A>;

template <class A> struct NumberTraits<Batch<A>> {
    using Mask = xsimd::batch_bool<float, A>;
    static constexpr int width = static_cast<int>(Batch<A>::size);
};

template <class A> RELUME_INLINE Batch<A> select(xsimd::batch_bool<float, A> m, Batch<A> a, Batch<A> b) {
    return xsimd::select(m, a, b);
}
template <class A> RELUME_INLINE Batch<A> min(Batch<A> a, Batch<A> b) { return xsimd::min(a, b); }
template <class A> RELUME_INLINE Batch<A> max(Batch<A> a, Batch<A> b) { return xsimd::max(a, b); }
template <class A> RELUME_INLINE Batch<A> abs(Batch<A> x) { return xsimd::abs(x); }
template <class A> RELUME_INLINE Batch<A> sqrt(Batch<A> x) { return xsimd::sqrt(x); }
template <class A> RELUME_INLINE Batch<A> floor(Batch<A> x) { return xsimd::floor(x); }
template <class A> RELUME_INLINE Batch<A> exp(Batch<A> x) { return xsimd::exp(x); }
template <class A> RELUME_INLINE Batch<A> exp2(Batch<A> x) { return xsimd::exp2(x); }
template <class A> RELUME_INLINE Batch<A> log(Batch<A> x) { return xsimd::log(x); }
template <class A> RELUME_INLINE Batch<A> log1p(Batch<A> x) { return xsimd::log1p(x); }
template <class A> RELUME_INLINE Batch<A> acos(Batch<A> x) { return xsimd::acos(x); }
template <class A> RELUME_INLINE Batch<A> asin(Batch<A> x) { return xsimd::asin(x); }
template <class A> RELUME_INLINE Batch<A> atan2(Batch<A> y, Batch<A> x) { return xsimd::atan2(y, x); }
template <class A> RELUME_INLINE bool any(xsimd::batch_bool<float, A> m) { return xsimd::any(m); }
template <class A> RELUME_INLINE bool all(xsimd::batch_bool<float, A> m) { return xsimd::all(m); }
// Not x != x: xsimd 8 compares "ordered and unequal" on AVX, which NaN is not.
template <class A> RELUME_INLINE xsimd::batch_bool<float, A> is_nan(Batch<A> x) { return !(x == x); }

// Sine and cosine, 1.5e-7 off at most for |x| ≤ 1000. xsimd's own call a routine of a library for large x, which an
// object of one ISA must not export.
namespace native {
template <class A>
RELUME_INLINE Batch<A> sin_of_half_turns(Batch<A> x, Batch<A> k, Batch<A> sign) {  // sign·sin(x − k·π), |x − k·π| ≤ π/2
    Batch<A> r = x - k * Batch<A>(3.140625f);  // π in three parts of few bits (Cody–Waite 1980)
    r = r - k * Batch<A>(9.67502593994140625e-4f) - k * Batch<A>(1.509957990978376432e-7f);
    const Batch<A> r2 = r * r;
    Batch<A> p = Batch<A>(-1.f / 39916800.f);  // Taylor to r¹¹: 6e-8 off
    p = xsimd::fma(p, r2, Batch<A>(1.f / 362880.f));
    p = xsimd::fma(p, r2, Batch<A>(-1.f / 5040.f));
    p = xsimd::fma(p, r2, Batch<A>(1.f / 120.f));
    p = xsimd::fma(p, r2, Batch<A>(-1.f / 6.f));
    return sign * xsimd::fma(p * r2, r, r);
}
template <class A> RELUME_INLINE Batch<A> one_if_even(Batch<A> k) {  // −1 if odd
    return Batch<A>(1.f) - Batch<A>(2.f) * (k - Batch<A>(2.f) * xsimd::floor(Batch<A>(0.5f) * k));
}
}  // namespace native
template <class A> RELUME_INLINE Batch<A> sin(Batch<A> x) {
    const Batch<A> k = xsimd::floor(x * Batch<A>(0.318309886f) + Batch<A>(0.5f));
    return native::sin_of_half_turns(x, k, native::one_if_even(k));
}
template <class A> RELUME_INLINE Batch<A> cos(Batch<A> x) {
    const Batch<A> k = xsimd::floor(x * Batch<A>(0.318309886f));
    return native::sin_of_half_turns(x, k + Batch<A>(0.5f), -native::one_if_even(k));
}

template <class A> RELUME_INLINE Batch<A> pow(Batch<A> x, Batch<A> y) {
    // exp(y·log x), with the two ends that the product 0·∞ would spoil.
    const Batch<A> tiny(1e-37f);
    const Batch<A> p = xsimd::exp(y * xsimd::log(xsimd::max(x, tiny)));
    return xsimd::select(x < tiny, xsimd::select(y == Batch<A>(0.f), Batch<A>(1.f), Batch<A>(0.f)), p);
}

// The hardware's estimates (12 bits on SSE and AVX, 14 on AVX-512) and one Newton step, 2 ulp at the worst: worth 1.25×
// over division and square root. Where there is no good estimate, the exact operations. Fused multiply-add by name as
// well: xsimd 8 has none for AVX-512.
namespace native {
#  if defined(__AVX512F__)
RELUME_INLINE __m512 rcp(__m512 x) { return _mm512_rcp14_ps(x); }
RELUME_INLINE __m512 rsqrt(__m512 x) { return _mm512_rsqrt14_ps(x); }
RELUME_INLINE __m512 fma(__m512 a, __m512 b, __m512 c) { return _mm512_fmadd_ps(a, b, c); }
RELUME_INLINE __m512 fnma(__m512 a, __m512 b, __m512 c) { return _mm512_fnmadd_ps(a, b, c); }
#  endif
#  if defined(__AVX__)
RELUME_INLINE __m256 rcp(__m256 x) { return _mm256_rcp_ps(x); }
RELUME_INLINE __m256 rsqrt(__m256 x) { return _mm256_rsqrt_ps(x); }
#  endif
#  if defined(__FMA__)
RELUME_INLINE __m256 fma(__m256 a, __m256 b, __m256 c) { return _mm256_fmadd_ps(a, b, c); }
RELUME_INLINE __m256 fnma(__m256 a, __m256 b, __m256 c) { return _mm256_fnmadd_ps(a, b, c); }
#  endif
#  if defined(__SSE2__)
RELUME_INLINE __m128 rcp(__m128 x) { return _mm_rcp_ps(x); }
RELUME_INLINE __m128 rsqrt(__m128 x) { return _mm_rsqrt_ps(x); }
RELUME_INLINE __m128 fma(__m128 a, __m128 b, __m128 c) { return _mm_add_ps(_mm_mul_ps(a, b), c); }
RELUME_INLINE __m128 fnma(__m128 a, __m128 b, __m128 c) { return _mm_sub_ps(c, _mm_mul_ps(a, b)); }
#  endif
}  // namespace native

template <class A> RELUME_INLINE Batch<A> fma(Batch<A> a, Batch<A> b, Batch<A> c) {
#  if defined(__SSE2__)
    using R = typename Batch<A>::register_type;
    return Batch<A>(native::fma(R(a), R(b), R(c)));
#  else
    return xsimd::fma(a, b, c);
#  endif
}

/// c − a·b
template <class A> RELUME_INLINE Batch<A> fnma(Batch<A> a, Batch<A> b, Batch<A> c) {
#  if defined(__SSE2__)
    using R = typename Batch<A>::register_type;
    return Batch<A>(native::fnma(R(a), R(b), R(c)));
#  else
    return xsimd::fnma(a, b, c);
#  endif
}

template <class A> RELUME_INLINE Batch<A> rcp(Batch<A> x) {
#  if defined(__SSE2__)
    const Batch<A> y(native::rcp(typename Batch<A>::register_type(x)));
    return fma(y, fnma(x, y, Batch<A>(1.f)), y);
#  else
    return Batch<A>(1.f) / x;
#  endif
}

template <class A> RELUME_INLINE Batch<A> rsqrt(Batch<A> x) {
#  if defined(__SSE2__)
    const Batch<A> y(native::rsqrt(typename Batch<A>::register_type(x)));
    return fma(y * Batch<A>(0.5f), fnma(x * y, y, Batch<A>(1.f)), y);
#  else
    return Batch<A>(1.f) / xsimd::sqrt(x);
#  endif
}

template <class A> RELUME_INLINE Batch<A> rsqrt(Batch<A> x, Batch<A> half) {
#  if defined(__SSE2__)
    const Batch<A> y(native::rsqrt(typename Batch<A>::register_type(x)));
    return y * fnma(half, y * y, Batch<A>(1.5f));
#  else
    static_cast<void>(half);
    return rsqrt(x);
#  endif
}

template <class T>
concept IsBatch = xsimd::is_batch<T>::value;

template <IsBatch T> RELUME_INLINE T load(const float* p) { return T::load_unaligned(p); }

template <class A> RELUME_INLINE void store(float* p, Batch<A> x) { x.store_unaligned(p); }

#  if defined(__AVX2__)
namespace native {
RELUME_INLINE __m256 gather(const float* p, __m256 i) { return _mm256_i32gather_ps(p, _mm256_cvttps_epi32(i), 4); }
#    if defined(__AVX512F__)
RELUME_INLINE __m512 gather(const float* p, __m512 i) { return _mm512_i32gather_ps(_mm512_cvttps_epi32(i), p, 4); }
#    endif
}  // namespace native
#  endif

template <class A> RELUME_INLINE Batch<A> gather(const float* p, Batch<A> index) {
#  if defined(__AVX2__)
    return Batch<A>(native::gather(p, typename Batch<A>::register_type(index)));
#  else
    alignas(64) float lanes[kWidth<Batch<A>>];
    index.store_aligned(lanes);
    for (float& lane : lanes) lane = p[static_cast<std::int32_t>(lane)];
    return Batch<A>::load_aligned(lanes);
#  endif
}

#  if defined(__SSE2__)
namespace native {
RELUME_INLINE void stream(float* p, __m128 x) { _mm_stream_ps(p, x); }
#    if defined(__AVX__)
RELUME_INLINE void stream(float* p, __m256 x) { _mm256_stream_ps(p, x); }
#    endif
#    if defined(__AVX512F__)
RELUME_INLINE void stream(float* p, __m512 x) { _mm512_stream_ps(p, x); }
#    endif
}  // namespace native
#  endif

template <class A> RELUME_INLINE void store_streaming(float* p, Batch<A> x) {
#  if defined(__SSE2__)
    native::stream(p, typename Batch<A>::register_type(x));
#  else
    store(p, x);
#  endif
}

template <class A>
RELUME_INLINE void store_interleaved(float* p, Batch<A> x, Batch<A> y, Batch<A> z, Batch<A> w, int lanes, bool stream) {
    constexpr int kLanes = kWidth<Batch<A>>;
    alignas(64) float planar[4][kLanes];
    x.store_aligned(planar[0]);
    y.store_aligned(planar[1]);
    z.store_aligned(planar[2]);
    w.store_aligned(planar[3]);
#  if defined(__SSE2__)
    if (lanes >= kLanes) [[likely]] {
        for (int k = 0; k < kLanes; k += 4) {
            __m128 a = _mm_load_ps(planar[0] + k), b = _mm_load_ps(planar[1] + k), c = _mm_load_ps(planar[2] + k),
                   d = _mm_load_ps(planar[3] + k);
            _MM_TRANSPOSE4_PS(a, b, c, d);
            const __m128 pixels[4] = {a, b, c, d};
            for (int q = 0; q < 4; ++q) {
                if (stream) _mm_stream_ps(p + 4 * (k + q), pixels[q]);
                else _mm_storeu_ps(p + 4 * (k + q), pixels[q]);
            }
        }
        return;
    }
#  endif
    static_cast<void>(stream);
    for (int k = 0; k < kLanes && k < lanes; ++k)
        for (int c = 0; c < 4; ++c) p[4 * k + c] = planar[c][k];
}

}  // namespace relume

#  include "relume/shading/pair.h"

namespace relume {

#endif  // RELUME_ISA_BATCH

// ---- for every T --------------------------------------------------------------------------------------------------

/// `lanes` values; the lanes beyond repeat the last.
template <class T> RELUME_INLINE T load_partial(const float* p, int lanes) {
    if (lanes >= kWidth<T>) [[likely]]
        return load<T>(p);
    alignas(64) float padded[kWidth<T>];
    for (int k = 0; k < kWidth<T>; ++k) padded[k] = p[k < lanes ? k : lanes - 1];
    return load<T>(padded);
}

/// i, of which the optimiser knows nothing: what is loaded through it is loaded again instead of kept.
RELUME_INLINE int opaque(int i) {
    asm("" : "+r"(i));
    return i;
}

template <class T> RELUME_INLINE T clamp(T x, T low, T high) { return min(max(x, low), high); }
template <class T> RELUME_INLINE T saturate(T x) { return clamp(x, T(0.f), T(1.f)); }
template <class T> RELUME_INLINE T square(T x) { return x * x; }
template <class T> RELUME_INLINE T lerp(T a, T b, T t) { return fma(t, b - a, a); }
/// √x for x that rounding may have brought below 0.
template <class T> RELUME_INLINE T safe_sqrt(T x) { return sqrt(max(x, T(0.f))); }
/// x⁵; Schlick's (1 − x)⁵ takes x clamped to [0, 1].
template <class T> RELUME_INLINE T pow5(T x) {
    const T x2 = x * x;
    return x2 * x2 * x;
}

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kInvPi = 0.31830988618379067154;

/// A constant of type T from a double, without a narrowing warning.
template <class T> RELUME_INLINE T constant(double x) {
    if constexpr (std::is_same_v<T, double>) return x;
    else return T(static_cast<float>(x));
}

}  // namespace relume
