// SPDX-License-Identifier: Apache-2.0
#include "gbuffer/band_reader.h"

#include <algorithm>
#include <cmath>
#include <new>

#include "gbuffer/band_plan.h"
#include "gbuffer/gbuffer_impl.h"
#include "gbuffer/planes.h"
#include "relume/error.h"

namespace relume {

namespace {

constexpr std::size_t kAlignment = 64;
constexpr int kRowsInMemory = 16;
constexpr int kLeastBandRows = 16;

/// Floats at the alignment that every instruction set likes; grows, never shrinks.
class AlignedFloats {
public:
    AlignedFloats() = default;
    AlignedFloats(const AlignedFloats&) = delete;
    AlignedFloats& operator=(const AlignedFloats&) = delete;
    ~AlignedFloats() { release(); }

    float* reserve(std::size_t count) {
        if (count > size_) {
            release();
            data_ = static_cast<float*>(::operator new (count * sizeof(float), std::align_val_t{kAlignment}));
            size_ = count;
        }
        return data_;
    }

private:
    void release() {
        if (data_) ::operator delete (data_, std::align_val_t{kAlignment});
        data_ = nullptr;
        size_ = 0;
    }
    float* data_ = nullptr;
    std::size_t size_ = 0;
};

std::size_t padded(int count) { return (static_cast<std::size_t>(count) + 15) / 16 * 16; }

}  // namespace

struct BandReader::Scratch::Impl {
    AlignedFloats band;              ///< raw planes of the loaded rows
    AlignedFloats run;               ///< registers of the current run
    std::vector<ConstPlane> planes;  ///< one per raw register
    std::vector<const float*> registers;
    std::vector<float*> results;
    std::vector<const float*> outputs;
    const void* reader = nullptr;  ///< whose registers these are
    int top = 0;                   ///< absolute row at the top of `planes`
    std::size_t run_stride = 0;
};

BandReader::Scratch::Scratch() : impl(std::make_unique<Impl>()) {}
BandReader::Scratch::~Scratch() = default;
BandReader::Scratch::Scratch(Scratch&&) noexcept = default;

struct BandReader::Impl {
    explicit Impl(const GBuffer& buffer, std::span<const ChannelRequest> requests)
        : source(buffer.impl()), plan(source, requests) {
        for (std::size_t f = 0; f < source.files.size(); ++f) {
            std::vector<int> used;
            for (std::size_t k = 0; k < plan.raws.size(); ++k) {
                const gbuffer::RawPlane& raw = plan.raws[k].plane;
                if (!raw.memory.data && raw.address.file == static_cast<int>(f)) used.push_back(static_cast<int>(k));
            }
            file_raws.push_back(std::move(used));
        }
        // Geometry of row 0; rows differ by a constant.
        const Camera& camera = source.view_camera;
        const std::array<double, 16>& m = camera.camera_to_world;
        geometry.perspective = camera.projection == Projection::perspective;
        for (std::size_t i = 0; i < 3; ++i) {
            const double x = m[4 * i], y = m[4 * i + 1], z = m[4 * i + 2], t = m[4 * i + 3];
            geometry.origin[i] = t;
            geometry.forward[i] = -z;
            geometry.row_ray[i] = x * (0.5 * camera.x_scale + camera.x_offset) +
                                  y * (0.5 * camera.y_scale + camera.y_offset) + (geometry.perspective ? -z : t);
            geometry.column_ray[i] = x * camera.x_scale;
            next_row[i] = y * camera.y_scale;
        }
    }

    const GBuffer::Impl& source;
    gbuffer::BandPlan plan;
    std::vector<std::vector<int>> file_raws;  ///< raw registers by file
    gbuffer::RunGeometry geometry;
    std::array<double, 3> next_row{};
};

BandReader::BandReader(const GBuffer& gbuffer, std::span<const ChannelRequest> requests)
    : impl_(std::make_unique<Impl>(gbuffer, requests)) {}

BandReader::~BandReader() = default;

int BandReader::band_rows() const {
    int rows = 0;
    for (const gbuffer::PlannedRaw& raw : impl_->plan.raws) {
        if (raw.plane.memory.data) continue;
        const gbuffer::SourceFile& file = impl_->source.files[static_cast<std::size_t>(raw.plane.address.file)];
        rows = std::max(rows, file.header.parts[static_cast<std::size_t>(raw.plane.address.part)].rows_per_chunk);
    }
    if (rows == 0) return kRowsInMemory;
    return rows >= kLeastBandRows ? rows : (kLeastBandRows + rows - 1) / rows * rows;
}

void BandReader::load(int y, int rows, Scratch& scratch) const {
    Scratch::Impl& s = *scratch.impl;
    const GBuffer::Impl& source = impl_->source;
    const gbuffer::BandPlan& plan = impl_->plan;
    const std::size_t count = plan.raws.size();
    if (s.planes.size() != count) s.planes.resize(count);
    if (source.in_memory()) {
        s.top = source.data_window.y;
        for (std::size_t k = 0; k < count; ++k)
            s.planes[k] = plan.raws[k].plane.memory;
        return;
    }
    s.top = y;
    const std::size_t stride = padded(source.data_window.width);
    const std::size_t plane_size = stride * static_cast<std::size_t>(rows);
    float* band = s.band.reserve(plane_size * count);
    const Window region{source.data_window.x, y, source.data_window.width, rows};
    std::vector<io::ReadTarget> targets;
    for (std::size_t f = 0; f < source.files.size(); ++f) {
        targets.clear();
        for (const int k : impl_->file_raws[f]) {
            const gbuffer::PlannedRaw& raw = plan.raws[static_cast<std::size_t>(k)];
            const Plane plane{reinterpret_cast<std::byte*>(band + plane_size * static_cast<std::size_t>(k)),
                              raw.integer ? PixelType::uint32 : PixelType::float32, 4,
                              static_cast<std::ptrdiff_t>(stride * sizeof(float))};
            s.planes[static_cast<std::size_t>(k)] = plane;
            targets.push_back({raw.plane.address.part, raw.plane.address.channel, plane});
        }
        if (!targets.empty()) source.files[f].pixels->read(region, targets);
    }
}

std::span<const float* const> BandReader::segment(int y, int x, int count, Scratch& scratch) const {
    Scratch::Impl& s = *scratch.impl;
    const gbuffer::BandPlan& plan = impl_->plan;
    const Window& window = impl_->source.data_window;
    const std::size_t stride = padded(count);
    if (s.reader != impl_.get() || s.run_stride < stride) {
        s.reader = impl_.get();
        s.run_stride = std::max(stride, s.run_stride);
        float* run = s.run.reserve(s.run_stride * plan.registers);
        s.registers.resize(plan.registers);
        s.results.resize(plan.registers);
        s.outputs.resize(plan.outputs.size());
        for (std::size_t r = 0; r < plan.registers; ++r) {
            s.results[r] = run + r * s.run_stride;
            s.registers[r] = s.results[r];
        }
    }
    const gbuffer::RowPlanes rows{s.planes.data(), y - s.top, x - window.x, window.width};
    for (std::size_t k = 0; k < plan.raws.size(); ++k) {
        const ConstPlane& plane = s.planes[k];
        const PixelType wanted = plan.raws[k].integer ? PixelType::uint32 : PixelType::float32;
        if (plane.type == wanted && plane.x_stride == 4) {
            s.registers[k] =
                reinterpret_cast<const float*>(plane.data + rows.row * plane.y_stride + rows.first_column * 4);
        } else if (plan.raws[k].integer) {
            gbuffer::gather(plane, rows.row, rows.first_column, count, reinterpret_cast<std::uint32_t*>(s.results[k]));
            s.registers[k] = s.results[k];
        } else {
            gbuffer::gather(plane, rows.row, rows.first_column, count, s.results[k]);
            s.registers[k] = s.results[k];
        }
    }
    if (!plan.steps.empty()) {
        gbuffer::RunGeometry geometry = impl_->geometry;
        for (std::size_t i = 0; i < 3; ++i)
            geometry.row_ray[i] += y * impl_->next_row[i];
        for (const gbuffer::Step& step : plan.steps) {
            gbuffer::run(step, s.registers.data(), s.results.data(), count, x, geometry, rows);
        }
    }
    for (std::size_t i = 0; i < plan.outputs.size(); ++i) {
        s.outputs[i] = s.registers[static_cast<std::size_t>(plan.outputs[i])];
    }
    return s.outputs;
}

}  // namespace relume
