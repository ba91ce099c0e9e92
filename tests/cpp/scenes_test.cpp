// SPDX-License-Identifier: Apache-2.0
// What is true of the G-buffers of all built-in scenes.
#include "relume/scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <set>

#include <glm/geometric.hpp>

#include "io/exr.h"
#include "relume/error.h"
#include "scene_pixels.h"

namespace relume {
namespace {

using glm::dvec3;

SceneImage small(std::string_view name, int samples, int paths = 0, int threads = 1) {
    SceneOptions options;
    options.width = 64;
    options.height = 36;
    options.samples = samples;
    options.paths = paths;
    options.threads = threads;
    return render_scene(name, options);
}

TEST(ScenesTest, UnknownNamesAndBadOptionsAreErrors) {
    try {
        render_scene("cornel");
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::parameter);
        EXPECT_STREQ(error.what(), "there is no scene 'cornel'; the scenes are sdf and cornell");
    }
    const auto refused = [](auto change) {
        SceneOptions options;
        options.width = options.height = 2;
        change(options);
        try {
            render_scene("sdf", options);
            return false;
        } catch (const Error& error) {
            return error.kind() == ErrorKind::value;
        }
    };
    EXPECT_TRUE(refused([](SceneOptions& o) { o.width = -1; }));
    EXPECT_TRUE(refused([](SceneOptions& o) { o.height = 40000; }));
    EXPECT_TRUE(refused([](SceneOptions& o) { o.samples = -4; }));
    EXPECT_TRUE(refused([](SceneOptions& o) { o.paths = -2; }));
    EXPECT_TRUE(refused([](SceneOptions& o) { o.bounces = 65; }));
    EXPECT_TRUE(refused([](SceneOptions& o) { o.threads = -1; }));
    EXPECT_TRUE(refused([](SceneOptions& o) { o.time = std::numeric_limits<double>::infinity(); }));
    EXPECT_FALSE(refused([](SceneOptions&) {}));
}

TEST(ScenesTest, OnePixelIsEnough) {
    for (const SceneInfo& info : scenes()) {
        SceneOptions options;
        options.width = options.height = 1;
        const SceneImage image = render_scene(info.name, options);
        for (const SceneChannel& channel : image.channels) {
            ASSERT_EQ(channel.pixels.size(), 1u);
            EXPECT_TRUE(std::isfinite(channel.pixels[0])) << channel.name;
        }
    }
}

TEST(ScenesTest, PixelsDoNotDependOnThreads) {
    for (const SceneInfo& info : scenes()) {
        const SceneImage one = small(info.name, 3, 2, 1);
        for (const int threads : {2, 5}) {
            const SceneImage many = small(info.name, 3, 2, threads);
            ASSERT_EQ(one.channels.size(), many.channels.size());
            for (std::size_t c = 0; c < one.channels.size(); ++c) {
                EXPECT_EQ(one.channels[c].pixels, many.channels[c].pixels) << one.channels[c].name;
            }
        }
    }
}

TEST(ScenesTest, TheSeedReachesTheBeautyAlone) {
    SceneOptions options;
    options.width = options.height = 16;
    options.samples = 2;
    options.paths = 1;
    const SceneImage a = render_scene("cornell", options);
    options.seed = 1;
    const SceneImage b = render_scene("cornell", options);
    for (const SceneChannel& channel : a.channels) {
        const bool beauty = channel.name.starts_with("ViewLayer.Combined") && !channel.name.ends_with(".A");
        EXPECT_EQ(channel.pixels != b.find(channel.name)->pixels, beauty) << channel.name;
    }
}

TEST(ScenesTest, TheCameraTurnsDepthIntoPosition) {
    for (const SceneInfo& info : scenes()) {
        const SceneImage image = small(info.name, 1);
        const Camera& c = image.camera;
        int surfaces = 0;
        for (int j = 0; j < image.window.height; ++j) {
            for (int i = 0; i < image.window.width; ++i) {
                const double depth = at(image, "Depth.Z", i, j);
                if (at(image, "IndexOB.X", i, j) == 0) {
                    EXPECT_EQ(depth, 1e10f);
                    continue;
                }
                ++surfaces;
                const dvec3 in_camera{depth * ((i + 0.5) * c.x_scale + c.x_offset),
                                      depth * ((j + 0.5) * c.y_scale + c.y_offset), -depth};
                const dvec3 position = triple(image, "Position", "XYZ", i, j);
                for (int row = 0; row < 3; ++row) {
                    double expected = c.camera_to_world[4 * row + 3];
                    for (int k = 0; k < 3; ++k) expected += c.camera_to_world[4 * row + k] * in_camera[k];
                    EXPECT_NEAR(position[row], expected, 1e-6 * depth) << info.name << " " << i << " " << j;
                }
            }
        }
        EXPECT_GT(surfaces, 1000);
    }
}

TEST(ScenesTest, EdgesArePremultipliedAndTheCentreDecidesTheRest) {
    for (const SceneInfo& info : scenes()) {
        const SceneImage centre = small(info.name, 1);
        const SceneImage image = small(info.name, 16, 1);
        int edges = 0;
        for (int j = 0; j < image.window.height; ++j) {
            for (int i = 0; i < image.window.width; ++i) {
                for (const char* name :
                     {"Depth.Z", "Position.X", "Position.Y", "Position.Z", "IndexOB.X", "IndexMA.X"}) {
                    EXPECT_EQ(at(image, name, i, j), at(centre, name, i, j));
                }
                const double coverage = at(image, "albedo.A", i, j);
                EXPECT_EQ(at(image, "Combined.A", i, j), coverage);
                const double length = glm::length(triple(image, "Normal", "XYZ", i, j));
                EXPECT_LE(length, coverage + 1e-6);
                double matte = 0;
                int objects = 0;
                for (const char* rank :
                     {"CryptoObject00.g", "CryptoObject00.a", "CryptoObject01.g", "CryptoObject01.a"}) {
                    matte += at(image, rank, i, j);
                    objects += at(image, rank, i, j) > 0;
                }
                EXPECT_NEAR(matte, coverage, 1e-6);
                if (coverage == 0 || coverage == 1) continue;
                ++edges;
                // The ground's horizon and the box's rim: one flat surface and the background.
                if (objects == 1) {
                    EXPECT_NEAR(length, coverage, 1e-6);
                }
            }
        }
        EXPECT_GT(edges, 30) << info.name;
    }
}

TEST(ScenesTest, ManifestsNameTheMattes) {
    for (const SceneInfo& info : scenes()) {
        SceneOptions options;
        options.width = options.height = 64;
        options.samples = 1;
        options.paths = 0;
        const SceneImage image = render_scene(info.name, options);
        const std::string& manifest = image.attributes.at("cryptomatte/542cafa/manifest");
        std::set<float> indices;
        for (int j = 0; j < image.window.height; ++j) {
            for (int i = 0; i < image.window.width; ++i) {
                const float index = at(image, "IndexOB.X", i, j);
                const float id = at(image, "CryptoObject00.r", i, j);
                EXPECT_EQ(index == 0, id == 0);
                if (index != 0 && indices.insert(index).second) {
                    std::array<char, 16> hex{};
                    std::snprintf(hex.data(), hex.size(), "\":\"%08x\"", std::bit_cast<std::uint32_t>(id));
                    EXPECT_NE(manifest.find(hex.data()), std::string::npos) << manifest << hex.data();
                }
            }
        }
        EXPECT_EQ(indices.size(), info.name == "sdf" ? 2u : 14u);
    }
    const std::string manifest = small("sdf", 1).attributes.at("cryptomatte/542cafa/manifest");
    EXPECT_EQ(manifest, R"({"sphere":"591e9a8d","ground":"c5b51ede"})");
}

TEST(ScenesTest, AnOpaqueFilmHasTheSkyBehindIt) {
    SceneOptions options;
    options.width = 64;
    options.height = 36;
    options.samples = 8;
    const SceneImage clear = render_scene("sdf", options);
    options.opaque = true;
    const SceneImage opaque = render_scene("sdf", options);
    for (int i = 0; i < 64; ++i) {
        EXPECT_EQ(at(clear, "Combined.A", i, 0), 0);
        EXPECT_EQ(at(clear, "Combined.B", i, 0), 0);
        EXPECT_EQ(at(opaque, "Combined.A", i, 0), 1);
        // Away from the sun and near the horizon: half-way between the gradient's ends, and a little below.
        EXPECT_NEAR(at(opaque, "Combined.R", i, 0), 0.65, 0.02);
        EXPECT_NEAR(at(opaque, "Combined.B", i, 0), 0.95, 0.02);
        EXPECT_EQ(at(clear, "Combined.R", i, 35), at(opaque, "Combined.R", i, 35));
    }
}

TEST(ScenesTest, FilesHoldWhatWasRendered) {
    const std::filesystem::path folder = testing::TempDir() + "relume_scenes";
    std::filesystem::create_directories(folder);
    for (const SceneInfo& info : scenes()) {
        SceneOptions options;
        options.width = 50;
        options.height = 37;
        options.samples = 2;
        options.paths = 1;
        const std::filesystem::path path = folder / (std::string(info.name) + ".exr");
        write_scene(info.name, path, options);
        const SceneImage image = render_scene(info.name, options);

        const io::ExrReader reader(path);
        ASSERT_EQ(reader.header().parts.size(), 1u);
        const io::Part& part = reader.header().parts[0];
        EXPECT_EQ(part.data_window, image.window);
        EXPECT_EQ(part.display_window, image.window);
        ASSERT_EQ(part.channels.size(), image.channels.size());
        for (std::size_t c = 0; c < part.channels.size(); ++c) {
            EXPECT_EQ(part.channels[c].name, image.channels[c].name);
            EXPECT_EQ(part.channels[c].type, PixelType::float32);
            std::vector<float> pixels(image.channels[c].pixels.size());
            const Plane plane{reinterpret_cast<std::byte*>(pixels.data()), PixelType::float32, 4, 4 * 50};
            const io::ReadTarget target{0, static_cast<int>(c), plane};
            reader.read(image.window, {&target, 1});
            EXPECT_EQ(pixels, image.channels[c].pixels) << image.channels[c].name;
        }
        for (const auto& entry : image.attributes) {
            const auto same = [&](const io::Attribute& a) {
                return a.name == entry.first && std::get<std::string>(a.value) == entry.second;
            };
            EXPECT_EQ(std::ranges::count_if(part.attributes, same), 1) << entry.first;
        }
    }
    EXPECT_THROW(write_scene("sdf", folder / "none" / "sdf.exr", {.width = 4, .height = 4}), Error);
    std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace relume
