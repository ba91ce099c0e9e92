// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "relume/export.h"

namespace relume {

/// Version of the library that is loaded, "0.1.0": what `relume --version`, the output's metadata and `relume doctor`
/// say.
RELUME_API std::string_view version() noexcept;

/// "OpenEXR 3.5.3 (bundled)" or "OpenEXR 3.1.5 (system)": which OpenEXRCore the library was built with.
RELUME_API std::string_view openexr_build() noexcept;

}  // namespace relume
