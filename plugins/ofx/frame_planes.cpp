// SPDX-License-Identifier: Apache-2.0
#include "frame_planes.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "threads/workers.h"

namespace relume::ofx {

namespace {

std::atomic<std::int64_t> filled{0};

/// How far the mending of an ID looks: for one that is sure two pixels away, whose neighbours have to be known.
constexpr int kMendReach = 3;

std::int64_t area_of(const OfxRectI& rect) { return std::int64_t{rect.x2 - rect.x1} * (rect.y2 - rect.y1); }

}  // namespace

std::int64_t filled_pixels() { return filled; }

FramePlanes::FramePlanes(const ClipImage& image, const OfxRectI& frame, int components, Numbers numbers)
    : image_(image), frame_(frame), numbers_(numbers) {
    const bool floating = image.depth() == Depth::float32 || image.depth() == Depth::half;
    components = std::min(components, image.components());
    if (image.depth() == Depth::half && numbers != Numbers::blurred_ids) type_ = PixelType::half;
    const auto size = static_cast<std::ptrdiff_t>(size_of(type_));
    if (floating && image.contains(frame) && numbers != Numbers::blurred_ids) {
        for (int c = 0; c < components; ++c)
            planes_.push_back(
                {image.at(frame.x1, frame.y2 - 1) + c * size, type_, image.pixel_bytes(), -image.row_bytes()});
        return;
    }
    const std::ptrdiff_t row = size * (frame.x2 - frame.x1), plane = row * (frame.y2 - frame.y1);
    // Not cleared: pages that nobody fills cost nothing.
    memory_ = std::make_unique_for_overwrite<std::byte[]>(static_cast<std::size_t>(plane) *
                                                          static_cast<std::size_t>(components));
    for (int c = 0; c < components; ++c) planes_.push_back({memory_.get() + c * plane, type_, size, row});
}

void FramePlanes::fill(const OfxRectI& part, const std::atomic<bool>& cancel) {
    const OfxRectI rect = intersection(part, frame_);
    if (!memory_ || is_empty(rect)) return;
    filled += area_of(rect);
    // Mending looks at the rows around: it is dearer for one row than for several.
    const int rows = numbers_ == Numbers::blurred_ids ? 16 : 1;
    parallel_for((rect.y2 - rect.y1 + rows - 1) / rows, default_threads(), &cancel, [&](int, int band) {
        const int y = rect.y1 + band * rows;
        for (int c = 0; c < count(); ++c) {
            if (numbers_ == Numbers::blurred_ids) mend({rect.x1, y, rect.x2, std::min(y + rows, rect.y2)}, c);
            else convert(rect.x1, rect.x2, y, c);
        }
    });
}

void FramePlanes::fill_row(int y) {
    if (!memory_ || y < frame_.y1 || y >= frame_.y2) return;
    filled += frame_.x2 - frame_.x1;
    for (int c = 0; c < count(); ++c) {
        if (numbers_ == Numbers::blurred_ids) mend({frame_.x1, y, frame_.x2, y + 1}, c);
        else convert(frame_.x1, frame_.x2, y, c);
    }
}

std::byte* FramePlanes::at(int x, int y, int component) const {
    const auto size = static_cast<std::ptrdiff_t>(size_of(type_));
    const std::ptrdiff_t width = frame_.x2 - frame_.x1, height = frame_.y2 - frame_.y1;
    return memory_.get() + size * (width * (height * component + frame_.y2 - 1 - y) + x - frame_.x1);
}

void FramePlanes::convert(int x1, int x2, int y, int component) {
    const std::size_t size = size_of(type_);
    const auto bytes = [size](int first, int end) { return size * static_cast<std::size_t>(end - first); };
    const OfxRectI seen = intersection({x1, y, x2, y + 1}, image_.bounds());
    std::byte* to = at(x1, y, component);
    if (is_empty(seen)) {
        std::memset(to, 0, bytes(x1, x2));
        return;
    }
    std::memset(to, 0, bytes(x1, seen.x1));
    std::memset(to + bytes(x1, seen.x2), 0, bytes(seen.x2, x2));
    to += bytes(x1, seen.x1);
    const std::ptrdiff_t step = image_.pixel_bytes();
    const std::byte* from = image_.at(seen.x1, y) + step / image_.components() * component;
    for (int x = seen.x1; x < seen.x2; ++x, from += step, to += size) {
        if (type_ == PixelType::half) {
            std::memcpy(to, from, size);
        } else {
            const float v = number_at(from, image_.depth(), numbers_ != Numbers::values);
            std::memcpy(to, &v, sizeof v);
        }
    }
}

float FramePlanes::number(int x, int y, int component) const {
    const OfxRectI& b = image_.bounds();
    if (x < b.x1 || x >= b.x2 || y < b.y1 || y >= b.y2) return 0;
    return number_at(image_.at(x, y) + image_.pixel_bytes() / image_.components() * component, image_.depth(), true);
}

void FramePlanes::mend(const OfxRectI& part, int component) {
    const OfxRectI around =
        intersection({part.x1 - kMendReach, part.y1 - kMendReach, part.x2 + kMendReach, part.y2 + kMendReach}, frame_);
    const int w = around.x2 - around.x1, h = around.y2 - around.y1;
    const auto index = [w](int x, int y) {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(w) + static_cast<std::size_t>(x);
    };
    // From the top down, as rows of the frame go: of several that are as near the first is taken.
    std::vector<float> ids(static_cast<std::size_t>(w) * static_cast<std::size_t>(h));
    std::vector<char> sure(ids.size());
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) ids[index(x, y)] = number(around.x1 + x, around.y2 - 1 - y, component);
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
            const float id = ids[index(x, y)];
            const bool beside = (x > 0 && ids[index(x - 1, y)] == id) || (x + 1 < w && ids[index(x + 1, y)] == id);
            const bool above = (y > 0 && ids[index(x, y - 1)] == id) || (y + 1 < h && ids[index(x, y + 1)] == id);
            sure[index(x, y)] = id == std::floor(id) && beside && above;
        }
    for (int y = around.y2 - part.y2; y < around.y2 - part.y1; ++y)
        for (int x = part.x1 - around.x1; x < part.x2 - around.x1; ++x) {
            float id = sure[index(x, y)] ? ids[index(x, y)] : 0;
            int nearest = sure[index(x, y)] ? 0 : 100;
            for (int j = std::max(y - 2, 0); nearest > 0 && j <= std::min(y + 2, h - 1); ++j)
                for (int i = std::max(x - 2, 0); i <= std::min(x + 2, w - 1); ++i) {
                    const int distance = (i - x) * (i - x) + (j - y) * (j - y);
                    if (!sure[index(i, j)] || distance >= nearest) continue;
                    nearest = distance;
                    id = ids[index(i, j)];
                }
            std::memcpy(at(around.x1 + x, around.y2 - 1 - y, component), &id, sizeof id);
        }
}

}  // namespace relume::ofx
