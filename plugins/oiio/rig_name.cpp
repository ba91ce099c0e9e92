// SPDX-License-Identifier: Apache-2.0
#include "oiio/rig_name.h"

#include <charconv>

#include "relume/error.h"
#include "relume/frames.h"

namespace relume::oiio {

namespace {

constexpr std::string_view kEnding = ".relume";

bool is_rig(std::string_view name) {
    if (name.size() <= kEnding.size()) return false;
    const std::string_view ending = name.substr(name.size() - kEnding.size());
    return std::equal(ending.begin(), ending.end(), kEnding.begin(),
                      [](char a, char b) { return (a >= 'A' && a <= 'Z' ? static_cast<char>(a + 32) : a) == b; });
}

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

/// Percent-encoding (RFC 3986, section 2.1).
std::string decoded(std::string_view text) {
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const int high = text[i] == '%' && i + 2 < text.size() ? hex_digit(text[i + 1]) : -1;
        const int low = high >= 0 ? hex_digit(text[i + 2]) : -1;
        if (low < 0) {
            out.push_back(text[i]);
            continue;
        }
        out.push_back(static_cast<char>(16 * high + low));
        i += 2;
    }
    return out;
}

std::int64_t frame_number(const std::string& text) {
    std::int64_t frame = 0;
    // Hosts hand numbers over as floating point as well.
    const std::size_t dot = text.find_last_not_of('0');
    const std::string whole = dot != std::string::npos && text[dot] == '.' ? text.substr(0, dot) : text;
    const auto [end, error] = std::from_chars(whole.data(), whole.data() + whole.size(), frame);
    if (error != std::errc() || end != whole.data() + whole.size())
        throw Error(ErrorKind::value, "frame is '" + text + "'; it is a whole number");
    return frame;
}

}  // namespace

std::optional<RigName> parse_name(const std::string& name) {
    RigName result;
    if (is_rig(name)) {
        result.path = name;
        return result;
    }
    // A folder's name may have a question mark, and so may what the query says.
    std::size_t query = name.find('?');
    while (query != std::string::npos && !is_rig(std::string_view(name).substr(0, query)))
        query = name.find('?', query + 1);
    if (query == std::string::npos) return std::nullopt;
    result.path = name.substr(0, query);
    std::string_view rest = std::string_view(name).substr(query + 1);
    while (!rest.empty()) {
        const std::size_t end = std::min(rest.find('&'), rest.size());
        const std::string_view setting = rest.substr(0, end);
        rest.remove_prefix(std::min(end + 1, rest.size()));
        if (setting.empty()) continue;
        const std::size_t equals = setting.find('=');
        if (equals == std::string_view::npos) {
            // Told where the rig is loaded, so that the host gets it as its error text.
            result.settings.emplace_back(decoded(setting), "");
            continue;
        }
        result.settings.emplace_back(decoded(setting.substr(0, equals)), decoded(setting.substr(equals + 1)));
    }
    return result;
}

Rig load_rig(const RigName& name) {
    Rig rig = Rig::load(name.path);
    for (const auto& [key, value] : name.settings) {
        if (key == "frame") rig.frame = frame_number(value);
        else rig.set(key, value);
    }
    const std::optional<std::string> main = rig.main_file();
    if (!main)
        throw Error(ErrorKind::value,
                    name.path.string() + ": names no G-buffer; write [gbuffer] file, or set gbuffer.file");
    if (!rig.frame && is_pattern(*main) && !std::filesystem::exists(*main))
        throw Error(ErrorKind::value,
                    name.path.string() + ": its G-buffer " + *main +
                        " is a sequence; say which frame: ?frame=N, relume:frame, or [gbuffer] frame");
    return rig.frame ? rig.of_frame(*rig.frame) : rig;
}

}  // namespace relume::oiio
