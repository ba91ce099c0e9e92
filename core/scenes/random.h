// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace relume::scene {

/// Philox4x32-10 (Salmon et al. 2011, "Parallel random numbers: as easy as 1, 2, 3", section 3.3): four random words
/// that are a function of a counter and a key alone, so that a picture does not depend on who renders which pixel when.
constexpr std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key) {
    for (int round = 0; round < 10; ++round) {
        const std::uint64_t a = std::uint64_t{0xD2511F53} * counter[0];
        const std::uint64_t b = std::uint64_t{0xCD9E8D57} * counter[2];
        counter = {static_cast<std::uint32_t>(b >> 32) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(b),
                   static_cast<std::uint32_t>(a >> 32) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(a)};
        key = {key[0] + 0x9E3779B9, key[1] + 0xBB67AE85};
    }
    return counter;
}

/// Inside (0, 1), never an end.
constexpr double to_unit(std::uint32_t word) { return (static_cast<double>(word) + 0.5) * 0x1p-32; }

/// The random numbers of one light path: draw(bounce) gives the four of a bounce.
struct PathRandom {
    std::uint64_t seed = 0;
    std::uint32_t pixel = 0;
    std::uint32_t path = 0;

    constexpr std::array<double, 4> draw(std::uint32_t bounce) const {
        const auto words = philox({bounce, path, pixel, 0},
                                  {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)});
        return {to_unit(words[0]), to_unit(words[1]), to_unit(words[2]), to_unit(words[3])};
    }
};

}  // namespace relume::scene
