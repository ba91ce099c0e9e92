// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "relume/gbuffer.h"

namespace relume {

/// A frame that a renderer filled with NaN is no picture: it would come out black. Throws (format) where one of the
/// channels is not finite in any of the pixels that hold a surface; `nonfinite` as in a report, over the whole frame.
void refuse_blank(const GBuffer& gbuffer, std::int64_t surfaces, const std::map<std::string, std::int64_t>& nonfinite);

}  // namespace relume
