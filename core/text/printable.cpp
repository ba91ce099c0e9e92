// SPDX-License-Identifier: Apache-2.0
#include "text/printable.h"

#include <algorithm>
#include <cstddef>
#include <optional>

namespace relume {

namespace {

struct Character {
    char32_t code;
    std::size_t bytes;
};

/// The first character of a text that is not empty; nothing where its bytes are not UTF-8.
std::optional<Character> first_character(std::string_view text) {
    const auto lead = static_cast<unsigned char>(text[0]);
    if (lead < 0x80) return Character{lead, 1};
    if (lead < 0xC2 || lead > 0xF4) return std::nullopt;
    const std::size_t more = lead >= 0xF0 ? 3 : lead >= 0xE0 ? 2 : 1;
    if (text.size() <= more) return std::nullopt;
    char32_t code = lead & (0x3Fu >> more);
    for (std::size_t k = 1; k <= more; ++k) {
        const auto next = static_cast<unsigned char>(text[k]);
        if ((next & 0xC0u) != 0x80u) return std::nullopt;
        code = (code << 6) | (next & 0x3Fu);
    }
    constexpr char32_t kLeast[] = {0, 0x80, 0x800, 0x10000};
    if (code < kLeast[more] || code > 0x10FFFF || (code >= 0xD800 && code <= 0xDFFF)) return std::nullopt;
    return Character{code, more + 1};
}

/// C0, DEL, C1, and the two that Unicode ends lines with.
bool is_control(char32_t code) {
    return code < 0x20 || (code >= 0x7F && code < 0xA0) || code == 0x2028 || code == 0x2029;
}

void append_escape(std::string& out, char32_t code) {
    constexpr char kDigits[] = "0123456789abcdef";
    if (code == '\n') {
        out += "\\n";
        return;
    }
    const int digits = code > 0xFF ? 4 : 2;
    out += digits == 4 ? "\\u" : "\\x";
    for (int shift = 4 * (digits - 1); shift >= 0; shift -= 4) out += kDigits[(code >> shift) & 15u];
}

}  // namespace

bool is_utf8(std::string_view text) {
    while (!text.empty()) {
        const auto character = first_character(text);
        if (!character) return false;
        text.remove_prefix(character->bytes);
    }
    return true;
}

std::string printable(std::string_view text) {
    if (std::all_of(text.begin(), text.end(), [](char c) { return c >= 0x20 && c < 0x7F; })) return std::string(text);
    std::string out;
    while (!text.empty()) {
        const auto character = first_character(text);
        const auto byte = static_cast<unsigned char>(text[0]);
        const char32_t code = character ? character->code : byte;
        const std::size_t bytes = character ? character->bytes : 1;
        if (is_control(code)) append_escape(out, code);
        else if (character) out += text.substr(0, bytes);
        else (out += static_cast<char>(0xC0u | byte >> 6)) += static_cast<char>(0x80u | (byte & 0x3Fu));
        text.remove_prefix(bytes);
    }
    return out;
}

}  // namespace relume
