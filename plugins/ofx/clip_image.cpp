// SPDX-License-Identifier: Apache-2.0
#include "clip_image.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>

#include "io/pixel_convert.h"
#include "relume/error.h"
#include "threads/workers.h"

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

FramePlanes::FramePlanes(const ClipImage& image, const OfxRectI& rect, int components, bool whole,
                         const std::atomic<bool>& cancel)
    : width_(rect.x2 - rect.x1), height_(rect.y2 - rect.y1) {
    const bool floating = image.depth() == Depth::float32 || image.depth() == Depth::half;
    components = std::min(components, image.components());
    if (!floating || !image.contains(rect)) {
        copy(image, rect, components, whole, cancel);
        return;
    }
    const PixelType type = image.depth() == Depth::half ? PixelType::half : PixelType::float32;
    for (int c = 0; c < components; ++c)
        planes_.push_back({image.at(rect.x1, rect.y2 - 1) + c * static_cast<std::ptrdiff_t>(size_of(type)), type,
                           image.pixel_bytes(), -image.row_bytes()});
}

void FramePlanes::copy(const ClipImage& image, const OfxRectI& rect, int components, bool whole,
                       const std::atomic<bool>& cancel) {
    const bool half = image.depth() == Depth::half;
    const PixelType type = half ? PixelType::half : PixelType::float32;
    const std::size_t size = size_of(type), stored = bytes_of(image.depth());
    const auto row = static_cast<std::ptrdiff_t>(size) * width_;
    const std::ptrdiff_t plane = row * height_;
    memory_.assign(static_cast<std::size_t>(plane) * static_cast<std::size_t>(components), std::byte{0});
    for (int c = 0; c < components; ++c) planes_.push_back({memory_.data() + c * plane, type, row / width_, row});
    const OfxRectI part = intersection(rect, image.bounds());
    if (is_empty(part)) return;
    const auto count = static_cast<std::size_t>(part.x2 - part.x1);
    parallel_for(part.y2 - part.y1, default_threads(), &cancel, [&](int, int index) {
        const int y = part.y1 + index;
        for (int c = 0; c < components; ++c) {
            const std::byte* from = image.at(part.x1, y) + static_cast<std::ptrdiff_t>(stored) * c;
            std::byte* to = memory_.data() + c * plane + (rect.y2 - 1 - y) * row +
                            static_cast<std::ptrdiff_t>(size) * (part.x1 - rect.x1);
            for (std::size_t k = 0; k < count; ++k, from += image.pixel_bytes(), to += size) {
                if (half) {
                    std::memcpy(to, from, size);
                } else {
                    const float v = number_at(from, image.depth(), whole);
                    std::memcpy(to, &v, sizeof v);
                }
            }
        }
    });
}

void FramePlanes::mend_ids(const std::atomic<bool>& cancel) {
    const std::size_t size = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
    std::vector<std::byte> mended(planes_.size() * size * sizeof(float));
    for (std::size_t c = 0; c < planes_.size(); ++c)
        mend(static_cast<int>(c), reinterpret_cast<float*>(mended.data()) + c * size, cancel);
    memory_ = std::move(mended);
    for (std::size_t c = 0; c < planes_.size(); ++c)
        planes_[c] = {memory_.data() + c * size * sizeof(float), PixelType::float32, sizeof(float),
                      std::ptrdiff_t{4} * width_};
}

void FramePlanes::mend(int component, float* to, const std::atomic<bool>& cancel) const {
    const ConstPlane& plane = (*this)[component];
    const int w = width_, h = height_, threads = default_threads();
    const auto at = [w](int x, int y) {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(w) + static_cast<std::size_t>(x);
    };
    std::vector<float> ids(static_cast<std::size_t>(w) * static_cast<std::size_t>(h));
    std::vector<char> sure(ids.size());
    const Depth depth = plane.type == PixelType::half ? Depth::half : Depth::float32;
    parallel_for(h, threads, &cancel, [&](int, int y) {
        for (int x = 0; x < w; ++x)
            ids[at(x, y)] = number_at(plane.data + y * plane.y_stride + x * plane.x_stride, depth, true);
    });
    parallel_for(h, threads, &cancel, [&](int, int y) {
        for (int x = 0; x < w; ++x) {
            const float id = ids[at(x, y)];
            const bool beside = (x > 0 && ids[at(x - 1, y)] == id) || (x + 1 < w && ids[at(x + 1, y)] == id);
            const bool above = (y > 0 && ids[at(x, y - 1)] == id) || (y + 1 < h && ids[at(x, y + 1)] == id);
            sure[at(x, y)] = id == std::floor(id) && beside && above;
        }
    });
    parallel_for(h, threads, &cancel, [&](int, int y) {
        for (int x = 0; x < w; ++x) {
            float id = sure[at(x, y)] ? ids[at(x, y)] : 0;
            int nearest = sure[at(x, y)] ? 0 : 100;
            for (int j = std::max(y - 2, 0); nearest > 0 && j <= std::min(y + 2, h - 1); ++j)
                for (int i = std::max(x - 2, 0); i <= std::min(x + 2, w - 1); ++i) {
                    const int distance = (i - x) * (i - x) + (j - y) * (j - y);
                    if (!sure[at(i, j)] || distance >= nearest) continue;
                    nearest = distance;
                    id = ids[at(i, j)];
                }
            to[at(x, y)] = id;
        }
    });
}

}  // namespace relume::ofx
