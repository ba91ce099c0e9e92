// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>
#include <deque>
#include <limits>
#include <optional>
#include <utility>

#include "io/chunk_decoder.h"
#include "io/chunk_unpack.h"
#include "io/exr.h"
#include "io/exr_core.h"
#include "io/exr_header.h"
#include "relume/error.h"

namespace relume::io {

namespace {

constexpr int kMagicSize = 4;
constexpr unsigned char kMagic[kMagicSize] = {0x76, 0x2f, 0x31, 0x01};

void check_magic(const InputFile& file, const std::filesystem::path& path) {
    unsigned char magic[kMagicSize] = {};
    if (file.size() == 0) {
        throw Error(ErrorKind::format, path.string() + ": is empty");
    }
    if (file.read(magic, kMagicSize, 0) != kMagicSize || !std::equal(magic, magic + kMagicSize, kMagic)) {
        throw Error(ErrorKind::format, path.string() + ": is not an EXR file");
    }
}

Window intersection(const Window& a, const Window& b) {
    // In 64 bits: a caller's region may end beyond the largest int.
    const std::int64_t left = std::max(a.x, b.x);
    const std::int64_t top = std::max(a.y, b.y);
    const std::int64_t right = std::min(std::int64_t{a.x} + a.width, std::int64_t{b.x} + b.width);
    const std::int64_t bottom = std::min(std::int64_t{a.y} + a.height, std::int64_t{b.y} + b.height);
    if (right <= left || bottom <= top) {
        return {};
    }
    return {static_cast<int>(left), static_cast<int>(top), static_cast<int>(right - left),
            static_cast<int>(bottom - top)};
}

// Whether ZipRows can walk through the part's chunks.
bool can_walk_zip_rows(const Part& part) {
    return (part.compression == Compression::zip || part.compression == Compression::zips) && !part.deep &&
           std::all_of(part.channels.begin(), part.channels.end(),
                       [](const Channel& c) { return c.x_sampling == 1 && c.y_sampling == 1; });
}

// A chunk of a part: the band of rows that starts at `y`, or the tile (column, row) of the full-size level.
struct ChunkPosition {
    int column = 0;
    int row = 0;
};

}  // namespace

struct ExrReader::Impl {
    Impl(const std::filesystem::path& file_path, const ReadLimits& limits) : path(file_path), file(file_path) {
        check_magic(file, path);
        context = open_core_context(file, path);
        header = read_header(context.get(), path, file.size(), limits);
        for (int i = 0; i < static_cast<int>(header.parts.size()); ++i) {
            pools.emplace_back(context.get(), i, can_walk_zip_rows(part_at(i)));
        }
    }

    const Part& part_at(int index) const { return header.parts[static_cast<std::size_t>(index)]; }

    void check_targets(const Window& region, std::span<const ReadTarget> targets) const {
        if (std::int64_t{region.x} + region.width > std::numeric_limits<int>::max() ||
            std::int64_t{region.y} + region.height > std::numeric_limits<int>::max()) {
            throw Error(ErrorKind::value, path.string() + ": the region to read ends beyond the largest coordinate");
        }
        for (const ReadTarget& target : targets) {
            if (target.part < 0 || target.part >= static_cast<int>(header.parts.size())) {
                throw Error(ErrorKind::value, path.string() + ": has no part " + std::to_string(target.part));
            }
            const Part& part = part_at(target.part);
            if (target.channel < 0 || target.channel >= static_cast<int>(part.channels.size())) {
                throw Error(ErrorKind::value, path.string() + ": " + part_label(header, target.part) +
                                                  "has no channel " + std::to_string(target.channel));
            }
            if (target.plane.data == nullptr) {
                throw Error(ErrorKind::value, path.string() + ": no memory given for channel '" +
                                                  part.channels[static_cast<std::size_t>(target.channel)].name + "'");
            }
            if (part.deep) {
                fail(target.part, "is a deep image, which has no single value per pixel: flatten it first");
            }
            if (!is_supported(part.compression)) {
                fail(target.part, "is compressed by " + std::string(name_of(part.compression)) +
                                      ", which OpenEXR " OPENEXR_VERSION_STRING " cannot decode: save it as zip");
            }
        }
    }

    [[noreturn]] void fail(int part, const std::string& what) const {
        throw Error(ErrorKind::format, path.string() + ": " + part_label(header, part) + what);
    }

    exr_result_t locate(int part, ChunkPosition at, exr_chunk_info_t& chunk) const {
        clear_core_error();
        return part_at(part).tiled
                   ? exr_read_tile_chunk_info(context.get(), part, at.column, at.row, 0, 0, &chunk)
                   : exr_read_scanline_chunk_info(context.get(), part, band_start(part, at.row), &chunk);
    }

    int band_start(int part, int band) const {
        return part_at(part).data_window.y + band * part_at(part).rows_per_chunk;
    }

    int band_count(int part) const {
        const Part& p = part_at(part);
        return (p.data_window.height - 1) / p.rows_per_chunk + 1;
    }

    Window chunk_box(int part, ChunkPosition at) const {
        const Part& p = part_at(part);
        const Window& window = p.data_window;
        const std::int64_t width = p.tiled ? p.tile_width : window.width;
        const std::int64_t height = p.tiled ? p.tile_height : p.rows_per_chunk;
        const std::int64_t left = at.column * width;
        const std::int64_t top = at.row * height;
        return {static_cast<int>(window.x + left), static_cast<int>(window.y + top),
                static_cast<int>(std::min(width, window.width - left)),
                static_cast<int>(std::min(height, window.height - top))};
    }

    /// Says what is wrong with a chunk that could not be had. A file that ends too early, or whose writer was killed,
    /// lacks all chunks from one on: that is told apart from a single bad chunk by trying the others.
    [[noreturn]] void fail_chunk(int part, ChunkPosition at, exr_result_t code) const {
        const std::string message = take_core_error(code);
        if (file.error() != 0) {
            throw Error(ErrorKind::file, path.string() + ": cannot read: " + std::strerror(file.error()));
        }
        const Window box = chunk_box(part, at);
        const auto missing = [&](int band) {
            exr_chunk_info_t chunk{};
            return locate(part, {0, band}, chunk) != EXR_ERR_SUCCESS;
        };
        const int last = band_count(part) - 1;
        if (missing(at.row) && missing(last)) {
            int first = at.row;
            while (first > 0 && missing(first - 1)) {
                --first;
            }
            clear_core_error();
            const Window& window = part_at(part).data_window;
            fail(part, "truncated: rows " + std::to_string(chunk_box(part, {0, first}).y) + ".." +
                           std::to_string(window.y_end() - 1) + " are missing");
        }
        clear_core_error();
        const std::string where = part_at(part).tiled
                                      ? "tile (" + std::to_string(at.column) + ", " + std::to_string(at.row) + ")"
                                      : "rows " + std::to_string(box.y) + ".." + std::to_string(box.y_end() - 1);
        fail(part, "damaged at " + where + ": " + message);
    }

    void read_chunk(int index, ChunkPosition at, const Window& region, const Window& origin,
                    std::span<const ReadTarget> targets, DecoderPool::Lease& decoder) const {
        const Part& part = part_at(index);
        exr_chunk_info_t chunk{};
        exr_result_t code = locate(index, at, chunk);
        if (code != EXR_ERR_SUCCESS) {
            fail_chunk(index, at, code);
        }
        const Window box = chunk_box(index, at);
        if (chunk.width != box.width || chunk.height != box.height ||
            chunk.unpacked_size != unpacked_bytes(part, box) ||
            chunk.unpacked_size / max_ratio(part.compression) > chunk.packed_size) {
            clear_core_error();
            fail_chunk(index, at, EXR_ERR_CORRUPT_CHUNK);
        }
        const DecodedChunk pixels = decoder->decode(chunk, code);
        if (code != EXR_ERR_SUCCESS) {
            decoder.discard();
            fail_chunk(index, at, code);
        }
        if (pixels.zip_rows) {
            unpack_zip_chunk(pixels.bytes, box, part, region, origin, targets);
        } else {
            unpack_chunk(pixels.bytes, box, part, region, origin, targets);
        }
    }

    void read_part(int index, const Window& origin, std::span<const ReadTarget> targets) const {
        const Part& part = part_at(index);
        const Window region = intersection(origin, part.data_window);
        clear_outside(origin, region, targets);
        if (region.empty()) {
            return;
        }
        const Window needed = sampled_region(part, region, targets);
        const int height = part.tiled ? part.tile_height : part.rows_per_chunk;
        const int width = part.tiled ? part.tile_width : part.data_window.width;
        const int first_row = (needed.y - part.data_window.y) / height;
        const int last_row = (needed.y_end() - 1 - part.data_window.y) / height;
        const int first_column = (needed.x - part.data_window.x) / width;
        const int last_column = part.tiled ? (needed.x_end() - 1 - part.data_window.x) / width : first_column;
        DecoderPool::Lease decoder = pools[static_cast<std::size_t>(index)].borrow();
        for (int row = first_row; row <= last_row; ++row) {
            for (int column = first_column; column <= last_column; ++column) {
                read_chunk(index, {part.tiled ? column : 0, row}, region, origin, targets, decoder);
            }
        }
    }

    bool has_chunk(int part, ChunkPosition at) const {
        exr_chunk_info_t chunk{};
        return locate(part, at, chunk) == EXR_ERR_SUCCESS && chunk.data_offset > 0 &&
               chunk.data_offset + chunk.packed_size <= static_cast<std::uint64_t>(file.size());
    }

    bool has_all_chunks(int part) const {
        const Part& p = part_at(part);
        const int columns = p.tiled ? (p.data_window.width - 1) / p.tile_width + 1 : 1;
        const int rows = p.tiled ? (p.data_window.height - 1) / p.tile_height + 1 : band_count(part);
        for (int row = 0; row < rows; ++row) {
            for (int column = 0; column < columns; ++column) {
                if (!has_chunk(part, {column, row})) {
                    return false;
                }
            }
        }
        return true;
    }

    /// What was read before a change is one frame; what is read after it may be half of another.
    void check_unchanged() const {
        if (file.changed())
            throw Error(ErrorKind::file,
                        path.string() + ": changed on disk while it was open; open it again when it is written");
    }

    std::filesystem::path path;
    InputFile file;
    CoreContext context;
    Header header;
    mutable std::deque<DecoderPool> pools;  // one per part; the decoders refer to the context
};

ExrReader::ExrReader(const std::filesystem::path& path, const ReadLimits& limits)
    : impl_(std::make_unique<Impl>(path, limits)) {}

ExrReader::~ExrReader() = default;
ExrReader::ExrReader(ExrReader&&) noexcept = default;
ExrReader& ExrReader::operator=(ExrReader&&) noexcept = default;

const Header& ExrReader::header() const { return impl_->header; }

const std::filesystem::path& ExrReader::path() const { return impl_->path; }

int ExrReader::release_buffers() const {
    int decoders = 0;
    for (DecoderPool& pool : impl_->pools) decoders += pool.clear();
    return decoders;
}

bool ExrReader::is_whole() const {
    bool whole = true;
    for (int part = 0; whole && part < static_cast<int>(impl_->header.parts.size()); ++part) {
        whole = impl_->part_at(part).deep || impl_->has_all_chunks(part);
    }
    clear_core_error();
    return whole;
}

void ExrReader::read(const Window& region, std::span<const ReadTarget> targets) const {
    if (region.empty()) {
        return;
    }
    impl_->check_targets(region, targets);
    std::vector<ReadTarget> by_part(targets.begin(), targets.end());
    std::stable_sort(by_part.begin(), by_part.end(),
                     [](const ReadTarget& a, const ReadTarget& b) { return a.part < b.part; });
    try {
        for (auto begin = by_part.begin(); begin != by_part.end();) {
            const auto end = std::find_if(begin, by_part.end(),
                                          [&](const ReadTarget& target) { return target.part != begin->part; });
            impl_->read_part(begin->part, region, {begin, end});
            begin = end;
        }
    } catch (const Error&) {
        impl_->check_unchanged();
        throw;
    }
    impl_->check_unchanged();
}

}  // namespace relume::io
