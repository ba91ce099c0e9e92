// SPDX-License-Identifier: Apache-2.0
#include "gbuffer/kept_channels.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <new>

namespace relume::gbuffer {

namespace {

/// Many a layer of a material is in no pixel of a tile: its channels share these zeros, which stay in the cache.
alignas(64) constexpr std::array<float, kTilePixels> kZeros{};

/// +0 alone: a tile comes back with the bits that it had.
bool all_zero(const float* values, int count) {
    std::uint32_t any = 0;
    for (int i = 0; i < count; ++i) any |= std::bit_cast<std::uint32_t>(values[i]);
    return any == 0;
}

constexpr std::size_t kAlignment = 64;

std::size_t row_floats(const Window& window) { return (static_cast<std::size_t>(window.width) + 15) / 16 * 16; }

std::size_t floats(const Window& window, int components) {
    return static_cast<std::size_t>(components) * row_floats(window) * static_cast<std::size_t>(window.height);
}

float* allocated(std::size_t count) {
    // Pages that only zeros would go into are never touched.
    auto* const memory = static_cast<float*>(std::calloc(count * sizeof(float) + kAlignment, 1));
    if (memory == nullptr) throw std::bad_alloc();
    return memory;
}

float* aligned(float* memory) {
    const std::size_t beyond = reinterpret_cast<std::uintptr_t>(memory) % kAlignment;
    return memory + (kAlignment - beyond) % kAlignment / sizeof(float);
}

}  // namespace

KeptChannel::KeptChannel(const Window& window, int components)
    : window_(window),
      tiles_((window.width + kTilePixels - 1) / kTilePixels),
      stride_(row_floats(window)),
      memory_(allocated(floats(window, components))),
      first_(aligned(memory_.get())),
      states_(static_cast<std::size_t>(components) * static_cast<std::size_t>(tiles_) *
              static_cast<std::size_t>(window.height)) {}

std::size_t KeptChannel::state_of(int component, int y, int tile) const {
    const auto row = static_cast<std::size_t>(component) * static_cast<std::size_t>(window_.height) +
                     static_cast<std::size_t>(y - window_.y);
    return row * static_cast<std::size_t>(tiles_) + static_cast<std::size_t>(tile);
}

float* KeptChannel::memory_of(int component, int y, int x) const {
    const auto row = static_cast<std::size_t>(component) * static_cast<std::size_t>(window_.height) +
                     static_cast<std::size_t>(y - window_.y);
    return first_ + row * stride_ + static_cast<std::size_t>(x - window_.x);
}

void KeptChannel::store(int y, int x, int count, std::span<const float* const> planes) {
    const int column = x - window_.x;
    if (column % kTilePixels != 0 || count != std::min(kTilePixels, window_.width - column)) return;
    for (std::size_t k = 0; k < planes.size(); ++k) {
        const int component = static_cast<int>(k);
        std::atomic<std::uint8_t>& state = states_[state_of(component, y, column / kTilePixels)];
        std::uint8_t expected = absent;
        if (!state.compare_exchange_strong(expected, busy)) continue;
        const bool empty = all_zero(planes[k], count);
        if (!empty) std::memcpy(memory_of(component, y, x), planes[k], static_cast<std::size_t>(count) * sizeof(float));
        state.store(empty ? zero : ready, std::memory_order_release);
        done_.fetch_add(1, std::memory_order_acq_rel);
    }
}

const float* KeptChannel::run(int component, int y, int x, int count) const {
    const int column = x - window_.x, first = column / kTilePixels, last = (column + count - 1) / kTilePixels;
    // The memory of a tile of zeros was never written to, and is zero: good for what goes across tiles.
    if (first == last && states_[state_of(component, y, first)].load(std::memory_order_relaxed) == zero)
        return kZeros.data();
    return memory_of(component, y, x);
}

std::shared_ptr<KeptChannel> KeptChannels::of(const ChannelRequest& request, const Window& window) {
    const std::scoped_lock lock(mutex_);
    std::shared_ptr<KeptChannel>& channel = channels_[{request.kind, request.name, request.components, request.patterns,
                                                       request.scale, request.offset, request.widen}];
    if (channel) return channel;
    const auto bytes = static_cast<std::int64_t>(floats(window, request.components) * sizeof(float));
    if (bytes > free_) return nullptr;
    free_ -= bytes;
    channel = std::make_shared<KeptChannel>(window, request.components);
    return channel;
}

}  // namespace relume::gbuffer
