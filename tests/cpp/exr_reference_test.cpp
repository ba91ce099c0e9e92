// SPDX-License-Identifier: Apache-2.0
// Files that other programs wrote: tests/data/exr (see make_exr.cpp there) and whatever RELUME_TEST_DATA holds.
#include <OpenEXRConfig.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <iostream>

#include "exr_pattern.h"
#include "exr_test_image.h"
#include "relume/error.h"

namespace relume::io {
namespace {

const std::filesystem::path kFolder = std::filesystem::path(RELUME_SOURCE_DIR) / "tests/data/exr";
const Window kDisplay{0, 0, 32, 24};
const Window kData{-5, -3, 26, 37};

bool is_inside(const Window& window, int x, int y) {
    return x >= window.x && x < window.x_end() && y >= window.y && y < window.y_end();
}

// Channel by channel, pixel by pixel: `expected` in the channel's own type, as a double.
void expect_pixels(const ExrReader& reader, int part, const Window& region,
                   const std::function<double(int channel, int x, int y)>& expected, double tolerance = 0) {
    const std::vector<TestPlane> planes = read_planes(reader, part, region);
    const Part& header = reader.header().parts[static_cast<std::size_t>(part)];
    for (std::size_t c = 0; c < planes.size(); ++c) {
        for (int row = 0; row < region.height; ++row) {
            for (int column = 0; column < region.width; ++column) {
                double got = 0;
                switch (planes[c].type) {
                    case PixelType::half:
                        got = half_to_float(planes[c].at<std::uint16_t>(column, row));
                        break;
                    case PixelType::float32:
                        got = planes[c].at<float>(column, row);
                        break;
                    case PixelType::uint32:
                        got = planes[c].at<std::uint32_t>(column, row);
                        break;
                }
                const int x = region.x + column;
                const int y = region.y + row;
                const double wanted = is_inside(header.data_window, x, y) ? expected(static_cast<int>(c), x, y) : 0.0;
                ASSERT_NEAR(got, wanted, tolerance) << header.channels[c].name << " at " << x << ", " << y;
            }
        }
    }
}

double mixed_pattern(int channel, int x, int y) {
    return channel == 2 ? static_cast<double>(pattern_uint(2, x, y))
                        : static_cast<double>(pattern_value(channel, x, y));
}

const std::vector<Window> kRegions{kData, {-5, 11, 26, 16}, {0, 0, 32, 24}, {3, 5, 1, 1}, {-9, 30, 60, 9}};

class ExrReference : public testing::TestWithParam<const char*> {};

TEST_P(ExrReference, ScanlineAndTiled) {
    const std::string name = GetParam();
    const Compression compression = compression_from_name(name).value();
    for (const std::string layout : {"scanline_", "tiled_"}) {
        const auto path = kFolder / (layout + name + ".exr");
        if (!std::filesystem::exists(path)) {
            ASSERT_EQ(layout, "tiled_");  // the newer compressions have scanline files alone
            continue;
        }
        SCOPED_TRACE(path.filename());
        if (!is_supported(compression)) {
            EXPECT_THROW(read_planes(ExrReader(path), 0, kData), Error);
            continue;
        }
        const ExrReader reader(path);
        const Part& part = reader.header().parts.at(0);
        EXPECT_EQ(part.compression, compression);
        EXPECT_EQ(part.data_window, kData);
        EXPECT_EQ(part.display_window, kDisplay);
        EXPECT_EQ(part.tiled, layout == "tiled_");
        EXPECT_EQ(part.tile_width, part.tiled ? 16 : 0);
        const auto decoded = kFolder / (layout + name + ".decoded.exr");
        for (const Window& region : kRegions) {
            if (std::filesystem::exists(decoded)) {
                const auto planes = read_planes(ExrReader(decoded), 0, kData, PixelType::float32);
                const auto ids = read_planes(ExrReader(decoded), 0, kData, PixelType::uint32);
                // The discrete cosine transform of DWA is summed in another order, then rounded to half.
                const double tolerance = name.starts_with("dwa") ? 0.032 : 0;
                expect_pixels(
                    reader, 0, region,
                    [&](int c, int x, int y) {
                        const auto i = static_cast<std::size_t>(c);
                        return c == 2 ? static_cast<double>(ids[i].at<std::uint32_t>(x - kData.x, y - kData.y))
                                      : static_cast<double>(planes[i].at<float>(x - kData.x, y - kData.y));
                    },
                    tolerance);
            } else {
                expect_pixels(reader, 0, region, mixed_pattern);
            }
        }
    }
}

INSTANTIATE_TEST_SUITE_P(EveryCompression, ExrReference,
                         testing::Values("none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab",
                                         "htj2k256", "htj2k32", "zstd"),
                         [](const auto& compression) { return std::string(compression.param); });

TEST(ExrReferenceFiles, LevelsAndLineOrders) {
    for (const char* name : {"mipmap.exr", "ripmap.exr", "random_order.exr", "decreasing.exr"}) {
        SCOPED_TRACE(name);
        const ExrReader reader(kFolder / name);
        for (const Window& region : kRegions) {
            expect_pixels(reader, 0, region, mixed_pattern);
        }
    }
}

TEST(ExrReferenceFiles, SubsampledChannelsAreReplicated) {
    for (const char* name : {"none", "zips", "zip", "piz", "rle"}) {
        SCOPED_TRACE(name);
        const ExrReader reader(kFolder / ("subsampled_" + std::string(name) + ".exr"));
        for (const Window& region : {Window{-4, -6, 22, 40}, Window{-3, 5, 6, 1}, Window{1, 7, 9, 11}}) {
            expect_pixels(reader, 0, region, [](int c, int x, int y) {
                const auto even = [](int value) { return value - (value & 1); };
                return static_cast<double>(c == 2 ? pattern_value(c, x, y) : pattern_value(c, even(x), even(y)));
            });
        }
    }
}

TEST(ExrReferenceFiles, MultiPartWithTilesDeepAndViews) {
    if constexpr (OPENEXR_VERSION_MAJOR == 3 && OPENEXR_VERSION_MINOR < 2) {
        // It asks every part of a file that holds a deep one for an attribute that only deep parts have.
        EXPECT_THROW(ExrReader(kFolder / "multipart.exr"), Error);
        return;
    }
    const ExrReader reader(kFolder / "multipart.exr");
    const std::vector<Part>& parts = reader.header().parts;
    ASSERT_EQ(parts.size(), 4u);
    EXPECT_EQ(parts[0].name, "tiles");
    EXPECT_TRUE(parts[0].tiled);
    EXPECT_FALSE(parts[0].deep);
    EXPECT_TRUE(parts[1].deep);
    EXPECT_EQ(parts[2].view, "left");
    EXPECT_EQ(parts[3].view, "right");
    EXPECT_EQ(parts[3].name, "beauty.right");
    expect_pixels(reader, 0, kData, mixed_pattern);
    for (const int part : {2, 3}) {
        expect_pixels(reader, part, {-2, -2, 36, 30},
                      [](int c, int x, int y) { return static_cast<double>(pattern_value(c, x, y)); });
    }
    try {
        read_planes(reader, 1, {0, 0, 4, 4});
        FAIL() << "a deep part was read";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::format);
        EXPECT_NE(std::string(error.what()).find("part 1 'deep': is a deep image"), std::string::npos) << error.what();
    }
}

TEST(ExrReferenceFiles, EveryFileOfTheTestDataOpens) {
    const char* variable = std::getenv("RELUME_TEST_DATA");
    const std::filesystem::path folder =
        variable != nullptr ? variable : std::filesystem::path(RELUME_SOURCE_DIR) / "../shared/data";
    if (!std::filesystem::is_directory(folder)) {
        GTEST_SKIP() << "the test data is not there: RELUME_TEST_DATA names its folder, now " << folder;
    }
    int count = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        if (entry.path().extension() != ".exr") {
            continue;
        }
        SCOPED_TRACE(entry.path());
        const ExrReader reader(entry.path());
        ++count;
        for (std::size_t p = 0; p < reader.header().parts.size(); ++p) {
            const Part& part = reader.header().parts[p];
            // A band in the middle: whole files would take the time of all other tests.
            const int rows = std::min(part.rows_per_chunk, part.data_window.height);
            const Window band{part.data_window.x, part.data_window.y + part.data_window.height / 2,
                              part.data_window.width, rows};
            EXPECT_FALSE(part.channels.empty());
            EXPECT_NO_THROW(read_planes(reader, static_cast<int>(p), band, PixelType::float32));
        }
    }
    std::cout << "            " << count << " files in " << folder << '\n';
    EXPECT_GT(count, 0);
}

}  // namespace
}  // namespace relume::io
