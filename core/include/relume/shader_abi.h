// SPDX-License-Identifier: Apache-2.0
#pragma once

// The binary interface between librelume and a shading model, built in or loaded at run time. Plain data: no virtuals,
// no exceptions, no standard containers cross it. kShaderAbiVersion changes with any layout here; a plugin of another
// version is refused with a message (`relume doctor`).

#include <cstdint>

#include "relume/parameter.h"

namespace relume {

inline constexpr std::uint32_t kShaderAbiVersion = 2;

enum class LightKind : std::int32_t { sun, point, spot };
enum class SpotFalloff : std::int32_t { smoothstep, blender3, linear, step };

/// A light with a direction, in world space, ready for the kernel: rig values are converted once per frame.
struct DirectLight {
    LightKind kind;
    SpotFalloff falloff;
    std::int32_t inverse_square;  ///< else 1/(a₀ + a₁·d + a₂·d²)
    float position[3];
    float to_light[3];  ///< sun: l. Spot: the unit axis it shines along, negated
    float attenuation[3];
    float cone[4];  ///< spot: cos(half cone), 1/(blend width) in the falloff's own measure, half cone, blend
    /// Per lobe (diffuse, specular, transmission): irradiance W/m² of a sun, intensity W/sr of a point or spot, times
    /// colour, exposure and the light's multiplier for that lobe.
    float color[3][3];
    const float* mask;  ///< light linking: factor per pixel of the tile, finite; nullptr is 1
};

/// A light without a direction: irradiance(n) = mix(low, high, w), w = ½ + ½·n·axis or max(0, n·axis). Reaches the
/// diffuse part alone, times ambient occlusion.
struct AmbientLight {
    std::int32_t clamp;
    float axis[3];
    float low[3];
    float high[3];
    const float* mask;
};

/// A parameter of type table: width·height finite numbers, row 0 first. Sampled by relume/shading/table.h.
struct TableView {
    const float* texels;
    std::int32_t width;
    std::int32_t height;
};

/// Texels of a table at most: float counts them exactly.
inline constexpr std::int64_t kMostTexels = std::int64_t{1} << 22;

/// Views of a tile: `count` pixels of one row in structure-of-arrays form. A null plane means what its comment says.
struct ShaderTile {
    std::uint32_t size;  ///< sizeof(ShaderTile)
    std::int32_t count;

    const float* normal[3];    ///< any length; 0 is background
    const float* position[3];  ///< null: only lights without a position may be in `lights`
    const float* view[3];      ///< unit, to the camera; null: from eye and position, or constant
    float eye[3];              ///< camera position, or with `constant_view` the unit vector to the camera
    std::int32_t constant_view;
    const float* tangent[3];         ///< null: a frame made from the normal
    const float* ambient_occlusion;  ///< null: 1

    const float* const* slots;  ///< per float of Params: a plane, or null for constants[slot]
    const float* constants;
    const std::int32_t* options;
    const TableView* tables;  ///< one per table slot; null where the shader has none

    const DirectLight* lights;
    std::int32_t light_count;
    std::int32_t ambient_count;
    const AmbientLight* ambients;

    const float* weight;      ///< share of the pixel that this shader has; null: 1
    std::int32_t accumulate;  ///< add to the outputs instead of overwriting them
    std::int32_t emission;    ///< add emission (once per pixel, not once per light group)
    float* total[3];          ///< sum of all lobes and emission; may be null
    float* lobe[3][3];        ///< diffuse, specular, transmission; null where not asked for

    std::int64_t nonfinite;  ///< out: pixels with NaN or infinity in any input; their outputs are 0
};

/// One evaluation of f·NdotL (1/sr) for tests, plots and fitting; T is float or double. Arrays of `count` pixels:
/// params[slot][i], vectors as three arrays. tangent may hold nulls.
template <class T> struct ShaderEvaluation {
    std::uint32_t size;
    std::int64_t count;
    const T* const* params;
    const std::int32_t* options;
    const TableView* tables;
    const T* n[3];
    const T* v[3];
    const T* l[3];
    const T* tangent[3];
    T* diffuse[3];
    T* specular[3];
    T* transmission[3];
};

using ShadeFunction = void (*)(ShaderTile*);

struct ShaderKernel {
    const char* isa;  ///< "scalar", "x86-64-v2", "x86-64-v3", "x86-64-v4", "neon"
    ShadeFunction shade;
};

struct ShaderAbi {
    std::uint32_t version;  ///< kShaderAbiVersion
    std::uint32_t size;     ///< sizeof(ShaderAbi)
    const char* name;
    const char* label;
    const char* help;
    const Parameter* parameters;
    std::uint32_t parameter_count;
    std::uint32_t parameter_size;  ///< sizeof(Parameter)
    std::int32_t float_slots;
    std::int32_t option_slots;
    std::int32_t table_slots;
    std::int32_t needs_tangent;
    std::int32_t kernel_count;
    const ShaderKernel* kernels;  ///< the scalar reference first, then by rising ISA
    void (*evaluate_float)(const ShaderEvaluation<float>*);
    void (*evaluate_double)(const ShaderEvaluation<double>*);
    /// The built-in table of a slot at (u, v) in [0, 1]²; null where the shader has no tables.
    double (*default_table)(std::int32_t slot, double u, double v);
};

/// What a plugin file exports, under the name kShaderPluginSymbol: its shaders, `count` set.
using ShaderPluginFunction = const ShaderAbi* const* (*)(std::int32_t* count);
inline constexpr const char* kShaderPluginSymbol = "relume_shader_plugin_v1";  // for all versions of the ABI

}  // namespace relume
