// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

// The pixels of the files in tests/data/exr: their maker and the tests that read them share nothing but this.

/// Channel `channel` at pixel (x, y): exact in half precision, in steps, so that every compression finds something to
/// do.
inline float pattern_value(int channel, int x, int y) {
    return static_cast<float>(((x >> 1) * 8 + (y >> 1) * 16 + channel * 32) & 1023) / 16.0f - 20.0f;
}

inline std::uint32_t pattern_uint(int channel, int x, int y) {
    return 3000000000u + static_cast<std::uint32_t>((x >> 2) + 100 * (y >> 2) + channel);
}
