// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "relume/rig.h"

namespace relume::rigfile {

/// A number as TOML writes floats, in the fewest digits that read back to the same number: "0.5", "3.0", "1e+30",
/// "inf".
std::string number_text(double number);
/// The same, whole numbers without ".0": for lists, where TOML mixes both, and for messages.
std::string short_number_text(double number);
/// A TOML basic string with its quotes.
std::string string_text(std::string_view text);
/// A key, bare where TOML allows that.
std::string key_text(std::string_view key);
/// The value as TOML. Three equal numbers of a color are written as one.
std::string value_text(const Value& value, ParameterType type);

/// What a value is, for messages: "the string 'bright'", "the number 3.5", "a list of 2 numbers".
std::string describe(const Value& value);

/// What a row asks for, for messages: "a number", "3 numbers [x, y, z]", "one of half, float".
std::string expectation(const Parameter& row);

std::vector<std::string_view> split_choices(std::string_view choices);

}  // namespace relume::rigfile
