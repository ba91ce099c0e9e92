// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <vector>

#include "clip_image.h"
#include "relume/image.h"

namespace relume::ofx {

/// How an image's numbers are meant.
enum class Numbers {
    values,       ///< bytes and shorts are 0..1
    ids,          ///< bytes and shorts are the whole numbers that they are
    blurred_ids,  ///< the same, after a filter: one that no neighbour to the side and none above or below shares gives
                  ///< way to the nearest that is, else to 0
};

/// An image's first components as planes over a frame of pixels, row 0 at the top: where the image stands if it is
/// float or half and covers the frame, else memory of the frame's size that is filled where it is needed, with 0
/// outside of the image. What is not filled is never touched.
class FramePlanes {
public:
    /// `image` stays where it is.
    FramePlanes(const ClipImage& image, const OfxRectI& frame, int components, Numbers numbers);
    int count() const { return static_cast<int>(planes_.size()); }
    const ConstPlane& operator[](int component) const { return planes_[static_cast<std::size_t>(component)]; }

    /// Fills a part of the frame; the same part any number of times. Error(cancelled) as soon as `cancel` is set.
    void fill(const OfxRectI& part, const std::atomic<bool>& cancel);
    /// Row y alone, in this thread; other threads may fill other rows.
    void fill_row(int y);

private:
    void convert(int x1, int x2, int y, int component);
    void mend(const OfxRectI& part, int component);
    float number(int x, int y, int component) const;
    std::byte* at(int x, int y, int component) const;

    const ClipImage& image_;
    OfxRectI frame_;
    Numbers numbers_;
    PixelType type_ = PixelType::float32;
    std::vector<ConstPlane> planes_;
    std::unique_ptr<std::byte[]> memory_;
};

/// Pixels that were filled in this process, one for each image: how much work that is.
std::int64_t filled_pixels();

}  // namespace relume::ofx
