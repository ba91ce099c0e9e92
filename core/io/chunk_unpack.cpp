// SPDX-License-Identifier: Apache-2.0
#include "io/chunk_unpack.h"

#include <algorithm>
#include <cstring>
#include <utility>
#include <vector>

#include "io/exr_header.h"
#include "io/pixel_convert.h"
#include "io/zip_rows.h"

namespace relume::io {

namespace {

std::byte* pixel_address(const Plane& plane, std::int64_t column, std::int64_t row) {
    return plane.data + row * plane.y_stride + column * plane.x_stride;
}

void clear_run(const Plane& plane, std::int64_t column, std::int64_t row, std::int64_t count) {
    if (count <= 0) {
        return;
    }
    std::byte* at = pixel_address(plane, column, row);
    const std::size_t size = size_of(plane.type);
    if (plane.x_stride == static_cast<std::ptrdiff_t>(size)) {
        std::memset(at, 0, static_cast<std::size_t>(count) * size);
        return;
    }
    for (std::int64_t i = 0; i < count; ++i, at += plane.x_stride) {
        std::memset(at, 0, size);
    }
}

// The first sampled coordinate at or after `start`.
std::int64_t first_sample(std::int64_t start, int sampling) { return -floor_div(-start, sampling) * sampling; }

// The sample that stands for `at`: the last one at or before it, but never one before the window's first.
std::int64_t sample_for(std::int64_t at, std::int64_t window_start, int sampling) {
    return std::max(floor_div(at, sampling) * sampling, first_sample(window_start, sampling));
}

// One row of samples into one row of the target; `box_x` is the first pixel of the chunk's row.
void unpack_row(const std::byte* samples, std::int64_t box_x, std::int64_t row_samples, const Channel& channel,
                std::int64_t window_x, std::int64_t x, std::int64_t count, std::byte* out, const Plane& plane) {
    const auto size = static_cast<std::ptrdiff_t>(size_of(channel.type));
    if (channel.x_sampling == 1) {
        convert_run({samples + (x - box_x) * size, channel.type, size}, {out, plane.type, plane.x_stride},
                    static_cast<std::size_t>(count));
        return;
    }
    const std::int64_t first = first_sample(box_x, channel.x_sampling);
    for (std::int64_t i = 0; i < count; ++i, out += plane.x_stride) {
        const std::int64_t sample = sample_for(x + i, window_x, channel.x_sampling);
        const std::int64_t index = std::clamp<std::int64_t>((sample - first) / channel.x_sampling, 0, row_samples - 1);
        convert_run({samples + index * size, channel.type, size}, {out, plane.type, plane.x_stride}, 1);
    }
}

}  // namespace

Window sampled_region(const Part& part, const Window& region, std::span<const ReadTarget> targets) {
    std::int64_t left = region.x;
    std::int64_t right = region.x_end();
    std::int64_t top = region.y;
    std::int64_t bottom = region.y_end();
    const Window& window = part.data_window;
    for (const ReadTarget& target : targets) {
        const Channel& channel = part.channels[static_cast<std::size_t>(target.channel)];
        left = std::min(left, sample_for(region.x, window.x, channel.x_sampling));
        right = std::max(right, sample_for(region.x, window.x, channel.x_sampling) + 1);
        top = std::min(top, sample_for(region.y, window.y, channel.y_sampling));
        bottom = std::max(bottom, sample_for(region.y, window.y, channel.y_sampling) + 1);
    }
    right = std::min<std::int64_t>(right, window.x_end());
    bottom = std::min<std::int64_t>(bottom, window.y_end());
    return {static_cast<int>(left), static_cast<int>(top), static_cast<int>(right - left),
            static_cast<int>(bottom - top)};
}

void unpack_chunk(std::span<const std::byte> pixels, const Window& box, const Part& part, const Window& region,
                  const Window& origin, std::span<const ReadTarget> targets) {
    const Window& window = part.data_window;
    const std::byte* samples = pixels.data();
    for (std::int64_t y = box.y; y < box.y_end(); ++y) {
        for (std::size_t c = 0; c < part.channels.size(); ++c) {
            const Channel& channel = part.channels[c];
            if (floor_div(y, channel.y_sampling) * channel.y_sampling != y) {
                continue;
            }
            const std::int64_t row_samples = sample_count(box.x, box.width, channel.x_sampling);
            // A sampled row stands for the rows up to the next; the first of all also for those above it.
            const std::int64_t from = y == first_sample(window.y, channel.y_sampling) ? window.y : y;
            const std::int64_t row_begin = std::max<std::int64_t>(from, region.y);
            const std::int64_t row_end = std::min<std::int64_t>(y + channel.y_sampling, region.y_end());
            const std::int64_t left = box.x == window.x ? box.x : first_sample(box.x, channel.x_sampling);
            const std::int64_t right =
                box.x_end() == window.x_end() ? box.x_end() : first_sample(box.x_end(), channel.x_sampling);
            const std::int64_t column_begin = std::max<std::int64_t>(left, region.x);
            const std::int64_t column_end = std::min<std::int64_t>(right, region.x_end());
            if (row_samples > 0 && column_begin < column_end) {
                for (const ReadTarget& target : targets) {
                    if (static_cast<std::size_t>(target.channel) != c) {
                        continue;
                    }
                    for (std::int64_t row = row_begin; row < row_end; ++row) {
                        unpack_row(samples, box.x, row_samples, channel, window.x, column_begin,
                                   column_end - column_begin,
                                   pixel_address(target.plane, column_begin - origin.x, row - origin.y), target.plane);
                    }
                }
            }
            samples += row_samples * static_cast<std::int64_t>(size_of(channel.type));
        }
    }
}

void unpack_zip_chunk(std::span<const std::byte> inflated, const Window& box, const Part& part, const Window& region,
                      const Window& origin, std::span<const ReadTarget> targets) {
    ZipRows rows(inflated.data(), inflated.size());
    const std::int64_t begin = std::max(box.x, region.x), end = std::min(box.x_end(), region.x_end());
    const auto width = static_cast<std::size_t>(box.width);
    std::vector<std::byte> samples;
    std::size_t skipped = 0;
    for (int y = box.y; y < box.y_end(); ++y) {
        for (std::size_t c = 0; c < part.channels.size(); ++c) {
            const PixelType type = part.channels[c].type;
            const std::size_t size = size_of(type), bytes = width * size;
            const auto wanted = [c](const ReadTarget& t) { return static_cast<std::size_t>(t.channel) == c; };
            const auto first = std::find_if(targets.begin(), targets.end(), wanted);
            if (first == targets.end() || y < region.y || y >= region.y_end() || begin >= end) {
                skipped += bytes;
                continue;
            }
            rows.skip(std::exchange(skipped, 0));
            const auto address = [&](const ReadTarget& t) {
                return pixel_address(t.plane, begin - origin.x, y - origin.y);
            };
            const Plane& plane = first->plane;
            const bool contiguous = plane.x_stride == static_cast<std::ptrdiff_t>(size_of(plane.type));
            const bool alone = std::find_if(first + 1, targets.end(), wanted) == targets.end();
            if (alone && contiguous && end - begin == box.width &&
                (plane.type == type || (type == PixelType::half && plane.type == PixelType::float32))) {
                if (plane.type == type) {
                    rows.read(address(*first), bytes);
                } else {
                    rows.read_halves(address(*first), width);
                }
                continue;
            }
            samples.resize(bytes);
            rows.read(samples.data(), bytes);
            for (const ReadTarget& t : targets) {
                if (wanted(t)) {
                    convert_run({samples.data() + static_cast<std::size_t>(begin - box.x) * size, type,
                                 static_cast<std::ptrdiff_t>(size)},
                                {address(t), t.plane.type, t.plane.x_stride}, static_cast<std::size_t>(end - begin));
                }
            }
        }
    }
}

void clear_outside(const Window& origin, const Window& inside, std::span<const ReadTarget> targets) {
    for (const ReadTarget& target : targets) {
        for (int row = 0; row < origin.height; ++row) {
            const int y = origin.y + row;
            if (inside.empty() || y < inside.y || y >= inside.y_end()) {
                clear_run(target.plane, 0, row, origin.width);
                continue;
            }
            clear_run(target.plane, 0, row, inside.x - origin.x);
            clear_run(target.plane, inside.x_end() - origin.x, row, origin.x_end() - inside.x_end());
        }
    }
}

}  // namespace relume::io
