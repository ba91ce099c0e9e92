// SPDX-License-Identifier: Apache-2.0
#pragma once

// Two batches as one number type. Shading is one long chain of dependent operations, and a CPU's schedulers do not
// reach from one light of it to the next: with two batches, operation by operation, the second fills the gaps of the
// first (1.2× on AVX-512, 1.3× on AVX2, 1.5× on SSE4.2, docs/performance.md). Included by simd.h, in objects of an ISA
// alone.

namespace relume {

template <class B> struct Pair {
    B a, b;
    Pair() = default;
    RELUME_INLINE Pair(B first, B second) : a(first), b(second) {}
    RELUME_INLINE explicit Pair(float x) : a(x), b(x) {}
    RELUME_INLINE Pair& operator+=(const Pair& x) { return *this = *this + x; }
    RELUME_INLINE Pair& operator-=(const Pair& x) { return *this = *this - x; }
    RELUME_INLINE Pair& operator*=(const Pair& x) { return *this = *this * x; }
    RELUME_INLINE Pair& operator/=(const Pair& x) { return *this = *this / x; }
};

template <class B> struct PairMask { MaskOf<B> a, b; };

template <class B> struct NumberTraits<Pair<B>> {
    using Mask = PairMask<B>;
    static constexpr int width = 2 * kWidth<B>;
};

#define RELUME_PAIR_UNARY(f) \
  template <class B> RELUME_INLINE Pair<B> f(const Pair<B>& x) { return {f(x.a), f(x.b)}; }
#define RELUME_PAIR_BINARY(f) \
  template <class B> RELUME_INLINE Pair<B> f(const Pair<B>& x, const Pair<B>& y) { return {f(x.a, y.a), f(x.b, y.b)}; }
#define RELUME_PAIR_TERNARY(f)                                                                       \
  template <class B> RELUME_INLINE Pair<B> f(const Pair<B>& x, const Pair<B>& y, const Pair<B>& z) { \
    return {f(x.a, y.a, z.a), f(x.b, y.b, z.b)};                                                     \
  }
#define RELUME_PAIR_OPERATOR(op)                                                             \
  template <class B> RELUME_INLINE Pair<B> operator op(const Pair<B>& x, const Pair<B>& y) { \
    return {x.a op y.a, x.b op y.b};                                                         \
  }
#define RELUME_PAIR_COMPARISON(op)                                                               \
  template <class B> RELUME_INLINE PairMask<B> operator op(const Pair<B>& x, const Pair<B>& y) { \
    return {x.a op y.a, x.b op y.b};                                                             \
  }
#define RELUME_PAIR_LOGICAL(op)                                                                          \
  template <class B> RELUME_INLINE PairMask<B> operator op(const PairMask<B>& x, const PairMask<B>& y) { \
    return {x.a op y.a, x.b op y.b};                                                                     \
  }

RELUME_PAIR_OPERATOR(+)
RELUME_PAIR_OPERATOR(-)
RELUME_PAIR_OPERATOR(*)
RELUME_PAIR_OPERATOR(/)
RELUME_PAIR_COMPARISON(<)
RELUME_PAIR_COMPARISON(<=)
RELUME_PAIR_COMPARISON(>)
RELUME_PAIR_COMPARISON(>=)
RELUME_PAIR_COMPARISON(==)
RELUME_PAIR_COMPARISON(!=)
RELUME_PAIR_LOGICAL(&&)
RELUME_PAIR_LOGICAL(||)
RELUME_PAIR_UNARY(abs)
RELUME_PAIR_UNARY(sqrt)
RELUME_PAIR_UNARY(rcp)
RELUME_PAIR_UNARY(rsqrt)
RELUME_PAIR_UNARY(floor)
RELUME_PAIR_UNARY(exp)
RELUME_PAIR_UNARY(exp2)
RELUME_PAIR_UNARY(log)
RELUME_PAIR_UNARY(log1p)
RELUME_PAIR_UNARY(sin)
RELUME_PAIR_UNARY(cos)
RELUME_PAIR_UNARY(acos)
RELUME_PAIR_UNARY(asin)
RELUME_PAIR_BINARY(min)
RELUME_PAIR_BINARY(max)
RELUME_PAIR_BINARY(rsqrt)
RELUME_PAIR_BINARY(atan2)
RELUME_PAIR_BINARY(pow)
RELUME_PAIR_TERNARY(fma)
RELUME_PAIR_TERNARY(fnma)

#undef RELUME_PAIR_UNARY
#undef RELUME_PAIR_BINARY
#undef RELUME_PAIR_TERNARY
#undef RELUME_PAIR_OPERATOR
#undef RELUME_PAIR_COMPARISON
#undef RELUME_PAIR_LOGICAL

template <class B> RELUME_INLINE Pair<B> operator-(const Pair<B>& x) { return {-x.a, -x.b}; }
template <class B> RELUME_INLINE PairMask<B> operator!(const PairMask<B>& m) { return {!m.a, !m.b}; }
template <class B> RELUME_INLINE bool any(const PairMask<B>& m) { return any(m.a || m.b); }
template <class B> RELUME_INLINE bool all(const PairMask<B>& m) { return all(m.a && m.b); }
template <class B> RELUME_INLINE PairMask<B> is_nan(const Pair<B>& x) { return {is_nan(x.a), is_nan(x.b)}; }
template <class B> RELUME_INLINE Pair<B> select(const PairMask<B>& m, const Pair<B>& x, const Pair<B>& y) {
    return {select(m.a, x.a, y.a), select(m.b, x.b, y.b)};
}

template <class T>
concept IsPair = std::is_same_v<T, Pair<decltype(T::a)>>;

template <IsPair T> RELUME_INLINE T load(const float* p) {
    using B = decltype(T::a);
    return {load<B>(p), load<B>(p + kWidth<B>)};
}
template <class B> RELUME_INLINE Pair<B> gather(const float* p, const Pair<B>& index) {
    return {gather(p, index.a), gather(p, index.b)};
}
template <class B> RELUME_INLINE void store(float* p, const Pair<B>& x) {
    store(p, x.a);
    store(p + kWidth<B>, x.b);
}

}  // namespace relume
