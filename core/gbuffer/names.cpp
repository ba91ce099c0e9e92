// SPDX-License-Identifier: Apache-2.0
#include "gbuffer/names.h"

#include <algorithm>

namespace relume::gbuffer {

namespace {

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

std::string lower(std::string_view text) {
    std::string result(text);
    std::transform(result.begin(), result.end(), result.begin(), [](char c) { return lower(c); });
    return result;
}

bool skipped(char c) { return c == ' ' || c == '_' || c == '-'; }

/// Compares as fold() would, character by character: this runs for every layer and every pattern of the table. How much
/// of `pattern` may be left over decides between equal names and beginnings.
bool begins_folded(std::string_view text, std::string_view pattern, bool whole) {
    std::size_t i = 0, j = 0;
    for (;;) {
        while (i < text.size() && skipped(text[i])) ++i;
        while (j < pattern.size() && skipped(pattern[j])) ++j;
        if (j == pattern.size()) return !whole || i == text.size();
        if (i == text.size() || lower(text[i]) != lower(pattern[j])) return false;
        ++i;
        ++j;
    }
}

bool ends_folded(std::string_view text, std::string_view pattern) {
    std::size_t i = text.size(), j = pattern.size();
    for (;;) {
        while (i > 0 && skipped(text[i - 1])) --i;
        while (j > 0 && skipped(pattern[j - 1])) --j;
        if (j == 0) return true;
        if (i == 0 || lower(text[i - 1]) != lower(pattern[j - 1])) return false;
        --i;
        --j;
    }
}

}  // namespace

std::string fold(std::string_view name) {
    std::string result;
    result.reserve(name.size());
    for (const char c : name) {
        if (c != ' ' && c != '_' && c != '-') result.push_back(lower(c));
    }
    return result;
}

std::vector<std::string_view> split(std::string_view text, char separator) {
    std::vector<std::string_view> parts;
    std::size_t start = 0;
    for (;;) {
        const std::size_t end = text.find(separator, start);
        if (end == std::string_view::npos) {
            parts.push_back(text.substr(start));
            return parts;
        }
        parts.push_back(text.substr(start, end - start));
        start = end + 1;
    }
}

char component_letter(std::string_view suffix) {
    const std::string word = lower(suffix);
    if (word.size() == 1) {
        constexpr std::string_view kLetters = "rgbaxyzwuvt";
        return kLetters.find(word[0]) == std::string_view::npos ? '\0' : static_cast<char>(word[0] - 'a' + 'A');
    }
    if (word == "red") return 'R';
    if (word == "green") return 'G';
    if (word == "blue") return 'B';
    if (word == "alpha") return 'A';
    return '\0';
}

Match match_layer(std::string_view layer, std::string_view pattern) {
    const std::size_t last_dot = layer.rfind('.');
    const std::string_view parent = last_dot == std::string_view::npos ? std::string_view() : layer.substr(0, last_dot);
    if (pattern.starts_with('*')) {
        const std::string_view ending = pattern.substr(1);
        if (!ends_folded(layer, ending)) return {};
        return {layer.ends_with(ending) ? Fit::exact : Fit::tolerant, std::string(parent)};
    }
    if (pattern.ends_with('*')) {
        const std::string_view word = last_dot == std::string_view::npos ? layer : layer.substr(last_dot + 1);
        const std::string_view beginning = pattern.substr(0, pattern.size() - 1);
        if (!begins_folded(word, beginning, false)) return {};
        return {word.starts_with(beginning) ? Fit::exact : Fit::tolerant, std::string(parent)};
    }
    // From the end to the front, so that the last words win over earlier ones; as many words as the pattern has.
    const auto dots = std::count(pattern.begin(), pattern.end(), '.');
    std::size_t end = layer.size();
    for (;;) {
        std::size_t begin = end;
        for (auto words = dots; words >= 0; --words) {
            if (words < dots) {
                if (begin == 0) return {};
                --begin;  // over the dot
            }
            while (begin > 0 && layer[begin - 1] != '.') --begin;
        }
        const std::string_view candidate = layer.substr(begin, end - begin);
        if (begins_folded(candidate, pattern, true)) {
            const Fit fit = end != layer.size() ? Fit::qualified : candidate == pattern ? Fit::exact : Fit::tolerant;
            return {fit, std::string(layer.substr(0, begin == 0 ? 0 : begin - 1))};
        }
        const std::size_t dot = end == 0 ? std::string_view::npos : layer.rfind('.', end - 1);
        if (dot == std::string_view::npos) return {};
        end = dot;
    }
}

}  // namespace relume::gbuffer
