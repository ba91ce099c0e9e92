// SPDX-License-Identifier: Apache-2.0
#include "io/exr_header.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "io/exr_attribute.h"
#include "relume/error.h"
#include "text/printable.h"

namespace relume::io {

namespace {

struct CompressionFacts {
    std::string_view name;
    /// More times smaller than its pixels no chunk can be: what a header claims beyond that is a lie. Run length coding
    /// makes 128 bytes of 2; deflate at most 1032 of 1 (and PXR24 drops a byte of 4 before); B44A 32 of 3. For the
    /// others the figures are generous bounds for chunks of one colour.
    std::uint64_t max_ratio;
    bool supported;
};

constexpr bool since(int major, int minor) {
    return OPENEXR_VERSION_MAJOR > major || (OPENEXR_VERSION_MAJOR == major && OPENEXR_VERSION_MINOR >= minor);
}

constexpr std::array<CompressionFacts, 14> kCompressions{{
    {"none", 1, true},
    {"rle", 64, true},
    {"zips", 1032, true},
    {"zip", 1032, true},
    {"piz", 1 << 15, true},
    {"pxr24", 1376, true},
    {"b44", 11, true},
    {"b44a", 11, true},
    {"dwaa", 1 << 17, since(3, 2)},
    {"dwab", 1 << 17, since(3, 2)},
    {"htj2k256", 1 << 21, since(3, 4)},
    {"htj2k32", 1 << 21, since(3, 4)},
    {"lj2k", 1 << 21, since(3, 5)},
    {"zstd", 1 << 17, since(3, 5)},
}};

const CompressionFacts& facts_of(Compression compression) {
    return kCompressions[static_cast<std::size_t>(compression)];
}

Window to_window(const exr_attr_box2i_t& box) {
    return {box.min.x, box.min.y, box.max.x - box.min.x + 1, box.max.y - box.min.y + 1};
}

PixelType to_pixel_type(exr_pixel_type_t type) {
    switch (type) {
        case EXR_PIXEL_HALF:
            return PixelType::half;
        case EXR_PIXEL_UINT:
            return PixelType::uint32;
        default:
            return PixelType::float32;
    }
}

class HeaderReader {
public:
    HeaderReader(exr_const_context_t context, const std::filesystem::path& path) : context_(context), path_(path) {}

    Part read_part(int index) const {
        Part part;
        read_channels(index, part);

        exr_attr_box2i_t box{};
        check(exr_get_data_window(context_, index, &box), "dataWindow");
        part.data_window = to_window(box);
        check(exr_get_display_window(context_, index, &box), "displayWindow");
        part.display_window = to_window(box);
        check(exr_get_pixel_aspect_ratio(context_, index, &part.pixel_aspect), "pixelAspectRatio");

        exr_compression_t compression = EXR_COMPRESSION_NONE;
        check(exr_get_compression(context_, index, &compression), "compression");
        if (static_cast<std::size_t>(compression) >= kCompressions.size()) {
            fail("unknown compression " + std::to_string(static_cast<int>(compression)));
        }
        part.compression = static_cast<Compression>(compression);

        exr_storage_t storage = EXR_STORAGE_SCANLINE;
        check(exr_get_storage(context_, index, &storage), "type");
        part.tiled = storage == EXR_STORAGE_TILED || storage == EXR_STORAGE_DEEP_TILED;
        part.deep = storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED;
        if (part.tiled) {
            read_tiles(index, part);
        } else {
            std::int32_t rows = 1;
            check(exr_get_scanlines_per_chunk(context_, index, &rows), "scanlines per chunk");
            part.rows_per_chunk = std::max(rows, 1);
        }
        read_attributes(index, part);
        return part;
    }

    [[noreturn]] void fail(const std::string& what) const {
        throw Error(ErrorKind::format, path_.string() + ": damaged header: " + what);
    }

private:
    void check(exr_result_t code, const char* what) const {
        if (code != EXR_ERR_SUCCESS) {
            fail(std::string(what) + ": " + take_core_error(code));
        }
    }

    void read_channels(int index, Part& part) const {
        const exr_attr_chlist_t* list = nullptr;
        check(exr_get_channels(context_, index, &list), "channels");
        for (int c = 0; c < list->num_channels; ++c) {
            const exr_attr_chlist_entry_t& entry = list->entries[c];
            if (entry.x_sampling < 1 || entry.y_sampling < 1) {
                fail("channel '" + std::string(entry.name.str) + "' has a sampling rate below 1");
            }
            // A name goes to every program that a user has: none of them expects more than a printable one.
            part.channels.push_back({printable({entry.name.str, static_cast<std::size_t>(entry.name.length)}),
                                     to_pixel_type(entry.pixel_type), entry.x_sampling, entry.y_sampling,
                                     entry.p_linear != 0});
        }
    }

    void read_tiles(int index, Part& part) const {
        std::uint32_t width = 0;
        std::uint32_t height = 0;
        exr_tile_level_mode_t levels = EXR_TILE_ONE_LEVEL;
        exr_tile_round_mode_t rounding = EXR_TILE_ROUND_DOWN;
        check(exr_get_tile_descriptor(context_, index, &width, &height, &levels, &rounding), "tiles");
        if (width == 0 || height == 0 || width > 0x7fffffffu || height > 0x7fffffffu) {
            fail("tiles of " + std::to_string(width) + "x" + std::to_string(height) + " pixels");
        }
        part.tile_width = static_cast<int>(width);
        part.tile_height = static_cast<int>(height);
        part.rows_per_chunk = std::max(1, std::min(part.tile_height, part.data_window.height));
    }

    void read_attributes(int index, Part& part) const {
        std::int32_t count = 0;
        check(exr_get_attribute_count(context_, index, &count), "attributes");
        for (std::int32_t i = 0; i < count; ++i) {
            const exr_attribute_t* source = nullptr;
            check(exr_get_attribute_by_index(context_, index, EXR_ATTR_LIST_FILE_ORDER, i, &source), "attributes");
            const std::string_view name(source->name, source->name_length);
            if (!is_structural(name)) {
                if (auto attribute = read_attribute(*source)) {
                    part.attributes.push_back(std::move(*attribute));
                }
            } else if (source->type == EXR_ATTR_STRING && source->string->str != nullptr) {
                const std::string text =
                    printable({source->string->str, static_cast<std::size_t>(source->string->length)});
                if (name == "name") {
                    part.name = text;
                } else if (name == "view") {
                    part.view = text;
                }
            }
        }
    }

    exr_const_context_t context_;
    const std::filesystem::path& path_;
};

void check_limits(const Header& header, const std::filesystem::path& path, std::int64_t file_size,
                  const ReadLimits& limits) {
    const auto refuse = [&](const std::string& what) { throw Error(ErrorKind::format, path.string() + ": " + what); };
    const auto count = static_cast<std::int64_t>(header.parts.size());
    if (count > limits.max_parts) {
        refuse(std::to_string(count) + " parts, more than the limit of " + std::to_string(limits.max_parts) +
               " (max_parts)");
    }
    std::int64_t channels = 0;
    for (std::size_t i = 0; i < header.parts.size(); ++i) {
        const Part& part = header.parts[i];
        const std::string label = part_label(header, static_cast<int>(i));
        const Window& window = part.data_window;
        const std::string size = std::to_string(window.width) + "x" + std::to_string(window.height) + " pixels";
        channels += static_cast<std::int64_t>(part.channels.size());
        if (channels > limits.max_channels) {
            refuse("more than the limit of " + std::to_string(limits.max_channels) + " channels (max_channels)");
        }
        if (std::int64_t{window.width} * window.height > limits.max_pixels) {
            refuse(label + "claims " + size + ", more than the limit of " + std::to_string(limits.max_pixels) +
                   " (max_pixels)");
        }
        if (!part.deep) {
            // A truncated file may hold less than its header says, but one that cannot hold a fraction of it is
            // refused here rather than after its pixels have been allocated.
            const std::uint64_t most = static_cast<std::uint64_t>(file_size) * max_ratio(part.compression);
            if (unpacked_bytes(part, window) / 8 > most) {
                refuse(label + "claims " + size + " in " + std::to_string(part.channels.size()) +
                       " channel(s), which " + std::to_string(file_size) + " bytes of " +
                       std::string(name_of(part.compression)) + " cannot hold: truncated or damaged");
            }
        }
    }
}

}  // namespace

std::string_view name_of(Compression compression) { return facts_of(compression).name; }

std::optional<Compression> compression_from_name(std::string_view name) {
    for (std::size_t i = 0; i < kCompressions.size(); ++i) {
        if (kCompressions[i].name == name) {
            return static_cast<Compression>(i);
        }
    }
    return std::nullopt;
}

bool is_supported(Compression compression) { return facts_of(compression).supported; }

std::uint64_t max_ratio(Compression compression) { return facts_of(compression).max_ratio; }

std::string part_label(const Header& header, int part) {
    if (header.parts.size() < 2) {
        return {};
    }
    const std::string& name = header.parts[static_cast<std::size_t>(part)].name;
    return "part " + std::to_string(part) + (name.empty() ? std::string{} : " '" + name + "'") + ": ";
}

std::int64_t sample_count(std::int64_t start, std::int64_t count, int sampling) {
    return floor_div(start + count - 1, sampling) - floor_div(start - 1, sampling);
}

std::uint64_t unpacked_bytes(const Part& part, const Window& box) {
    std::uint64_t total = 0;
    for (const Channel& channel : part.channels) {
        total += static_cast<std::uint64_t>(sample_count(box.x, box.width, channel.x_sampling)) *
                 static_cast<std::uint64_t>(sample_count(box.y, box.height, channel.y_sampling)) *
                 size_of(channel.type);
    }
    return total;
}

Header read_header(exr_const_context_t context, const std::filesystem::path& path, std::int64_t file_size,
                   const ReadLimits& limits) {
    const HeaderReader reader(context, path);
    int count = 0;
    if (exr_get_count(context, &count) != EXR_ERR_SUCCESS || count < 1) {
        reader.fail("no parts");
    }
    Header header;
    for (int i = 0; i < count; ++i) {
        header.parts.push_back(reader.read_part(i));
    }
    check_limits(header, path, file_size, limits);
    return header;
}

}  // namespace relume::io
