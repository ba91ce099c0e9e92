// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "relume/shading/vec.h"
#include "shaders/blender_principled/energy.h"
#include "shaders/blender_principled/sheen_tables.h"

namespace relume::shaders {

/// Sheen of a layer of fibers: a cosine lobe, linearly transformed along the view's projection x on the surface
/// (Zeltner, Burley, Chiang 2022). f·NdotL is albedo times this, ∫ = 1.
template <class T> struct MicrofiberSheen {
    Vec3<T> axis, x;
    T a, b, albedo;

    RELUME_INLINE T operator()(const Vec3<T>& l) const {
        const T z = max(dot(axis, l), T(0.f)), along = dot(x, l);
        const T across2 = max(fnma(along, along, fnma(z, z, T(1.f))), T(0.f));
        const T sheared = fma(a, along, b * z), a2 = a * a;
        const T length2 = fma(sheared, sheared, fma(a2, across2, z * z));
        const T ratio = a * rcp(max(length2, constant<T>(1e-12)));
        return constant<T>(kInvPi) * z * ratio * ratio;
    }
};

template <class T>
RELUME_INLINE MicrofiberSheen<T> microfiber_sheen(const Vec3<T>& axis, const Vec3<T>& v, T roughness) {
    constexpr int kNodes = 32;
    const T cosine = dot(axis, v);
    const Between<T> row = between(cosine, kNodes), column = between(roughness, kNodes);
    MicrofiberSheen<T> out;
    out.axis = axis;
    out.x = normalize(fma(axis, -cosine, v));
    out.a = bilinear(table::kSheenA, kNodes, row, column);
    out.b = bilinear(table::kSheenB, kNodes, row, column);
    out.albedo = bilinear(table::kSheenR, kNodes, row, column);
    return out;
}

}  // namespace relume::shaders
