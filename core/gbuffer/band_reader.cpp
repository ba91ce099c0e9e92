// SPDX-License-Identifier: Apache-2.0
#include "gbuffer/band_reader.h"

#include <algorithm>
#include <array>
#include <new>

#include "gbuffer/band_plan.h"
#include "gbuffer/gbuffer_impl.h"
#include "gbuffer/planes.h"

namespace relume {

namespace {

constexpr std::size_t kAlignment = 64;
constexpr int kRowsInMemory = 16;

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

int floor_divide(int a, int b) { return a >= 0 ? a / b : -((-a + b - 1) / b); }

}  // namespace

struct BandReader::Scratch::Impl {
    AlignedFloats band;              ///< raw planes of the loaded rows
    AlignedFloats run;               ///< registers of the current run
    std::vector<ConstPlane> planes;  ///< one per raw register
    std::vector<const float*> registers;
    std::vector<float*> results;
    std::vector<const float*> outputs;
    const void* reader = nullptr;  ///< whose registers these are
    std::size_t run_stride = 0;
    int top = 0;  ///< absolute row at the top of `planes`
    int rows = 0;
    std::array<AlignedFloats, 2> beyond;                ///< raw planes of the rows above and below the loaded ones
    std::array<std::vector<ConstPlane>, 2> neighbours;  ///< by raw register; empty until they are read
};

BandReader::Scratch::Scratch() : impl(std::make_unique<Impl>()) {}
BandReader::Scratch::~Scratch() = default;
BandReader::Scratch::Scratch(Scratch&&) noexcept = default;

struct BandReader::Impl {
    Impl(const GBuffer& buffer, std::span<const ChannelRequest> requests)
        : source(buffer.impl()), plan(source, sort(requests)) {
        for (std::size_t k = 0; k < plan.raws.size(); ++k) every_raw.push_back(static_cast<int>(k));
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
            geometry.next_row[i] = y * camera.y_scale;
        }
    }

    /// Where a request's planes come from: out of what is kept, else out of the plan, and then into what is kept.
    struct Answer {
        std::shared_ptr<gbuffer::KeptChannel> kept;  ///< may be null
        bool whole = false;
        std::size_t components = 1;
    };

    /// The requests that the plan must answer.
    std::vector<ChannelRequest> sort(std::span<const ChannelRequest> requests) {
        std::vector<ChannelRequest> planned;
        for (const ChannelRequest& request : requests) {
            Answer answer;
            if (source.kept) answer.kept = source.kept->of(request, source.data_window);
            answer.whole = answer.kept && answer.kept->whole();
            answer.components = static_cast<std::size_t>(request.components);
            if (!answer.whole) planned.push_back(request);
            outputs += answer.components;
            answers.push_back(std::move(answer));
        }
        return planned;
    }

    /// Reads `rows` rows from `y` on of some raw registers into `data`, and notes where they stand.
    void read(int y, int rows, std::span<const int> registers, float* data, std::vector<ConstPlane>& planes) const {
        const Window region{source.data_window.x, y, source.data_window.width, rows};
        const std::size_t stride = padded(region.width);
        const std::size_t plane_size = stride * static_cast<std::size_t>(rows);
        std::vector<io::ReadTarget> targets;
        for (std::size_t f = 0; f < source.files.size(); ++f) {
            targets.clear();
            for (std::size_t i = 0; i < registers.size(); ++i) {
                const auto k = static_cast<std::size_t>(registers[i]);
                const gbuffer::PlannedRaw& raw = plan.raws[k];
                if (raw.plane.address.file != static_cast<int>(f)) continue;
                const Plane plane{reinterpret_cast<std::byte*>(data + plane_size * i),
                                  raw.integer ? PixelType::uint32 : PixelType::float32, 4,
                                  static_cast<std::ptrdiff_t>(stride * sizeof(float))};
                planes[k] = plane;
                targets.push_back({raw.plane.address.part, raw.plane.address.channel, plane});
            }
            if (!targets.empty()) source.files[f].pixels->read(region, targets);
        }
    }

    /// The rows beyond the loaded ones, on demand.
    class Beyond final : public gbuffer::NeighbourRows {
    public:
        Beyond(const Impl& reader, Scratch::Impl& scratch) : reader_(reader), scratch_(scratch) {}

        ConstPlane row(int raw_register, int direction) const override {
            const std::size_t side = direction < 0 ? 0 : 1;
            std::vector<ConstPlane>& planes = scratch_.neighbours[side];
            if (planes.empty()) {
                planes.resize(reader_.plan.raws.size());
                const std::span<const int> registers = reader_.plan.neighbours;
                float* data =
                    scratch_.beyond[side].reserve(padded(reader_.source.data_window.width) * registers.size());
                reader_.read(direction < 0 ? scratch_.top - 1 : scratch_.top + scratch_.rows, 1, registers, data,
                             planes);
            }
            return planes[static_cast<std::size_t>(raw_register)];
        }

    private:
        const Impl& reader_;
        Scratch::Impl& scratch_;
    };

    const GBuffer::Impl& source;
    std::vector<Answer> answers;
    std::size_t outputs = 0;
    gbuffer::BandPlan plan;
    std::vector<int> every_raw;  ///< 0, 1, 2, …
    gbuffer::RunGeometry geometry;
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
    return rows == 0 ? kRowsInMemory : gbuffer::rows_of_band(rows);
}

void BandReader::load(int y, int rows, Scratch& scratch) const {
    Scratch::Impl& s = *scratch.impl;
    const GBuffer::Impl& source = impl_->source;
    const std::vector<gbuffer::PlannedRaw>& raws = impl_->plan.raws;
    s.planes.resize(raws.size());
    for (std::vector<ConstPlane>& planes : s.neighbours) planes.clear();
    if (source.in_memory()) {
        s.top = source.data_window.y;
        s.rows = source.data_window.height;
        for (std::size_t k = 0; k < raws.size(); ++k) s.planes[k] = raws[k].plane.memory;
        return;
    }
    s.top = y;
    s.rows = rows;
    const std::size_t plane_size = padded(source.data_window.width) * static_cast<std::size_t>(rows);
    impl_->read(y, rows, impl_->every_raw, s.band.reserve(plane_size * raws.size()), s.planes);
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
        s.outputs.resize(impl_->outputs);
        for (std::size_t r = 0; r < plan.registers; ++r) {
            s.results[r] = run + r * s.run_stride;
            s.registers[r] = s.results[r];
        }
    }
    const int row = y - s.top, column = x - window.x;
    for (std::size_t k = 0; k < plan.raws.size(); ++k) {
        const ConstPlane& plane = s.planes[k];
        const bool integer = plan.raws[k].integer;
        if (plane.type == (integer ? PixelType::uint32 : PixelType::float32) && plane.x_stride == 4) {
            const std::byte* at = plane.data + row * plane.y_stride + static_cast<std::ptrdiff_t>(column) * 4;
            s.registers[k] = reinterpret_cast<const float*>(at);
        } else if (integer) {
            gbuffer::gather(plane, row, column, count, reinterpret_cast<std::uint32_t*>(s.results[k]));
            s.registers[k] = s.results[k];
        } else {
            gbuffer::gather(plane, row, column, count, s.results[k]);
            s.registers[k] = s.results[k];
        }
    }
    if (!plan.steps.empty()) {
        gbuffer::RunGeometry geometry = impl_->geometry;
        for (std::size_t i = 0; i < 3; ++i) geometry.row_ray[i] += y * geometry.next_row[i];
        const Impl::Beyond beyond(*impl_, s);
        gbuffer::RowPlanes rows{s.planes.data(),        y,     row,   s.rows, column, window.width, y > window.y,
                                y + 1 < window.y_end(), false, false, &beyond};
        if (plan.chunk_rows > 0) {
            const auto chunk = [&](int r) { return floor_divide(r - plan.chunk_top, plan.chunk_rows); };
            rows.above_close = rows.above && chunk(y - 1) == chunk(y);
            rows.below_close = rows.below && chunk(y + 1) == chunk(y);
        }
        for (const gbuffer::Step& step : plan.steps) {
            gbuffer::run(step, s.registers.data(), s.results.data(), count, x, geometry, rows);
        }
    }
    std::size_t i = 0, planned = 0;
    for (const Impl::Answer& answer : impl_->answers) {
        for (std::size_t k = 0; k < answer.components; ++k)
            s.outputs[i + k] = answer.whole ? answer.kept->run(static_cast<int>(k), y, x, count)
                                            : s.registers[static_cast<std::size_t>(plan.outputs[planned + k])];
        if (!answer.whole) {
            if (answer.kept) answer.kept->store(y, x, count, std::span(s.outputs).subspan(i, answer.components));
            planned += answer.components;
        }
        i += answer.components;
    }
    return s.outputs;
}

}  // namespace relume
