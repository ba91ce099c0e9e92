// SPDX-License-Identifier: Apache-2.0
#include "output_image.h"

#include <cmath>
#include <cstring>
#include <utility>

#include "io/pixel_convert.h"

namespace relume::ofx {

namespace {

/// 0..1 to whole numbers, to the nearest; NaN is 0.
template <class Integer> void put_integer(std::byte* to, float value, float largest) {
    const float scaled = value > 0 ? std::fmin(value, 1.f) * largest + 0.5f : 0.f;
    const auto whole = static_cast<Integer>(scaled);
    std::memcpy(to, &whole, sizeof whole);
}

void put(std::byte* to, Depth depth, float value) {
    switch (depth) {
        case Depth::byte:
            put_integer<std::uint8_t>(to, value, 255.f);
            return;
        case Depth::short_integer:
            put_integer<std::uint16_t>(to, value, 65535.f);
            return;
        case Depth::half: {
            const std::uint16_t half = io::float_to_half(value);
            std::memcpy(to, &half, sizeof half);
            return;
        }
        case Depth::float32:
            std::memcpy(to, &value, sizeof value);
            return;
    }
}

}  // namespace

OutputImage::OutputImage(ClipImage image, const OfxRectI& window)
    : image_(std::move(image)), window_(intersection(window, image_.bounds())) {
    if (is_empty(window_)) window_ = {};
}

void OutputImage::clear(const OfxRectI& rect) {
    const OfxRectI part = intersection(rect, window_);
    if (is_empty(part)) return;
    const auto bytes = static_cast<std::size_t>((part.x2 - part.x1) * image_.pixel_bytes());
    for (int y = part.y1; y < part.y2; ++y) std::memset(image_.at(part.x1, y), 0, bytes);
}

std::vector<Plane> OutputImage::planes(const OfxRectI& rect) const {
    const bool half = image_.depth() == Depth::half;
    if ((!half && image_.depth() != Depth::float32) || image_.components() < 3) return {};
    const PixelType type = half ? PixelType::half : PixelType::float32;
    std::vector<Plane> planes;
    for (int c = 0; c < image_.components(); ++c)
        planes.push_back({image_.at(rect.x1, rect.y2 - 1) + c * static_cast<std::ptrdiff_t>(size_of(type)), type,
                          image_.pixel_bytes(), -image_.row_bytes()});
    return planes;
}

void OutputImage::store(const OfxRectI& rect, std::span<const float> rgba) {
    const int components = image_.components();
    const std::ptrdiff_t size = image_.pixel_bytes() / components;
    const float* from = rgba.data();
    for (int y = rect.y2 - 1; y >= rect.y1; --y) {
        std::byte* to = image_.at(rect.x1, y);
        for (int x = rect.x1; x < rect.x2; ++x, from += 4) {
            // An image of one component is alpha.
            for (int c = 0; c < components; ++c, to += size) put(to, image_.depth(), from[components == 1 ? 3 : c]);
        }
    }
}

}  // namespace relume::ofx
