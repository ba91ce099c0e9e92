# SPDX-License-Identifier: Apache-2.0
# Headers of releases of OpenImageIO that are not installed, and empty libraries of their names to link against: a plugin
# runs in a host that has the library, and finds it by its soname. The source releases come from PyPI by pip, pinned by
# hash in tools/oiio-source.txt, and are kept under RELUME_DEPS_DIR.

# The folder with include/OpenImageIO and lib of one release, in `result`; `inner` is the namespace of its version,
# `soversion` its libraries'.
function(relume_openimageio_release version inner soversion result)
    set(folder "${RELUME_DEPS_DIR}/openimageio-${version}")
    set(${result} "${folder}" PARENT_SCOPE)
    file(SHA256 "${CMAKE_CURRENT_FUNCTION_LIST_FILE}" recipe)
    string(SUBSTRING "${recipe} ${CMAKE_C_COMPILER_ID}" 0 80 recipe)
    if(EXISTS "${folder}/recipe")
        file(READ "${folder}/recipe" made_by)
        if(made_by STREQUAL recipe)
            return()
        endif()
    endif()
    file(LOCK "${RELUME_DEPS_DIR}/openimageio.lock" GUARD FUNCTION TIMEOUT 600)
    set(tarball "${RELUME_DEPS_DIR}/openimageio-${version}.tar.gz")
    if(NOT EXISTS "${tarball}")
        message(STATUS "OpenImageIO ${version}: fetching its headers from PyPI")
        find_package(Python 3.11 REQUIRED COMPONENTS Interpreter)
        file(STRINGS "${PROJECT_SOURCE_DIR}/tools/oiio-source.txt" pin REGEX "==${version} ")
        file(WRITE "${RELUME_DEPS_DIR}/openimageio-${version}.txt" "${pin}\n")
        execute_process(
            COMMAND "${Python_EXECUTABLE}" -m pip download --quiet --no-deps --no-binary :all: --no-build-isolation
                    --require-hashes --requirement "${RELUME_DEPS_DIR}/openimageio-${version}.txt" --dest "${RELUME_DEPS_DIR}"
            RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
        if(NOT status EQUAL 0)
            message(FATAL_ERROR "OpenImageIO ${version}: fetching by pip failed (${status}):\n${output}\n"
                                "RELUME_OIIO_RELEASES=OFF builds for the installed OpenImageIO alone.")
        endif()
    endif()
    file(REMOVE_RECURSE "${folder}")
    file(ARCHIVE_EXTRACT INPUT "${tarball}" DESTINATION "${RELUME_DEPS_DIR}" PATTERNS "*/src/include/OpenImageIO/*")
    file(RENAME "${folder}/src/include" "${folder}/include")
    # What OpenImageIO's own configuration would say of a release.
    string(REPLACE "." ";" numbers "${version}")
    list(GET numbers 0 PROJECT_VERSION_MAJOR)
    list(GET numbers 1 PROJECT_VERSION_MINOR)
    list(GET numbers 2 PROJECT_VERSION_PATCH)
    list(GET numbers 3 PROJECT_VERSION_TWEAK)
    set(PROJECT_VERSION_RELEASE_TYPE "")
    set(PROJ_NAME OIIO)
    set(PROJ_NAMESPACE OpenImageIO)
    set(PROJ_VERSION_NAMESPACE "${inner}")
    set(PROJ_NAMESPACE_V "OpenImageIO_${inner}")
    set(OIIO_USE_COMPILED_FMT_VALUE 0)
    set(Imath_VERSION_MAJOR 3)
    set(Imath_VERSION_MINOR 1)
    set(CMAKE_CXX_STANDARD 17)
    set(OIIO_TBB OFF)
    configure_file("${folder}/include/OpenImageIO/oiioversion.h.in" "${folder}/include/OpenImageIO/oiioversion.h")
    file(MAKE_DIRECTORY "${folder}/lib")
    foreach(name OpenImageIO OpenImageIO_Util)
        execute_process(
            COMMAND "${CMAKE_C_COMPILER}" -shared -nostdlib -x c /dev/null "-Wl,-soname,lib${name}.so.${soversion}" -o
                    "${folder}/lib/lib${name}.so" COMMAND_ERROR_IS_FATAL ANY)
    endforeach()
    file(WRITE "${folder}/recipe" "${recipe}")
endfunction()
