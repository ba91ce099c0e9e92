// SPDX-License-Identifier: Apache-2.0
// A host that reads a rig by OpenImageIO, each time with another exposure, so that nothing is there already: from
// opening it to float pixels in memory that the host has had before. Compiled by bench_doors.py for the installed
// OpenImageIO.
//
// oiio_door RIG LIGHT REPEATS: prints a JSON line of the best wall seconds.

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

int main(int argc, char** argv) {
    if (argc != 4) return 2;
    double best = 1e9;
    std::vector<float> pixels;
    for (int repeat = 0; repeat <= std::atoi(argv[3]); ++repeat) {
        OIIO::ImageSpec config;
        config[std::string("relume:light.") + argv[2] + ".exposure"] = 1e-6f * static_cast<float>(repeat);
        const auto start = std::chrono::steady_clock::now();
        const auto image = OIIO::ImageInput::open(argv[1], &config);
        if (!image) {
            std::fprintf(stderr, "oiio_door: %s\n", OIIO::geterror().c_str());
            return 1;
        }
        pixels.resize(image->spec().image_pixels() * static_cast<std::size_t>(image->spec().nchannels));
        if (!image->read_image(0, 0, 0, -1, OIIO::TypeFloat, pixels.data())) {
            std::fprintf(stderr, "oiio_door: %s\n", image->geterror().c_str());
            return 1;
        }
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
        if (repeat > 0) best = std::min(best, seconds.count());
    }
    std::printf("{\"seconds\": %.6f}\n", best);
}
