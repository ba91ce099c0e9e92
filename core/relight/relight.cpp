// SPDX-License-Identifier: Apache-2.0
#include "relume/relight.h"

#include <algorithm>
#include <chrono>
#include <mutex>
#include <optional>

#include "gbuffer/band_reader.h"
#include "relight/blank_frame.h"
#include "relight/output_header.h"
#include "relight/plan.h"
#include "relight/shade_pass.h"
#include "relume/error.h"
#include "threads/workers.h"

namespace relume {

namespace {

using Clock = std::chrono::steady_clock;

/// Outputs beyond this many bytes are written past the cache, which they would only flush.
constexpr std::int64_t kStreamBytes = std::int64_t{8} << 20;

/// Rows of a band at the least.
constexpr int kLeastRows = 8;

/// What a thread owns.
struct Worker {
    explicit Worker(const Plan& plan) : pass(plan) {}
    ShadePass pass;
    BandReader::Scratch scratch;
    std::vector<float> rows;    // output planes of a band, for files
    std::vector<float> sparse;  // channels of a tile, where not every pixel is wanted
    std::vector<const float*> sparse_planes;
    std::vector<ConstPlane> channels;
};

/// One frame's relight over bands of rows; where a band's pixels go is the caller's.
class Frame {
public:
    Frame(const GBuffer& gbuffer, const Rig& rig, const RelightOptions& options)
        : plan(gbuffer, rig),
          reader(gbuffer, plan.requests),
          window(options.region.value_or(gbuffer.data_window())),
          gbuffer_(gbuffer),
          options_(options) {
        if (options.threads < 0)
            throw Error(ErrorKind::value, "threads must be 0 (all) or more, not " + std::to_string(options.threads));
        if (window.empty())
            throw Error(ErrorKind::value, "the G-buffer has no pixels (" + std::to_string(window.width) + " × " +
                                              std::to_string(window.height) + ")");
        const Window& data = gbuffer.data_window();
        if (!contains(data, window)) throw Error(ErrorKind::value, "the region leaves the data window of the G-buffer");
        top_ = data.y;
        if (options.step < 1)
            throw Error(ErrorKind::value, "step must be 1 (every pixel) or more, not " + std::to_string(options.step));
    }

    /// `rows_per_band` a multiple of what reader and writer like. `target_of(worker, y, rows)` gives the AOVs' targets,
    /// planes at the band's first pixel; `done(worker, y, rows)` is called after the band.
    template <class TargetOf, class Done> void run(int rows_per_band, TargetOf&& target_of, Done&& done, bool stream) {
        // Bands start where the reader's chunks do, also those of a region.
        const int first = window.y - (window.y - top_) % rows_per_band;
        const int bands = (window.y_end() - first + rows_per_band - 1) / rows_per_band;
        const int threads =
            std::clamp(options_.threads > 0 ? options_.threads : default_threads(), 1, std::max(1, bands));
        std::vector<std::unique_ptr<Worker>> workers(static_cast<std::size_t>(threads));
        std::atomic<int> finished{0};
        parallel_for(bands, threads, options_.cancel, [&](int w, int band) {
            auto& worker = workers[static_cast<std::size_t>(w)];
            if (!worker) worker = std::make_unique<Worker>(plan);
            const int y = std::max(window.y, first + band * rows_per_band);
            const int rows = std::min(first + (band + 1) * rows_per_band, window.y_end()) - y;
            reader.load(y, rows, worker->scratch);
            const std::vector<Target> targets = target_of(*worker, y, rows);
            shade_rows(*worker, y, rows, targets, stream);
            done(*worker, y, rows);
            if (options_.progress) options_.progress(static_cast<double>(++finished) / bands);
        });
        for (const auto& worker : workers) {
            if (!worker) continue;
            report.shaded += worker->pass.shaded;
            report.background += worker->pass.background;
            for (const auto& [name, count] : worker->pass.nonfinite) report.nonfinite[name] += count;
        }
        report.pixels = static_cast<std::int64_t>(wanted(window.width)) * wanted(window.height);
        // A part of a frame may well have no more than that.
        if (window == gbuffer_.data_window()) refuse_blank(gbuffer_, report.shaded, report.nonfinite);
        report.warnings = plan.warnings;
        report.notes = plan.notes;
        report.seconds = std::chrono::duration<double>(Clock::now() - start_).count();
    }

    const Plan plan;
    const BandReader reader;
    const Window window;
    RelightReport report;

private:
    /// How many of so many pixels are shaded.
    int wanted(int pixels) const { return pixels / options_.step + (pixels % options_.step != 0); }

    /// Every step-th pixel of a run, from the first on.
    std::span<const float* const> thinned(std::span<const float* const> planes, int count, Worker& worker) const {
        worker.sparse.resize(planes.size() * kTilePixels);
        worker.sparse_planes.resize(planes.size());
        for (std::size_t p = 0; p < planes.size(); ++p) {
            float* to = worker.sparse.data() + p * kTilePixels;
            const float* from = planes[p];
            if (options_.step == 2)  // in registers' widths
                for (int i = 0; i < (count + 1) / 2; ++i) to[i] = from[2 * i];
            else
                for (int i = 0; i < wanted(count); ++i) to[i] = from[i * options_.step];
            worker.sparse_planes[p] = to;
        }
        return worker.sparse_planes;
    }

    void shade_rows(Worker& worker, int y, int rows, const std::vector<Target>& targets, bool stream) {
        const int step = options_.step;
        std::vector<Target> at = targets;
        int out = 0;  // row of the targets
        for (int row = (step - (y - window.y) % step) % step; row < rows; row += step, ++out) {
            if (options_.cancel != nullptr && options_.cancel->load(std::memory_order_relaxed))
                throw Error(ErrorKind::cancelled, "cancelled");
            const int run = std::max(kTilePixels / step, 1) * step;
            for (int x = 0; x < window.width; x += run) {
                const int count = std::min(run, window.width - x);
                auto planes = reader.segment(y + row, window.x + x, count, worker.scratch);
                if (step > 1) planes = thinned(planes, count, worker);
                for (std::size_t a = 0; a < targets.size(); ++a)
                    for (std::size_t k = 0; k < targets[a].planes.size(); ++k)
                        at[a].planes[k].data = targets[a].planes[k].data + out * targets[a].planes[k].y_stride +
                                               x / step * targets[a].planes[k].x_stride;
                worker.pass.shade(planes, wanted(count), at, stream);
            }
        }
    }

    const GBuffer& gbuffer_;
    const RelightOptions& options_;
    int top_ = 0;  ///< of the data window
    const Clock::time_point start_ = Clock::now();
};

void check_target(const AovInfo& aov, const std::vector<Plane>& planes) {
    const auto wrong = [&](const std::string& what) {
        throw Error(ErrorKind::value, "output '" + aov.name + "': " + what);
    };
    const auto components = static_cast<std::size_t>(aov.components);
    if (planes.size() != components && !(aov.name == "beauty" && planes.size() == 3))
        wrong("has " + std::to_string(planes.size()) + " planes, needs " + std::to_string(components));
    for (const Plane& plane : planes) {
        if (plane.data == nullptr) wrong("has no memory");
        if (plane.type == PixelType::uint32) wrong("must be float32 or half");
    }
}

}  // namespace

RelightReport relight(const GBuffer& gbuffer, const Rig& rig, const std::map<std::string, std::vector<Plane>>& out,
                      const RelightOptions& options) {
    Frame frame(gbuffer, rig, options);
    const std::vector<AovInfo>& aovs = frame.plan.aovs;
    for (const auto& [name, planes] : out)
        if (std::none_of(aovs.begin(), aovs.end(), [&, &wanted = name](const AovInfo& a) { return a.name == wanted; }))
            throw Error(ErrorKind::value, "output '" + name + "' is none of the rig's pictures; add it to output.aovs");
    std::vector<Target> whole(aovs.size());
    for (std::size_t a = 0; a < aovs.size(); ++a) {
        const auto found = out.find(aovs[a].name);
        if (found == out.end()) continue;
        check_target(aovs[a], found->second);
        whole[a].planes = found->second;
    }
    const std::int64_t bytes = static_cast<std::int64_t>(frame.window.width) * frame.window.height * 16;
    // From memory any height will do: enough rows that a band is worth handing out.
    const int natural = std::max(1, frame.reader.band_rows());
    const int rows = (kLeastRows + natural - 1) / natural * natural;
    frame.run(
        rows,
        [&](Worker&, int y, int) {
            std::vector<Target> targets = whole;
            for (Target& target : targets)
                for (Plane& plane : target.planes)
                    plane.data += (y - frame.window.y + options.step - 1) / options.step * plane.y_stride;
            return targets;
        },
        [](Worker&, int, int) {}, bytes > kStreamBytes);
    return frame.report;
}

RelightReport relight_to_file(const GBuffer& gbuffer, const Rig& rig, const std::filesystem::path& path,
                              const RelightOptions& options) {
    if (options.region || options.step != 1)
        throw Error(ErrorKind::value, "relight_to_file() writes the whole data window, no region and no proxy");
    Frame frame(gbuffer, rig, options);
    const OutputLayout layout = output_layout(gbuffer, rig, frame.plan);
    io::ExrWriter writer(path, layout.header, layout.options);
    // A band is whole chunks of the writer, and of the reader where one chunk of it is taller.
    const int chunk = writer.rows_per_chunk();
    const int rows = (std::max(frame.reader.band_rows(), chunk) + chunk - 1) / chunk * chunk;

    std::size_t components = 0;
    for (const AovInfo& aov : frame.plan.aovs) components += static_cast<std::size_t>(aov.components);
    const auto plane_of = [&](Worker& worker, std::size_t index, int band_rows) {
        return worker.rows.data() +
               index * static_cast<std::size_t>(frame.window.width) * static_cast<std::size_t>(band_rows);
    };
    const std::ptrdiff_t y_stride =
        static_cast<std::ptrdiff_t>(frame.window.width) * static_cast<std::ptrdiff_t>(sizeof(float));
    frame.run(
        rows,
        [&](Worker& worker, int, int band_rows) {
            worker.rows.resize(components * static_cast<std::size_t>(frame.window.width) *
                               static_cast<std::size_t>(rows));
            std::vector<Target> targets(frame.plan.aovs.size());
            std::size_t index = 0;
            for (std::size_t a = 0; a < targets.size(); ++a)
                for (int k = 0; k < frame.plan.aovs[a].components; ++k)
                    targets[a].planes.push_back({reinterpret_cast<std::byte*>(plane_of(worker, index++, band_rows)),
                                                 PixelType::float32, 4, y_stride});
            return targets;
        },
        [&](Worker& worker, int y, int band_rows) {
            for (std::size_t part = 0; part < layout.header.parts.size(); ++part) {
                worker.channels.assign(layout.header.parts[part].channels.size(), ConstPlane{});
                std::size_t index = 0;
                for (std::size_t a = 0; a < layout.slots.size(); ++a)
                    for (const int channel : layout.slots[a].channels) {
                        const float* plane = plane_of(worker, index++, band_rows);
                        if (layout.slots[a].part == static_cast<int>(part))
                            worker.channels[static_cast<std::size_t>(channel)] = {
                                reinterpret_cast<const std::byte*>(plane), PixelType::float32, 4, y_stride};
                    }
                writer.write(static_cast<int>(part), y, band_rows, worker.channels);
            }
        },
        false);
    writer.commit();
    return frame.report;
}

}  // namespace relume
