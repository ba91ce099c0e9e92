// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "relume/shading/shading.h"

namespace relume::shaders {

/// What the generations of blender_principled have in one table.
template <class T> struct BlenderPrincipledParams {
    Color<T> base_color;
    T metallic;
    T roughness;
    T specular;
    Color<T> specular_tint;
    T anisotropic;
    T anisotropic_rotation;
    Color<T> sheen_tint;
    Color<T> emission;
    // Generation 3.
    T sheen;
    T clearcoat;
    T clearcoat_roughness;
    // Generation 5.
    T ior;
    T diffuse_roughness;
    T coat_weight;
    T coat_roughness;
    T coat_ior;
    Color<T> coat_tint;
    T sheen_weight;
    T sheen_roughness;
    Vec3<T> geometric_normal;
};

struct BlenderPrincipledOptions {
    enum Generation : std::int32_t { newest, three, five };
    enum Distribution : std::int32_t { ggx, multi_ggx };
    enum Emission : std::int32_t { by_source, emitted, seen };

    std::int32_t generation;
    std::int32_t distribution;
    std::int32_t emission_is;
};

/// alpha² (the product of both alphas) at and below which Cycles takes a lobe for a mirror.
inline constexpr double kPrincipledMirror = 1e-7;

/// The tangent frame turned by `turns` about the normal.
template <class T>
RELUME_INLINE void rotated_frame(const Geometry<T>& g, T turns, Vec3<T>& tangent, Vec3<T>& bitangent) {
    Vec3<T> t, b;
    tangent_frame(g, t, b);
    const T angle = constant<T>(2 * kPi) * turns;
    const T c = cos(angle), s = sin(angle);
    tangent = fma(b, s, scale(t, c));
    bitangent = fma(t, -s, scale(b, c));
}

}  // namespace relume::shaders
