// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <tuple>
#include <vector>

#include "gbuffer/band_reader.h"
#include "relume/gbuffer.h"

namespace relume::gbuffer {

/// What one request gives in every pixel of the window, in canonical form. It is filled tile by tile, by any number of
/// threads, and read once it is whole.
class KeptChannel {
public:
    KeptChannel(const Window& window, int components);

    bool whole() const { return done_.load(std::memory_order_acquire) == std::ssize(states_); }

    /// Keeps a run of pixels where that is a tile: one that starts kTilePixels pixels after another, and is as long.
    void store(int y, int x, int count, std::span<const float* const> planes);

    /// `count` pixels from (x, y) on of a component, of a channel that is whole.
    const float* run(int component, int y, int x, int count) const;

private:
    enum State : std::uint8_t { absent, busy, ready, zero };

    std::size_t state_of(int component, int y, int tile) const;
    float* memory_of(int component, int y, int x) const;

    struct Free {
        void operator()(float* memory) const { std::free(memory); }
    };
    Window window_;
    int tiles_;           ///< of a row
    std::size_t stride_;  ///< floats from row to row
    std::unique_ptr<float, Free> memory_;
    float* first_;  ///< in it, at the alignment that every instruction set likes
    std::vector<std::atomic<std::uint8_t>> states_;
    std::atomic<std::int64_t> done_{0};
};

/// The channels of a G-buffer that were asked for, as long as they fit.
class KeptChannels {
public:
    explicit KeptChannels(std::int64_t bytes) : free_(bytes) {}

    /// nullptr where there is no room.
    std::shared_ptr<KeptChannel> of(const ChannelRequest& request, const Window& window);

private:
    using Key = std::tuple<ChannelRequest::Kind, std::string, int, std::vector<std::string>, double, double, LobeWidth>;
    std::mutex mutex_;
    std::int64_t free_;
    std::map<Key, std::shared_ptr<KeptChannel>> channels_;
};

}  // namespace relume::gbuffer
