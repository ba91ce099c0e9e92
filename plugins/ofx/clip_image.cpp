// SPDX-License-Identifier: Apache-2.0
#include "clip_image.h"

#include <algorithm>
#include <cmath>
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

}  // namespace

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

FramePlanes::FramePlanes(const ClipImage& image, const OfxRectI& rect, bool whole)
    : width_(rect.x2 - rect.x1), height_(rect.y2 - rect.y1) {
    const bool floating = image.depth() == Depth::float32 || image.depth() == Depth::half;
    if (!floating || !image.contains(rect)) {
        copy(image, rect, whole);
        return;
    }
    const PixelType type = image.depth() == Depth::half ? PixelType::half : PixelType::float32;
    for (int c = 0; c < image.components(); ++c)
        planes_.push_back({image.at(rect.x1, rect.y2 - 1) + c * static_cast<std::ptrdiff_t>(size_of(type)), type,
                           image.pixel_bytes(), -image.row_bytes()});
}

void FramePlanes::copy(const ClipImage& image, const OfxRectI& rect, bool whole) {
    const int components = image.components();
    const bool half = image.depth() == Depth::half;
    const PixelType type = half ? PixelType::half : PixelType::float32;
    const auto pixel = static_cast<std::ptrdiff_t>(size_of(type)) * components;
    const std::ptrdiff_t row = pixel * width_;
    memory_.assign(static_cast<std::size_t>(row) * static_cast<std::size_t>(height_), std::byte{0});
    const OfxRectI part = intersection(rect, image.bounds());
    if (!is_empty(part)) {
        const std::size_t count = static_cast<std::size_t>(part.x2 - part.x1) * static_cast<std::size_t>(components);
        for (int y = part.y1; y < part.y2; ++y) {
            const std::byte* from = image.at(part.x1, y);
            std::byte* to = memory_.data() + (rect.y2 - 1 - y) * row + (part.x1 - rect.x1) * pixel;
            if (half || image.depth() == Depth::float32) {
                std::memcpy(to, from, count * size_of(type));
                continue;
            }
            const std::size_t size = bytes_of(image.depth());
            for (std::size_t k = 0; k < count; ++k) {
                const float v = number_at(from + k * size, image.depth(), whole);
                std::memcpy(to + k * sizeof v, &v, sizeof v);
            }
        }
    }
    for (int c = 0; c < components; ++c)
        planes_.push_back({memory_.data() + c * static_cast<std::ptrdiff_t>(size_of(type)), type, pixel, row});
}

void FramePlanes::mend_ids() {
    const auto w = static_cast<std::size_t>(width_), h = static_cast<std::size_t>(height_);
    const std::size_t size = w * h;
    std::vector<std::byte> mended(planes_.size() * size * sizeof(float));
    std::vector<float> ids(size);
    std::vector<char> sure(size);
    for (std::size_t c = 0; c < planes_.size(); ++c) {
        const ConstPlane& plane = planes_[c];
        for (std::size_t y = 0; y < h; ++y)
            for (std::size_t x = 0; x < w; ++x)
                ids[y * w + x] = number_at(plane.data + static_cast<std::ptrdiff_t>(y) * plane.y_stride +
                                               static_cast<std::ptrdiff_t>(x) * plane.x_stride,
                                           plane.type == PixelType::half ? Depth::half : Depth::float32, true);
        const auto same = [&](std::size_t at, bool there, std::ptrdiff_t step) {
            return there && ids[static_cast<std::size_t>(static_cast<std::ptrdiff_t>(at) + step)] == ids[at];
        };
        const auto row = static_cast<std::ptrdiff_t>(w);
        for (std::size_t y = 0; y < h; ++y)
            for (std::size_t x = 0; x < w; ++x) {
                const std::size_t at = y * w + x;
                sure[at] = ids[at] == std::floor(ids[at]) && (same(at, x > 0, -1) || same(at, x + 1 < w, 1)) &&
                           (same(at, y > 0, -row) || same(at, y + 1 < h, row));
            }
        std::byte* to = mended.data() + c * size * sizeof(float);
        for (std::size_t y = 0; y < h; ++y)
            for (std::size_t x = 0; x < w; ++x) {
                float id = 0;
                int nearest = 100;
                for (int dy = -2; dy <= 2; ++dy)
                    for (int dx = -2; dx <= 2; ++dx) {
                        const auto i = static_cast<std::ptrdiff_t>(x) + dx, j = static_cast<std::ptrdiff_t>(y) + dy;
                        if (i < 0 || j < 0 || i >= row || j >= static_cast<std::ptrdiff_t>(h)) continue;
                        const auto from = static_cast<std::size_t>(j * row + i);
                        if (!sure[from] || dx * dx + dy * dy >= nearest) continue;
                        nearest = dx * dx + dy * dy;
                        id = ids[from];
                    }
                std::memcpy(to + (y * w + x) * sizeof id, &id, sizeof id);
            }
    }
    memory_ = std::move(mended);
    for (std::size_t c = 0; c < planes_.size(); ++c)
        planes_[c] = {memory_.data() + c * size * sizeof(float), PixelType::float32, sizeof(float),
                      static_cast<std::ptrdiff_t>(w * sizeof(float))};
}

}  // namespace relume::ofx
