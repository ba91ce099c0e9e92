// SPDX-License-Identifier: Apache-2.0
// The G-buffer by clips, held against the library on the same arrays.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "ofx_scene.h"

namespace relume::ofx::test {
namespace {

const SceneClips& scene() {
    static const SceneClips made;
    return made;
}

TEST(OfxClipsTest, GivesTheLibrarysPixels) {
    Host host;
    Node node(host, name::kContextGeneral);
    scene().connect(node);
    light_one(node);
    std::unique_ptr<Image> image;
    ASSERT_EQ(node.render({.window = scene().bounds}, image), kOk) << node.instance().message;
    const std::vector<float> wanted = scene().relit(rig_one(), kAllClips);
    EXPECT_EQ(pixels(*image), wanted);
    EXPECT_EQ(complaints(host), "");
    // A picture, and no even grey.
    EXPECT_GT(*std::max_element(wanted.begin(), wanted.end()), 0.2f);
}

TEST(OfxClipsTest, TilesAndThreadsGiveTheSameBits) {
    Host host;
    Node node(host, name::kContextGeneral);
    scene().connect(node);
    light_one(node);
    const std::vector<float> whole = scene().relit(rig_one(), kAllClips);
    std::vector<OfxRectI> tiles;
    for (int y = 0; y < scene().height; y += 19)
        for (int x = 0; x < scene().width; x += 37)
            tiles.push_back({x, y, std::min(x + 37, scene().width), std::min(y + 19, scene().height)});
    std::atomic<std::size_t> next{0};
    std::atomic<int> wrong{0};
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t)
        threads.emplace_back([&] {
            for (std::size_t k = next++; k < tiles.size(); k = next++) {
                std::unique_ptr<Image> image;
                if (node.render({.window = tiles[k]}, image) != kOk ||
                    pixels(*image) != crop(whole, scene().width, scene().bounds, tiles[k]))
                    ++wrong;
            }
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(wrong, 0);
    EXPECT_EQ(complaints(host), "");
}

TEST(OfxClipsTest, MissingNormalIsSaidByName) {
    Host host;
    Node node(host, name::kContextGeneral);
    scene().connect(node, {"Source", "BaseColor"});
    light_one(node);
    std::unique_ptr<Image> image;
    EXPECT_EQ(node.render({.window = scene().bounds}, image), kFailed);
    EXPECT_NE(node.instance().message.find("'Normal'"), std::string::npos) << node.instance().message;
    // Once it is connected, the message goes and the picture comes.
    scene().connect(node);
    EXPECT_EQ(node.render({.window = scene().bounds}, image), kOk);
    EXPECT_EQ(node.instance().message, "");
    EXPECT_EQ(pixels(*image), scene().relit(rig_one(), kAllClips));
    // Connected without an image, as Resolve has it.
    node.clip("Normal").has_image = false;
    EXPECT_EQ(node.render({.window = scene().bounds}, image), kFailed);
    EXPECT_NE(node.instance().message.find("'Normal'"), std::string::npos);
    EXPECT_EQ(complaints(host), "");
}

TEST(OfxClipsTest, MissingInputsAreAsIfTheyWereNotConnected) {
    Host host;
    Node node(host, name::kContextGeneral);
    scene().connect(node);
    light_one(node);
    for (const char* clip : {"Roughness", "Metallic", "BaseColor"}) node.clip(clip).has_image = false;
    std::unique_ptr<Image> image;
    ASSERT_EQ(node.render({.window = scene().bounds}, image), kOk) << node.instance().message;
    EXPECT_EQ(pixels(*image), scene().relit(rig_one(), {"Source", "Normal", "Position"}));
    EXPECT_EQ(complaints(host), "");
}

}  // namespace
}  // namespace relume::ofx::test
