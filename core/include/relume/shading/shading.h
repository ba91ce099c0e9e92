// SPDX-License-Identifier: Apache-2.0
#pragma once

// What a shading model sees: the surface at a pixel, one light at a time, and the terms it answers with.
//
// Conventions: n, v, l, h are unit, point away from the surface, in world space. Results are f·NdotL in 1/sr; the
// light's irradiance (or intensity times attenuation) multiplies them outside.

#include "relume/shading/vec.h"

namespace relume {

enum class Lobe : int { diffuse, specular, transmission };

template <class T> struct Lobes {
    Color<T> diffuse;
    Color<T> specular;
    Color<T> transmission;
};

/// The surface at a pixel.
template <class T> struct Geometry {
    Vec3<T> n;
    Vec3<T> v;
    T n_dot_v;  ///< clamped to [1e-4, 1], for denominators
    T ambient_occlusion;
    bool isotropic;  ///< the tile has no anisotropy at all: known when the kernel is compiled, so that what hangs on it
                     ///< is left out of the loop (it cost 13 % of a single light's time in registers)
    Vec3<T> tangent;  ///< as given, neither unit nor orthogonal; 0 where there is none. Shaders with needs_tangent
                      ///< only, and through tangent_frame()
};

/// Orthonormal tangent and bitangent: the given tangent made orthogonal to n, else some frame around n. Not cheap: call
/// it where a lobe is anisotropic.
template <class T> RELUME_INLINE void tangent_frame(const Geometry<T>& g, Vec3<T>& tangent, Vec3<T>& bitangent) {
    orthonormal_frame(g.n, tangent, bitangent);
    const Vec3<T> t = fma(g.n, -dot(g.n, g.tangent), g.tangent);
    const T length2 = dot(t, t);
    const MaskOf<T> usable = length2 > constant<T>(1e-12);
    tangent = select(usable, scale(t, rsqrt(max(length2, constant<T>(1e-12)))), tangent);
    bitangent = select(usable, cross(g.n, tangent), bitangent);
}

/// One light at a pixel.
template <class T> struct LightSample {
    Vec3<T> l;
    T n_dot_l;  ///< not clamped
    T v_dot_l;
    /// Share of the light's colour that arrives (1/d², cone, mask). The kernel multiplies the results by it, unless the
    /// model says `scales_by_arriving = true` and does so itself where that is cheaper.
    T arriving;
};

/// Lower bound of NdotL and NdotV in denominators.
inline constexpr double kMinCosine = 1e-4;

/// The half vector's cosines. NdotH and sin²θh come from q = |h − n|² = 2 − 2·NdotH, since 1 − NdotH² cancels: at alpha
/// 0.001 that is 121 % off in float, this 0.1 %. VdotH is |v + l|/2, which is 1e-7/|v + l| off: so far from unit length
/// float's directions are.
template <class T> struct HalfVector {
    T q;        ///< |h − n|²
    T v_dot_h;  ///< = LdotH; in [0, 1] up to rounding
    T inv_len;  ///< 1/|v + l|: h = (v + l)·inv_len

    RELUME_INLINE T n_dot_h() const { return fma(q, constant<T>(-0.5), T(1.f)); }
    /// sin²θh = |n × h|²; may be below 0 by a rounding error where h is near −n.
    RELUME_INLINE T sin2_h() const { return q * fma(q, constant<T>(-0.25), T(1.f)); }
};

template <class T> RELUME_INLINE HalfVector<T> half_vector(const Geometry<T>& g, const LightSample<T>& s) {
    HalfVector<T> h;
    // |v + l|², which 2 + 2·v·l would lose where l is near −v. Where they are opposite there is no h: it becomes 0.
    const Vec3<T> sum = add(g.v, s.l);
    const T length2 = fma(sum.x, sum.x, fma(sum.y, sum.y, fma(sum.z, sum.z, constant<T>(1e-16))));
    const T half = constant<T>(0.5) * length2;
    h.inv_len = rsqrt(length2, half);
    h.v_dot_h = half * h.inv_len;
    const Vec3<T> d{fma(sum.x, h.inv_len, -g.n.x), fma(sum.y, h.inv_len, -g.n.y), fma(sum.z, h.inv_len, -g.n.z)};
    h.q = dot(d, d);
    return h;
}

/// h itself, for anisotropic lobes.
template <class T>
RELUME_INLINE Vec3<T> half_direction(const Geometry<T>& g, const LightSample<T>& s, const HalfVector<T>& h) {
    return scale(add(g.v, s.l), h.inv_len);
}

/// The view mirrored at the surface, reflect(−v, n): the mirror direction, around which l lies in a highlight.
template <class T> RELUME_INLINE Vec3<T> mirrored_view(const Geometry<T>& g) {
    return fma(g.n, T(2.f) * dot(g.n, g.v), negate(g.v));
}

/// What a model that is a sum of per-pixel colours times scalar terms prepares once per pixel:
/// f·NdotL = Σ color[k]·term_k(l). The kernel sums light colour × term over all lights and multiplies by the pixel's
/// colours once. A model adds what else its terms need in a struct derived from this.
template <class T, int N> struct PreparedTerms {
    Color<T> color[N];
    Color<T> ambient;  ///< per unit of irradiance from lights without direction (cd/π)
    Color<T> emission;
};

}  // namespace relume
