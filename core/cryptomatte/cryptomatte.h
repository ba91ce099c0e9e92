// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/exr.h"

/// Cryptomatte 1.2.0 (Friedman, Jones 2015): ID mattes as ranked pairs of a hashed name and its coverage.
namespace relume::cryptomatte {

/// MurmurHash3_x86_32 with seed 0 (Appleby 2011) of the bytes of `name`.
std::uint32_t murmur3(std::string_view name);

/// The ID under which a name stands in the pixels: its hash, with bit 23 flipped where the exponent would make it a
/// subnormal, infinity or NaN. The float is these bits.
std::uint32_t id_bits(std::string_view name);

/// Names and IDs of a manifest {"name": "8 hex digits", …}. Throws Error(format) that says where the text goes wrong.
std::map<std::string, std::uint32_t> parse_manifest(std::string_view json, std::string_view where);

/// Whether `pattern` describes all of `name`: `*` any run of characters, `?` any one, `[a-z]` and `[!a-z]` a set.
bool matches(std::string_view pattern, std::string_view name);

/// What the header says of one Cryptomatte layer.
struct LayerInfo {
    std::string key;            ///< 7 hex digits
    std::string name;           ///< "ViewLayer.CryptoObject"; its channels are name00, name01, …
    std::string manifest;       ///< JSON, "" when there is none
    std::string manifest_file;  ///< a file beside the EXR, "" when there is none
};
std::vector<LayerInfo> layer_infos(const io::Header& header);

/// The layer's manifest, from the header or from the file beside `exr`. Empty, with a note, when it can't be read: a
/// matte is still found by the hash of its name. A manifest_file that is absolute or climbs out of the folder is not
/// opened.
std::map<std::string, std::uint32_t> load_manifest(const LayerInfo& layer, const std::filesystem::path& exr,
                                                   std::vector<std::string>& notes);

/// IDs of all names in `manifest` that one of `patterns` matches, and the hashes of patterns that are plain names.
/// Sorted, without repetition. A pattern that begins with "object:", "material:" or "asset:" goes on in a `layer` of
/// that kind alone.
std::vector<std::uint32_t> ids_of(std::span<const std::string> patterns, std::string_view layer,
                                  const std::map<std::string, std::uint32_t>& manifest);

}  // namespace relume::cryptomatte
