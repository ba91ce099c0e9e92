// SPDX-License-Identifier: Apache-2.0
// Text of files and users on its way to people and to other programs, none of which expect more than UTF-8 on one line.
#pragma once

#include <string>
#include <string_view>

namespace relume {

/// As RFC 3629 has it: no overlong forms, no surrogates, nothing above U+10FFFF.
bool is_utf8(std::string_view text);

/// The text as UTF-8 on one line: control characters and line separators become escapes (\n, \x1b, \u2028), and a byte
/// that is not part of UTF-8 is taken for Latin-1. Printable UTF-8 comes back as it is, so twice does no more than
/// once.
std::string printable(std::string_view text);

}  // namespace relume
