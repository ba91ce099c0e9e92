// SPDX-License-Identifier: Apache-2.0
#include "scenes/name_id.h"

#include <bit>

namespace relume::scene {

std::uint32_t name_id(std::string_view name) {
    const auto byte = [&](std::size_t i) { return std::uint32_t{static_cast<unsigned char>(name[i])}; };
    const auto scramble = [](std::uint32_t block) { return std::rotl(block * 0xcc9e2d51u, 15) * 0x1b873593u; };
    std::uint32_t hash = 0;
    const std::size_t whole = name.size() / 4 * 4;
    for (std::size_t i = 0; i < whole; i += 4) {
        hash ^= scramble(byte(i) | byte(i + 1) << 8 | byte(i + 2) << 16 | byte(i + 3) << 24);
        hash = std::rotl(hash, 13) * 5 + 0xe6546b64u;
    }
    std::uint32_t rest = 0;
    for (std::size_t i = name.size(); i > whole; --i) rest = rest << 8 | byte(i - 1);
    hash ^= scramble(rest);

    hash ^= static_cast<std::uint32_t>(name.size());
    hash ^= hash >> 16;
    hash *= 0x85ebca6bu;
    hash ^= hash >> 13;
    hash *= 0xc2b2ae35u;
    hash ^= hash >> 16;

    const std::uint32_t exponent = hash >> 23 & 0xff;
    return exponent == 0 || exponent == 255 ? hash ^ 1u << 23 : hash;
}

std::string name_id_hex(std::uint32_t id) {
    std::string text(8, '0');
    for (int digit = 7; digit >= 0; --digit, id >>= 4) text[static_cast<std::size_t>(digit)] = "0123456789abcdef"[id & 15];
    return text;
}

}  // namespace relume::scene
