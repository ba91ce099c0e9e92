// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <tuple>
#include <vector>

#include "gbuffer/gbuffer_impl.h"

namespace relume::gbuffer {

/// Pixels of a file that are decoded once: what was read in whole rows of the window is given out of memory from then
/// on. Any number of threads may read.
class KeptPixels final : public PixelSource {
public:
    /// Keeps planes as long as they fit into `bytes`, which several files may share.
    KeptPixels(std::shared_ptr<const PixelSource> source, const Window& window,
               std::shared_ptr<std::atomic<std::int64_t>> bytes)
        : source_(std::move(source)), window_(window), bytes_(std::move(bytes)) {}

    void read(const Window& region, std::span<const io::ReadTarget> targets) const override;

private:
    enum State : std::uint8_t { absent, busy, ready };
    struct Kept {
        std::vector<std::byte> memory;
        std::vector<std::atomic<std::uint8_t>> rows;
    };
    using Key = std::tuple<int, int, PixelType>;  ///< part, channel, as what it was asked for

    /// nullptr where there is no room.
    Kept* plane(const io::ReadTarget& target) const;
    std::byte* row_of(Kept& kept, int y, PixelType type) const;

    std::shared_ptr<const PixelSource> source_;
    Window window_;
    std::shared_ptr<std::atomic<std::int64_t>> bytes_;  ///< still free
    mutable std::mutex mutex_;
    mutable std::map<Key, std::unique_ptr<Kept>> planes_;
};

}  // namespace relume::gbuffer
