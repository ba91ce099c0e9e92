// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "io/exr.h"
#include "io/exr_core.h"

namespace relume::io {

/// Translates the header that OpenEXRCore parsed, and checks it against `limits` and against what a file of `file_size`
/// bytes can hold, so that whoever allocates a part's pixels does so for a file that may have them.
/// Throws Error(format).
Header read_header(exr_const_context_t context, const std::filesystem::path& path, std::int64_t file_size,
                   const ReadLimits& limits);

/// How many times smaller than its pixels a chunk can be at most.
std::uint64_t max_ratio(Compression compression);

/// "part 3 'ViewLayer.Normal': ", for messages; "" for the only part of a file.
std::string part_label(const Header& header, int part);

/// Samples at multiples of `sampling` among the `count` coordinates from `start` on.
std::int64_t sample_count(std::int64_t start, std::int64_t count, int sampling);

/// Bytes of the pixels of `box` in a chunk, in the file's own types.
std::uint64_t unpacked_bytes(const Part& part, const Window& box);

constexpr std::int64_t floor_div(std::int64_t value, std::int64_t divisor) {
    const std::int64_t quotient = value / divisor;
    return value % divisor < 0 ? quotient - 1 : quotient;
}

}  // namespace relume::io
