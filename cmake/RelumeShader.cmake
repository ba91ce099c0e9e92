# SPDX-License-Identifier: Apache-2.0
# How a shading model is compiled: once as the scalar reference (with its parameter table and array evaluation), once per
# instruction set. Used by plugins/shaders and, from the installed package, by relume_add_shader() for models of one's own.

# relume_isa_list(<variable>): ids of the instruction sets this build makes kernels for, "scalar" left out.
function(relume_isa_list out)
    set(isas "")
    if(NOT DEFINED RELUME_SIMD OR RELUME_SIMD)
        if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64|amd64")
            set(isas v2 v3 v4)
        elseif(CMAKE_SYSTEM_PROCESSOR MATCHES "aarch64|arm64")
            set(isas neon)
        endif()
    endif()
    set(${out} "${isas}" PARENT_SCOPE)
endfunction()

# relume_isa_objects(<target> <isa> <source>...): an OBJECT library `<target>.isa-<isa>` of the sources for one instruction
# set. Its objects export nothing but the kernels: a weak symbol (an inline function of a library, say) that the linker
# picked from an AVX-512 object would run on every CPU. The kernels are static and flattened (everything they call is
# inlined, in every build type) and compiled without exceptions, so that none is left; a test looks with nm.
function(relume_isa_objects target isa)
    set(library "${target}.isa-${isa}")
    add_library(${library} OBJECT ${ARGN})
    set_target_properties(${library} PROPERTIES POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden
                                                VISIBILITY_INLINES_HIDDEN ON)
    target_compile_definitions(${library} PRIVATE RELUME_ISA_ID=${isa})
    target_compile_options(${library} PRIVATE -fno-math-errno -fno-trapping-math)
    if(RELUME_SANITIZE)
        # Marking the scopes of a flattened kernel's thousand temporaries costs 37 s a file instead of 7, and finds nothing
        # that the checks of heap and stack bounds would not.
        target_compile_options(${library} PRIVATE -fno-sanitize-address-use-after-scope)
        # Pairs of batches instrumented are another five minutes for the same code twice.
        target_compile_definitions(${library} PRIVATE RELUME_SINGLE_BATCHES)
    else()
        target_compile_options(${library} PRIVATE -O3)
    endif()
    if(isa STREQUAL "scalar")
        relume_isa_list(isas)
        if("v2" IN_LIST isas)
            target_compile_definitions(${library} PRIVATE RELUME_HAVE_X86_KERNELS)
        elseif("neon" IN_LIST isas)
            target_compile_definitions(${library} PRIVATE RELUME_HAVE_NEON_KERNELS)
        endif()
    else()
        set(batch_v2 "xsimd::sse4_2")
        set(batch_v3 "xsimd::fma3<xsimd::avx2>")
        set(batch_v4 "xsimd::avx512bw")
        set(batch_neon "xsimd::neon64")
        target_compile_definitions(${library} PRIVATE "RELUME_ISA_BATCH=${batch_${isa}}")
        if(isa MATCHES "^v")
            target_compile_options(${library} PRIVATE -march=x86-64-${isa})
        endif()
        if(isa STREQUAL "v4")
            target_compile_options(${library} PRIVATE -mprefer-vector-width=512)
        endif()
        target_compile_options(${library} PRIVATE -fno-exceptions -ffp-contract=fast)
        if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
            # GCC 12 on its own AVX-512 header: the "undefined" vectors there.
            target_compile_options(${library} PRIVATE -Wno-maybe-uninitialized)
            if(NOT RELUME_SANITIZE)
                # Structs of batches are split into registers whatever their size (default: 136 bytes, two AVX-512
                # batches). Instrumented, the largest kernels would take minutes for it.
                target_compile_options(${library} PRIVATE --param=sra-max-scalarization-size-Ospeed=8192)
            endif()
        endif()
    endif()
endfunction()

# relume_add_shader(<name> <source>): a shading model outside relume's tree, as a plugin `<name>.relume.so`. The source
# ends with RELUME_SHADER(<name>, Type). Put the file's folder on RELUME_SHADER_PATH.
function(relume_add_shader name source)
    set(entry "${CMAKE_CURRENT_BINARY_DIR}/${name}_entry.cpp")
    file(CONFIGURE OUTPUT "${entry}" CONTENT [[
// Made by relume_add_shader().
#include "relume/shader_abi.h"
extern "C" const relume::ShaderAbi relume_shader_@name@;
extern "C" __attribute__((visibility("default"))) const relume::ShaderAbi* const* relume_shader_plugin_v1(std::int32_t* count) {
    static const relume::ShaderAbi* const shaders[] = {&relume_shader_@name@};
    *count = 1;
    return shaders;
}
]] @ONLY)
    add_library(${name} MODULE "${entry}")
    set_target_properties(${name} PROPERTIES PREFIX "" OUTPUT_NAME "${name}.relume" SUFFIX ".so"
                                             CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
    target_link_libraries(${name} PRIVATE relume::shader_headers)
    relume_isa_list(isas)
    foreach(isa scalar ${isas})
        relume_isa_objects(${name} ${isa} "${source}")
        target_link_libraries(${name}.isa-${isa} PRIVATE relume::shader_headers)
        target_link_libraries(${name} PRIVATE ${name}.isa-${isa})
    endforeach()
    if(NOT APPLE)
        target_link_options(${name} PRIVATE -Wl,--exclude-libs,ALL)
    endif()
endfunction()
