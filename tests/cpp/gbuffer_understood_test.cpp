// SPDX-License-Identifier: Apache-2.0
// Frames in memory that come again: understood once, and anew as soon as a pixel differs that detection looked at.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "made_camera.h"
#include "relume/gbuffer.h"

namespace relume {
namespace {

/// Normals and positions of hills, all over the frame or in its first rows alone.
struct Hills {
    Hills(int w, int h, int surface_rows = 1 << 20) : width(w), height(h) {
        Camera camera = test::look_at({3, -4, 5}, {0, 0, 0});
        test::set_lens(camera, {0, 0, w, h}, 0.4);
        for (std::vector<float>& plane : planes)
            plane.resize(static_cast<std::size_t>(w) * static_cast<std::size_t>(h));
        for (int y = 0; y < std::min(h, surface_rows); ++y)
            for (int x = 0; x < w; ++x) {
                const auto p = test::at_depth(camera, x + 0.5, y + 0.5, test::hills(x, y, 6));
                for (std::size_t c = 0; c < 3; ++c) at(3 + c, x, y) = static_cast<float>(p[c]);
                at(2, x, y) = 1;
            }
    }
    float& at(std::size_t plane, int x, int y) {
        return planes[plane]
                     [static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
    }
    std::map<std::string, MemoryChannel> channels() const {
        std::map<std::string, MemoryChannel> all;
        for (std::size_t k = 0; k < 6; ++k)
            all[k < 3 ? "normal" : "position"].planes.push_back({reinterpret_cast<const std::byte*>(planes[k].data()),
                                                                 PixelType::float32, 4, std::ptrdiff_t{4} * width});
        return all;
    }
    MemoryFrame frame() const { return {{0, 0, width, height}, {0, 0, width, height}}; }
    GBuffer understood(UnderstoodFrames& known, const GBufferOptions& options = {}) const {
        return GBuffer::from_memory(frame(), channels(), options, known);
    }

    int width, height;
    std::array<std::vector<float>, 6> planes;
};

TEST(UnderstoodFramesTest, TheSamePixelsElsewhereAreUnderstoodOnce) {
    UnderstoodFrames known;
    const Hills first(120, 300);
    const Hills copy = first;
    const GBuffer fresh = GBuffer::from_memory(first.frame(), first.channels());
    for (const Hills* hills : {&first, &copy, &first}) {
        const GBuffer gbuffer = hills->understood(known);
        ASSERT_TRUE(gbuffer.camera().has_value());
        EXPECT_EQ(gbuffer.camera()->camera_to_world, fresh.camera()->camera_to_world);
        EXPECT_EQ(gbuffer.camera_reason(), fresh.camera_reason());
        EXPECT_EQ(gbuffer.notes(), fresh.notes());
        ChannelRequest request;
        request.name = "position";
        request.components = 3;
        std::array<float, 3> p{};
        std::vector<Plane> out;
        for (float& value : p) out.push_back({reinterpret_cast<std::byte*>(&value), PixelType::float32, 4, 4});
        read_channels(gbuffer, {&request, 1}, out, 1, Window{77, 123, 1, 1});
        EXPECT_EQ(p[1], first.planes[4][123 * 120 + 77]);
    }
    EXPECT_EQ(known.understood(), 1);
    known.clear();
    first.understood(known);
    EXPECT_EQ(known.understood(), 2);
}

TEST(UnderstoodFramesTest, WhatElseDiffersIsAnotherFrame) {
    UnderstoodFrames known;
    const Hills hills(120, 300);
    hills.understood(known);
    GBufferOptions options;
    options.channels["normal"].flip = "x";
    hills.understood(known, options);
    EXPECT_EQ(known.understood(), 2);
    MemoryFrame moved = hills.frame();
    moved.data_window.x = 10;
    EXPECT_NE(GBuffer::from_memory(moved, hills.channels(), {}, known).camera_reason(), "");
    EXPECT_EQ(known.understood(), 3);
    auto channels = hills.channels();
    channels["normal"].rule.space = Space::camera;
    GBuffer::from_memory(hills.frame(), channels, {}, known);
    EXPECT_EQ(known.understood(), 4);
    hills.understood(known);
    EXPECT_EQ(known.understood(), 4);
    // A frame that is refused is refused again.
    channels.erase("normal");
    for (int k = 0; k < 2; ++k) EXPECT_ANY_THROW(GBuffer::from_memory(hills.frame(), channels, {}, known));
}

/// Little surface: detection looks at more rows for positions than it does at first.
TEST(UnderstoodFramesTest, EveryLookCounts) {
    UnderstoodFrames known;
    Hills hills(64, 1024, 12);
    hills.understood(known);
    const auto understood_after = [&](std::size_t plane, int y) {
        const std::int64_t before = known.understood();
        hills.at(plane, 30, y) += 0.25f;
        hills.understood(known);
        return known.understood() - before;
    };
    EXPECT_EQ(understood_after(3, 8), 1);  // a row of the first look
    EXPECT_EQ(understood_after(3, 6), 1);  // of the second
    EXPECT_EQ(understood_after(0, 6), 0);  // which is at positions alone
    EXPECT_EQ(understood_after(3, 4), 0);
}

TEST(UnderstoodFramesTest, ThreadsThatBringOneFrameUnderstandItOnce) {
    UnderstoodFrames known;
    const Hills one(120, 300), two(120, 200);
    std::vector<std::thread> threads;
    std::atomic<int> wrong{0};
    for (int t = 0; t < 4; ++t)
        threads.emplace_back([&, t] {
            for (int k = 0; k < 8; ++k)
                if (!((t + k) % 2 == 0 ? one : two).understood(known).camera()) ++wrong;
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(wrong, 0);
    EXPECT_EQ(known.understood(), 2);
}

}  // namespace
}  // namespace relume
