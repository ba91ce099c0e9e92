// SPDX-License-Identifier: Apache-2.0
#pragma once

// Vectors and colours of T. The type is GLM's; GLM's own dot, normalize and mix refuse a batch, so these are relume's.

#ifndef GLM_FORCE_XYZW_ONLY
#  define GLM_FORCE_XYZW_ONLY
#endif
#include <glm/detail/type_vec3.hpp>
#include <glm/vec3.hpp>

#include "relume/shading/simd.h"

namespace relume {

template <class T> using Vec3 = glm::vec<3, T, glm::defaultp>;
template <class T> using Color = glm::vec<3, T, glm::defaultp>;

template <class T> RELUME_INLINE T dot(const Vec3<T>& a, const Vec3<T>& b) {
    return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z));
}
template <class T> RELUME_INLINE Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T> RELUME_INLINE Vec3<T> scale(const Vec3<T>& a, T s) { return {a.x * s, a.y * s, a.z * s}; }
/// a·s + b
template <class T> RELUME_INLINE Vec3<T> fma(const Vec3<T>& a, T s, const Vec3<T>& b) {
    return {fma(a.x, s, b.x), fma(a.y, s, b.y), fma(a.z, s, b.z)};
}
template <class T> RELUME_INLINE Vec3<T> add(const Vec3<T>& a, const Vec3<T>& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T> RELUME_INLINE Vec3<T> sub(const Vec3<T>& a, const Vec3<T>& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T> RELUME_INLINE Vec3<T> mul(const Vec3<T>& a, const Vec3<T>& b) {
    return {a.x * b.x, a.y * b.y, a.z * b.z};
}
template <class T> RELUME_INLINE Vec3<T> negate(const Vec3<T>& a) { return {-a.x, -a.y, -a.z}; }
template <class T> RELUME_INLINE Vec3<T> splat(T s) { return {s, s, s}; }
template <class T> RELUME_INLINE Vec3<T> lerp(const Vec3<T>& a, const Vec3<T>& b, T t) {
    return {lerp(a.x, b.x, t), lerp(a.y, b.y, t), lerp(a.z, b.z, t)};
}
template <class T> RELUME_INLINE Vec3<T> select(MaskOf<T> m, const Vec3<T>& a, const Vec3<T>& b) {
    return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)};
}
template <class T> RELUME_INLINE Color<T> one_minus(const Color<T>& c) {
    return {T(1.f) - c.x, T(1.f) - c.y, T(1.f) - c.z};
}
template <class T> RELUME_INLINE T max_component(const Color<T>& c) { return max(c.x, max(c.y, c.z)); }

/// Unit vector along a; 0 stays finite (and is not unit).
template <class T> RELUME_INLINE Vec3<T> normalize(const Vec3<T>& a) {
    return scale(a, rsqrt(max(dot(a, a), constant<T>(1e-30))));
}

/// A tangent frame around the unit vector n, continuous but at n.z = 0⁻ (Duff et al. 2017, without its branch).
template <class T> RELUME_INLINE void orthonormal_frame(const Vec3<T>& n, Vec3<T>& tangent, Vec3<T>& bitangent) {
    const T one(1.f);
    const T sign = select(n.z < T(0.f), -one, one);
    const T a = -rcp(sign + n.z);
    const T b = n.x * n.y * a;
    tangent = {fma(sign * n.x, n.x * a, one), sign * b, -sign * n.x};
    bitangent = {b, fma(n.y, n.y * a, sign), -n.y};
}

}  // namespace relume
