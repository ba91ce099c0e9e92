// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "relume/export.h"

namespace relume {

/// Whether a file's name stands for a sequence: it holds #### (any number of #), %04d (%d, %4d) or {frame}
/// ({frame:04d}). A single # counts in the file's own name only, not in a folder's.
RELUME_API bool is_pattern(std::string_view pattern);

/// The name of one frame: each place holder becomes the number, padded with zeros to the number of # or the digits of
/// %04d and {frame:04d}; {frame} is not padded. A name without place holders is returned as it is. A negative number's
/// minus counts as a digit, as in printf.
RELUME_API std::string resolve_frame(std::string_view pattern, std::int64_t frame);

/// The frames of "1001-1100x2,1200": numbers and ranges, last included, each with an optional step, in the order given
/// and without repetitions. Negative numbers are written as they are: "-10--5". Errors: value (what does not fit and
/// what would; a range that runs backwards; more than a million frames).
RELUME_API std::vector<std::int64_t> parse_frames(std::string_view text);

}  // namespace relume
