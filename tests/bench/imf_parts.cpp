// SPDX-License-Identifier: Apache-2.0
// The reading and the writing of ./dev bench's frame as OpenEXR's C++ library does them, which is what a tool of today
// uses: the named channels to planar float, then R, G, B, A as half. Compiled by bench_files.py once for each OpenEXR.
//
// imf_parts FRAME OUT THREADS REPEATS CHANNEL…: prints a JSON line of the best CPU and wall seconds of each.

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfThreading.h>
#include <OpenEXRConfig.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

namespace {

struct Seconds {
    double cpu = 1e9, wall = 1e9;
};

double cpu_now() {
    timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

template <class F> void measure(Seconds& best, F&& work) {
    const double cpu = cpu_now();
    const auto wall = std::chrono::steady_clock::now();
    work();
    best.cpu = std::min(best.cpu, cpu_now() - cpu);
    best.wall = std::min(best.wall, std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count());
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 6) return 2;
    Imf::setGlobalThreadCount(std::atoi(argv[3]) > 1 ? std::atoi(argv[3]) : 0);
    const std::vector<std::string> names(argv + 5, argv + argc);
    Seconds reading, writing;
    int width = 0, height = 0;
    std::vector<std::vector<float>> planes(names.size());
    std::vector<std::uint16_t> rgba;
    for (int repeat = 0; repeat < std::atoi(argv[4]); ++repeat) {
        measure(reading, [&] {
            Imf::InputFile file(argv[1]);
            const auto window = file.header().dataWindow();
            width = window.max.x - window.min.x + 1;
            height = window.max.y - window.min.y + 1;
            Imf::FrameBuffer buffer;
            for (std::size_t k = 0; k < names.size(); ++k) {
                planes[k].resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
                buffer.insert(names[k], Imf::Slice::Make(Imf::FLOAT, planes[k].data(), window, sizeof(float),
                                                         sizeof(float) * static_cast<std::size_t>(width)));
            }
            file.setFrameBuffer(buffer);
            file.readPixels(window.min.y, window.max.y);
        });
        if (rgba.empty()) {
            // The first channels' own values: what is written compresses as pictures do.
            rgba.resize(planes[0].size() * 4);
            Imf::InputFile file(argv[1]);
            const auto window = file.header().dataWindow();
            Imf::FrameBuffer buffer;
            const char* beauty[] = {"beauty.R", "beauty.G", "beauty.B"};
            for (std::size_t k = 0; k < 3; ++k)
                buffer.insert(beauty[k], Imf::Slice::Make(Imf::HALF, &rgba[k * planes[0].size()], window, 2,
                                                          2 * static_cast<std::size_t>(width)));
            file.setFrameBuffer(buffer);
            file.readPixels(window.min.y, window.max.y);
            std::fill(rgba.begin() + static_cast<std::ptrdiff_t>(3 * planes[0].size()), rgba.end(),
                      std::uint16_t{0x3c00});
        }
        measure(writing, [&] {
            Imf::Header header(width, height);
            header.compression() = Imf::ZIP_COMPRESSION;
            Imf::FrameBuffer buffer;
            const char* channels[] = {"R", "G", "B", "A"};
            for (std::size_t k = 0; k < 4; ++k) {
                header.channels().insert(channels[k], Imf::Channel(Imf::HALF));
                buffer.insert(channels[k], Imf::Slice(Imf::HALF, reinterpret_cast<char*>(&rgba[k * planes[0].size()]),
                                                      2, 2 * static_cast<std::size_t>(width)));
            }
            Imf::OutputFile file(argv[2], header);
            file.setFrameBuffer(buffer);
            file.writePixels(height);
        });
    }
    std::printf("{\"version\": \"%s\", \"read\": [%.4f, %.4f], \"write\": [%.4f, %.4f]}\n", OPENEXR_VERSION_STRING,
                reading.cpu, reading.wall, writing.cpu, writing.wall);
}
