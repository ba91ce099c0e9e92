// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace relume::scene {

/// Cryptomatte 1.2.0's ID of a name: MurmurHash3_x86_32 (Appleby 2011, seed 0) of its UTF-8 bytes, with bit 23 flipped
/// where the exponent bits would make the number that shares its bits a denormal, infinity or NaN.
std::uint32_t name_id(std::string_view name);

/// Eight lower-case hexadecimal digits, as manifests hold them.
std::string name_id_hex(std::uint32_t id);

}  // namespace relume::scene
