# SPDX-License-Identifier: Apache-2.0
# relume::opencolorio, by header and library: the package files that Debian 12 ships for CMake point to nowhere. Used by
# the build and by the installed package alike.
find_path(RELUME_OPENCOLORIO_INCLUDE_DIR OpenColorIO/OpenColorIO.h REQUIRED)
find_library(RELUME_OPENCOLORIO_LIBRARY OpenColorIO REQUIRED)
mark_as_advanced(RELUME_OPENCOLORIO_INCLUDE_DIR RELUME_OPENCOLORIO_LIBRARY)
if(NOT TARGET relume::opencolorio)
    add_library(relume::opencolorio UNKNOWN IMPORTED GLOBAL)
    set_target_properties(
        relume::opencolorio PROPERTIES IMPORTED_LOCATION "${RELUME_OPENCOLORIO_LIBRARY}"
                                       INTERFACE_INCLUDE_DIRECTORIES "${RELUME_OPENCOLORIO_INCLUDE_DIR}")
endif()
