// SPDX-License-Identifier: Apache-2.0
// Parts of a frame: regions of a relight and of read_channels, and arrays that are a part or a proxy of a frame.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "relume/error.h"
#include "relume/light.h"
#include "relume/relight.h"
#include "relume/scenes.h"

namespace relume {
namespace {

std::vector<Plane> interleaved(std::vector<float>& rgba, int width, int height) {
    rgba.assign(std::size_t{4} * static_cast<std::size_t>(width) * static_cast<std::size_t>(height), -1.f);
    std::vector<Plane> planes;
    for (std::size_t k = 0; k < 4; ++k)
        planes.push_back(
            {reinterpret_cast<std::byte*>(rgba.data() + k), PixelType::float32, 16, std::ptrdiff_t{16} * width});
    return planes;
}

std::vector<float> relit(const GBuffer& gbuffer, const Rig& rig, const Window& region, int threads = 0) {
    std::vector<float> rgba;
    RelightOptions options;
    options.region = region;
    options.threads = threads;
    const RelightReport report =
        relight(gbuffer, rig, {{"beauty", interleaved(rgba, region.width, region.height)}}, options);
    EXPECT_EQ(report.pixels, std::int64_t{region.width} * region.height);
    return rgba;
}

std::vector<float> part_of(const std::vector<float>& whole, const Window& window, const Window& part) {
    std::vector<float> out;
    for (int y = part.y; y < part.y_end(); ++y)
        for (int x = 4 * part.x; x < 4 * part.x_end(); ++x)
            out.push_back(whole[static_cast<std::size_t>((y - window.y) * 4 * window.width + x - 4 * window.x)]);
    return out;
}

class RegionTest : public testing::Test {
protected:
    void SetUp() override {
        SceneOptions options;
        options.width = 150;
        options.height = 90;
        options.samples = 4;
        path = testing::TempDir() + "relume_region.exr";
        write_scene("sdf", path, options);
    }
    void TearDown() override { std::filesystem::remove(path); }
    std::filesystem::path path;
    const Rig rig = Rig::loads(R"(
[[light]]
type = "sun"
direction = [-0.6, -0.8, 0.5]
[[light]]
type = "point"
position = [1, 2, -1]
intensity = 3
[[shader]]
object_id = [1]
use = "ggx"
)");
};

TEST_F(RegionTest, HasTheBitsOfTheWhole) {
    const GBuffer gbuffer = GBuffer::read(path);
    const Window& all = gbuffer.data_window();
    std::vector<float> whole;
    relight(gbuffer, rig, {{"beauty", interleaved(whole, all.width, all.height)}});
    for (const Window& region : {all, Window{0, 0, 1, 1}, Window{149, 89, 1, 1}, Window{17, 31, 64, 3},
                                 Window{0, 47, 150, 2}, Window{101, 5, 33, 80}})
        for (const int threads : {1, 3})
            EXPECT_EQ(relit(gbuffer, rig, region, threads), part_of(whole, all, region)) << region.x << " " << region.y;
}

TEST_F(RegionTest, ReadChannelsOfAPart) {
    const GBuffer gbuffer = GBuffer::read(path);
    ChannelRequest request;
    request.name = "position";
    request.components = 3;
    const auto read = [&](const Window& window, const std::optional<Window>& region) {
        std::vector<std::vector<float>> planes(
            3, std::vector<float>(static_cast<std::size_t>(window.width * window.height)));
        std::vector<Plane> out;
        for (auto& plane : planes)
            out.push_back(
                {reinterpret_cast<std::byte*>(plane.data()), PixelType::float32, 4, std::ptrdiff_t{4} * window.width});
        read_channels(gbuffer, {&request, 1}, out, 2, region);
        return planes;
    };
    const auto whole = read(gbuffer.data_window(), {});
    for (const Window& region : {Window{3, 15, 40, 35}, Window{149, 0, 1, 90}, Window{70, 44, 1, 1}}) {
        const auto part = read(region, region);
        for (int y = 0; y < region.height; ++y)
            for (int x = 0; x < region.width; ++x)
                for (std::size_t k = 0; k < 3; ++k)
                    ASSERT_EQ(part[k][static_cast<std::size_t>(y * region.width + x)],
                              whole[k][static_cast<std::size_t>((region.y + y) * 150 + region.x + x)]);
    }
}

TEST_F(RegionTest, KeptChannelsAreTheSameAndNeedNoFile) {
    const GBuffer plain = GBuffer::read(path);
    const Window all = plain.data_window(), part{20, 33, 50, 30};
    const std::vector<float> whole = relit(plain, rig, all);
    GBuffer little = GBuffer::read(path), kept = GBuffer::read(path);
    little.keep_channels(std::int64_t{5} * 160 * 90 * 4);  // of five planes
    kept.keep_channels(std::int64_t{1} << 30);
    for (const GBuffer* gbuffer : {&little, &kept}) {
        EXPECT_EQ(relit(*gbuffer, rig, part, 3), part_of(whole, all, part));
        for (const int threads : {3, 1, 2}) EXPECT_EQ(relit(*gbuffer, rig, all, threads), whole);
        EXPECT_EQ(relit(*gbuffer, rig, part, 3), part_of(whole, all, part));
    }
    Rig brighter = rig, other_model = rig;
    brighter.lights[0].values.set(find_light_type("sun")->parameters, "exposure", 1.0, "sun");
    const std::vector<float> bright = relit(plain, brighter, all);
    // Another model asks for more: that is read, and kept too.
    other_model.set("shader.0.use", "cook_torrance");
    const std::vector<float> other = relit(plain, other_model, all);
    EXPECT_EQ(relit(kept, other_model, all), other);
    std::filesystem::resize_file(path, 400);
    EXPECT_THROW(relit(little, rig, all), Error);
    EXPECT_EQ(relit(kept, rig, all, 2), whole);
    EXPECT_EQ(relit(kept, brighter, all, 2), bright);
    EXPECT_EQ(relit(kept, other_model, all, 2), other);
    EXPECT_NE(other, whole);
}

TEST_F(RegionTest, KeptChannelsOfRowsOfSeveralTiles) {
    SceneOptions options;
    options.width = 4099;
    options.height = 5;
    options.samples = 1;
    write_scene("sdf", path, options);
    const GBuffer plain = GBuffer::read(path);
    GBuffer kept = GBuffer::read(path);
    kept.keep_channels(std::int64_t{1} << 30);
    const Window all = plain.data_window(), across{4000, 1, 99, 3};
    const std::vector<float> whole = relit(plain, rig, all);
    for (int k = 0; k < 3; ++k) {
        EXPECT_EQ(relit(kept, rig, all), whole);
        EXPECT_EQ(relit(kept, rig, across), part_of(whole, all, across));
    }
    std::filesystem::resize_file(path, 400);  // nothing is left to read
    EXPECT_EQ(relit(kept, rig, all), whole);
}

TEST_F(RegionTest, StepsAreThePixelsOfTheWhole) {
    GBuffer gbuffer = GBuffer::read(path);
    const Window all = gbuffer.data_window(), part{20, 33, 51, 31};
    gbuffer.keep_channels(std::int64_t{1} << 30);
    for (const Window& window : {all, part, part}) {
        const std::vector<float> whole = relit(gbuffer, rig, window);
        for (const int step : {2, 3, 7, 200}) {
            const int width = (window.width + step - 1) / step, height = (window.height + step - 1) / step;
            std::vector<float> rgba;
            RelightOptions options;
            options.region = window;
            options.step = step;
            const RelightReport report = relight(gbuffer, rig, {{"beauty", interleaved(rgba, width, height)}}, options);
            EXPECT_EQ(report.pixels, std::int64_t{width} * height);
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < 4 * width; ++x)
                    ASSERT_EQ(rgba[static_cast<std::size_t>(4 * width * y + x)],
                              whole[static_cast<std::size_t>(4 * (y * step * window.width + x / 4 * step) + x % 4)])
                        << "step " << step << ", " << x / 4 << ", " << y;
        }
    }
    RelightOptions options;
    std::vector<float> rgba;
    for (const int step : {0, -2}) {
        options.step = step;
        EXPECT_THROW(relight(gbuffer, rig, {{"beauty", interleaved(rgba, 150, 90)}}, options), Error);
    }
    options.step = 2;
    EXPECT_THROW(relight_to_file(gbuffer, rig, path.string() + ".out", options), Error);
}

TEST_F(RegionTest, OutsideIsRefused) {
    const GBuffer gbuffer = GBuffer::read(path);
    constexpr int kLargest = std::numeric_limits<int>::max();
    std::vector<float> rgba(4);
    for (const Window& region : {Window{-1, 0, 4, 4}, Window{0, 87, 4, 4}, Window{148, 0, 3, 1}, Window{0, 0, 0, 0},
                                 Window{1, 1, kLargest, 1}, Window{-kLargest, 0, kLargest, 1}}) {
        RelightOptions options;
        options.region = region;
        const std::vector<Plane> planes(4, {reinterpret_cast<std::byte*>(rgba.data()), PixelType::float32, 16, 0});
        EXPECT_THROW(relight(gbuffer, rig, {{"beauty", planes}}, options), Error);
        EXPECT_THROW(relight_to_file(gbuffer, rig, path.string() + ".out", options), Error);
        ChannelRequest request;
        request.name = "depth";
        EXPECT_THROW(read_channels(gbuffer, {&request, 1}, {planes.data(), 1}, 1, region), Error);
    }
}

/// A frame of unit normals but for one pixel that no sample looks at.
TEST(MemoryFrameTest, ResampledNormalsAreUnitVectors) {
    constexpr int kSize = 400;
    std::vector<float> zero(kSize * kSize, 0.f), one(kSize * kSize, 1.f);
    one[201 * kSize + 7] = 0.5f;
    const auto plane = [&](std::vector<float>& v) {
        return ConstPlane{reinterpret_cast<const std::byte*>(v.data()), PixelType::float32, 4, 4 * kSize};
    };
    std::map<std::string, MemoryChannel> channels;
    channels["normal"].planes = {plane(zero), plane(zero), plane(one)};
    const auto normal_at = [&](const GBuffer& gbuffer, int x, int y) {
        ChannelRequest request;
        request.name = "normal";
        request.components = 3;
        std::array<float, 3> n{};
        std::vector<Plane> out;
        for (float& v : n) out.push_back({reinterpret_cast<std::byte*>(&v), PixelType::float32, 4, 4});
        read_channels(gbuffer, {&request, 1}, out, 1, Window{x, y, 1, 1});
        return n;
    };
    MemoryFrame frame{{0, 0, kSize, kSize}, {0, 0, kSize, kSize}};
    frame.resampled = true;
    EXPECT_EQ(normal_at(GBuffer::from_memory(frame, channels), 7, 201)[2], 1.f);
    EXPECT_FALSE(GBuffer::from_memory(frame, channels).normal_variance());
    frame.resampled = false;
    EXPECT_EQ(normal_at(GBuffer::from_memory(frame, channels), 7, 201)[2], 0.5f);
}

/// The camera goes across the display window, wherever the arrays lie in it: by hand.
TEST(MemoryFrameTest, ViewDirectionsOfAPartOfAFrame) {
    std::vector<float> zero(20 * 10, 0.f), one(20 * 10, 1.f);
    const auto plane = [&](std::vector<float>& v) {
        return ConstPlane{reinterpret_cast<const std::byte*>(v.data()), PixelType::float32, 4, 80};
    };
    std::map<std::string, MemoryChannel> channels;
    channels["normal"].planes = {plane(zero), plane(zero), plane(one)};
    GBufferOptions options;
    options.fov = 90;
    const MemoryFrame frame{{-5, 30, 20, 10}, {0, 0, 100, 50}, 2};
    const GBuffer gbuffer = GBuffer::from_memory(frame, channels, options);
    ChannelRequest request;
    request.name = "view";
    request.components = 3;
    for (const auto& [x, y] : {std::pair(-5, 30), std::pair(14, 39), std::pair(3, 33)}) {
        std::array<float, 3> v{};
        std::vector<Plane> out;
        for (float& value : v) out.push_back({reinterpret_cast<std::byte*>(&value), PixelType::float32, 4, 4});
        read_channels(gbuffer, {&request, 1}, out, 1, Window{x, y, 1, 1});
        // Half the display's width is tan 45°; a pixel is twice as wide as it is high.
        const double across = (x + 0.5 - 50) / 50, up = -(y + 0.5 - 25) / 100;
        const double length = std::sqrt(across * across + up * up + 1);
        EXPECT_NEAR(static_cast<double>(v[0]), -across / length, 1e-6);
        EXPECT_NEAR(static_cast<double>(v[1]), -up / length, 1e-6);
        EXPECT_NEAR(static_cast<double>(v[2]), 1 / length, 1e-6);
    }
    EXPECT_THROW(GBuffer::from_memory(MemoryFrame{{0, 0, 20, 10}, {0, 0, 20, 10}, 0}, channels, options), Error);
}

}  // namespace
}  // namespace relume
