// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numeric>
#include <vector>

#include "relume/rig.h"
#include "rig/problem.h"
#include "text/printable.h"

namespace relume {

namespace {

// Longer words are no slips of the pen, and comparing them would cost time.
constexpr std::size_t kLongestWord = 64;

char folded(char c) {
    if (c >= 'A' && c <= 'Z') return static_cast<char>(c - 'A' + 'a');
    return c == '-' || c == ' ' ? '_' : c;
}

/// Edits between two words: insert, delete, replace, swap neighbours (Damerau 1964; no part is edited twice).
std::size_t edit_distance(std::string_view a, std::string_view b) {
    const std::size_t columns = b.size() + 1;
    std::vector<std::size_t> before(columns), above(columns), row(columns);
    std::iota(above.begin(), above.end(), std::size_t{0});
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = i;
        for (std::size_t j = 1; j < columns; ++j) {
            const bool same = folded(a[i - 1]) == folded(b[j - 1]);
            row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + (same ? 0 : 1)});
            const bool swapped =
                i > 1 && j > 1 && folded(a[i - 1]) == folded(b[j - 2]) && folded(a[i - 2]) == folded(b[j - 1]);
            if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
        }
        std::swap(before, above);
        std::swap(above, row);
    }
    return above.back();
}

bool begins_with(std::string_view word, std::string_view start) {
    return start.size() <= word.size() &&
           std::equal(start.begin(), start.end(), word.begin(), [](char a, char b) { return folded(a) == folded(b); });
}

/// Whether one of the words that make up a name, as "angle" of "cone_angle".
bool has_part(std::string_view name, std::string_view word) {
    for (std::size_t at = 0; at <= name.size();) {
        const std::size_t end = std::min(name.find('_', at), name.size());
        if (end - at == word.size() && begins_with(name.substr(at), word)) return true;
        at = end + 1;
    }
    return false;
}

}  // namespace

std::string nearest_name(std::string_view word, std::span<const std::string_view> candidates) {
    if (word.empty() || word.size() > kLongestWord) return {};
    std::string_view best;
    std::size_t best_distance = 0;
    for (const std::string_view candidate : candidates) {
        if (candidate.size() > kLongestWord) continue;
        const std::size_t allowed = 1 + std::max(word.size(), candidate.size()) / 4;
        std::size_t distance = edit_distance(word, candidate);
        // "rough" for roughness, "angle" for cone_angle: a start or a part of three letters or more is as good as the
        // last distance that still counts.
        const bool start = word.size() >= 3 && candidate.size() >= 3 &&
                           (begins_with(candidate, word) || begins_with(word, candidate) || has_part(candidate, word));
        if (start) distance = std::min(distance, allowed);
        // A word of which every letter is wrong is near to nothing.
        if (distance > allowed || distance >= std::max(word.size(), candidate.size())) continue;
        if (best.empty() || distance < best_distance) {
            best = candidate;
            best_distance = distance;
        }
    }
    return std::string(best);
}

namespace rigfile {

std::string one_line(std::string_view text) {
    constexpr std::size_t kMost = 60;
    std::size_t end = std::min(text.size(), kMost);
    // never inside a UTF-8 sequence
    while (end < text.size() && end < kMost + 4 && (static_cast<unsigned char>(text[end]) & 0xC0u) == 0x80u) ++end;
    return printable(text.substr(0, end)) + (end < text.size() ? "…" : "");
}

std::string in_quotes(std::string_view text) { return "'" + one_line(text) + "'"; }

std::string suggestion(std::string_view word, std::span<const std::string_view> candidates) {
    if (const std::string near = nearest_name(word, candidates); !near.empty()) return "; did you mean '" + near + "'?";
    constexpr std::size_t kMost = 40;
    std::string list;
    for (std::size_t k = 0; k < candidates.size() && k < kMost; ++k)
        list += (k == 0 ? "" : ", ") + std::string(candidates[k]);
    if (candidates.empty()) return {};
    return (candidates.size() == 1 ? "; there is " : "; there are ") + list + (candidates.size() > kMost ? ", …" : "");
}

const Parameter* find_row(std::span<const Parameter> table, std::string_view name) {
    const auto found = std::find_if(table.begin(), table.end(), [&](const Parameter& p) { return p.name == name; });
    return found == table.end() ? nullptr : &*found;
}

const Parameter& require_row(std::span<const Parameter> table, std::string_view name, std::string_view what) {
    if (const Parameter* row = find_row(table, name)) return *row;
    std::vector<std::string_view> names;
    for (const Parameter& p : table) names.push_back(p.name);
    throw Problem(Problem::Cause::name, "unknown key " + in_quotes(name) + " in " + std::string(what),
                  suggestion(name, names));
}

}  // namespace rigfile
}  // namespace relume
