// SPDX-License-Identifier: Apache-2.0
#include "gbuffer/kept_pixels.h"

#include "io/pixel_convert.h"

namespace relume::gbuffer {

namespace {

void copy_row(const std::byte* from, const Plane& to, int row, PixelType type, int count) {
    io::convert_run({from, type, static_cast<std::ptrdiff_t>(size_of(type))},
                    {to.data + row * to.y_stride, to.type, to.x_stride}, static_cast<std::size_t>(count));
}

}  // namespace

KeptPixels::Kept* KeptPixels::plane(const io::ReadTarget& target) const {
    const std::scoped_lock lock(mutex_);
    std::unique_ptr<Kept>& kept = planes_[{target.part, target.channel, target.plane.type}];
    if (kept) return kept->memory.empty() ? nullptr : kept.get();
    kept = std::make_unique<Kept>();
    const std::int64_t bytes =
        std::int64_t{window_.width} * window_.height * static_cast<std::int64_t>(size_of(target.plane.type));
    if (bytes_->fetch_sub(bytes) < bytes) {
        bytes_->fetch_add(bytes);
        return nullptr;
    }
    kept->memory.resize(static_cast<std::size_t>(bytes));
    kept->rows = std::vector<std::atomic<std::uint8_t>>(static_cast<std::size_t>(window_.height));
    return kept.get();
}

std::byte* KeptPixels::row_of(Kept& kept, int y, PixelType type) const {
    return kept.memory.data() +
           static_cast<std::size_t>(y - window_.y) * static_cast<std::size_t>(window_.width) * size_of(type);
}

void KeptPixels::read(const Window& region, std::span<const io::ReadTarget> targets) const {
    if (region.x != window_.x || region.width != window_.width || !contains(window_, region)) {
        source_->read(region, targets);
        return;
    }
    std::vector<io::ReadTarget> missing;
    std::vector<Kept*> to_keep;
    for (const io::ReadTarget& target : targets) {
        Kept* kept = plane(target);
        const auto state = [&](int y) -> std::atomic<std::uint8_t>& {
            return kept->rows[static_cast<std::size_t>(y - window_.y)];
        };
        bool whole = kept != nullptr;
        for (int y = region.y; whole && y < region.y_end(); ++y)
            whole = state(y).load(std::memory_order_acquire) == ready;
        if (!whole) {
            missing.push_back(target);
            to_keep.push_back(kept);
            continue;
        }
        for (int y = region.y; y < region.y_end(); ++y)
            copy_row(row_of(*kept, y, target.plane.type), target.plane, y - region.y, target.plane.type, region.width);
    }
    if (missing.empty()) return;
    source_->read(region, missing);
    for (std::size_t k = 0; k < missing.size(); ++k) {
        if (to_keep[k] == nullptr) continue;
        const Plane& plane = missing[k].plane;
        for (int y = region.y; y < region.y_end(); ++y) {
            // Two threads may have read the same row: one of them keeps it.
            auto& state = to_keep[k]->rows[static_cast<std::size_t>(y - window_.y)];
            std::uint8_t expected = absent;
            if (!state.compare_exchange_strong(expected, busy)) continue;
            const Plane row{row_of(*to_keep[k], y, plane.type), plane.type,
                            static_cast<std::ptrdiff_t>(size_of(plane.type)), 0};
            io::convert_run({plane.data + (y - region.y) * plane.y_stride, plane.type, plane.x_stride},
                            {row.data, row.type, row.x_stride}, static_cast<std::size_t>(region.width));
            state.store(ready, std::memory_order_release);
        }
    }
}

}  // namespace relume::gbuffer
