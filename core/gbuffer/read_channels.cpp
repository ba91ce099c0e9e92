// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "gbuffer/band_reader.h"
#include "io/pixel_convert.h"
#include "relume/error.h"
#include "relume/gbuffer.h"
#include "threads/workers.h"

namespace relume {

void read_channels(const GBuffer& gbuffer, std::span<const ChannelRequest> requests, std::span<const Plane> out,
                   int threads, const std::optional<Window>& region) {
    std::vector<PixelType> types;  // what BandReader gives
    for (const ChannelRequest& request : requests)
        types.insert(types.end(), static_cast<std::size_t>(request.components),
                     request.kind == ChannelRequest::Kind::id ? PixelType::uint32 : PixelType::float32);
    if (types.size() != out.size())
        throw Error(ErrorKind::value,
                    std::to_string(out.size()) + " planes given for " + std::to_string(types.size()) + " components");
    for (const Plane& plane : out)
        if (plane.data == nullptr) throw Error(ErrorKind::value, "a plane without memory");

    const Window& data = gbuffer.data_window();
    const Window window = region.value_or(data);
    if (region && (window.empty() || !contains(data, window)))
        throw Error(ErrorKind::value, "the region leaves the data window of the G-buffer");
    const BandReader reader(gbuffer, requests);
    const int band = std::max(reader.band_rows(), 1);
    // Bands start where the file's chunks do, also those of a region.
    const int first = window.y - (window.y - data.y) % band;
    const int bands = (window.y_end() - first + band - 1) / band;
    const int workers = std::clamp(threads > 0 ? threads : default_threads(), 1, std::max(bands, 1));
    std::vector<std::unique_ptr<BandReader::Scratch>> scratches(static_cast<std::size_t>(workers));
    parallel_for(bands, workers, nullptr, [&](int worker, int index) {
        auto& scratch = scratches[static_cast<std::size_t>(worker)];
        if (!scratch) scratch = std::make_unique<BandReader::Scratch>();
        const int begin = std::max(window.y, first + index * band);
        const int end = std::min(window.y_end(), first + (index + 1) * band);
        const int top = begin - window.y, rows = end - begin;
        reader.load(begin, rows, *scratch);
        for (int row = top; row < top + rows; ++row) {
            const auto planes = reader.segment(window.y + row, window.x, window.width, *scratch);
            for (std::size_t k = 0; k < out.size(); ++k)
                io::convert_run({reinterpret_cast<const std::byte*>(planes[k]), types[k], 4},
                                {out[k].data + row * out[k].y_stride, out[k].type, out[k].x_stride},
                                static_cast<std::size_t>(window.width));
        }
    });
}

}  // namespace relume
