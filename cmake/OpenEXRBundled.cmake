# SPDX-License-Identifier: Apache-2.0
# OpenEXRCore 3.5.3, static, with its own libdeflate, OpenJPH and zstd and the system's Imath. The source release comes
# from PyPI by pip, pinned by hash in tools/openexr-source.txt. It is built once per compiler and set of flags, under
# RELUME_DEPS_DIR, and shared by all build directories: it is C with a C interface and is never built with sanitizers.
set(_version 3.5.3)
set(_flags "-O3 -DNDEBUG")
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64|amd64")
    # Its predictor and its zip reconstruction are scalar without SSE4.1: 22 % of reading a zip file.
    string(APPEND _flags " -march=x86-64-v2")
endif()
set(_compiler "${CMAKE_C_COMPILER_ID}-${CMAKE_C_COMPILER_VERSION}")
file(REAL_PATH "${CMAKE_C_COMPILER}" _c_compiler)
file(REAL_PATH "${CMAKE_CXX_COMPILER}" _cxx_compiler)
file(SHA256 "${CMAKE_CURRENT_LIST_FILE}" _recipe)
file(SHA256 "${PROJECT_SOURCE_DIR}/tools/openexr-source.txt" _pin)
string(SHA256 _key "${_recipe} ${_pin} ${_c_compiler} ${_cxx_compiler} ${_flags} ${CMAKE_SYSTEM_PROCESSOR}")
string(SUBSTRING "${_key}" 0 10 _key)
set(_prefix "${RELUME_DEPS_DIR}/openexr-${_version}-${_compiler}-${_key}")
set(_archive "${_prefix}/lib/libOpenEXRCore.a")

function(_relume_run what)
    execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
    if(NOT status EQUAL 0)
        message(FATAL_ERROR "Bundled OpenEXR: ${what} failed (${status}):\n${output}\n"
                            "RELUME_OPENEXR=system builds with the OpenEXR that is installed instead.")
    endif()
endfunction()

function(_relume_build_openexr)
    file(MAKE_DIRECTORY "${RELUME_DEPS_DIR}")
    file(LOCK "${RELUME_DEPS_DIR}/openexr.lock" GUARD FUNCTION TIMEOUT 1200)
    if(EXISTS "${_archive}")
        return()
    endif()
    set(tarball "${RELUME_DEPS_DIR}/openexr-${_version}.tar.gz")
    if(NOT EXISTS "${tarball}")
        message(STATUS "Bundled OpenEXR: fetching the source release ${_version} from PyPI")
        find_package(Python 3.11 REQUIRED COMPONENTS Interpreter)
        # The build backend only names the version here; nothing is compiled. pip checks the hash.
        _relume_run("fetching by pip"
            "${Python_EXECUTABLE}" -m pip download --quiet --no-deps --no-binary :all: --no-build-isolation
            --require-hashes --requirement "${PROJECT_SOURCE_DIR}/tools/openexr-source.txt" --dest "${RELUME_DEPS_DIR}")
    endif()
    set(source "${RELUME_DEPS_DIR}/openexr-${_version}")
    set(build "${_prefix}/build")
    set(launcher)
    if(RELUME_CCACHE_PROGRAM)
        set(launcher "-DCMAKE_C_COMPILER_LAUNCHER=${RELUME_CCACHE_PROGRAM}"
                     "-DCMAKE_CXX_COMPILER_LAUNCHER=${RELUME_CCACHE_PROGRAM}")
    endif()
    file(REMOVE_RECURSE "${source}" "${_prefix}")
    file(ARCHIVE_EXTRACT INPUT "${tarball}" DESTINATION "${RELUME_DEPS_DIR}")
    message(STATUS "Bundled OpenEXR: building it for ${_compiler}, once (about a minute on two cores)")
    _relume_run("configuring"
        "${CMAKE_COMMAND}" -S "${source}" -B "${build}" -G "${CMAKE_GENERATOR}"
        "-DCMAKE_MAKE_PROGRAM=${CMAKE_MAKE_PROGRAM}"
        "-DCMAKE_C_COMPILER=${CMAKE_C_COMPILER}" "-DCMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER}"
        ${launcher}
        "-DCMAKE_C_FLAGS_RELEASE=${_flags}" "-DCMAKE_CXX_FLAGS_RELEASE=${_flags}"
        -DCMAKE_BUILD_TYPE=Release -DBUILD_SHARED_LIBS=OFF -DCMAKE_POSITION_INDEPENDENT_CODE=ON
        "-DImath_DIR=${Imath_DIR}"
        -DOPENEXR_FORCE_INTERNAL_DEFLATE=ON -DOPENEXR_FORCE_INTERNAL_OPENJPH=ON -DOPENEXR_FORCE_INTERNAL_ZSTD=ON
        -DOPENEXR_BUILD_TOOLS=OFF -DOPENEXR_BUILD_EXAMPLES=OFF -DOPENEXR_TEST_LIBRARIES=OFF -DBUILD_TESTING=OFF)
    _relume_run("compiling"
        "${CMAKE_COMMAND}" -E env "CCACHE_BASEDIR=${RELUME_DEPS_DIR}" CCACHE_NOHASHDIR=1
        "${CMAKE_COMMAND}" --build "${build}" --target OpenEXRCore --parallel)
    # Only Core was built, so OpenEXR's own install step, which wants the C++ library too, cannot be used.
    file(GLOB headers "${source}/src/lib/OpenEXRCore/openexr*.h" "${build}/cmake/*Config.h")
    file(COPY ${headers} DESTINATION "${_prefix}/include/OpenEXR")
    file(COPY "${source}/LICENSE.md" DESTINATION "${_prefix}")
    file(GLOB_RECURSE built "${build}/src/lib/OpenEXRCore/libOpenEXRCore*.a")
    file(MAKE_DIRECTORY "${_prefix}/lib")
    file(COPY_FILE "${built}" "${_archive}.part")
    file(RENAME "${_archive}.part" "${_archive}")
    file(REMOVE_RECURSE "${build}" "${source}")
endfunction()

if(NOT EXISTS "${_archive}")
    _relume_build_openexr()
endif()
message(STATUS "Bundled OpenEXR: ${_prefix}")
add_library(relume_openexrcore INTERFACE IMPORTED GLOBAL)
target_include_directories(relume_openexrcore SYSTEM INTERFACE "${_prefix}/include" "${_prefix}/include/OpenEXR")
target_compile_definitions(relume_openexrcore INTERFACE RELUME_OPENEXR_BUNDLED)
target_link_libraries(relume_openexrcore INTERFACE "${_archive}" Imath::Imath Threads::Threads m)
set(RELUME_OPENEXR_BUILD "OpenEXR ${_version} (bundled)")
