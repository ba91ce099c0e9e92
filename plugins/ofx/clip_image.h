// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "instance.h"
#include "relume/image.h"

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

/// An image's first components as planes over a rectangle of pixels, row 0 at the top: where the image stands if it is
/// float or half and covers the rectangle, else a copy with 0 outside of the image. Bytes and shorts become 0..1, or
/// with `whole` the whole numbers that they are. Error(cancelled) as soon as `cancel` is set.
class FramePlanes {
public:
    FramePlanes(const ClipImage& image, const OfxRectI& rect, int components, bool whole,
                const std::atomic<bool>& cancel);
    int count() const { return static_cast<int>(planes_.size()); }
    const ConstPlane& operator[](int component) const { return planes_[static_cast<std::size_t>(component)]; }

    /// IDs that a filter has made: one that no neighbour to the side and none above or below shares gives way to the
    /// nearest that is, else to 0.
    void mend_ids(const std::atomic<bool>& cancel);

private:
    void copy(const ClipImage& image, const OfxRectI& rect, int components, bool whole,
              const std::atomic<bool>& cancel);
    void mend(int component, float* to, const std::atomic<bool>& cancel) const;
    int width_, height_;
    std::vector<ConstPlane> planes_;
    std::vector<std::byte> memory_;
};

OfxRectI intersection(const OfxRectI& a, const OfxRectI& b);
bool is_empty(const OfxRectI& rect);

}  // namespace relume::ofx
