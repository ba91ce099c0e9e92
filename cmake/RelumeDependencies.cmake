# SPDX-License-Identifier: Apache-2.0
# Everything librelume is made with. All of it comes from the package manager, but for OpenEXR (OpenEXRBundled.cmake).
set(THREADS_PREFER_PTHREAD_FLAG ON)
find_package(Threads REQUIRED)
find_package(glm REQUIRED)
# By its headers alone: Debian's target for xsimd asks for a library `xtl` that is none.
find_path(RELUME_XSIMD_INCLUDE_DIR xsimd/xsimd.hpp REQUIRED)
mark_as_advanced(RELUME_XSIMD_INCLUDE_DIR)
find_package(tomlplusplus 3 REQUIRED)
find_package(Imath 3.1 QUIET REQUIRED)

# relume_openexrcore: the one name that core/io links, wherever OpenEXRCore came from.
if(RELUME_OPENEXR STREQUAL "bundled")
    include(OpenEXRBundled)
elseif(RELUME_OPENEXR STREQUAL "system")
    find_package(OpenEXR 3.1 REQUIRED)
    add_library(relume_openexrcore INTERFACE IMPORTED GLOBAL)
    target_link_libraries(relume_openexrcore INTERFACE OpenEXR::OpenEXRCore)
    set(RELUME_OPENEXR_BUILD "OpenEXR ${OpenEXR_VERSION} (system)")
else()
    message(FATAL_ERROR "RELUME_OPENEXR is '${RELUME_OPENEXR}'; it is either bundled or system")
endif()

# What every translation unit of ours is compiled with, the kernels of each instruction set included.
add_library(relume_flags INTERFACE)
target_compile_features(relume_flags INTERFACE cxx_std_20)
target_compile_options(
    relume_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
                           # GCC 12 sees an overlap in its own std::string (GCC bug 105329).
                           $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
                           $<$<BOOL:${RELUME_WERROR}>:-Werror>)
target_include_directories(relume_flags INTERFACE "${PROJECT_SOURCE_DIR}/core/include" "${PROJECT_SOURCE_DIR}/core")
# With only xyzw names a glm::vec is three plain members; r, g, b and s, t, p would be anonymous unions beside them.
target_compile_definitions(relume_flags INTERFACE GLM_FORCE_XYZW_ONLY $<$<NOT:$<BOOL:${RELUME_SIMD}>>:RELUME_NO_SIMD>)
target_include_directories(relume_flags SYSTEM INTERFACE "${RELUME_XSIMD_INCLUDE_DIR}")
target_link_libraries(relume_flags INTERFACE glm::glm Threads::Threads)

# toml++ is used by its headers alone: Debian's target would link a shared library that a wheel would have to carry.
add_library(relume_toml INTERFACE)
target_compile_definitions(relume_toml INTERFACE TOML_HEADER_ONLY=1)
target_include_directories(
    relume_toml SYSTEM INTERFACE $<TARGET_PROPERTY:tomlplusplus::tomlplusplus,INTERFACE_INCLUDE_DIRECTORIES>)
