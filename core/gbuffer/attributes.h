// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/exr.h"

namespace relume::gbuffer {

/// nullptr when the part has no such attribute. The case of the name does not matter.
const io::Attribute* find_attribute(const io::Part& part, std::string_view name);

/// The same over all parts, the first one first: some writers put their metadata into the first part alone.
const io::Attribute* find_attribute(const io::Header& header, std::string_view name);

/// The value of a string attribute, nullptr when it is absent or of another type.
const std::string* text_attribute(const io::Part& part, std::string_view name);
const std::string* text_attribute(const io::Header& header, std::string_view name);

/// The value of a numeric attribute, or of a string attribute that holds one number.
std::optional<double> number_attribute(const io::Header& header, std::string_view name);

/// The values of a numeric attribute of `count` numbers, nullptr when it is absent or of another size.
const std::vector<double>* numbers_attribute(const io::Header& header, std::string_view name, std::size_t count);

}  // namespace relume::gbuffer
