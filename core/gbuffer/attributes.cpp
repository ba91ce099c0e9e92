// SPDX-License-Identifier: Apache-2.0
#include "gbuffer/attributes.h"

#include <algorithm>
#include <charconv>

namespace relume::gbuffer {

namespace {

bool same_name(std::string_view a, std::string_view b) {
    const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](char x, char y) { return lower(x) == lower(y); });
}

}  // namespace

const io::Attribute* find_attribute(const io::Part& part, std::string_view name) {
    for (const io::Attribute& attribute : part.attributes) {
        // Nuke writes what it read back with this prefix.
        constexpr std::string_view kNuke = "exr/";
        std::string_view own = attribute.name;
        if (same_name(own, name) || (own.starts_with(kNuke) && same_name(own.substr(kNuke.size()), name))) {
            return &attribute;
        }
    }
    return nullptr;
}

const io::Attribute* find_attribute(const io::Header& header, std::string_view name) {
    for (const io::Part& part : header.parts) {
        if (const io::Attribute* attribute = find_attribute(part, name)) return attribute;
    }
    return nullptr;
}

const std::string* text_attribute(const io::Part& part, std::string_view name) {
    const io::Attribute* attribute = find_attribute(part, name);
    return attribute ? std::get_if<std::string>(&attribute->value) : nullptr;
}

const std::string* text_attribute(const io::Header& header, std::string_view name) {
    const io::Attribute* attribute = find_attribute(header, name);
    return attribute ? std::get_if<std::string>(&attribute->value) : nullptr;
}

std::optional<double> number_attribute(const io::Header& header, std::string_view name) {
    const io::Attribute* attribute = find_attribute(header, name);
    if (!attribute) return std::nullopt;
    if (const auto* numbers = std::get_if<std::vector<double>>(&attribute->value)) {
        return numbers->size() == 1 ? std::optional(numbers->front()) : std::nullopt;
    }
    if (const auto* text = std::get_if<std::string>(&attribute->value)) {
        double number = 0;
        const auto [end, error] = std::from_chars(text->data(), text->data() + text->size(), number);
        if (error == std::errc() && end == text->data() + text->size()) return number;
    }
    return std::nullopt;
}

const std::vector<double>* numbers_attribute(const io::Header& header, std::string_view name, std::size_t count) {
    const io::Attribute* attribute = find_attribute(header, name);
    const auto* numbers = attribute ? std::get_if<std::vector<double>>(&attribute->value) : nullptr;
    return numbers && numbers->size() == count ? numbers : nullptr;
}

}  // namespace relume::gbuffer
