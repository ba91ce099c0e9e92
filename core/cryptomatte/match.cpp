// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "cryptomatte/cryptomatte.h"

namespace relume::cryptomatte {

namespace {

/// Bytes of the UTF-8 character that starts here.
std::size_t character_size(std::string_view text) {
    std::size_t size = 1;
    while (size < text.size() && (static_cast<unsigned char>(text[size]) & 0xc0u) == 0x80u) ++size;
    return size;
}

/// Where the set that starts at `pattern` ends (behind its ']'); npos when it is no set.
std::size_t set_end(std::string_view pattern) {
    std::size_t i = 1;
    if (i < pattern.size() && (pattern[i] == '!' || pattern[i] == '^')) ++i;
    if (i < pattern.size() && pattern[i] == ']') ++i;
    const std::size_t end = pattern.find(']', i);
    return end == std::string_view::npos ? std::string_view::npos : end + 1;
}

bool in_set(std::string_view set, std::string_view character) {
    set = set.substr(1, set.size() - 2);
    const bool negated = !set.empty() && (set[0] == '!' || set[0] == '^');
    if (negated) set.remove_prefix(1);
    bool found = false;
    while (!set.empty()) {
        const std::string_view low = set.substr(0, character_size(set));
        set.remove_prefix(low.size());
        std::string_view high = low;
        if (set.size() >= 2 && set[0] == '-') {
            set.remove_prefix(1);
            high = set.substr(0, character_size(set));
            set.remove_prefix(high.size());
        }
        // The order of UTF-8 strings is the order of code points.
        found = found || (low <= character && character <= high);
    }
    return found != negated;
}

/// Length of "object:" and its like at the front of a pattern; 0 where there is none.
std::size_t kind_size(std::string_view pattern) {
    for (const std::string_view kind : {"object:", "material:", "asset:"}) {
        if (pattern.starts_with(kind)) return kind.size();
    }
    return 0;
}

/// Whether a layer holds names of a kind, by its own name: "ViewLayer.CryptoMaterial", "crypto_material".
bool is_of_kind(std::string_view layer, std::string_view kind) {
    const auto same = [](char a, char b) { return (a >= 'A' && a <= 'Z' ? static_cast<char>(a - 'A' + 'a') : a) == b; };
    layer.remove_prefix(layer.rfind('.') + 1);  // a view layer may be called "material"
    return std::search(layer.begin(), layer.end(), kind.begin(), kind.end(), same) != layer.end();
}

}  // namespace

bool matches(std::string_view pattern, std::string_view name) {
    // The classic walk with one point of return: at the last '*', which then takes one character more.
    std::string_view after_star, retry;
    bool star = false;
    for (;;) {
        if (!pattern.empty() && pattern[0] == '*') {
            pattern.remove_prefix(1);
            after_star = pattern;
            retry = name;
            star = true;
            continue;
        }
        if (name.empty() && pattern.empty()) return true;
        bool same = false;
        std::size_t pattern_step = 0;
        const std::size_t name_step = name.empty() ? 0 : character_size(name);
        if (!pattern.empty() && !name.empty()) {
            const std::string_view character = name.substr(0, name_step);
            const std::size_t set = pattern[0] == '[' ? set_end(pattern) : std::string_view::npos;
            if (pattern[0] == '?') {
                same = true;
                pattern_step = 1;
            } else if (set != std::string_view::npos) {
                same = in_set(pattern.substr(0, set), character);
                pattern_step = set;
            } else {
                pattern_step = character_size(pattern);
                same = pattern.substr(0, pattern_step) == character;
            }
        }
        if (same) {
            pattern.remove_prefix(pattern_step);
            name.remove_prefix(name_step);
            continue;
        }
        if (!star || retry.empty()) return false;
        retry.remove_prefix(character_size(retry));
        name = retry;
        pattern = after_star;
    }
}

std::vector<std::uint32_t> ids_of(std::span<const std::string> patterns, std::string_view layer,
                                  const std::map<std::string, std::uint32_t>& manifest) {
    std::vector<std::uint32_t> ids;
    const auto add = [&](const std::string& pattern) {
        const auto exact = manifest.find(pattern);
        if (exact != manifest.end()) ids.push_back(exact->second);
        // A plain name needs no manifest.
        if (pattern.find_first_of("*?[") == std::string::npos) {
            ids.push_back(id_bits(pattern));
            return;
        }
        for (const auto& [name, id] : manifest) {
            if (matches(pattern, name)) ids.push_back(id);
        }
    };
    for (const std::string& pattern : patterns) {
        add(pattern);  // a name may begin with what is a kind elsewhere
        const std::size_t kind = kind_size(pattern);
        if (kind > 0 && is_of_kind(layer, std::string_view(pattern).substr(0, kind - 1))) add(pattern.substr(kind));
    }
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    return ids;
}

}  // namespace relume::cryptomatte
