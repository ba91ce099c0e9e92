// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace relume::gbuffer {

/// Two times 64 bits, to tell whether numbers are the same.
using Hash = std::array<std::uint64_t, 2>;

/// Of the bytes of a sampled row. A lane takes each word by a bijection: one changed number always shows in its lane.
class RowHash {
public:
    void take(std::span<const std::byte> bytes) {
        std::array<std::uint64_t, kLanes> lanes = lanes_;  // in registers
        std::array<std::uint64_t, kLanes> words{};
        while (bytes.size() >= sizeof words) {
            std::memcpy(words.data(), bytes.data(), sizeof words);
            for (std::size_t k = 0; k < kLanes; ++k) lanes[k] = taken(lanes[k], words[k]);
            bytes = bytes.subspan(sizeof words);
        }
        if (!bytes.empty()) {
            words = {};
            std::memcpy(words.data(), bytes.data(), bytes.size());
            for (std::size_t k = 0; k < kLanes; ++k) lanes[k] = taken(lanes[k], words[k]);
        }
        lanes_ = lanes;
    }

    Hash value() const {
        return {mixed(mixed(lanes_[0], lanes_[1]), mixed(lanes_[2], lanes_[3])),
                mixed(mixed(lanes_[3], lanes_[1]), mixed(lanes_[2], lanes_[0]))};
    }

private:
    static constexpr std::size_t kLanes = 4;
    static constexpr std::uint64_t kFactor = 0x9E3779B97F4A7C15, kOther = 0xD6E8FEB86659FD93;  // odd
    static std::uint64_t taken(std::uint64_t lane, std::uint64_t word) { return std::rotl(lane ^ word, 29) * kFactor; }
    static std::uint64_t mixed(std::uint64_t a, std::uint64_t b) {
        std::uint64_t h = (a ^ std::rotl(b * kOther, 31)) * kFactor;
        h = (h ^ (h >> 32)) * kOther;
        return h ^ (h >> 29);
    }
    std::array<std::uint64_t, kLanes> lanes_{1, 2, 3, 4};
};

}  // namespace relume::gbuffer
