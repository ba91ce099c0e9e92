# SPDX-License-Identifier: Apache-2.0
# A process may hold other copies of OpenEXR, zstd and libdeflate (Blender, OpenImageIO, PyPI's OpenEXR): nothing but
# our own names leaves a binary of ours. --exclude-libs hides static archives, the version script what is left: weak
# instances of standard library templates, which have default visibility whatever the flags say.
function(relume_export_symbols target map)
    target_link_options(
        ${target} PRIVATE LINKER:--exclude-libs,ALL "LINKER:--version-script=${map}"
                          $<$<NOT:$<BOOL:${RELUME_SANITIZE}>>:LINKER:--no-undefined>)
    set_property(TARGET ${target} APPEND PROPERTY LINK_DEPENDS "${map}")
endfunction()
