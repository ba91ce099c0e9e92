// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>
#include <thread>

#include "exr_test_image.h"
#include "relume/error.h"

namespace relume::io {
namespace {

constexpr PixelType kTypes[] = {PixelType::half, PixelType::float32, PixelType::uint32};

std::vector<Compression> compressions() {
    std::vector<Compression> result;
    for (int i = 0; i <= static_cast<int>(Compression::zstd); ++i) {
        if (is_supported(static_cast<Compression>(i))) {
            result.push_back(static_cast<Compression>(i));
        }
    }
    return result;
}

Part make_part(const Window& window, std::vector<Channel> channels) {
    Part part;
    part.data_window = window;
    part.display_window = {0, 0, 100, 80};
    part.channels = std::move(channels);
    return part;
}

// Error that a compression may make: relative, above 0.001 in units of the image's amplitude. 0 means bit for bit.
double tolerance(Compression compression, PixelType type) {
    switch (compression) {
        case Compression::pxr24:
            return type == PixelType::float32 ? 1.0 / 32768 : 0;
        case Compression::b44:
        case Compression::b44a:
            return type == PixelType::half ? 0.05 : 0;
        case Compression::dwaa:
        case Compression::dwab:
        case Compression::lj2k:
            return type == PixelType::uint32 ? 0 : 0.1;
        default:
            return 0;
    }
}

bool is_lossy(Compression compression) {
    return tolerance(compression, PixelType::half) > 0 || tolerance(compression, PixelType::float32) > 0;
}

void expect_test_image(const std::vector<TestPlane>& read, const Part& written, const Window& region,
                       Compression compression) {
    const Window& window = written.data_window;
    for (std::size_t c = 0; c < read.size(); ++c) {
        const PixelType type = written.channels[c].type;
        const double bound = tolerance(compression, type);
        int wrong = 0;
        double worst = 0;
        for (int row = 0; row < region.height; ++row) {
            for (int column = 0; column < region.width; ++column) {
                const int x = region.x + column;
                const int y = region.y + row;
                const bool inside = x >= window.x && x < window.x_end() && y >= window.y && y < window.y_end();
                if (type == PixelType::uint32) {
                    wrong +=
                        read[c].at<std::uint32_t>(column, row) != (inside ? test_uint(static_cast<int>(c), x, y) : 0);
                    continue;
                }
                const float value = inside ? test_value(static_cast<int>(c), x, y, is_lossy(compression)) : 0.0f;
                const double expected = type == PixelType::float32 ? value * 1.0001f : value;
                const double got = type == PixelType::half ? half_to_float(read[c].at<std::uint16_t>(column, row))
                                                           : read[c].at<float>(column, row);
                const double scale = bound > 0.001 ? 24.0 : std::abs(expected);
                worst = std::max(worst, got == expected ? 0.0 : std::abs(got - expected) / scale);
            }
        }
        EXPECT_EQ(wrong, 0) << written.channels[c].name;
        EXPECT_LE(worst, bound) << written.channels[c].name << " by " << name_of(compression);
    }
}

TEST(ExrRoundTrip, EveryCompressionTypeAndWindow) {
    const TemporaryFolder folder;
    const Window windows[] = {{0, 0, 64, 40}, {-13, -7, 37, 51}, {5, 9, 1, 1}, {3, -20, 17, 270}};
    for (const Compression compression : compressions()) {
        for (const Window& window : windows) {
            std::vector<Channel> channels;
            for (const PixelType type : kTypes) {
                channels.push_back({"a" + std::to_string(static_cast<int>(type)), type});
                channels.push_back({"b" + std::to_string(static_cast<int>(type)), type});
            }
            std::sort(channels.begin(), channels.end(), [](auto& a, auto& b) { return a.name < b.name; });
            const Part part = make_part(window, channels);
            const auto path = folder / "image.exr";
            SCOPED_TRACE(std::string(name_of(compression)) + " " + std::to_string(window.width) + "x" +
                         std::to_string(window.height));
            write_test_image(path, {{part}}, {.compression = compression, .dwa_quality = 10}, is_lossy(compression));

            const ExrReader reader(path);
            const Part& read = reader.header().parts.at(0);
            EXPECT_EQ(read.data_window, window);
            EXPECT_EQ(read.display_window, part.display_window);
            EXPECT_EQ(read.compression, compression);
            ASSERT_EQ(read.channels.size(), channels.size());
            expect_test_image(read_planes(reader, 0, window), part, window, compression);

            // Any region: within, across and beyond the data window.
            const Window regions[] = {{window.x + 1, window.y + 3, 9, 5},
                                      {window.x - 4, window.y - 4, window.width + 9, window.height + 7},
                                      {window.x + 500, window.y, 3, 3}};
            for (const Window& region : regions) {
                expect_test_image(read_planes(reader, 0, region), part, region, compression);
            }
        }
    }
}

TEST(ExrRoundTrip, ConvertsBetweenAllTypes) {
    const TemporaryFolder folder;
    const Window window{-2, 1, 33, 20};
    const Part part = make_part(window, {{"f", PixelType::float32}, {"h", PixelType::half}, {"u", PixelType::uint32}});
    write_test_image(folder / "types.exr", {{part}});
    const ExrReader reader(folder / "types.exr");
    const auto floats = read_planes(reader, 0, window, PixelType::float32);
    const auto halves = read_planes(reader, 0, window, PixelType::half);
    const auto uints = read_planes(reader, 0, window, PixelType::uint32);
    for (int row = 0; row < window.height; ++row) {
        for (int column = 0; column < window.width; ++column) {
            const int x = window.x + column;
            const int y = window.y + row;
            const float f = test_value(0, x, y) * 1.0001f;
            const float h = test_value(1, x, y);
            const std::uint32_t u = test_uint(2, x, y);
            EXPECT_EQ(floats[0].at<float>(column, row), f);
            EXPECT_EQ(floats[1].at<float>(column, row), h);
            EXPECT_EQ(floats[2].at<float>(column, row), static_cast<float>(u));
            EXPECT_EQ(halves[0].at<std::uint16_t>(column, row), float_to_half(f));
            EXPECT_EQ(halves[1].at<std::uint16_t>(column, row), float_to_half(h));
            EXPECT_EQ(halves[2].at<std::uint16_t>(column, row), float_to_half(static_cast<float>(u)));
            EXPECT_EQ(uints[0].at<std::uint32_t>(column, row), f > 0 ? static_cast<std::uint32_t>(f) : 0u);
            EXPECT_EQ(uints[1].at<std::uint32_t>(column, row), h > 0 ? static_cast<std::uint32_t>(h) : 0u);
            EXPECT_EQ(uints[2].at<std::uint32_t>(column, row), u);
        }
    }
}

TEST(ExrRoundTrip, StridesBothWays) {
    const TemporaryFolder folder;
    const Window window{0, 0, 21, 35};
    const Part part = make_part(window, {{"B", PixelType::half}, {"G", PixelType::half}, {"R", PixelType::half}});

    // Interleaved floats, bottom row first, are written; the same layout is read back.
    std::vector<float> interleaved(static_cast<std::size_t>(window.width) * window.height * 3);
    for (int y = 0; y < window.height; ++y) {
        for (int x = 0; x < window.width; ++x) {
            for (int c = 0; c < 3; ++c) {
                interleaved[static_cast<std::size_t>(((window.height - 1 - y) * window.width + x) * 3 + c)] =
                    test_value(c, x, y);
            }
        }
    }
    const auto plane_of = [&](std::vector<float>& image, int c) {
        const std::ptrdiff_t row = window.width * 12;
        return Plane{reinterpret_cast<std::byte*>(image.data()) + (window.height - 1) * row + c * 4, PixelType::float32,
                     12, -row};
    };
    {
        ExrWriter writer(folder / "strides.exr", {{part}}, {});
        writer.write(
            0, 0, window.height,
            std::vector<ConstPlane>{plane_of(interleaved, 0), plane_of(interleaved, 1), plane_of(interleaved, 2)});
        writer.commit();
    }
    const ExrReader reader(folder / "strides.exr");
    expect_test_image(read_planes(reader, 0, window), part, window, Compression::zip);

    std::vector<float> read(interleaved.size());
    std::vector<ReadTarget> targets;
    for (int c = 0; c < 3; ++c) {
        targets.push_back({0, c, plane_of(read, c)});
    }
    reader.read(window, targets);
    EXPECT_EQ(read, interleaved);
}

TEST(ExrRoundTrip, SubsampledChannels) {
    const TemporaryFolder folder;
    const Window window{-4, -8, 40, 44};
    for (const Compression compression : compressions()) {
        if (compression == Compression::dwaa || compression == Compression::dwab || compression == Compression::lj2k ||
            compression == Compression::b44 || compression == Compression::b44a) {
            continue;  // lossy
        }
        const Part part =
            make_part(window, {{"BY", PixelType::half, 2, 4}, {"RY", PixelType::half, 4, 2}, {"Y", PixelType::half}});
        SCOPED_TRACE(name_of(compression));
        write_test_image(folder / "yc.exr", {{part}}, {.compression = compression});
        const ExrReader reader(folder / "yc.exr");
        EXPECT_EQ(reader.header().parts[0].channels[0].y_sampling, 4);
        for (const Window& region : {window, Window{-3, 3, 7, 1}, Window{-1, 5, 30, 20}}) {
            const auto planes = read_planes(reader, 0, region);
            for (int row = 0; row < region.height; ++row) {
                for (int column = 0; column < region.width; ++column) {
                    const auto down = [](int value, int step) { return value - ((value % step) + step) % step; };
                    const int x = region.x + column;
                    const int y = region.y + row;
                    ASSERT_EQ(half_to_float(planes[0].at<std::uint16_t>(column, row)),
                              test_value(0, down(x, 2), down(y, 4)));
                    ASSERT_EQ(half_to_float(planes[1].at<std::uint16_t>(column, row)),
                              test_value(1, down(x, 4), down(y, 2)));
                    ASSERT_EQ(half_to_float(planes[2].at<std::uint16_t>(column, row)), test_value(2, x, y));
                }
            }
        }
    }
}

TEST(ExrRoundTrip, MultiPartStereoWithAttributesOfEveryType) {
    const TemporaryFolder folder;
    const Window window{0, 0, 24, 40};
    const auto numbers = [](std::size_t count) {
        std::vector<double> values(count);
        std::iota(values.begin(), values.end(), 1.0);
        return values;
    };
    const std::vector<Attribute> attributes{
        {"comment", "string", std::string("two\nlines, \xc3\xa9 and a \0 inside", 26)},
        {"multiView", "stringvector", std::vector<std::string>{"left", "right", ""}},
        {"none", "stringvector", std::vector<std::string>{}},
        {"weights", "floatvector", numbers(5)},
        {"screenWindowCenter", "v2f", std::vector<double>{0.5, -0.25}},
        {"screenWindowWidth", "float", std::vector<double>{1.5}},
        {"int", "int", std::vector<double>{-2147483648.0}},
        {"float", "float", std::vector<double>{0.25}},
        {"double", "double", std::vector<double>{0.1}},
        {"v2i", "v2i", numbers(2)},
        {"v2f", "v2f", numbers(2)},
        {"v2d", "v2d", numbers(2)},
        {"v3i", "v3i", numbers(3)},
        {"v3f", "v3f", numbers(3)},
        {"v3d", "v3d", numbers(3)},
        {"box2i", "box2i", numbers(4)},
        {"box2f", "box2f", numbers(4)},
        {"m33f", "m33f", numbers(9)},
        {"m33d", "m33d", numbers(9)},
        {"worldToCamera", "m44f", numbers(16)},
        {"m44d", "m44d", numbers(16)},
        {"chromaticities", "chromaticities",
         std::vector<double>{0.5, 0.25, 0.25, 0.5, 0.125, 0.0625, 0.3125, 0.328125}},
        {"framesPerSecond", "rational", std::vector<double>{24000, 1001}},
        {"timeCode", "timecode", std::vector<double>{16777216, 4294967295.0}},
        {"keyCode", "keycode", numbers(7)},
        {"envmap", "envmap", std::vector<double>{1}},
        {"unknown", "madeUpType", std::vector<std::byte>{std::byte{1}, std::byte{0}, std::byte{255}}},
        {"a name of more than thirty-one characters", "string", std::string("x")},
    };
    Header header;
    for (const char* view : {"left", "right"}) {
        Part part = make_part(window, {{"N.X", PixelType::float32}, {"N.Y", PixelType::float32}});
        part.name = std::string("ViewLayer.Normal.") + view;
        part.view = view;
        part.pixel_aspect = 1.5f;
        part.attributes = attributes;
        header.parts.push_back(part);
    }
    write_test_image(folder / "parts.exr", header, {.compression = Compression::zips});

    const ExrReader reader(folder / "parts.exr");
    ASSERT_EQ(reader.header().parts.size(), 2u);
    for (std::size_t p = 0; p < 2; ++p) {
        const Part& part = reader.header().parts[p];
        EXPECT_EQ(part.name, header.parts[p].name);
        EXPECT_EQ(part.view, header.parts[p].view);
        EXPECT_EQ(part.pixel_aspect, 1.5f);
        ASSERT_EQ(part.attributes.size(), attributes.size());
        for (std::size_t a = 0; a < attributes.size(); ++a) {
            EXPECT_EQ(part.attributes[a].name, attributes[a].name);
            EXPECT_EQ(part.attributes[a].type, attributes[a].type);
            if (attributes[a].type == "string" && attributes[a].name == "comment") {
                continue;  // below
            }
            if (attributes[a].name == "float" || attributes[a].type != "float") {
                EXPECT_EQ(part.attributes[a].value, attributes[a].value) << attributes[a].name;
            }
        }
        EXPECT_EQ(std::get<std::string>(part.attributes[0].value), std::get<std::string>(attributes[0].value));
        expect_test_image(read_planes(reader, static_cast<int>(p), window), part, window, Compression::zips);
    }
    // What was read can be written again, to the same bytes.
    ExrWriter copy(folder / "copy.exr", reader.header(), {.compression = Compression::zips});
    for (int p = 0; p < 2; ++p) {
        auto planes = read_planes(reader, p, window);
        copy.write(p, 0, window.height, const_planes(planes));
    }
    copy.commit();
    EXPECT_EQ(ExrReader(folder / "copy.exr").header().parts[1].attributes.size(), attributes.size());
}

TEST(ExrRoundTrip, ChannelsInAnyOrder) {
    const TemporaryFolder folder;
    const Window window{0, 0, 8, 8};
    const Part part = make_part(window, {{"R", PixelType::half}, {"G", PixelType::float32}, {"B", PixelType::half}});
    write_test_image(folder / "order.exr", {{part}});
    const ExrReader reader(folder / "order.exr");
    const auto planes = read_planes(reader, 0, window, PixelType::float32);
    const std::vector<Channel>& channels = reader.header().parts[0].channels;
    ASSERT_EQ(channels[0].name, "B");
    ASSERT_EQ(channels[1].name, "G");
    ASSERT_EQ(channels[2].name, "R");
    EXPECT_EQ(planes[0].at<float>(3, 2), test_value(2, 3, 2));
    EXPECT_EQ(planes[1].at<float>(3, 2), test_value(1, 3, 2) * 1.0001f);
    EXPECT_EQ(planes[2].at<float>(3, 2), test_value(0, 3, 2));
}

TEST(ExrRoundTrip, ThreadsWriteAndReadBandsInAnyOrder) {
    const TemporaryFolder folder;
    const Window window{-5, 7, 200, 333};
    Header header;
    for (const char* name : {"one", "two"}) {
        Part part = make_part(window, {{"A", PixelType::half}, {"Z", PixelType::float32}});
        part.name = name;
        header.parts.push_back(part);
    }
    std::vector<TestPlane> planes = test_planes(header.parts[0]);
    write_test_image(folder / "straight.exr", header);
    for (const unsigned seed : {1u, 2u, 3u}) {
        ExrWriter writer(folder / "threads.exr", header, {});
        const int rows = writer.rows_per_chunk();
        std::vector<std::pair<int, int>> bands;
        for (int y = window.y; y < window.y_end(); y += rows) {
            bands.push_back({0, y});
            bands.push_back({1, y});
        }
        std::shuffle(bands.begin(), bands.end(), std::mt19937(seed));
        std::atomic<std::size_t> next{0};
        std::vector<std::thread> threads;
        for (int t = 0; t < 4; ++t) {
            threads.emplace_back([&] {
                for (std::size_t i = next++; i < bands.size(); i = next++) {
                    const auto [part, y] = bands[i];
                    writer.write(part, y, std::min(rows, window.y_end() - y), const_planes(planes, y - window.y));
                }
            });
        }
        for (std::thread& thread : threads) {
            thread.join();
        }
        writer.commit();
        // The same bytes in the same order, whoever wrote when.
        const ExrReader reader(folder / "threads.exr");
        std::atomic<int> failures{0};
        threads.clear();
        next = 0;
        for (int t = 0; t < 4; ++t) {
            threads.emplace_back([&] {
                for (std::size_t i = next++; i < bands.size(); i = next++) {
                    const Window band{window.x, bands[i].second, window.width,
                                      std::min(rows, window.y_end() - bands[i].second)};
                    const auto read = read_planes(reader, bands[i].first, band);
                    failures += read[0].at<std::uint16_t>(3, 2 % band.height) !=
                                float_to_half(test_value(0, band.x + 3, band.y + 2 % band.height));
                    failures += read[1].at<float>(7, 0) != test_value(1, band.x + 7, band.y) * 1.0001f;
                }
            });
        }
        for (std::thread& thread : threads) {
            thread.join();
        }
        EXPECT_EQ(failures, 0);
        EXPECT_EQ(file_bytes(folder / "threads.exr").size(), file_bytes(folder / "straight.exr").size());
    }
}

}  // namespace
}  // namespace relume::io
