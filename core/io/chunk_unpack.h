// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "io/exr.h"

namespace relume::io {

/// Rows and columns of a chunk that must be decoded so that all pixels of `region` have the sample that stands for
/// them: `region` itself, grown where a target's channel is subsampled. Both lie in the part's data window.
Window sampled_region(const Part& part, const Window& region, std::span<const ReadTarget> targets);

/// Converts the pixels that `region` and the chunk share, with each subsampled sample standing for all pixels up to the
/// next. `pixels` holds the chunk whose pixels cover `box`, laid out as in the file; `targets` all belong to `part`,
/// and their planes start at `origin`'s top left pixel.
void unpack_chunk(std::span<const std::byte> pixels, const Window& box, const Part& part, const Window& region,
                  const Window& origin, std::span<const ReadTarget> targets);

/// The same for a chunk that was inflated and no more (no channel of the part is subsampled then).
void unpack_zip_chunk(std::span<const std::byte> inflated, const Window& box, const Part& part, const Window& region,
                      const Window& origin, std::span<const ReadTarget> targets);

/// Zeroes the pixels of `origin` that lie outside `inside`, in every target.
void clear_outside(const Window& origin, const Window& inside, std::span<const ReadTarget> targets);

}  // namespace relume::io
