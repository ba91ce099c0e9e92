// SPDX-License-Identifier: Apache-2.0
// The walk through inflated ZIP chunks against the format's rule written out: all differences added up, then the two
// runs of bytes put together.

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <vector>

#include "io/pixel_convert.h"
#include "io/zip_rows.h"

namespace relume::io {
namespace {

std::vector<std::uint8_t> pixels_of(std::vector<std::uint8_t> stored) {
    for (std::size_t i = 1; i < stored.size(); ++i) {
        stored[i] = static_cast<std::uint8_t>(stored[i - 1] + stored[i] - 128);
    }
    std::vector<std::uint8_t> pixels(stored.size());
    for (std::size_t i = 0; i < stored.size(); ++i) {
        pixels[i] = stored[i / 2 + (i % 2 != 0 ? stored.size() / 2 : 0)];
    }
    return pixels;
}

class ZipRowsTest : public ::testing::TestWithParam<bool> {};

TEST_P(ZipRowsTest, AnyWalkGivesThePixelsOfTheRule) {
    std::mt19937 random(5);
    for (int round = 0; round < 400; ++round) {
        std::vector<std::uint8_t> stored(2 * (random() % 700));
        for (std::uint8_t& byte : stored) {
            byte = static_cast<std::uint8_t>(random());
        }
        const std::vector<std::uint8_t> expected = pixels_of(stored);
        ZipRows rows(reinterpret_cast<const std::byte*>(stored.data()), stored.size(), GetParam());
        std::size_t at = 0;
        while (at < stored.size()) {
            const std::size_t size = std::min<std::size_t>(2 * (1 + random() % 90), stored.size() - at);
            const std::size_t count = size / 2;
            switch (random() % 3) {
                case 0:
                    rows.skip(size);
                    break;
                case 1: {
                    std::vector<std::uint8_t> got(size);
                    rows.read(reinterpret_cast<std::byte*>(got.data()), size);
                    EXPECT_TRUE(std::equal(got.begin(), got.end(), expected.begin() + static_cast<std::ptrdiff_t>(at)))
                        << "round " << round << ", " << size << " bytes at " << at;
                    break;
                }
                default: {
                    std::vector<float> got(count);
                    rows.read_halves(reinterpret_cast<std::byte*>(got.data()), count);
                    for (std::size_t i = 0; i < count; ++i) {
                        std::uint16_t bits;
                        std::memcpy(&bits, &expected[at + 2 * i], sizeof bits);
                        const float value = half_to_float(bits);
                        EXPECT_EQ(std::memcmp(&got[i], &value, sizeof value), 0)
                            << "round " << round << ", half " << i << " of " << count << " at " << at;
                    }
                }
            }
            at += size;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Paths, ZipRowsTest, ::testing::Bool(),
                         [](const auto& path) { return path.param ? "Scalar" : "Widest"; });

}  // namespace
}  // namespace relume::io
