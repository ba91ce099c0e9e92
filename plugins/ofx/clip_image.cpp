// SPDX-License-Identifier: Apache-2.0
#include "clip_image.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <utility>

#include "io/pixel_convert.h"
#include "relume/error.h"

namespace relume::ofx {

namespace {

std::size_t bytes_of(Depth depth) {
    switch (depth) {
        case Depth::byte:
            return 1;
        case Depth::short_integer:
        case Depth::half:
            return 2;
        case Depth::float32:
            break;
    }
    return 4;
}

Depth depth_named(const std::string& name) {
    if (name == name::kDepthByte) return Depth::byte;
    if (name == name::kDepthShort) return Depth::short_integer;
    if (name == name::kDepthHalf) return Depth::half;
    if (name == name::kDepthFloat) return Depth::float32;
    throw Error(ErrorKind::format, "an image has pixels of depth '" + name + "', which Relume does not read");
}

int components_named(const std::string& name) {
    if (name == name::kRgba) return 4;
    if (name == name::kRgb) return 3;
    if (name == name::kAlpha) return 1;
    throw Error(ErrorKind::format, "an image has components '" + name + "', which Relume does not read");
}

}  // namespace

float number_at(const std::byte* at, Depth depth, bool whole) {
    switch (depth) {
        case Depth::byte: {
            const auto v = static_cast<float>(std::to_integer<int>(*at));
            return whole ? v : v / 255.f;
        }
        case Depth::short_integer: {
            std::uint16_t v = 0;
            std::memcpy(&v, at, sizeof v);
            return whole ? static_cast<float>(v) : static_cast<float>(v) / 65535.f;
        }
        case Depth::half: {
            std::uint16_t v = 0;
            std::memcpy(&v, at, sizeof v);
            return io::half_to_float(v);
        }
        case Depth::float32:
            break;
    }
    float v = 0;
    std::memcpy(&v, at, sizeof v);
    return v;
}

OfxRectI intersection(const OfxRectI& a, const OfxRectI& b) {
    return {std::max(a.x1, b.x1), std::max(a.y1, b.y1), std::min(a.x2, b.x2), std::min(a.y2, b.y2)};
}

bool is_empty(const OfxRectI& rect) { return rect.x1 >= rect.x2 || rect.y1 >= rect.y2; }

std::optional<ClipImage> ClipImage::fetch(OfxImageClipHandle clip, double time, const OfxRectD* region) {
    OfxPropertySetHandle handle = nullptr;
    if (clip == nullptr) return std::nullopt;
    if (host().effect->clipGetImage(clip, time, region, &handle) != kOk || handle == nullptr) return std::nullopt;
    ClipImage image(handle);  // given back whatever follows
    const Properties p(handle);
    void* data = nullptr;
    std::array<int, 4> bounds{};
    if (!p.get(name::kPropData, data) || data == nullptr || !p.get(name::kPropBounds, bounds)) return std::nullopt;
    image.data_ = static_cast<std::byte*>(data);
    image.bounds_ = {bounds[0], bounds[1], bounds[2], bounds[3]};
    if (is_empty(image.bounds_)) return std::nullopt;
    image.depth_ = depth_named(p.text(name::kPropPixelDepth));
    image.components_ = components_named(p.text(name::kPropComponents));
    image.row_bytes_ = p.integer(name::kPropRowBytes, 0);
    if (image.row_bytes_ == 0) image.row_bytes_ = (bounds[2] - bounds[0]) * image.pixel_bytes();
    return image;
}

ClipImage::ClipImage(ClipImage&& other) noexcept
    : handle_(std::exchange(other.handle_, nullptr)),
      data_(other.data_),
      bounds_(other.bounds_),
      row_bytes_(other.row_bytes_),
      depth_(other.depth_),
      components_(other.components_) {}

ClipImage::~ClipImage() {
    if (handle_) host().effect->clipReleaseImage(handle_);
}

std::ptrdiff_t ClipImage::pixel_bytes() const { return static_cast<std::ptrdiff_t>(bytes_of(depth_)) * components_; }

}  // namespace relume::ofx
