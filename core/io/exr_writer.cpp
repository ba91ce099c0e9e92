// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstring>
#include <deque>
#include <numeric>
#include <utility>

#include "io/chunk_encoder.h"
#include "io/exr.h"
#include "io/exr_header.h"
#include "io/exr_header_writer.h"
#include "io/ordered_chunks.h"
#include "io/output_file.h"
#include "relume/error.h"

namespace relume::io {

namespace {

// Compressed chunks that wait for their turn: many times what threads in step leave waiting.
constexpr std::size_t kQueueBytes = std::size_t{64} << 20;

// For each channel of the file the caller's index: a file has them sorted by name.
std::vector<std::size_t> sorted_order(const std::vector<Channel>& channels) {
    std::vector<std::size_t> order(channels.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return channels[a].name < channels[b].name; });
    return order;
}

}  // namespace

struct ExrWriter::Impl {
    Impl(const std::filesystem::path& path, const Header& wanted, const WriteOptions& options)
        : header(normalized_for_writing(wanted)), window(header.parts.front().data_window), file(path) {
        for (std::size_t i = 0; i < header.parts.size(); ++i) {
            orders.push_back(sorted_order(wanted.parts[i].channels));
            pools.emplace_back(header.parts[i], options);
        }
        rows_per_chunk = pools.front().rows_per_chunk();
        chunk_count = (window.height - 1) / rows_per_chunk + 1;
        const std::string bytes = header_bytes(header, options.compression, chunk_count);
        const std::size_t chunks = static_cast<std::size_t>(chunk_count) * header.parts.size();
        table_offset = bytes.size();
        file.write(std::as_bytes(std::span(bytes)), {}, 0);
        output.emplace(file, chunks, table_offset + chunks * sizeof(std::uint64_t), kQueueBytes);
    }

    std::size_t part_count() const { return header.parts.size(); }

    // Bands of all parts follow each other in the file, as they come out of a relight.
    std::size_t chunk_number(int part, int band) const {
        return static_cast<std::size_t>(band) * part_count() + static_cast<std::size_t>(part);
    }

    void check_call(int part, int y, int rows, std::span<const ConstPlane> channels) const {
        const auto refuse = [&](const std::string& what) {
            throw Error(ErrorKind::value, file.path().string() + ": " + what);
        };
        if (part < 0 || static_cast<std::size_t>(part) >= part_count()) {
            refuse("has no part " + std::to_string(part));
        }
        const int top = y - window.y;
        if (y < window.y || rows < 1 || rows > window.y_end() - y || top % rows_per_chunk != 0 ||
            (rows % rows_per_chunk != 0 && rows != window.y_end() - y)) {
            refuse("rows " + std::to_string(y) + ".." + std::to_string(std::int64_t{y} + rows - 1) +
                   " do not start and end at multiples of " + std::to_string(rows_per_chunk) +
                   " within the data window");
        }
        if (channels.size() != orders[static_cast<std::size_t>(part)].size()) {
            refuse(std::to_string(channels.size()) + " planes given for " +
                   std::to_string(orders[static_cast<std::size_t>(part)].size()) + " channels");
        }
        for (const ConstPlane& plane : channels) {
            if (plane.data == nullptr) {
                refuse("a plane without pixels");
            }
        }
    }

    void write_chunk(int part, int band, std::span<const ConstPlane> channels, ChunkEncoder& encoder) {
        const int y = window.y + band * rows_per_chunk;
        const std::span<const std::byte> data = encoder.encode(y, channels);
        std::array<std::int32_t, 3> leader{part, y, static_cast<std::int32_t>(data.size())};
        std::span<const std::byte> bytes = std::as_bytes(std::span(leader));
        if (part_count() == 1) {
            bytes = bytes.subspan(sizeof(std::int32_t));  // the part's number stands in multi-part files alone
        }
        if (!output->put(chunk_number(part, band), bytes, data)) {
            throw Error(ErrorKind::value, file.path().string() + ": " + part_label(header, part) + "row " +
                                              std::to_string(y) + " was written twice");
        }
    }

    void check_complete() const {
        const std::vector<std::uint64_t>& offsets = output->offsets();
        const auto missing = static_cast<std::size_t>(std::find(offsets.begin(), offsets.end(), 0u) - offsets.begin());
        if (missing == offsets.size()) {
            return;
        }
        const auto part = static_cast<int>(missing % part_count());
        const int y = window.y + static_cast<int>(missing / part_count()) * rows_per_chunk;
        throw Error(ErrorKind::value, file.path().string() + ": " + part_label(header, part) + "rows from " +
                                          std::to_string(y) + " on were never written");
    }

    void commit() {
        check_complete();
        std::vector<std::uint64_t> table;
        for (int part = 0; part < static_cast<int>(part_count()); ++part) {
            for (int band = 0; band < chunk_count; ++band) {
                table.push_back(output->offsets()[chunk_number(part, band)]);
            }
        }
        file.write(std::as_bytes(std::span(table)), {}, table_offset);
        file.commit();
    }

    Header header;
    Window window;
    OutputFile file;
    std::vector<std::vector<std::size_t>> orders;
    std::deque<EncoderPool> pools;
    int rows_per_chunk = 1;
    int chunk_count = 0;
    std::uint64_t table_offset = 0;
    std::optional<OrderedChunks> output;
    bool committed = false;
};

ExrWriter::ExrWriter(const std::filesystem::path& path, const Header& header, const WriteOptions& options)
    : impl_(std::make_unique<Impl>(path, header, options)) {}

ExrWriter::~ExrWriter() = default;

int ExrWriter::rows_per_chunk() const { return impl_->rows_per_chunk; }

void ExrWriter::write(int part, int y, int rows, std::span<const ConstPlane> channels) {
    Impl& impl = *impl_;
    impl.check_call(part, y, rows, channels);
    const std::vector<std::size_t>& order = impl.orders[static_cast<std::size_t>(part)];
    EncoderPool::Lease encoder = impl.pools[static_cast<std::size_t>(part)].borrow();
    std::vector<ConstPlane> planes(channels.size());
    for (int row = 0; row < rows; row += impl.rows_per_chunk) {
        for (std::size_t c = 0; c < planes.size(); ++c) {
            planes[c] = channels[order[c]];
            planes[c].data += row * planes[c].y_stride;
        }
        impl.write_chunk(part, (y + row - impl.window.y) / impl.rows_per_chunk, planes, *encoder.operator->());
    }
}

void ExrWriter::commit() {
    if (impl_->committed) {
        throw Error(ErrorKind::value, impl_->file.path().string() + ": was committed before");
    }
    impl_->commit();
    impl_->committed = true;
}

}  // namespace relume::io
