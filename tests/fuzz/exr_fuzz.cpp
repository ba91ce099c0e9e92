// SPDX-License-Identifier: Apache-2.0
// libFuzzer's target for the EXR reader: any bytes either are read or give an Error, quickly and in little memory.
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "io/exr.h"
#include "relume/error.h"

namespace {

using namespace relume;
using namespace relume::io;

constexpr std::int64_t kMaxBand = 1 << 20;  // values of one band that this target allocates

void read_part(const ExrReader& reader, int index) {
    const Part& part = reader.header().parts[static_cast<std::size_t>(index)];
    const Window& window = part.data_window;
    const auto count = static_cast<std::int64_t>(std::min<std::size_t>(part.channels.size(), 16));
    const int width = std::min(window.width, 2000);
    const int step = std::max(1, std::min(part.rows_per_chunk, 64));
    if (std::int64_t{width} * step * count > kMaxBand) {
        return;
    }
    std::vector<float> pixels(static_cast<std::size_t>(width) * step * count);
    for (int band = 0; band < 8 && band * step < window.height; ++band) {
        const Window region{window.x, window.y + band * step, width, std::min(step, window.height - band * step)};
        std::vector<ReadTarget> targets;
        for (int c = 0; c < count; ++c) {
            auto* data = reinterpret_cast<std::byte*>(pixels.data() + static_cast<std::size_t>(c) * width * step);
            targets.push_back({index, c, {data, PixelType::float32, 4, std::ptrdiff_t{width} * 4}});
        }
        reader.read(region, targets);
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const int file = ::memfd_create("exr", 0);
    static const std::string path = "/proc/self/fd/" + std::to_string(file);
    if (::ftruncate(file, 0) != 0 || ::pwrite(file, data, size, 0) != static_cast<ssize_t>(size)) {
        return 0;
    }
    ReadLimits limits;
    limits.max_pixels = 1 << 24;
    try {
        const ExrReader reader(path, limits);
        for (int part = 0; part < static_cast<int>(std::min<std::size_t>(reader.header().parts.size(), 8)); ++part) {
            try {
                read_part(reader, part);
            } catch (const Error&) {
                // damaged, deep or truncated: the next part may be whole
            }
        }
    } catch (const Error&) {
        // not an EXR that anybody could read
    }
    return 0;
}
