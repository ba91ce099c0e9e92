# SPDX-License-Identifier: Apache-2.0
# ccache where there is one. Paths are taken relative to the checkout, so that two clones share what they compiled.
find_program(RELUME_CCACHE_PROGRAM ccache)
mark_as_advanced(RELUME_CCACHE_PROGRAM)
if(RELUME_CCACHE_PROGRAM AND PROJECT_IS_TOP_LEVEL AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
    set(CMAKE_C_COMPILER_LAUNCHER
        "${CMAKE_COMMAND}" -E env "CCACHE_BASEDIR=${PROJECT_SOURCE_DIR}" CCACHE_NOHASHDIR=1 "${RELUME_CCACHE_PROGRAM}")
    set(CMAKE_CXX_COMPILER_LAUNCHER "${CMAKE_C_COMPILER_LAUNCHER}")
endif()
