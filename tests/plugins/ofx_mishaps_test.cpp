// SPDX-License-Identifier: Apache-2.0
// What goes wrong beside the node, while it renders: the host stays up, is told, and gets the right picture next time.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include "io/exr.h"
#include "ofx_scene.h"
#include "relume/relight.h"
#include "relume/scenes.h"

namespace relume::ofx::test {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 480, kHeight = 320;
constexpr OfxRectI kFrame{0, 0, kWidth, kHeight};

class OfxMishapsTest : public testing::Test {
protected:
    void SetUp() override {
        folder = fs::temp_directory_path() / ("relume_mishaps_" + std::to_string(getpid()));
        fs::remove_all(folder);
        fs::create_directories(folder);
    }
    void TearDown() override {
        fs::remove_all(folder);
        EXPECT_EQ(complaints(host), "");
    }

    fs::path write(const std::string& name, double time) const {
        SceneOptions options;
        options.width = kWidth;
        options.height = kHeight;
        options.samples = 1;
        options.time = time;
        write_scene("sdf", folder / name, options);
        return folder / name;
    }

    /// So many lights that a frame takes many times as long as the host is left alone.
    fs::path write_lights() const {
        std::ofstream file(folder / "lights.relume");
        for (int k = 0; k < 300; ++k)
            file << "[[light]]\ntype = \"spot\"\nposition = [" << 0.03 * k - 5
                 << ", 3, 1]\ndirection = [0.1, -1, -0.2]\ncone_angle = 120\nintensity = 0.01\n";
        return folder / "lights.relume";
    }

    static std::vector<float> by_library(const fs::path& file, const Rig& rig) {
        const GBuffer gbuffer = GBuffer::read(file, rig.gbuffer);
        const Window& window = gbuffer.data_window();
        std::vector<float> rgba(std::size_t{4} * static_cast<std::size_t>(window.width) *
                                static_cast<std::size_t>(window.height));
        std::vector<Plane> planes;
        for (std::size_t k = 0; k < 4; ++k)
            planes.push_back({reinterpret_cast<std::byte*>(rgba.data() + k), PixelType::float32, 16,
                              std::ptrdiff_t{16} * window.width});
        relight(gbuffer, rig, {{"beauty", planes}});
        return rgba;
    }

    OfxStatus render(Node& node, double time = 0) {
        std::unique_ptr<Image> image;
        const OfxStatus status = node.render({.time = time, .window = kFrame}, image);
        got = pixels(*image);
        return status;
    }

    fs::path folder;
    Host host;
    std::vector<float> got;
};

TEST_F(OfxMishapsTest, FileThatChangesWhileItIsRendered) {
    const fs::path one = write("one.exr", 0), two = write("two.exr", 1), file = folder / "file.exr";
    const fs::path lights = write_lights();
    const std::vector<float> wanted = by_library(two, Rig::load(lights));
    Node node(host, name::kContextGenerator);
    node.set("gbuffer_file", file.string());
    node.set("rig", lights.string());
    const auto overwrite = [&](const fs::path& with) {
        fs::copy_file(with, folder / "next.exr", fs::copy_options::overwrite_existing);
        fs::rename(folder / "next.exr", file);
    };
    // The host is asked whether to stop for the first time when the frame is under way.
    overwrite(one);
    int asked = 0;
    node.instance().abort = [&] {
        if (asked++ == 0) overwrite(two);
        return false;
    };
    ASSERT_EQ(render(node), kOk) << node.instance().message;
    EXPECT_GT(asked, 1);
    EXPECT_EQ(got, wanted);

    // One that never comes to rest, however seldom the host is asked.
    node.instance().abort = nullptr;
    overwrite(one);
    std::atomic<bool> restless{true};
    std::thread writer([&] {
        while (restless) {
            overwrite(two);
            overwrite(one);
        }
    });
    EXPECT_EQ(render(node), kFailed);
    restless = false;
    writer.join();
    EXPECT_NE(node.instance().message.find("file.exr: changes while it is being read"), std::string::npos)
        << node.instance().message;

    overwrite(two);
    ASSERT_EQ(render(node), kOk) << node.instance().message;
    EXPECT_EQ(node.instance().message, "");
    EXPECT_EQ(got, wanted);
}

TEST_F(OfxMishapsTest, FileThatGoesWhileItIsRendered) {
    const fs::path file = write("file.exr", 0), kept = write("kept.exr", 0);
    const fs::path lights = write_lights();
    Node node(host, name::kContextGenerator);
    node.set("gbuffer_file", file.string());
    node.set("rig", lights.string());
    node.instance().abort = [&] {
        fs::remove(file);
        return false;
    };
    EXPECT_EQ(render(node), kFailed);
    EXPECT_NE(node.instance().message.find("file.exr"), std::string::npos) << node.instance().message;
    node.instance().abort = nullptr;
    fs::rename(kept, file);
    ASSERT_EQ(render(node), kOk) << node.instance().message;
    EXPECT_EQ(got, by_library(file, Rig::load(lights)));
}

TEST_F(OfxMishapsTest, CacheThatIsFull) {
    std::vector<std::vector<float>> wanted;
    for (int frame = 0; frame < 4; ++frame)
        wanted.push_back(by_library(write("shot.000" + std::to_string(frame) + ".exr", 0.7 * frame), rig_one()));
    for (const char* megabytes : {"1", "0"}) {
        ASSERT_EQ(setenv("RELUME_CACHE_MB", megabytes, 1), 0);
        Node node(host, name::kContextGenerator);
        node.set("gbuffer_file", (folder / "shot.####.exr").string());
        light_one(node);
        std::atomic<int> wrong{0};
        std::vector<std::thread> threads;
        for (int t = 0; t < 3; ++t)
            threads.emplace_back([&, t] {
                for (int k = 0; k < 8; ++k) {
                    const int frame = (t + k / 2) % 4;
                    const OfxRectI tile{(k % 2) * 200, 30, 280 + (k % 2) * 200, 310};
                    std::unique_ptr<Image> image;
                    if (node.render({.time = 1.0 * frame, .window = tile}, image) != kOk ||
                        pixels(*image) != crop(wanted[static_cast<std::size_t>(frame)], kWidth, kFrame, tile))
                        ++wrong;
                }
            });
        for (std::thread& thread : threads) thread.join();
        EXPECT_EQ(wrong, 0) << megabytes << " MB: " << node.instance().message;
    }
    unsetenv("RELUME_CACHE_MB");
}

TEST_F(OfxMishapsTest, TwoFramesOfClipsAtOnce) {
    const SceneClips scene;
    SceneClips dark = scene;
    for (std::vector<float>& plane : dark.channels["base_color"])
        for (float& value : plane) value *= 0.25f;
    Node node(host, name::kContextGeneral);
    light_one(node);
    for (const char* clip : kAllClips) {
        const Picture even = scene.picture(clip), odd = dark.picture(clip);
        node.connect(clip, [=](double time) { return time == 0 ? even : odd; });
    }
    const std::array wanted{scene.relit(rig_one(), kAllClips), dark.relit(rig_one(), kAllClips)};
    ASSERT_NE(wanted[0], wanted[1]);
    std::atomic<int> wrong{0};
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < 2; ++t)
        threads.emplace_back([&, t] {
            for (int k = 0; k < 8; ++k) {
                std::unique_ptr<Image> image;
                if (node.render({.time = static_cast<double>(t), .window = scene.bounds}, image) != kOk ||
                    pixels(*image) != wanted[t])
                    ++wrong;
            }
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(wrong, 0) << node.instance().message;
}

TEST_F(OfxMishapsTest, HostWithoutAnImageToRenderInto) {
    const fs::path file = write("file.exr", 0);
    for (const char* context : {name::kContextGenerator, name::kContextGeneral}) {
        Node node(host, context);
        node.set("gbuffer_file", file.string());
        light_one(node);
        node.clip(name::kClipOutput).has_image = false;
        EXPECT_EQ(render(node), kFailed);
        EXPECT_NE(node.instance().message.find("no image to render into"), std::string::npos);
        node.clip(name::kClipOutput).has_image = true;
        ASSERT_EQ(render(node), kOk) << node.instance().message;
        EXPECT_EQ(node.instance().message, "");
        EXPECT_EQ(got, by_library(file, rig_one()));
    }
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST_F(OfxMishapsTest, NoMemoryForTheFrame) {
    // More than an allocator has at hand.
    const int width = 2800, height = 2000;
    const fs::path file = folder / "large.exr";
    {
        io::Header header;
        io::Part& part = header.parts.emplace_back();
        part.data_window = part.display_window = {0, 0, width, height};
        for (const char* channel : {"N.X", "N.Y", "N.Z"}) part.channels.push_back({channel, PixelType::half});
        const std::vector<float> zero(static_cast<std::size_t>(width)), one(zero.size(), 1.f);
        const auto row = [](const std::vector<float>& values) {
            return ConstPlane{reinterpret_cast<const std::byte*>(values.data()), PixelType::float32, 4, 0};
        };
        io::ExrWriter writer(file, header);
        writer.write(0, 0, height, std::vector<ConstPlane>{row(zero), row(zero), row(one)});
        writer.commit();
    }
    const OfxRectI frame{0, 0, width, height};
    Node node(host, name::kContextGenerator);
    node.set("gbuffer_file", file.string());
    light_one(node);
    std::unique_ptr<Image> image = std::make_unique<Image>(&host);
    image->bounds = frame;
    image->allocate(0, false);
    std::size_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    rlimit before{};
    ASSERT_EQ(getrlimit(RLIMIT_AS, &before), 0);
    rlimit less = before;
    less.rlim_cur = pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE)) + (std::size_t{1} << 20);
    ASSERT_EQ(setrlimit(RLIMIT_AS, &less), 0);
    const OfxStatus status = node.render_into({.window = frame}, *image);
    ASSERT_EQ(setrlimit(RLIMIT_AS, &before), 0);
    EXPECT_TRUE(status == kErrMemory || status == kFailed) << status;
    EXPECT_NE(node.instance().message, "");
    ASSERT_EQ(node.render_into({.window = frame}, *image), kOk) << node.instance().message;
    EXPECT_EQ(node.instance().message, "");
    EXPECT_EQ(pixels(*image), by_library(file, rig_one()));
}
#endif

TEST_F(OfxMishapsTest, HostsOfAnotherVersion) {
    const fs::path file = write("file.exr", 0);
    const Binary binary;
    // What a host looks at before it goes on.
    EXPECT_EQ(binary.plugin()->apiVersion, 1);
    EXPECT_STREQ(binary.plugin()->pluginApi, name::kImageEffectApi);
    const auto get = reinterpret_cast<OfxPlugin* (*)(int)>(binary.symbol("OfxGetPlugin"));
    EXPECT_EQ(get(-1), nullptr);
    EXPECT_EQ(get(1), nullptr);
    // Hosts that have the suites in versions that the node does not know, before and after.
    for (const int version : {0, 2, 3})
        for (const char* suite : {name::kPropertySuite, name::kImageEffectSuite, name::kParameterSuite}) {
            Host other({.suite_versions = {{suite, version}}});
            Node node(other, "");
            EXPECT_EQ(node.loaded(), kErrMissingHostFeature) << suite << " " << version;
            EXPECT_NE(node.act(name::kActionDescribe, nullptr), kOk);
        }
    // Messages are a luxury.
    Host mute({.suite_versions = {{name::kMessageSuite, 3}}});
    {
        Node node(mute, name::kContextGenerator);
        node.set("gbuffer_file", (folder / "none.exr").string());
        light_one(node);
        EXPECT_EQ(render(node), kFailed);
        node.set("gbuffer_file", file.string());
        EXPECT_EQ(render(node), kOk);
        EXPECT_EQ(got, by_library(file, rig_one()));
    }
    Node node(host, name::kContextGenerator);
    node.set("gbuffer_file", file.string());
    light_one(node);
    EXPECT_EQ(render(node), kOk) << node.instance().message;
    EXPECT_EQ(got, by_library(file, rig_one()));
    Host::current = &host;
}

}  // namespace
}  // namespace relume::ofx::test
