// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace relume {

/// The last step of a tile: shaded light over the picture that was there. All planes are `count` contiguous floats.
struct ComposeTile {
    std::int32_t count;
    const float* normal[3];  ///< 0 is background
    const float* coverage;   ///< null: 1
    const float* alpha;      ///< null: 1
    const float* beauty[3];  ///< null: 0
    const float* light[3];   ///< shaded radiance of the covered part
    std::int32_t add;        ///< add to the beauty instead of replacing it
    /// R, G, B, A (A may be null). With `interleaved` set rgba[0] points to 4·count floats, R G B A by pixel. `stream`:
    /// stores that bypass the cache; interleaved, rgba[0] is 16-byte aligned then.
    float* rgba[4];
    std::int32_t interleaved;
    std::int32_t stream;
    float* cover;         ///< out, may be null: coverage of the surface, 0 on background; AOVs are multiplied by it
    std::int64_t shaded;  ///< out: pixels with any coverage
    std::int64_t
        nonfinite;  ///< out: pixels whose beauty, alpha or coverage is NaN or infinite; that value is taken as 0
};

using ComposeFunction = void (*)(ComposeTile*);

/// Of the active instruction set.
ComposeFunction compose_kernel();

}  // namespace relume
