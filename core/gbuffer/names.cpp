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
    if (pattern.starts_with('*')) {
        const std::string_view ending = pattern.substr(1);
        if (!fold(layer).ends_with(fold(ending))) return {};
        const std::size_t dot = layer.rfind('.');
        return {layer.ends_with(ending) ? Fit::exact : Fit::tolerant,
                dot == std::string_view::npos ? std::string() : std::string(layer.substr(0, dot))};
    }
    if (pattern.ends_with('*')) {
        const std::size_t dot = layer.rfind('.');
        const std::size_t start = dot == std::string_view::npos ? 0 : dot + 1;
        const std::string_view beginning = pattern.substr(0, pattern.size() - 1);
        if (!fold(layer.substr(start)).starts_with(fold(beginning))) return {};
        return {layer.substr(start).starts_with(beginning) ? Fit::exact : Fit::tolerant,
                std::string(layer.substr(0, start == 0 ? 0 : dot))};
    }
    const std::vector<std::string_view> words = split(layer, '.');
    const std::string folded = fold(pattern);
    const auto length = static_cast<std::size_t>(std::count(pattern.begin(), pattern.end(), '.')) + 1;
    if (words.size() < length) return {};
    // From the end to the front, so that the last words win over earlier ones.
    for (std::size_t first = words.size() - length + 1; first-- > 0;) {
        const std::size_t begin = static_cast<std::size_t>(words[first].data() - layer.data());
        const std::string_view& last = words[first + length - 1];
        const std::size_t end = static_cast<std::size_t>(last.data() - layer.data()) + last.size();
        const std::string_view candidate = layer.substr(begin, end - begin);
        if (fold(candidate) != folded) continue;
        const bool whole = first + length == words.size();
        const Fit fit = !whole ? Fit::qualified : candidate == pattern ? Fit::exact : Fit::tolerant;
        return {fit, std::string(layer.substr(0, begin == 0 ? 0 : begin - 1))};
    }
    return {};
}

}  // namespace relume::gbuffer
