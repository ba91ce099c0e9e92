// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "instance.h"

namespace relume::ofx {

enum class Depth { byte, short_integer, half, float32 };

/// An image of a clip, given back when this object ends.
class ClipImage {
public:
    /// Nothing where the clip is not connected, or is and has no image. `region` canonical, null for the host's choice.
    static std::optional<ClipImage> fetch(OfxImageClipHandle clip, double time, const OfxRectD* region);
    ClipImage(ClipImage&& other) noexcept;
    ClipImage& operator=(ClipImage&&) = delete;
    ~ClipImage();

    OfxRectI bounds() const { return bounds_; }
    Depth depth() const { return depth_; }
    int components() const { return components_; }  ///< 4, 3 or 1
    std::ptrdiff_t pixel_bytes() const;
    std::ptrdiff_t row_bytes() const { return row_bytes_; }
    Properties properties() const { return Properties(handle_); }
    /// Pixel (x, y), y up, which lies inside the bounds.
    std::byte* at(int x, int y) const {
        return data_ + (y - bounds_.y1) * row_bytes_ + (x - bounds_.x1) * pixel_bytes();
    }
    bool contains(const OfxRectI& rect) const {
        return bounds_.x1 <= rect.x1 && bounds_.y1 <= rect.y1 && bounds_.x2 >= rect.x2 && bounds_.y2 >= rect.y2;
    }

private:
    explicit ClipImage(OfxPropertySetHandle handle) : handle_(handle) {}
    OfxPropertySetHandle handle_ = nullptr;
    std::byte* data_ = nullptr;
    OfxRectI bounds_{};
    std::ptrdiff_t row_bytes_ = 0;
    Depth depth_ = Depth::float32;
    int components_ = 4;
};

/// One component as stored. Bytes and shorts become 0..1, or with `whole` the whole numbers that they are.
float number_at(const std::byte* at, Depth depth, bool whole);

OfxRectI intersection(const OfxRectI& a, const OfxRectI& b);
bool is_empty(const OfxRectI& rect);

}  // namespace relume::ofx
