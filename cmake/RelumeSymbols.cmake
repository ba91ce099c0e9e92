# SPDX-License-Identifier: Apache-2.0
# A process may hold other copies of OpenEXR, zstd and libdeflate (Blender, OpenImageIO, PyPI's OpenEXR): nothing but
# our own names leaves a binary of ours. --exclude-libs hides static archives, the version script what is left: weak
# instances of standard library templates, which have default visibility whatever the flags say.
function(relume_export_symbols target map)
    target_link_options(${target} PRIVATE LINKER:--exclude-libs,ALL "LINKER:--version-script=${map}")
    get_target_property(type ${target} TYPE)
    if(type STREQUAL "SHARED_LIBRARY" AND NOT RELUME_SANITIZE)
        # A Python module takes its undefined symbols from the interpreter, a sanitized library from its runtime.
        target_link_options(${target} PRIVATE LINKER:--no-undefined)
    endif()
    set_property(TARGET ${target} APPEND PROPERTY LINK_DEPENDS "${map}")
endfunction()
