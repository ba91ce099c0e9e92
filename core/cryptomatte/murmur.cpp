// SPDX-License-Identifier: Apache-2.0
#include <bit>

#include "cryptomatte/cryptomatte.h"

namespace relume::cryptomatte {

namespace {

std::uint32_t byte_at(std::string_view text, std::size_t index) { return static_cast<unsigned char>(text[index]); }

std::uint32_t scramble(std::uint32_t block) { return std::rotl(block * 0xcc9e2d51u, 15) * 0x1b873593u; }

}  // namespace

std::uint32_t murmur3(std::string_view name) {
    std::uint32_t hash = 0;
    const std::size_t blocks = name.size() / 4;
    for (std::size_t i = 0; i < blocks; ++i) {
        const std::uint32_t block = byte_at(name, 4 * i) | byte_at(name, 4 * i + 1) << 8 |
                                    byte_at(name, 4 * i + 2) << 16 | byte_at(name, 4 * i + 3) << 24;
        hash = std::rotl(hash ^ scramble(block), 13) * 5 + 0xe6546b64u;
    }
    std::uint32_t tail = 0;
    for (std::size_t i = name.size(); i > 4 * blocks; --i) tail = tail << 8 | byte_at(name, i - 1);
    hash ^= scramble(tail);
    hash ^= static_cast<std::uint32_t>(name.size());
    hash = (hash ^ hash >> 16) * 0x85ebca6bu;
    hash = (hash ^ hash >> 13) * 0xc2b2ae35u;
    return hash ^ hash >> 16;
}

std::uint32_t id_bits(std::string_view name) {
    const std::uint32_t hash = murmur3(name);
    const std::uint32_t exponent = hash >> 23 & 255u;
    return exponent == 0 || exponent == 255 ? hash ^ 1u << 23 : hash;
}

}  // namespace relume::cryptomatte
