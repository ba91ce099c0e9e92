// SPDX-License-Identifier: Apache-2.0
#include "io/exr_attribute.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <string_view>

#include "relume/error.h"

namespace relume::io {

static_assert(std::endian::native == std::endian::little, "EXR files are little-endian, and so is this code");

namespace {

// The types that are a fixed run of numbers, as they stand in a file and, packed alike, in OpenEXRCore's structures.
// i int32, u uint32, b uint8, f float, d double.
struct NumberLayout {
    std::string_view type;
    std::string_view fields;
};

constexpr std::array<NumberLayout, 25> kNumberLayouts{{
    {"int", "i"},
    {"float", "f"},
    {"double", "d"},
    {"v2i", "ii"},
    {"v2f", "ff"},
    {"v2d", "dd"},
    {"v3i", "iii"},
    {"v3f", "fff"},
    {"v3d", "ddd"},
    {"box2i", "iiii"},
    {"box2f", "ffff"},
    {"m33f", "fffffffff"},
    {"m33d", "ddddddddd"},
    {"m44f", "ffffffffffffffff"},
    {"m44d", "dddddddddddddddd"},
    {"chromaticities", "ffffffff"},
    {"rational", "iu"},
    {"timecode", "uu"},
    {"keycode", "iiiiiii"},
    {"tiledesc", "uub"},
    {"compression", "b"},
    {"envmap", "b"},
    {"lineOrder", "b"},
    {"deepImageState", "b"},
    {"floatvector", ""},
}};

std::string_view fields_of(std::string_view type) {
    const auto* found = std::find_if(kNumberLayouts.begin(), kNumberLayouts.end(),
                                     [&](const NumberLayout& layout) { return layout.type == type; });
    return found == kNumberLayouts.end() ? std::string_view{} : found->fields;
}

template <typename T> double take(const std::byte*& from) {
    T value;
    std::memcpy(&value, from, sizeof value);
    from += sizeof value;
    return static_cast<double>(value);
}

template <typename T> void append(std::string& to, T value) {
    std::array<char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), &value, sizeof value);
    to.append(bytes.data(), bytes.size());
}

template <typename T> T to_integer(double value) {
    constexpr auto low = static_cast<double>(std::numeric_limits<T>::min());
    constexpr auto high = static_cast<double>(std::numeric_limits<T>::max());
    return static_cast<T>(value == value ? std::clamp(value, low, high) : 0.0);
}

std::vector<double> take_numbers(std::string_view fields, const void* source) {
    std::vector<double> values;
    const auto* from = static_cast<const std::byte*>(source);
    for (const char field : fields) {
        switch (field) {
            case 'i':
                values.push_back(take<std::int32_t>(from));
                break;
            case 'u':
                values.push_back(take<std::uint32_t>(from));
                break;
            case 'b':
                values.push_back(take<std::uint8_t>(from));
                break;
            case 'f':
                values.push_back(take<float>(from));
                break;
            default:
                values.push_back(take<double>(from));
                break;
        }
    }
    return values;
}

void append_number(std::string& to, char field, double value) {
    switch (field) {
        case 'i':
            append(to, to_integer<std::int32_t>(value));
            break;
        case 'u':
            append(to, to_integer<std::uint32_t>(value));
            break;
        case 'b':
            append(to, to_integer<std::uint8_t>(value));
            break;
        case 'f':
            append(to, static_cast<float>(value));
            break;
        default:
            append(to, value);
            break;
    }
}

std::vector<std::byte> bytes_of(const void* data, std::size_t size) {
    const auto* from = static_cast<const std::byte*>(data);
    return data == nullptr ? std::vector<std::byte>{} : std::vector<std::byte>(from, from + size);
}

std::vector<std::byte> to_bytes(const std::string& text) { return bytes_of(text.data(), text.size()); }

std::string to_string(const exr_attr_string_t& text) {
    return text.str == nullptr || text.length <= 0 ? std::string{}
                                                   : std::string(text.str, static_cast<std::size_t>(text.length));
}

std::vector<std::byte> preview_bytes(const exr_attr_preview_t& preview) {
    std::string bytes;
    append(bytes, preview.width);
    append(bytes, preview.height);
    const std::size_t pixels = std::size_t{preview.width} * preview.height * 4;
    if (preview.rgba != nullptr) {
        bytes.append(reinterpret_cast<const char*>(preview.rgba), pixels);
    }
    return to_bytes(bytes);
}

[[noreturn]] void throw_mismatch(const Attribute& attribute, std::string_view wanted) {
    throw Error(ErrorKind::value,
                "attribute '" + attribute.name + "' of type '" + attribute.type + "' must hold " + std::string(wanted));
}

}  // namespace

bool is_structural(std::string_view name) {
    static constexpr std::array<std::string_view, 13> kNames{
        "channels", "compression", "dataWindow", "displayWindow", "lineOrder", "pixelAspectRatio",   "tiles",
        "name",     "type",        "version",    "chunkCount",    "view",      "maxSamplesPerPixel",
    };
    return std::find(kNames.begin(), kNames.end(), name) != kNames.end();
}

std::optional<Attribute> read_attribute(const exr_attribute_t& source) {
    Attribute result;
    result.name.assign(source.name, source.name_length);
    result.type.assign(source.type_name, source.type_name_length);
    switch (source.type) {
        case EXR_ATTR_UNKNOWN:
        case EXR_ATTR_LAST_KNOWN_TYPE:
        case EXR_ATTR_CHLIST:
            return std::nullopt;
        case EXR_ATTR_STRING:
            result.value = to_string(*source.string);
            break;
        case EXR_ATTR_STRING_VECTOR: {
            std::vector<std::string> texts;
            texts.reserve(static_cast<std::size_t>(std::max(source.stringvector->n_strings, 0)));
            for (int i = 0; i < source.stringvector->n_strings; ++i) {
                texts.push_back(to_string(source.stringvector->strings[i]));
            }
            result.value = std::move(texts);
            break;
        }
        case EXR_ATTR_FLOAT_VECTOR: {
            const float* values = source.floatvector->arr;
            result.value = std::vector<double>(values, values + std::max(source.floatvector->length, 0));
            break;
        }
        case EXR_ATTR_PREVIEW:
            result.value = preview_bytes(*source.preview);
            break;
        case EXR_ATTR_OPAQUE:
            result.value = bytes_of(source.opaque->packed_data, static_cast<std::size_t>(source.opaque->size));
            break;
        case EXR_ATTR_INT:
            result.value = take_numbers("i", &source.i);
            break;
        case EXR_ATTR_FLOAT:
            result.value = take_numbers("f", &source.f);
            break;
        case EXR_ATTR_DOUBLE:
            result.value = take_numbers("d", &source.d);
            break;
#if OPENEXR_VERSION_MAJOR > 3 || OPENEXR_VERSION_MINOR >= 4
        case EXR_ATTR_BYTES: {
            std::string bytes;
            append(bytes, source.bytes->hint_length);
            if (source.bytes->type_hint != nullptr) {
                bytes.append(source.bytes->type_hint, source.bytes->hint_length);
            }
            if (source.bytes->data != nullptr) {
                bytes.append(reinterpret_cast<const char*>(source.bytes->data), source.bytes->size);
            }
            result.value = to_bytes(bytes);
            break;
        }
#endif
        default: {
            // One byte stands in the union itself, everything larger behind a pointer.
            const std::string_view fields = fields_of(result.type);
            result.value = take_numbers(fields, fields == "b" ? &source.uc : source.rawptr);
            break;
        }
    }
    return result;
}

std::string attribute_bytes(const Attribute& attribute) {
    std::string bytes;
    if (const auto* raw = std::get_if<std::vector<std::byte>>(&attribute.value)) {
        bytes.assign(reinterpret_cast<const char*>(raw->data()), raw->size());
    } else if (const auto* text = std::get_if<std::string>(&attribute.value)) {
        if (attribute.type != "string") {
            throw_mismatch(attribute, "something else than text");
        }
        bytes = *text;
    } else if (const auto* texts = std::get_if<std::vector<std::string>>(&attribute.value)) {
        if (attribute.type != "stringvector") {
            throw_mismatch(attribute, "something else than a list of texts");
        }
        for (const std::string& entry : *texts) {
            append(bytes, static_cast<std::int32_t>(entry.size()));
            bytes += entry;
        }
    } else {
        const auto& numbers = std::get<std::vector<double>>(attribute.value);
        const std::string_view fields = fields_of(attribute.type);
        if (attribute.type != "floatvector" && fields.size() != numbers.size()) {
            throw_mismatch(attribute, fields.empty() ? "bytes" : std::to_string(fields.size()) + " number(s)");
        }
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            append_number(bytes, fields.empty() ? 'f' : fields[i], numbers[i]);
        }
    }
    return bytes;
}

}  // namespace relume::io
