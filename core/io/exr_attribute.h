// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "io/exr.h"
#include "io/exr_core.h"

namespace relume::io {

/// Whether OpenEXR itself defines the attribute's meaning and this module keeps it in a field of Part, or writes it
/// anew: channels, windows, compression, name, chunk count and so on. Such names are never in Part::attributes.
bool is_structural(std::string_view name);

/// An attribute of an open file; absent when its value cannot be had (a second channel list).
std::optional<Attribute> read_attribute(const exr_attribute_t& source);

/// The value's bytes as they stand in a file, without the size. Throws Error(value) when the value does not fit the
/// type.
std::string attribute_bytes(const Attribute& attribute);

}  // namespace relume::io
