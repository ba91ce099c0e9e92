// SPDX-License-Identifier: Apache-2.0
// Tiles of one frame: what is done once for all of them, and that it is done again where pixels have changed. The
// node's own objects, for their counts.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cmath>
#include <thread>

#include "ofx/clip_gbuffer.h"
#include "ofx_scene.h"

namespace relume::ofx {
extern "C" OfxPlugin* OfxGetPlugin(int nth);
}

namespace relume::ofx::test {
namespace {

constexpr int kWidth = 96, kHeight = 64;

const SceneClips& scene() {
    static const SceneClips made(kWidth, kHeight);
    return made;
}

/// `columns` × `rows` tiles of a frame.
std::vector<OfxRectI> tiles_of(const OfxRectI& frame, int columns, int rows) {
    const int width = frame.x2 - frame.x1, height = frame.y2 - frame.y1;
    std::vector<OfxRectI> tiles;
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i)
            tiles.push_back({frame.x1 + width * i / columns, frame.y1 + height * j / rows,
                             frame.x1 + width * (i + 1) / columns, frame.y1 + height * (j + 1) / rows});
    return tiles;
}

class OfxTilesTest : public testing::Test {
protected:
    void SetUp() override {
        ASSERT_EQ(node.loaded(), kOk);
        light_one(node);
    }
    void TearDown() override {
        EXPECT_EQ(complaints(host), "");
        EXPECT_TRUE(host.lent.empty());
    }

    /// Frames that were understood while `work` ran.
    template <class Work> std::int64_t understood(Work&& work) {
        const std::int64_t before = understood_frames().understood();
        work();
        return understood_frames().understood() - before;
    }

    /// Pixels that are not those of `whole`, an image of `frame`, over the tiles by several threads.
    std::size_t wrong_tiles(const std::vector<OfxRectI>& tiles, const std::vector<float>& whole, const OfxRectI& frame,
                            double scale = 1) {
        std::atomic<std::size_t> next{0}, wrong{0};
        std::vector<std::thread> threads;
        for (int t = 0; t < 4; ++t)
            threads.emplace_back([&] {
                for (std::size_t k = next++; k < tiles.size(); k = next++) {
                    std::unique_ptr<Image> tile;
                    if (node.render({.window = tiles[k], .scale = scale}, tile) != kOk ||
                        pixels(*tile) != crop(whole, frame.x2 - frame.x1, frame, tiles[k]))
                        ++wrong;
                }
            });
        for (std::thread& thread : threads) thread.join();
        return wrong;
    }

    std::vector<float> rendered(const OfxRectI& window) {
        EXPECT_EQ(node.render({.window = window}, image), kOk) << node.instance().message;
        return pixels(*image);
    }

    /// Every clip hands out the same memory each time, as the scene has it now.
    void keep_images() {
        for (const char* clip : kAllClips) node.clip(clip).lasting = node.clip(clip).image(0, 1);
    }

    Host host;
    Node node{host, name::kContextGeneral, OfxGetPlugin(0)};
    std::unique_ptr<Image> image;
};

TEST_F(OfxTilesTest, SixtyFourTilesAreUnderstoodOnce) {
    scene().connect(node);
    const std::vector<float> whole = scene().relit(rig_one(), kAllClips);
    const std::vector<OfxRectI> tiles = tiles_of(scene().bounds, 8, 8);
    ASSERT_EQ(tiles.size(), 64u);
    EXPECT_EQ(understood([&] { EXPECT_EQ(wrong_tiles(tiles, whole, scene().bounds), 0u); }), 1);
    // Nor again at another time, with another light, nor for the whole.
    node.set("light1_exposure", 1.5);
    EXPECT_EQ(understood([&] { rendered(scene().bounds); }), 0);
    Rig rig = rig_one();
    rig.set("light.sun.exposure", "1.5");
    EXPECT_EQ(pixels(*image), scene().relit(rig, kAllClips));
    // What is forgotten is understood again.
    EXPECT_EQ(node.act(name::kActionPurgeCaches, &node.instance()), kOk);
    EXPECT_EQ(understood([&] { rendered(scene().bounds); }), 1);
}

TEST_F(OfxTilesTest, ChangedPixelsInTheSameMemoryAreSeen) {
    scene().connect(node);
    keep_images();
    const std::vector<float> first = scene().relit(rig_one(), kAllClips);
    EXPECT_EQ(understood([&] { EXPECT_EQ(rendered(scene().bounds), first); }), 1);
    EXPECT_EQ(understood([&] { EXPECT_EQ(rendered(scene().bounds), first); }), 0);

    // Normals that are packed into 0..1 from now on: another convention, in the same place.
    SceneClips packed = scene();
    Image& normals = *node.clip("Normal").lasting;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            for (int c = 0; c < 3; ++c) {
                const float stored = (normals.number(x, y, c) + 1) / 2;
                normals.put(x, y, c, stored);
                packed.channels["normal"][static_cast<std::size_t>(c)]
                               [static_cast<std::size_t>((kHeight - 1 - y) * kWidth + x)] = stored;
            }
    EXPECT_EQ(understood([&] { EXPECT_EQ(rendered(scene().bounds), packed.relit(rig_one(), kAllClips)); }), 1);
    EXPECT_NE(pixels(*image), first);

    // The camera walks on: positions elsewhere.
    SceneClips moved = packed;
    Image& positions = *node.clip("Position").lasting;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const auto at = static_cast<std::size_t>((kHeight - 1 - y) * kWidth + x);
            const float value = positions.number(x, y, 0) + (positions.number(x, y, 0) != 0 ? 0.5f : 0.f);
            positions.put(x, y, 0, value);
            moved.channels["position"][0][at] = value;
        }
    EXPECT_EQ(understood([&] { EXPECT_EQ(rendered(scene().bounds), moved.relit(rig_one(), kAllClips)); }), 1);

    // One pixel of the colour: nothing new to understand, and the picture has it.
    SceneClips painted = moved;
    Image& colors = *node.clip("BaseColor").lasting;
    colors.put(50, 20, 1, 0.9f);
    painted.channels["base_color"][1][static_cast<std::size_t>((kHeight - 1 - 20) * kWidth + 50)] = 0.9f;
    EXPECT_EQ(understood([&] { EXPECT_EQ(rendered(scene().bounds), painted.relit(rig_one(), kAllClips)); }), 0);
}

TEST_F(OfxTilesTest, EveryPixelThatDetectionLooksAtCounts) {
    scene().connect(node);
    keep_images();
    rendered(scene().bounds);
    // One normal in each row of the frame, one by one: 64 rows are all that detection may look at here.
    Image& normals = *node.clip("Normal").lasting;
    std::int64_t seen = 0;
    for (int y = 0; y < kHeight; ++y) {
        normals.put(y, y, 2, 0.123f);
        seen += understood([&] { rendered({0, 0, 8, 8}); });
    }
    EXPECT_EQ(seen, kHeight);
}

TEST_F(OfxTilesTest, AnotherRigUnderstandsAnew) {
    scene().connect(node);
    rendered(scene().bounds);
    node.choose("normal_space", "camera");
    EXPECT_EQ(understood([&] { rendered(scene().bounds); }), 1);
    node.choose("normal_space", "auto");
    EXPECT_EQ(understood([&] { rendered(scene().bounds); }), 0);
    EXPECT_EQ(pixels(*image), scene().relit(rig_one(), kAllClips));
}

TEST_F(OfxTilesTest, TakesOfATileWhatTheTileNeeds) {
    for (const char* clip : kAllClips) node.clip(clip).depth = name::kDepthShort;
    scene().connect(node);
    keep_images();
    const auto filled = [&](const OfxRectI& window) {
        const std::int64_t before = filled_pixels();
        rendered(window);
        return filled_pixels() - before;
    };
    filled(scene().bounds);
    // A column and a row more of a tile, of six clips.
    const std::int64_t small = filled({40, 20, 50, 30});
    EXPECT_EQ(filled({40, 20, 51, 30}) - small, 6 * 12);
    EXPECT_EQ(filled({40, 20, 50, 31}) - small, 6 * (10 + 2 * MemoryFrame::kReach));
    // Detection looks at half of the clips.
    EXPECT_LT(small, 3 * kWidth * kHeight + 6 * 12 * 26 + 1);
}

/// Clips whose images do not reach to the frame's edge, so that they are copied, with faces that meet in pixels whose
/// normals are means: those look at their neighbours.
TEST_F(OfxTilesTest, TilesOfCopiesSeeTheirNeighbours) {
    constexpr int kTall = 300;  // detection looks at some hundred rows
    SceneClips creased(kWidth, kTall);
    for (int y = 0; y < kTall; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const bool across = x % 7 == 0, down = y % 5 == 0;
            const float side = (x / 7 + y / 5) % 2 == 0 ? 1.f : 0.f;
            const std::array<float, 3> normal =
                across || down ? std::array{0.55f, 0.f, 0.45f} : std::array{side, 0.f, 1 - side};
            for (std::size_t c = 0; c < 3; ++c)
                creased.channels["normal"][c][static_cast<std::size_t>(y * kWidth + x)] = normal[c];
        }
    // Between any two tiles another frame goes through the same memory, there and around.
    constexpr int kAround = 2 * MemoryFrame::kReach;
    for (const char* clip : kAllClips) {
        const Picture picture = creased.picture(clip);
        const Picture other(creased.bounds,
                            [](int x, int, int c) { return c == 1 ? 1.f : static_cast<float>(x % 2) * 0.1f; });
        node.connect(clip, [=](double time) { return time == 0 ? picture : other; });
    }
    node.choose("gbuffer_normal_variance", "on");
    node.clip("Source").region_of_definition = OfxRectD{-5, -4, kWidth + 7.0, kTall + 3.0};
    const OfxRectI frame{-5, -4, kWidth + 7, kTall + 3};
    const std::vector<float> whole = rendered(frame);
    for (const auto& [columns, rows] : {std::pair(1, 91), std::pair(26, 3)})
        for (const OfxRectI& tile : tiles_of(frame, columns, rows)) {
            const OfxRectI around = {std::max(tile.x1 - kAround, frame.x1), std::max(tile.y1 - kAround, frame.y1),
                                     std::min(tile.x2 + kAround, frame.x2), std::min(tile.y2 + kAround, frame.y2)};
            ASSERT_EQ(node.render({.time = 1, .window = around}, image), kOk) << node.instance().message;
            ASSERT_EQ(rendered(tile), crop(whole, kWidth + 12, frame, tile)) << tile.x1 << " " << tile.y1;
        }
    // And that is the library's picture of them.
    Rig rig = rig_one();
    rig.gbuffer.normal_variance = NormalVariance::on;
    MemoryFrame larger{{-5, 1080 - kTall - 3, kWidth + 12, kTall + 7}, {0, 0, 1920, 1080}};
    Arrays arrays;
    for (const auto& [name, planes] : creased.arrays(kAllClips))
        for (const std::vector<float>& plane : planes) {
            std::vector<float>& wide = arrays[name].emplace_back();
            wide.resize(static_cast<std::size_t>((kWidth + 12) * (kTall + 7)));
            for (int y = 0; y < kTall; ++y)
                for (int x = 0; x < kWidth; ++x)
                    wide[static_cast<std::size_t>((y + 3) * (kWidth + 12) + x + 5)] =
                        plane[static_cast<std::size_t>(y * kWidth + x)];
        }
    EXPECT_EQ(whole, relit(arrays, larger, rig, rig.gbuffer));
}

TEST_F(OfxTilesTest, TilesOfAProxyWithIds) {
    scene().connect(node);
    node.connect("IDs", Picture(scene().bounds, [](int x, int y, int c) {
                     return c == 3 ? 1.f : static_cast<float>((x / 7 + y / 5 + c) % 4);
                 }));
    node.set("overrides", "shader.0.use = unlit\nshader.0.object_id = [2]\nshader.0.emission = [9, 0, 0]");
    const OfxRectI frame{0, 0, kWidth / 2, kHeight / 2};
    ASSERT_EQ(node.render({.window = frame, .scale = 0.5}, image), kOk) << node.instance().message;
    const std::vector<float> whole = pixels(*image);
    EXPECT_EQ(understood([&] { EXPECT_EQ(wrong_tiles(tiles_of(frame, 8, 8), whole, frame, 0.5), 0u); }), 0);
}

}  // namespace
}  // namespace relume::ofx::test
