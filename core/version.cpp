// SPDX-License-Identifier: Apache-2.0
#include "relume/version.h"

namespace relume {

std::string_view version() noexcept { return RELUME_VERSION; }

std::string_view openexr_build() noexcept { return RELUME_OPENEXR_BUILD; }

}  // namespace relume
