// SPDX-License-Identifier: Apache-2.0
#include "io/exr_header_writer.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <set>
#include <string_view>

#include "io/exr_attribute.h"
#include "io/exr_header.h"
#include "relume/error.h"
#include "text/number_format.h"

namespace relume::io {

namespace {

constexpr std::int64_t kMaxCoordinate = (std::int64_t{1} << 30) - 1;  // half the range: OpenEXR refuses windows beyond
constexpr std::size_t kShortName = 31;
constexpr std::size_t kLongName = 255;
constexpr std::uint32_t kVersion = 2;
constexpr std::uint32_t kLongNamesFlag = 0x400;
constexpr std::uint32_t kMultiPartFlag = 0x1000;

[[noreturn]] void refuse(const Header& header, std::size_t part, const std::string& what) {
    throw Error(ErrorKind::value, "cannot write EXR: " + part_label(header, static_cast<int>(part)) + what);
}

void check_window(const Header& header, std::size_t part, const Window& window, const std::string& name) {
    if (window.empty() || window.x < -kMaxCoordinate || window.y < -kMaxCoordinate ||
        std::int64_t{window.x} + window.width > kMaxCoordinate ||
        std::int64_t{window.y} + window.height > kMaxCoordinate) {
        refuse(header, part,
               "the " + name + " window of " + std::to_string(window.width) + "x" + std::to_string(window.height) +
                   " pixels is empty or too large");
    }
}

void check_name(const Header& header, std::size_t part, const std::string& name, const std::string& of) {
    if (name.empty() || name.size() > kLongName || name.find('\0') != std::string::npos) {
        refuse(header, part, "the name of " + of + " must have 1 to 255 characters: '" + name + "'");
    }
}

void check_channels(const Header& header, std::size_t index) {
    const Part& part = header.parts[index];
    if (part.channels.empty()) {
        refuse(header, index, "no channels");
    }
    for (std::size_t c = 0; c < part.channels.size(); ++c) {
        const Channel& channel = part.channels[c];
        check_name(header, index, channel.name, "a channel");
        if (c > 0 && part.channels[c - 1].name == channel.name) {
            refuse(header, index, "two channels are called '" + channel.name + "'");
        }
        const Window& window = part.data_window;
        if (channel.x_sampling < 1 || channel.y_sampling < 1 || window.x % channel.x_sampling != 0 ||
            window.y % channel.y_sampling != 0 || window.width % channel.x_sampling != 0 ||
            window.height % channel.y_sampling != 0) {
            refuse(header, index, "the data window is no multiple of the sampling of channel '" + channel.name + "'");
        }
    }
}

// OpenEXR has attributes that parts of one file must share.
bool is_shared(const Attribute& attribute) {
    return attribute.name == "chromaticities" || attribute.name == "timeCode";
}

class HeaderBytes {
public:
    template <typename T> void number(T value) { bytes_.append(reinterpret_cast<const char*>(&value), sizeof value); }

    void name(std::string_view text) {
        bytes_ += text;
        bytes_ += '\0';
    }

    void attribute(std::string_view attribute_name, std::string_view type, std::string_view value) {
        name(attribute_name);
        name(type);
        number(static_cast<std::int32_t>(value.size()));
        bytes_ += value;
    }

    template <typename T> void attribute_of(std::string_view attribute_name, std::string_view type, const T& value) {
        attribute(attribute_name, type, {reinterpret_cast<const char*>(&value), sizeof value});
    }

    void window(std::string_view attribute_name, const Window& box) {
        attribute_of(attribute_name, "box2i",
                     std::array<std::int32_t, 4>{box.x, box.y, box.x_end() - 1, box.y_end() - 1});
    }

    void end() { bytes_ += '\0'; }
    std::string take() { return std::move(bytes_); }

private:
    std::string bytes_;
};

std::string channel_list(const std::vector<Channel>& channels) {
    HeaderBytes list;
    for (const Channel& channel : channels) {
        constexpr std::int32_t kUint = 0;
        constexpr std::int32_t kHalf = 1;
        constexpr std::int32_t kFloat = 2;
        list.name(channel.name);
        list.number(channel.type == PixelType::uint32 ? kUint : channel.type == PixelType::half ? kHalf : kFloat);
        list.number(std::array<std::uint8_t, 4>{channel.perceptually_linear ? std::uint8_t{1} : std::uint8_t{0}});
        list.number(std::array<std::int32_t, 2>{channel.x_sampling, channel.y_sampling});
    }
    list.end();
    return list.take();
}

bool has_attribute(const Part& part, std::string_view name) {
    return std::any_of(part.attributes.begin(), part.attributes.end(),
                       [&](const Attribute& attribute) { return attribute.name == name; });
}

void append_part(HeaderBytes& bytes, const Part& part, Compression compression, bool multi_part, int chunk_count) {
    bytes.attribute("channels", "chlist", channel_list(part.channels));
    bytes.attribute_of("compression", "compression", static_cast<std::uint8_t>(compression));
    bytes.window("dataWindow", part.data_window);
    bytes.window("displayWindow", part.display_window);
    bytes.attribute_of("lineOrder", "lineOrder", std::uint8_t{0});  // increasing y
    bytes.attribute_of("pixelAspectRatio", "float", part.pixel_aspect);
    if (!has_attribute(part, "screenWindowCenter")) {
        bytes.attribute_of("screenWindowCenter", "v2f", std::array<float, 2>{0, 0});
    }
    if (!has_attribute(part, "screenWindowWidth")) {
        bytes.attribute_of("screenWindowWidth", "float", 1.0f);
    }
    if (!part.name.empty()) {
        bytes.attribute("name", "string", part.name);
    }
    if (!part.view.empty()) {
        bytes.attribute("view", "string", part.view);
    }
    if (multi_part) {
        bytes.attribute("type", "string", "scanlineimage");
        bytes.attribute_of("chunkCount", "int", static_cast<std::int32_t>(chunk_count));
    }
    for (const Attribute& attribute : part.attributes) {
        bytes.attribute(attribute.name, attribute.type, attribute_bytes(attribute));
    }
    bytes.end();
}

bool has_long_names(const Header& header) {
    const auto is_long = [](const std::string& name) { return name.size() > kShortName; };
    return std::any_of(header.parts.begin(), header.parts.end(), [&](const Part& part) {
        return std::any_of(part.channels.begin(), part.channels.end(),
                           [&](const Channel& channel) { return is_long(channel.name); }) ||
               std::any_of(part.attributes.begin(), part.attributes.end(), [&](const Attribute& attribute) {
                   return is_long(attribute.name) || is_long(attribute.type);
               });
    });
}

}  // namespace

Header normalized_for_writing(const Header& header) {
    if (header.parts.empty()) {
        throw Error(ErrorKind::value, "cannot write EXR: no parts");
    }
    Header result = header;
    const Part& first = header.parts.front();
    std::set<std::string_view> names;
    for (std::size_t i = 0; i < result.parts.size(); ++i) {
        Part& part = result.parts[i];
        check_window(header, i, part.data_window, "data");
        check_window(header, i, part.display_window, "display");
        if (part.data_window != first.data_window || part.display_window != first.display_window ||
            part.pixel_aspect != first.pixel_aspect) {
            refuse(header, i, "all parts must have the same windows and pixel aspect ratio");
        }
        if (!(part.pixel_aspect > 1e-6f && part.pixel_aspect < 1e6f)) {
            refuse(header, i, format_numbers("the pixel aspect ratio %g is out of range", {part.pixel_aspect}));
        }
        if (header.parts.size() > 1) {
            check_name(header, i, part.name, "a part of a multi-part file");
            if (!names.insert(header.parts[i].name).second) {
                refuse(header, i, "two parts are called '" + part.name + "'");
            }
        }
        std::stable_sort(part.channels.begin(), part.channels.end(),
                         [](const Channel& a, const Channel& b) { return a.name < b.name; });
        check_channels(result, i);

        // The last of several attributes of one name counts; those that this writer makes itself are dropped.
        std::vector<Attribute> attributes;
        const auto add = [&](const Attribute& attribute) {
            const auto same = std::find_if(attributes.begin(), attributes.end(),
                                           [&](const Attribute& other) { return other.name == attribute.name; });
            if (same != attributes.end()) {
                *same = attribute;
            } else if (!is_structural(attribute.name)) {
                check_name(header, i, attribute.name, "an attribute");
                check_name(header, i, attribute.type, "an attribute's type");
                attributes.push_back(attribute);
            }
        };
        for (const Attribute& attribute : part.attributes) {
            if (i == 0 || !is_shared(attribute) || has_attribute(result.parts[0], attribute.name)) {
                add(attribute);
            }
        }
        for (const Attribute& attribute : result.parts[0].attributes) {
            if (i > 0 && is_shared(attribute)) {
                add(attribute);
            }
        }
        part.attributes = std::move(attributes);
    }
    return result;
}

std::string header_bytes(const Header& header, Compression compression, int chunk_count) {
    const bool multi_part = header.parts.size() > 1;
    HeaderBytes bytes;
    bytes.number(std::array<std::uint8_t, 4>{0x76, 0x2f, 0x31, 0x01});
    bytes.number(kVersion | (multi_part ? kMultiPartFlag : 0) | (has_long_names(header) ? kLongNamesFlag : 0));
    for (const Part& part : header.parts) {
        append_part(bytes, part, compression, multi_part, chunk_count);
    }
    if (multi_part) {
        bytes.end();
    }
    return bytes.take();
}

}  // namespace relume::io
