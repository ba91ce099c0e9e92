// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <fstream>
#include <iterator>
#include <optional>

#include "cryptomatte/cryptomatte.h"
#include "relume/error.h"
#include "text/printable.h"

namespace relume::cryptomatte {

namespace {

constexpr std::uintmax_t kLargestManifest = std::uintmax_t{256} << 20;

/// Reads the one kind of JSON that manifests are: an object of strings.
class ManifestParser {
public:
    ManifestParser(std::string_view text, std::string_view where) : text_(text), where_(where) {}

    std::map<std::string, std::uint32_t> parse() {
        std::map<std::string, std::uint32_t> manifest;
        expect('{');
        if (!take('}')) {
            do {
                std::string name = string();
                // Some writers know no UTF-8; a name of control characters is JSON's good right.
                if (!is_utf8(name)) name = printable(name);
                expect(':');
                const std::size_t at = position_;
                const std::string digits = string();
                manifest.insert_or_assign(std::move(name), id(digits, at));
            } while (take(','));
            expect('}');
        }
        skip_blanks();
        if (position_ != text_.size() && text_[position_] != '\0') fail("text after the closing brace");
        return manifest;
    }

private:
    [[noreturn]] void fail(const std::string& what) const {
        throw Error(ErrorKind::format, std::string(where_) + ": damaged Cryptomatte manifest, " + what + " at byte " +
                                           std::to_string(position_));
    }

    void skip_blanks() {
        while (position_ < text_.size() && (text_[position_] == ' ' || text_[position_] == '\t' ||
                                            text_[position_] == '\n' || text_[position_] == '\r')) {
            ++position_;
        }
    }

    bool take(char c) {
        skip_blanks();
        if (position_ >= text_.size() || text_[position_] != c) return false;
        ++position_;
        return true;
    }

    void expect(char c) {
        if (!take(c)) fail(std::string("'") + c + "' expected");
    }

    std::uint32_t hex4() {
        std::uint32_t value = 0;
        for (int i = 0; i < 4; ++i, ++position_) {
            const std::optional<std::uint32_t> digit = position_ < text_.size() ? hex(text_[position_]) : std::nullopt;
            if (!digit) fail("four hexadecimal digits expected");
            value = value << 4 | *digit;
        }
        return value;
    }

    static std::optional<std::uint32_t> hex(char c) {
        if (c >= '0' && c <= '9') return static_cast<std::uint32_t>(c - '0');
        if (c >= 'a' && c <= 'f') return static_cast<std::uint32_t>(c - 'a' + 10);
        if (c >= 'A' && c <= 'F') return static_cast<std::uint32_t>(c - 'A' + 10);
        return std::nullopt;
    }

    static void append_utf8(std::string& text, std::uint32_t code) {
        const auto put = [&](std::uint32_t byte) { text.push_back(static_cast<char>(byte)); };
        if (code < 0x80) {
            put(code);
        } else if (code < 0x800) {
            put(0xc0 | code >> 6), put(0x80 | (code & 63));
        } else if (code < 0x10000) {
            put(0xe0 | code >> 12), put(0x80 | (code >> 6 & 63)), put(0x80 | (code & 63));
        } else {
            put(0xf0 | code >> 18), put(0x80 | (code >> 12 & 63)), put(0x80 | (code >> 6 & 63)),
                put(0x80 | (code & 63));
        }
    }

    std::uint32_t escaped_code() {
        std::uint32_t code = hex4();
        if (code >= 0xdc00 && code < 0xe000) fail("half of a surrogate pair");
        if (code < 0xd800 || code >= 0xdc00) return code;
        if (text_.substr(position_, 2) != "\\u") fail("half of a surrogate pair");
        position_ += 2;
        const std::uint32_t low = hex4();
        if (low < 0xdc00 || low >= 0xe000) fail("half of a surrogate pair");
        return 0x10000 + ((code - 0xd800) << 10) + (low - 0xdc00);
    }

    std::string string() {
        expect('"');
        std::string result;
        while (position_ < text_.size() && text_[position_] != '"') {
            if (text_[position_] != '\\') {
                result.push_back(text_[position_++]);
                continue;
            }
            if (++position_ >= text_.size()) break;
            const char c = text_[position_++];
            switch (c) {
                case '"':
                case '\\':
                case '/':
                    result.push_back(c);
                    break;
                case 'b':
                    result.push_back('\b');
                    break;
                case 'f':
                    result.push_back('\f');
                    break;
                case 'n':
                    result.push_back('\n');
                    break;
                case 'r':
                    result.push_back('\r');
                    break;
                case 't':
                    result.push_back('\t');
                    break;
                case 'u':
                    append_utf8(result, escaped_code());
                    break;
                default:
                    fail("unknown escape");
            }
        }
        if (position_ >= text_.size()) fail("a string without an end");
        ++position_;
        return result;
    }

    std::uint32_t id(const std::string& digits, std::size_t at) {
        std::uint32_t value = 0;
        bool good = !digits.empty() && digits.size() <= 8;
        for (const char c : digits) {
            const std::optional<std::uint32_t> digit = hex(c);
            good = good && digit;
            value = value << 4 | digit.value_or(0);
        }
        if (!good) {
            position_ = at;
            fail("an ID of eight hexadecimal digits expected");
        }
        return value;
    }

    std::string_view text_;
    std::string_view where_;
    std::size_t position_ = 0;
};

/// `cryptomatte/<key>/<field>` in its parts; nothing for other attributes.
std::optional<std::pair<std::string, std::string>> key_and_field(std::string_view name) {
    // Nuke writes what it read back with this prefix.
    if (name.starts_with("exr/")) name.remove_prefix(4);
    constexpr std::string_view kPrefix = "cryptomatte/";
    if (!name.starts_with(kPrefix)) return std::nullopt;
    name.remove_prefix(kPrefix.size());
    const std::size_t slash = name.find('/');
    if (slash == std::string_view::npos) return std::nullopt;
    return std::pair(std::string(name.substr(0, slash)), std::string(name.substr(slash + 1)));
}

bool stays_in_folder(const std::filesystem::path& file) {
    return !file.empty() && file.is_relative() && !file.has_root_path() &&
           std::none_of(file.begin(), file.end(), [](const auto& part) { return part == ".."; });
}

}  // namespace

std::map<std::string, std::uint32_t> parse_manifest(std::string_view json, std::string_view where) {
    return ManifestParser(json, where).parse();
}

std::vector<LayerInfo> layer_infos(const io::Header& header) {
    std::vector<LayerInfo> layers;
    for (const io::Part& part : header.parts) {
        for (const io::Attribute& attribute : part.attributes) {
            const auto split = key_and_field(attribute.name);
            const auto* text = std::get_if<std::string>(&attribute.value);
            if (!split || !text) continue;
            const std::string &key = split->first, &field = split->second;
            auto layer = std::find_if(layers.begin(), layers.end(), [&](const LayerInfo& l) { return l.key == key; });
            if (layer == layers.end()) layer = layers.insert(layers.end(), LayerInfo{key, {}, {}, {}});
            if (field == "name") layer->name = printable(*text);
            if (field == "manifest") layer->manifest = *text;
            if (field == "manif_file") layer->manifest_file = *text;
        }
    }
    std::erase_if(layers, [](const LayerInfo& layer) { return layer.name.empty(); });
    return layers;
}

std::map<std::string, std::uint32_t> load_manifest(const LayerInfo& layer, const std::filesystem::path& exr,
                                                   std::vector<std::string>& notes) {
    const std::string what = "Cryptomatte layer '" + layer.name + "': ";
    try {
        if (!layer.manifest.empty()) return parse_manifest(layer.manifest, exr.string());
        if (layer.manifest_file.empty()) return {};
        const std::filesystem::path file(layer.manifest_file);
        if (!stays_in_folder(file)) {
            notes.push_back(what + "its manif_file '" + printable(layer.manifest_file) +
                            "' leaves the EXR's folder and is not read");
            return {};
        }
        const std::filesystem::path path = exr.parent_path() / file;
        std::error_code error;
        const std::uintmax_t size = std::filesystem::file_size(path, error);
        std::ifstream stream(path, std::ios::binary);
        if (error || !stream || size > kLargestManifest) {
            notes.push_back(what + "its manifest " + printable(path.string()) +
                            " can't be read; names are matched by their hash");
            return {};
        }
        const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
        return parse_manifest(text, path.string());
    } catch (const Error& error) {
        notes.push_back(what + error.what() + "; names are matched by their hash");
        return {};
    }
}

}  // namespace relume::cryptomatte
