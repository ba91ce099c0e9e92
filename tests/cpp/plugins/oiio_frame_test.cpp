// SPDX-License-Identifier: Apache-2.0
// What the OpenImageIO plugin is made of, without OpenImageIO: names, and frames that are rendered where they are read.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <random>
#include <thread>

#include "gbuffer_files.h"
#include "oiio/relit_frame.h"
#include "oiio/rig_name.h"
#include "relume/error.h"
#include "relume/scenes.h"

namespace relume::oiio {
namespace {

TEST(RigName, IsTheFileAndItsSettings) {
    EXPECT_FALSE(parse_name("shot.exr"));
    EXPECT_FALSE(parse_name("relume"));
    EXPECT_FALSE(parse_name(".relume"));
    EXPECT_FALSE(parse_name("shot.relume.txt"));
    EXPECT_FALSE(parse_name("shot.exr?name=1"));
    EXPECT_EQ(parse_name("a/Shot.RELUME")->path, "a/Shot.RELUME");
    EXPECT_TRUE(parse_name("shot.relume")->settings.empty());
    const auto name = parse_name("a?b/shot.relume?light.key.exposure=1&frame=1003&&camera.fov=3%309%2e6");
    ASSERT_TRUE(name);
    EXPECT_EQ(name->path, "a?b/shot.relume");
    const std::vector<std::pair<std::string, std::string>> wanted{
        {"light.key.exposure", "1"}, {"frame", "1003"}, {"camera.fov", "309.6"}};
    EXPECT_EQ(name->settings, wanted);
    EXPECT_EQ(parse_name("s.relume?a=100%&b=%zz")->settings[1].second, "%zz");
    EXPECT_EQ(parse_name("a?b/s.relume?gbuffer.file=what?.exr")->path, "a?b/s.relume");
    EXPECT_EQ(parse_name("a?b/s.relume?gbuffer.file=what?.exr")->settings[0].second, "what?.exr");
}

class RelitFrameTest : public testing::Test {
protected:
    void SetUp() override {
        folder_ =
            std::filesystem::temp_directory_path() / ("relume_oiio_" + std::to_string(::getpid()) +
                                                      testing::UnitTest::GetInstance()->current_test_info()->name());
        std::filesystem::create_directories(folder_);
        write(1001, 0);
        rig("file = 'shot.####.exr'\nframe = 1001");
    }
    void TearDown() override {
        std::filesystem::remove_all(folder_);
        BlockCache::instance().set_limit(std::size_t{1} << 30);
    }

    void write(int frame, double time) const {
        SceneOptions options;
        options.width = 200;
        options.height = 150;
        options.samples = 1;
        options.time = time;
        write_scene("sdf", folder_ / ("shot." + std::to_string(frame) + ".exr"), options);
    }
    /// The same surface in every pixel, but for normals without a number, in all rows or all but those of one strip.
    void write_nan(int frame, bool all) const {
        const auto normal = [all](int, int y) { return all || y < kTile ? std::nan("") : 0.6; };
        const auto grey = [](int, int) { return 0.5; };
        test::MadePart part;
        part.channels = {{"R", grey}, {"G", grey}, {"B", grey}, {"N.X", normal}, {"N.Y", normal}, {"N.Z", normal}};
        test::write_exr(folder_ / ("shot." + std::to_string(frame) + ".exr"), {part},
                        {{0, 0, 200, 150}, {0, 0, 200, 150}});
    }
    void rig(const std::string& gbuffer) const {
        std::ofstream(path())
            << "version = 1\n[gbuffer]\n"
            << gbuffer
            << "\n[[light]]\nname = 'key'\ntype = 'sun'\ndirection = [-0.6, -0.8, 0.5]\nirradiance = 2.0\n"
               "[output]\naovs = ['diffuse', 'light:key']\n";
    }
    std::filesystem::path path() const { return folder_ / "shot.relume"; }
    std::shared_ptr<RelitFrame> frame(const std::string& query = "") const {
        return RelitFrame::get(load_rig(*parse_name(path().string() + query)));
    }

    /// All of one picture, by relight() itself.
    static std::vector<std::byte> whole(const Rig& rig, const RelitFrame& frame, std::size_t picture) {
        const GBuffer gbuffer = GBuffer::read(*rig.main_file(), rig.gbuffer);
        const int components = frame.pictures()[picture].components;
        const std::size_t pixel = size_of(frame.type()) * static_cast<std::size_t>(components);
        std::vector<std::byte> out(pixel * 200 * 150);
        std::vector<Plane> planes;
        for (int k = 0; k < components; ++k)
            planes.push_back({out.data() + static_cast<std::size_t>(k) * size_of(frame.type()), frame.type(),
                              static_cast<std::ptrdiff_t>(pixel), static_cast<std::ptrdiff_t>(200 * pixel)});
        relight(gbuffer, rig, {{aovs(rig)[picture].name, planes}});
        return out;
    }

    /// Tiles in a random order, each from a call of its own.
    static std::vector<std::byte> by_tiles(RelitFrame& frame, int picture, unsigned seed) {
        const std::size_t pixel =
            size_of(frame.type()) *
            static_cast<std::size_t>(frame.pictures()[static_cast<std::size_t>(picture)].components);
        std::vector<std::byte> out(pixel * 200 * 150);
        std::vector<std::pair<int, int>> tiles;
        for (int y = 0; y < 150; y += kTile)
            for (int x = 0; x < 200; x += kTile) tiles.emplace_back(x, y);
        std::shuffle(tiles.begin(), tiles.end(), std::mt19937(seed));
        for (const auto& [x, y] : tiles)
            frame.read(picture, x, std::min(x + kTile, 200), y, std::min(y + kTile, 150),
                       out.data() + (static_cast<std::size_t>(y) * 200 + static_cast<std::size_t>(x)) * pixel,
                       static_cast<std::ptrdiff_t>(200 * pixel));
        return out;
    }

    std::filesystem::path folder_;
};

TEST_F(RelitFrameTest, TilesHaveTheBitsOfTheWhole) {
    for (const std::string query : {"", "?output.type=float"}) {
        const Rig rig = load_rig(*parse_name(path().string() + query));
        const auto relit = frame(query);
        ASSERT_EQ(relit->pictures().size(), 3u);
        EXPECT_EQ(relit->pictures()[0].components, 4);
        EXPECT_EQ(relit->pictures()[2].name, "light_key");
        for (unsigned p = 0; p < 3; ++p)
            EXPECT_EQ(by_tiles(*relit, static_cast<int>(p), p), whole(rig, *relit, p)) << query << " " << p;
        EXPECT_EQ(relit->rendered_rows(), 150);  // once, for all pictures
    }
}

TEST_F(RelitFrameTest, TheRowsAskedForAreRendered) {
    const auto relit = frame();
    std::vector<std::byte> tile(8 * kTile * kTile);
    relit->read(0, 64, 128, 64, 128, tile.data(), 8 * kTile);
    EXPECT_EQ(relit->rendered_rows(), kTile);
    relit->read(1, 0, 64, 70, 71, tile.data(), 6 * kTile);
    EXPECT_EQ(relit->rendered_rows(), kTile);
    relit->read(0, 0, 1, 149, 150, tile.data(), 8);
    EXPECT_EQ(relit->rendered_rows(), kTile + 150 - 128);
}

TEST_F(RelitFrameTest, ManyThreadsRenderOnce) {
    const auto relit = frame();
    std::vector<std::vector<std::byte>> read(8);
    {
        std::vector<std::jthread> threads;
        for (unsigned k = 0; k < read.size(); ++k)
            threads.emplace_back([&, k] { read[k] = by_tiles(*frame(), static_cast<int>(k % 2), k); });
    }
    EXPECT_EQ(relit->rendered_rows(), 150);
    for (unsigned k = 2; k < read.size(); ++k) EXPECT_EQ(read[k], read[k % 2]);
}

TEST_F(RelitFrameTest, AFullCacheCostsTimeAlone) {
    const auto relit = frame();
    const std::vector<std::byte> first = by_tiles(*relit, 0, 1);
    const std::size_t strip = 200 * kTile * 2 * (4 + 3 + 3);
    BlockCache::instance().set_limit(strip);
    EXPECT_LE(BlockCache::instance().bytes(), strip);
    std::vector<std::vector<std::byte>> read(4);
    {
        std::vector<std::jthread> threads;
        for (unsigned k = 0; k < read.size(); ++k) threads.emplace_back([&, k] { read[k] = by_tiles(*relit, 0, k); });
    }
    for (const auto& pixels : read) EXPECT_EQ(pixels, first);
    EXPECT_LE(BlockCache::instance().bytes(), strip);
    EXPECT_GT(relit->rendered_rows(), 150);
    BlockCache::instance().set_limit(0);
    EXPECT_EQ(by_tiles(*relit, 0, 7), first);
}

TEST_F(RelitFrameTest, MemoryIsUsedAgain) {
    BlockCache& cache = BlockCache::instance();
    const std::byte* first = nullptr;
    {
        const BlockMemory memory(123456);
        first = memory.data();
    }
    EXPECT_GE(cache.spare_bytes(), 123456u);
    {
        const BlockMemory memory(123456), another(123456);
        EXPECT_EQ(memory.data(), first);
        EXPECT_NE(another.data(), first);
    }
    // Frames that follow one another: never more than the limit in all, and nothing of one shows in the next.
    const std::size_t picture = 200 * 150 * 2 * (4 + 3 + 3), limit = 2 * picture + picture / 2;
    cache.set_limit(0);
    cache.set_limit(limit);
    std::vector<std::vector<std::byte>> read;
    for (int pass = 0; pass < 2; ++pass)
        for (const char* setting : {"?light.key.exposure=1", "?light.key.exposure=2", "?light.key.exposure=3"}) {
            read.push_back(by_tiles(*frame(setting), 0, 1));
            EXPECT_LE(cache.bytes() + cache.spare_bytes(), limit);
        }
    EXPECT_NE(read[0], read[1]);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(read[k], read[k + 3]);
    cache.set_limit(0);
    EXPECT_EQ(cache.spare_bytes(), 0u);
}

TEST_F(RelitFrameTest, WhatChangedIsAnotherFrame) {
    const auto relit = frame();
    EXPECT_EQ(frame(), relit);
    EXPECT_NE(frame("?light.key.exposure=1"), relit);
    const std::vector<std::byte> before = by_tiles(*relit, 0, 1);
    write(1001, 1);
    const auto changed = frame();
    EXPECT_NE(changed, relit);
    EXPECT_NE(by_tiles(*changed, 0, 1), before);
    rig("file = 'shot.####.exr'\nframe = 1001\nnormal_variance = 'off'");
    EXPECT_NE(frame(), changed);
}

TEST_F(RelitFrameTest, FramesOfASequence) {
    write(1002, 1);
    const auto first = frame(), second = frame("?frame=1002");
    EXPECT_NE(by_tiles(*first, 0, 1), by_tiles(*second, 0, 1));
    EXPECT_EQ(frame("?frame=1002.0"), second);
    EXPECT_EQ(frame("?gbuffer.frame=1002"), second);
}

TEST_F(RelitFrameTest, AFrameOfNanIsRefusedHoweverItIsRead) {
    write_nan(3001, true);
    write_nan(3002, false);
    const auto refusal = [](const std::function<void()>& read) {
        try {
            read();
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    const std::string words = "normal is NaN or infinite in all 30000 pixels";
    std::vector<std::byte> out(std::size_t{200} * 150 * 8);
    const auto whole_of = [&](RelitFrame& of) { of.read(0, 0, 200, 0, 150, out.data(), 200 * 8); };
    EXPECT_NE(refusal([&] { whole_of(*frame("?frame=3001")); }).find(words), std::string::npos);
    // By strips it shows with the last of them, and from then on.
    const auto strips = frame("?frame=3001&light.key.exposure=1");
    for (int y : {64, 128, 64}) EXPECT_EQ(refusal([&] { strips->read(0, 0, 200, y, y + 1, out.data(), 0); }), "");
    for (int y : {0, 64, 0})
        EXPECT_NE(refusal([&] { strips->read(0, 0, 200, y, y + 1, out.data(), 0); }).find(words), std::string::npos);
    // A part of a frame may well have no number.
    const auto partly = frame("?frame=3002");
    EXPECT_EQ(refusal([&] { by_tiles(*partly, 0, 3); }), "");
    EXPECT_EQ(refusal([&] { whole_of(*frame("?frame=3002&light.key.exposure=1")); }), "");
}

TEST_F(RelitFrameTest, ErrorsSayWhat) {
    const auto says = [&](const std::string& query, const std::string& words) {
        try {
            frame(query);
            ADD_FAILURE() << query << " is no error";
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
        }
    };
    says("?light.kye.exposure=1", "'key'");
    says("?frame=ten", "'ten'");
    says("?frame=1003", "shot.1003.exr");
    says("?gbuffer.channels.normal=nothing", "nothing");
    rig("file = 'shot.####.exr'");
    says("", "say which frame");
    rig("");
    says("", "names no G-buffer");
    std::ofstream(path()) << "version = 1\n[[light]\n";
    says("", "shot.relume:2");
    std::filesystem::remove(path());
    says("", "shot.relume");
}

TEST_F(RelitFrameTest, AChangeInTheMiddleIsToldAndForgotten) {
    const auto size = std::filesystem::file_size(folder_ / "shot.1001.exr");
    std::filesystem::copy_file(folder_ / "shot.1001.exr", folder_ / "whole");
    const auto relit = frame();
    std::vector<std::byte> tile(8 * kTile * kTile);
    EXPECT_NO_THROW(relit->read(0, 0, 64, 0, 64, tile.data(), 8 * kTile));
    // Somebody writes into the file while it is open: what was read before stays, the rest would be of another frame.
    std::filesystem::resize_file(folder_ / "shot.1001.exr", size * 3 / 4);
    EXPECT_NO_THROW(relit->read(0, 0, 64, 0, 64, tile.data(), 8 * kTile));
    for (int again = 0; again < 2; ++again) {
        try {
            relit->read(0, 0, 64, 86, 150, tile.data(), 8 * kTile);
            ADD_FAILURE() << "half a frame";
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find("shot.1001.exr: changed on disk"), std::string::npos)
                << error.what();
        }
    }
    std::filesystem::rename(folder_ / "whole", folder_ / "shot.1001.exr");
    EXPECT_NO_THROW(frame()->read(0, 0, 64, 86, 150, tile.data(), 8 * kTile));
}

}  // namespace
}  // namespace relume::oiio
