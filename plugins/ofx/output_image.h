// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "clip_image.h"
#include "relume/image.h"

namespace relume::ofx {

/// The picture that a render fills, inside its window alone.
class OutputImage {
public:
    /// `window`: pixels, y up. Errors: value (the host's image does not cover the window's part of it).
    OutputImage(ClipImage image, const OfxRectI& window);

    /// The window's part that the image has.
    const OfxRectI& window() const { return window_; }
    /// Transparent black.
    void clear(const OfxRectI& rect);
    /// Planes at the top of `rect` for R, G, B and A, as far as the image has them, where pixels of half and float can
    /// be written to; empty for what must go through store().
    std::vector<Plane> planes(const OfxRectI& rect) const;
    /// Whether its pixels are R, G, B and A as float, and where pixel (x, y) is; the row below is `row_bytes` before
    /// it.
    bool holds_floats() const { return image_.depth() == Depth::float32 && image_.components() == 4; }
    std::byte* at(int x, int y) const { return image_.at(x, y); }
    std::ptrdiff_t row_bytes() const { return image_.row_bytes(); }
    /// Writes R, G, B, A of `rect`, row 0 at the top, rounded to what the image holds.
    void store(const OfxRectI& rect, std::span<const float> rgba);

private:
    ClipImage image_;
    OfxRectI window_;
};

}  // namespace relume::ofx
