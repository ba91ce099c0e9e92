// SPDX-License-Identifier: Apache-2.0
#include "relume/frames.h"

#include <charconv>
#include <optional>
#include <unordered_set>

#include "relume/error.h"
#include "rig/problem.h"

namespace relume {

namespace {

constexpr std::size_t kMostFrames = 1'000'000;
constexpr int kWidest = 64;

/// A place holder's length in the text and the width that it pads to.
struct Holder {
    std::size_t length = 0;
    int width = 0;
};

/// Digits after an optional 0: the width of "04d" or "4d"; `end` is what must follow.
std::optional<Holder> width_holder(std::string_view text, std::size_t start, std::string_view end) {
    std::size_t at = start;
    int width = 0;
    while (at < text.size() && text[at] >= '0' && text[at] <= '9' && width <= kWidest)
        width = 10 * width + (text[at++] - '0');
    if (width > kWidest || text.substr(at, end.size()) != end) return std::nullopt;
    return Holder{at + end.size(), width};
}

/// The place holder that starts at `at`.
std::optional<Holder> holder_at(std::string_view text, std::size_t at, bool in_folder) {
    const std::string_view rest = text.substr(at);
    if (rest.front() == '#') {
        const std::size_t length = std::min(rest.find_first_not_of('#'), rest.size());
        if ((in_folder && length == 1) || length > kWidest) return std::nullopt;
        return Holder{length, static_cast<int>(length)};
    }
    if (rest.front() == '%') return width_holder(rest, 1, "d");
    constexpr std::string_view kName = "{frame";
    if (!rest.starts_with(kName)) return std::nullopt;
    if (rest.substr(kName.size(), 1) == "}") return Holder{kName.size() + 1, 0};
    if (rest.substr(kName.size(), 1) != ":") return std::nullopt;
    if (const auto padded = width_holder(rest, kName.size() + 1, "d}")) return padded;
    return width_holder(rest, kName.size() + 1, "}");
}

std::string padded(std::int64_t frame, int width) {
    std::string digits = std::to_string(frame);
    const bool negative = digits.front() == '-';
    if (negative) digits.erase(0, 1);
    const auto wanted = static_cast<std::size_t>(width) - (negative && width > 0 ? 1 : 0);
    if (digits.size() < wanted) digits.insert(0, wanted - digits.size(), '0');
    return (negative ? "-" : "") + digits;
}

/// Calls `text` for what stays and `holder` for what stands for the frame.
template <class Text, class Frame> void scan(std::string_view pattern, Text text, Frame frame) {
    const std::size_t slash = pattern.rfind('/');
    for (std::size_t at = 0; at < pattern.size();) {
        const bool in_folder = slash != std::string_view::npos && at < slash;
        if (const auto holder = holder_at(pattern, at, in_folder)) {
            frame(holder->width);
            at += holder->length;
            continue;
        }
        // A run of # that is no place holder is passed over as a whole.
        const std::size_t length =
            pattern[at] == '#' ? std::min(pattern.find_first_not_of('#', at), pattern.size()) - at : 1;
        text(pattern.substr(at, length));
        at += length;
    }
}

[[noreturn]] void refuse(std::string_view part, const std::string& why) {
    throw Error(ErrorKind::value, "frames " + rigfile::in_quotes(part) + ": " + why);
}

std::optional<std::int64_t> take_number(std::string_view& text) {
    std::int64_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc{}) return std::nullopt;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    return number;
}

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
    while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
    return text;
}

struct Range {
    std::int64_t first = 0;
    std::int64_t last = 0;
    std::int64_t step = 1;
};

Range parse_range(std::string_view part) {
    constexpr const char* kForm = "is not a frame, nor a range as 1001-1100 or 1001-1100x2";
    std::string_view rest = part;
    Range range;
    const auto first = take_number(rest);
    if (!first) refuse(part, kForm);
    range.first = range.last = *first;
    if (rest.empty()) return range;
    if (rest.front() != '-') refuse(part, kForm);
    rest.remove_prefix(1);
    const auto last = take_number(rest);
    if (!last) refuse(part, kForm);
    range.last = *last;
    if (!rest.empty()) {
        if (rest.front() != 'x') refuse(part, kForm);
        rest.remove_prefix(1);
        const auto step = take_number(rest);
        if (!step || !rest.empty()) refuse(part, kForm);
        if (*step < 1) refuse(part, "the step must be at least 1");
        range.step = *step;
    }
    if (range.last < range.first) refuse(part, "the last frame comes before the first");
    return range;
}

}  // namespace

bool is_pattern(std::string_view pattern) {
    bool found = false;
    scan(
        pattern, [](std::string_view) {}, [&](int) { found = true; });
    return found;
}

std::string resolve_frame(std::string_view pattern, std::int64_t frame) {
    std::string out;
    scan(
        pattern, [&](std::string_view text) { out += text; }, [&](int width) { out += padded(frame, width); });
    return out;
}

std::vector<std::int64_t> parse_frames(std::string_view text) {
    std::vector<std::int64_t> frames;
    std::unordered_set<std::int64_t> known;
    for (std::size_t at = 0; at <= text.size();) {
        const std::size_t comma = std::min(text.find(',', at), text.size());
        const std::string_view part = trimmed(text.substr(at, comma - at));
        at = comma + 1;
        if (part.empty()) refuse(text, "is empty between commas; write frames as 1001-1100x2,1200");
        const Range range = parse_range(part);
        // The span is unsigned: the ends may lie further apart than int64 reaches.
        const std::uint64_t span = static_cast<std::uint64_t>(range.last) - static_cast<std::uint64_t>(range.first);
        const auto step = static_cast<std::uint64_t>(range.step);
        if (span / step >= kMostFrames - frames.size()) refuse(part, "more than a million frames");
        for (std::uint64_t k = 0; k <= span / step; ++k) {
            const auto frame = static_cast<std::int64_t>(static_cast<std::uint64_t>(range.first) + k * step);
            if (known.insert(frame).second) frames.push_back(frame);
        }
    }
    return frames;
}

}  // namespace relume
