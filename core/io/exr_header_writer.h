// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "io/exr.h"

namespace relume::io {

/// Brings a header into the form that a file may have and checks it: channels sorted by name, parts named, what
/// OpenEXR wants equal in all parts taken from the first. Throws Error(value) naming the part.
Header normalized_for_writing(const Header& header);

/// The file's beginning, up to the chunk offset tables. `chunk_count` chunks per part.
std::string header_bytes(const Header& header, Compression compression, int chunk_count);

}  // namespace relume::io
