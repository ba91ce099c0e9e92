// SPDX-License-Identifier: Apache-2.0
#pragma once

// RELUME_SHADER(id, Type): the one line that makes a model known. relume_add_shader() compiles the file that holds it
// once per ISA with RELUME_ISA_ID set (scalar, v2, v3, v4, neon); each object holds that ISA's kernel, and the scalar
// one the table of them all. ISA objects must export nothing but their kernel.

#include "relume/shading/kernel.h"

#define RELUME_CONCAT_(a, b, c) a##b##_##c
#define RELUME_CONCAT(a, b, c) RELUME_CONCAT_(a, b, c)
#define RELUME_KERNEL(id, isa) RELUME_CONCAT(relume_kernel_, id, isa)

#if defined(RELUME_ISA_BATCH)

#  define RELUME_SHADER(id, Type)                                                 \
    extern "C" void RELUME_KERNEL(id, RELUME_ISA_ID)(relume::ShaderTile * tile) { \
      relume::shade_tile<Type, relume::Batch<RELUME_ISA_BATCH>>(tile);            \
    }

#else

#  if defined(RELUME_HAVE_X86_KERNELS)
#    define RELUME_DECLARE_KERNELS(id)                            \
      extern "C" void RELUME_KERNEL(id, v2)(relume::ShaderTile*); \
      extern "C" void RELUME_KERNEL(id, v3)(relume::ShaderTile*); \
      extern "C" void RELUME_KERNEL(id, v4)(relume::ShaderTile*);
#    define RELUME_LIST_KERNELS(id)                                                   \
      , {"x86-64-v2", RELUME_KERNEL(id, v2)}, {"x86-64-v3", RELUME_KERNEL(id, v3)}, { \
        "x86-64-v4", RELUME_KERNEL(id, v4)                                            \
      }
#  elif defined(RELUME_HAVE_NEON_KERNELS)
#    define RELUME_DECLARE_KERNELS(id) extern "C" void RELUME_KERNEL(id, neon)(relume::ShaderTile*);
#    define RELUME_LIST_KERNELS(id) \
      , { "neon", RELUME_KERNEL(id, neon) }
#  else
#    define RELUME_DECLARE_KERNELS(id)
#    define RELUME_LIST_KERNELS(id)
#  endif

namespace relume {

template <class S> constexpr auto default_table_of() -> double (*)(std::int32_t, double, double) {
    if constexpr (kTableSlots<S> != 0) return &S::default_table;
    else return nullptr;
}

template <class S> constexpr ShaderAbi make_shader_abi(const ShaderKernel* kernels, std::int32_t kernel_count) {
    static_assert(table_matches_params<S>(), "the parameter table and Params/Options do not match");
    static_assert(std::is_standard_layout_v<typename S::template Params<float>>, "Params may hold T and Vec3<T> alone");
    return {kShaderAbiVersion,
            sizeof(ShaderAbi),
            S::name.data(),
            S::label.data(),
            S::help.data(),
            S::parameters,
            static_cast<std::uint32_t>(std::size(S::parameters)),
            sizeof(Parameter),
            kFloatSlots<S>,
            kOptionSlots<S>,
            kTableSlots<S>,
            S::needs_tangent ? 1 : 0,
            kernel_count,
            kernels,
            &evaluate_arrays<S, float>,
            &evaluate_arrays<S, double>,
            default_table_of<S>()};
}

}  // namespace relume

#  define RELUME_SHADER(id, Type)                                                                                   \
    RELUME_DECLARE_KERNELS(id)                                                                                      \
    extern "C" void RELUME_KERNEL(id, scalar)(relume::ShaderTile * tile) { relume::shade_tile<Type, float>(tile); } \
    static const relume::ShaderKernel relume_kernels_##id[] = {                                                     \
        {"scalar", RELUME_KERNEL(id, scalar)} RELUME_LIST_KERNELS(id)};                                             \
    extern "C" const relume::ShaderAbi relume_shader_##id;                                                          \
    const relume::ShaderAbi relume_shader_##id =                                                                    \
        relume::make_shader_abi<Type>(relume_kernels_##id, static_cast<std::int32_t>(std::size(relume_kernels_##id)));

#endif
