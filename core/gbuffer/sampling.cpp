// SPDX-License-Identifier: Apache-2.0
#include "gbuffer/sampling.h"

#include <algorithm>
#include <cmath>

#include "gbuffer/planes.h"
#include "threads/workers.h"

namespace relume::gbuffer {

namespace {

constexpr int kRowsInMemory = 64;
constexpr int kRowsPerBand = 4;
constexpr int kDenseRows = 256;

/// Height of the chunks that reading one row decodes, over all the planes' parts.
int chunk_rows(const GBuffer::Impl& impl, std::span<const int> raws) {
    int rows = 1;
    for (const int raw : raws) {
        const RawPlane& plane = impl.raws[static_cast<std::size_t>(raw)];
        if (plane.memory.data) continue;
        const SourceFile& file = impl.files[static_cast<std::size_t>(plane.address.file)];
        rows = std::max(rows, file.header.parts[static_cast<std::size_t>(plane.address.part)].rows_per_chunk);
    }
    return rows;
}

/// Adds the rows beside every `step`-th of `rows` from `first` on, as far as they lie in [top, bottom).
void add_neighbours(std::vector<int>& rows, std::size_t first, std::size_t step, int top, int bottom) {
    const std::size_t count = rows.size();
    for (std::size_t k = first; k < count; k += step) {
        for (const int y : {rows[k] - 1, rows[k] + 1}) {
            if (y >= top && y < bottom) rows.push_back(y);
        }
    }
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
}

/// Rows to look at: bands far apart where a chunk costs many rows, single rows where it costs one. Some stand between
/// two others, which shows what changes from row to row.
std::vector<int> choose_rows(const Window& window, int chunk, bool in_memory, bool dense) {
    const int height = window.height;
    std::vector<int> rows;
    if (in_memory || chunk == 1) {
        const int count = std::min(height, dense ? kDenseRows : kRowsInMemory);
        for (int k = 0; k < count; ++k) {
            rows.push_back(window.y + static_cast<int>((2 * static_cast<std::int64_t>(k) + 1) * height / (2 * count)));
        }
        if (!dense) add_neighbours(rows, 1, 3, window.y, window.y_end());
        return rows;
    }
    const int chunks = (height + chunk - 1) / chunk;
    const int bands = std::min(chunks, dense ? 64 : std::clamp(128 / chunk, 6, 32));
    for (int b = 0; b < bands; ++b) {
        const auto index = static_cast<int>((2 * static_cast<std::int64_t>(b) + 1) * chunks / (2 * bands));
        const int top = index * chunk;
        const int size = std::min(chunk, height - top);
        // Where the chunks are few they must give more rows each.
        const int wanted = std::min(size, std::max(kRowsPerBand, kRowsInMemory / bands));
        const std::size_t first = rows.size();
        for (int k = 0; k < wanted; ++k) rows.push_back(window.y + top + (2 * k + 1) * size / (2 * wanted));
        if (!dense)
            add_neighbours(rows, first + static_cast<std::size_t>(wanted) / 2, kRowsPerBand, window.y + top,
                           window.y + top + size);
    }
    return rows;
}

/// Row y of the k-th plane, where somebody has to fill it first.
void fill(const GBuffer::Impl& impl, std::span<const int> raws, std::size_t k, int y) {
    const auto name = [&](std::size_t i) -> const std::string& {
        return impl.raws[static_cast<std::size_t>(raws[i])].name;
    };
    if (impl.fill_row && (k == 0 || name(k) != name(k - 1))) impl.fill_row(name(k), y);
}

/// Whether rows of a plane can be hashed where they stand.
bool is_dense(const ConstPlane& plane) {
    constexpr std::ptrdiff_t kWidestPixel = 16;
    return plane.x_stride >= static_cast<std::ptrdiff_t>(size_of(plane.type)) && plane.x_stride <= kWidestPixel;
}

/// Components that stand side by side in memory: planes from `first` on, `bytes` of each row.
struct Strip {
    ConstPlane first;
    std::size_t bytes = 0;
};

/// What the planes cover, each byte once, in the planes' order wherever their memory lies. What stands between two of
/// them counts too: it lies in the same cache lines.
std::vector<Strip> strips_of(const GBuffer::Impl& impl, std::span<const int> raws) {
    std::vector<Strip> strips;
    for (const int raw : raws) {
        const ConstPlane& plane = impl.raws[static_cast<std::size_t>(raw)].memory;
        const auto row = static_cast<std::size_t>((impl.data_window.width - 1) * plane.x_stride) + size_of(plane.type);
        const auto is_beside = [&](const Strip& strip) {
            const std::ptrdiff_t step = plane.data - strip.first.data;
            return is_dense(plane) && plane.x_stride == strip.first.x_stride &&
                   plane.y_stride == strip.first.y_stride && step > -plane.x_stride && step < plane.x_stride;
        };
        const auto at = std::find_if(strips.begin(), strips.end(), is_beside);
        if (at == strips.end()) {
            strips.push_back({plane, row});
            continue;
        }
        const std::byte* end = std::max(at->first.data + at->bytes, plane.data + row);
        if (plane.data < at->first.data) at->first = plane;
        at->bytes = static_cast<std::size_t>(end - at->first.data);
    }
    return strips;
}

/// Neighbouring `rows` of some planes, one SampledRow each.
void sample_band(const GBuffer::Impl& impl, std::span<const int> raws, std::span<const int> rows,
                 std::span<SampledRow> result) {
    const Window& window = impl.data_window;
    const auto width = static_cast<std::size_t>(window.width);
    const int top = rows.front();
    const int height = rows.back() - top + 1;
    const std::size_t plane_size = width * static_cast<std::size_t>(height);
    std::vector<ConstPlane> planes(raws.size());
    std::vector<float> band(impl.in_memory() ? 0 : plane_size * raws.size());
    for (std::size_t f = 0; f < impl.files.size(); ++f) {
        std::vector<io::ReadTarget> targets;
        for (std::size_t k = 0; k < raws.size(); ++k) {
            const RawPlane& raw = impl.raws[static_cast<std::size_t>(raws[k])];
            if (raw.memory.data || raw.address.file != static_cast<int>(f)) continue;
            auto* data = reinterpret_cast<std::byte*>(band.data() + k * plane_size);
            const Plane plane{data, PixelType::float32, 4, static_cast<std::ptrdiff_t>(width * 4)};
            targets.push_back({raw.address.part, raw.address.channel, plane});
            planes[k] = plane;
        }
        if (!targets.empty()) impl.files[f].pixels->read({window.x, top, window.width, height}, targets);
    }
    for (std::size_t r = 0; r < rows.size(); ++r) {
        SampledRow& row = result[r];
        row.y = rows[r];
        row.planes.resize(raws.size());
        for (std::size_t k = 0; k < raws.size(); ++k) {
            row.planes[k].resize(width);
            const RawPlane& raw = impl.raws[static_cast<std::size_t>(raws[k])];
            const bool memory = raw.memory.data != nullptr;
            if (memory) fill(impl, raws, k, row.y);
            gather(memory ? raw.memory : planes[k], memory ? row.y - window.y : row.y - top, 0, window.width,
                   row.planes[k].data());
        }
    }
}

}  // namespace

std::vector<SampledRow> sample_rows(const GBuffer::Impl& impl, std::span<const int> raws, int threads, bool dense) {
    const Window& window = impl.data_window;
    if (window.empty() || raws.empty()) return {};
    const int chunk = chunk_rows(impl, raws);
    const std::vector<int> rows = choose_rows(window, chunk, impl.in_memory(), dense);
    // Rows of one chunk are read together, so that it is decoded once.
    std::vector<std::size_t> starts;
    for (std::size_t r = 0; r < rows.size(); ++r) {
        if (r == 0 || (rows[r] - window.y) / chunk != (rows[r - 1] - window.y) / chunk) starts.push_back(r);
    }
    starts.push_back(rows.size());
    std::vector<SampledRow> result(rows.size());
    const int bands = static_cast<int>(starts.size()) - 1;
    parallel_for(bands, threads > 0 ? threads : default_threads(), nullptr, [&](int, int band) {
        const std::size_t first = starts[static_cast<std::size_t>(band)];
        const std::size_t last = starts[static_cast<std::size_t>(band) + 1];
        sample_band(impl, raws, std::span(rows).subspan(first, last - first),
                    std::span(result).subspan(first, last - first));
    });
    if (impl.looks)
        impl.looks->push_back({{raws.begin(), raws.end()}, dense, hash_of_rows(impl, raws, threads, dense)});
    return result;
}

Hash hash_of_rows(const GBuffer::Impl& impl, std::span<const int> raws, int threads, bool dense) {
    const Window& window = impl.data_window;
    if (window.empty() || raws.empty()) return {};
    const std::vector<int> rows = choose_rows(window, 1, true, dense);
    const std::vector<Strip> strips = strips_of(impl, raws);
    std::vector<Hash> hashes(rows.size());
    constexpr int kRowsAtOnce = 8;
    const int count = static_cast<int>(rows.size());
    const auto hash_rows = [&](int first, int last) {
        std::vector<float> numbers;
        for (int r = first; r < last; ++r) {
            const int y = rows[static_cast<std::size_t>(r)];
            for (std::size_t k = 0; k < raws.size(); ++k) fill(impl, raws, k, y);
            RowHash hash;
            for (const Strip& strip : strips) {
                if (is_dense(strip.first)) {
                    hash.take({strip.first.data + (y - window.y) * strip.first.y_stride, strip.bytes});
                    continue;
                }
                numbers.resize(static_cast<std::size_t>(window.width));
                gather(strip.first, y - window.y, 0, window.width, numbers.data());
                hash.take(std::as_bytes(std::span(numbers)));
            }
            hashes[static_cast<std::size_t>(r)] = hash.value();
        }
    };
    parallel_for((count + kRowsAtOnce - 1) / kRowsAtOnce, threads > 0 ? threads : default_threads(), nullptr,
                 [&](int, int task) { hash_rows(task * kRowsAtOnce, std::min(count, (task + 1) * kRowsAtOnce)); });
    RowHash all;
    for (const Hash& row : hashes) all.take(std::as_bytes(std::span(row)));
    return all.value();
}

DirectionStatistics direction_statistics(std::span<const SampledRow> rows, std::size_t first_plane) {
    DirectionStatistics statistics;
    std::int64_t all = 0, negative = 0, unit = 0, decoded = 0, near_unit = 0;
    for (const SampledRow& row : rows) {
        const std::size_t width = row.planes[first_plane].size();
        for (std::size_t i = 0; i < width; ++i) {
            double square = 0, decoded_square = 0, smallest = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                const double v = row.planes[first_plane + k][i];
                square += v * v;
                decoded_square += (2 * v - 1) * (2 * v - 1);
                smallest = std::min(smallest, v);
            }
            if (!std::isfinite(square)) continue;
            ++all;
            if (square == 0) {
                ++near_unit;
                continue;
            }
            near_unit += std::abs(std::sqrt(square) - 1) < 2e-3;
            ++statistics.samples;
            negative += smallest < -0.01;
            unit += std::abs(std::sqrt(square) - 1) < 0.05;
            decoded += std::abs(std::sqrt(decoded_square) - 1) < 0.05;
        }
    }
    const auto share = [](std::int64_t part, std::int64_t whole) {
        return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0.0;
    };
    statistics.negative = share(negative, statistics.samples);
    statistics.unit = share(unit, statistics.samples);
    statistics.unit_decoded = share(decoded, statistics.samples);
    statistics.near_unit = all > 0 ? share(near_unit, all) : 1.0;
    return statistics;
}

Range value_range(std::span<const SampledRow> rows, std::size_t plane) {
    Range range;
    for (const SampledRow& row : rows) {
        for (const float value : row.planes[plane]) {
            if (!std::isfinite(value)) continue;
            range.min = range.any ? std::min(range.min, static_cast<double>(value)) : value;
            range.max = range.any ? std::max(range.max, static_cast<double>(value)) : value;
            range.any = true;
        }
    }
    return range;
}

}  // namespace relume::gbuffer
