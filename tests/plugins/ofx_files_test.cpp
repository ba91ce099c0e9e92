// SPDX-License-Identifier: Apache-2.0
// The G-buffer by file, in every context: sequences, proxies, files that change or are wrong, several renders at once.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <clocale>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <thread>

#include "io/exr.h"
#include "ofx_scene.h"
#include "relume/error.h"
#include "relume/relight.h"
#include "relume/scenes.h"

namespace relume::ofx::test {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 80, kHeight = 48;
constexpr OfxRectI kFrame{0, 0, kWidth, kHeight};

class OfxFilesTest : public testing::Test {
protected:
    void SetUp() override {
        folder = fs::temp_directory_path() / ("relume_ofx_" + std::to_string(getpid()));
        fs::remove_all(folder);
        fs::create_directories(folder);
    }
    void TearDown() override {
        EXPECT_EQ(complaints(host), "");
        fs::remove_all(folder);
    }

    fs::path write(const std::string& name, double time = 0, int samples = 4) const {
        SceneOptions options;
        options.width = kWidth;
        options.height = kHeight;
        options.samples = samples;
        options.time = time;
        write_scene("sdf", folder / name, options);
        return folder / name;
    }

    /// As the command line and Python relight a file.
    static std::vector<float> by_library(const fs::path& path, const Rig& rig, const std::string& picture = "beauty") {
        const GBuffer gbuffer = GBuffer::read(path, rig.gbuffer);
        const Window& window = gbuffer.data_window();
        std::vector<float> rgba(std::size_t{4} * static_cast<std::size_t>(window.width) *
                                static_cast<std::size_t>(window.height));
        std::vector<Plane> planes;
        for (std::size_t k = 0; k < (picture == "beauty" ? 4u : 3u); ++k)
            planes.push_back({reinterpret_cast<std::byte*>(rgba.data() + k), PixelType::float32, 16,
                              std::ptrdiff_t{16} * window.width});
        relight(gbuffer, rig, {{picture, planes}});
        return rgba;
    }

    OfxStatus render(Node& node, const RenderJob& job, std::vector<float>& result) {
        std::unique_ptr<Image> image;
        const OfxStatus status = node.render(job, image);
        result = pixels(*image);
        return status;
    }

    fs::path folder;
    Host host;
    const std::string rig_file = std::string(RELUME_SOURCE_DIR) + "/examples/rigs/sdf.relume";
    std::vector<float> got;
};

TEST_F(OfxFilesTest, EveryContextGivesTheCommandLinesPixels) {
    const fs::path file = write("shot.exr");
    const std::vector<float> wanted = by_library(file, Rig::load(rig_file));
    for (const char* context : {name::kContextGeneral, name::kContextFilter, name::kContextGenerator}) {
        Node node(host, context);
        if (context != name::kContextGenerator)
            node.connect("Source", Picture(kFrame, [](int x, int, int) { return static_cast<float>(x); }));
        node.set("gbuffer_file", file.string());
        node.set("rig", rig_file);
        ASSERT_EQ(render(node, {.window = kFrame}, got), kOk) << node.instance().message;
        EXPECT_EQ(got, wanted) << context;
        const auto region = node.region_of_definition();
        ASSERT_TRUE(region.has_value());
        EXPECT_EQ(region->x1, 0);
        EXPECT_EQ(region->y2, kHeight);
    }
}

TEST_F(OfxFilesTest, KnobsAndOverridesAddToTheRig) {
    const fs::path file = write("shot.exr");
    Node node(host, name::kContextGenerator);
    node.set("gbuffer_file", file.string());
    node.set("rig", rig_file);
    node.set("overrides", "# brighter\nlight.sun.exposure = 1\n\nlight.sky.enabled = false");
    node.choose("light3_type", "spot");
    node.set("light3_position", std::vector{1.0, 3.0, -1.0});
    node.set("light3_direction", std::vector{0.0, -1.0, 0.2});
    node.set("light3_power", 40.0);
    node.set("light3_cone_angle", 70.0);
    node.choose("light3_falloff", "linear");
    node.choose("shader", "ggx");
    node.set("ggx_roughness", 0.9);  // there is a channel: it does not apply
    node.set("ggx_f0", std::vector{0.3, 0.2, 0.1});
    Rig rig = Rig::load(rig_file);
    rig.set("light.sun.exposure", "1");
    rig.set("light.sky.enabled", "false");
    rig.lights.push_back(Rig::loads(R"([[light]]
name = "light3"
type = "spot"
position = [1, 3, -1]
direction = [0, -1, 0.2]
power = 40
cone_angle = 70
falloff = "linear"
)")
                             .lights[0]);
    rig.shaders = Rig::loads("[[shader]]\nuse = \"ggx\"\nf0 = [0.3, 0.2, 0.1]").shaders;
    ASSERT_EQ(render(node, {.window = kFrame}, got), kOk) << node.instance().message;
    EXPECT_EQ(got, by_library(file, rig));
    // Now the knob is to win over the channel.
    node.set("override_channels", 1);
    rig.set("shader.0.roughness", "0.9");
    rig.set("shader.0.base_color", "[0.8, 0.8, 0.8]");
    for (const relume::Parameter& row : shader_use_parameters("ggx"))
        if (row.type == ParameterType::scalar && row.name != "roughness")
            rig.shaders[0].values.set(shader_use_parameters("ggx"), row.name, row.value[0], "ggx");
        else if (row.components() == 3 && row.name != "f0" && row.name != "base_color")
            rig.shaders[0].values.set(shader_use_parameters("ggx"), row.name, row.value, "ggx");
    ASSERT_EQ(render(node, {.window = kFrame}, got), kOk) << node.instance().message;
    EXPECT_EQ(got, by_library(file, rig));
}

TEST_F(OfxFilesTest, AnotherPictureOfTheRig) {
    const fs::path file = write("shot.exr");
    Node node(host, name::kContextGenerator);
    node.set("gbuffer_file", file.string());
    node.set("rig", rig_file);
    node.set("picture", "light:sun");
    Rig rig = Rig::load(rig_file);
    rig.output.values.set(output_parameters(), "aovs", std::vector<std::string>{"light:sun"}, "output");
    const std::vector<float> sun = by_library(file, rig, "light:sun"), beauty = by_library(file, rig);
    ASSERT_EQ(render(node, {.window = kFrame}, got), kOk) << node.instance().message;
    for (std::size_t k = 0; k < got.size(); ++k) ASSERT_EQ(got[k], k % 4 == 3 ? beauty[k] : sun[k]) << k;
    node.set("picture", "light:moon");
    EXPECT_EQ(render(node, {.window = kFrame}, got), kFailed);
    EXPECT_NE(node.instance().message.find("moon"), std::string::npos) << node.instance().message;
}

TEST_F(OfxFilesTest, SequencesAndTwoFramesAtOnce) {
    std::vector<std::vector<float>> wanted;
    const Rig rig = Rig::load(rig_file);
    for (int frame = 0; frame < 4; ++frame)
        wanted.push_back(by_library(write("shot.000" + std::to_string(frame) + ".exr", 0.7 * frame), rig));
    EXPECT_NE(wanted[0], wanted[1]);
    Node node(host, name::kContextGenerator);
    node.set("gbuffer_file", (folder / "shot.####.exr").string());
    node.set("rig", rig_file);
    EXPECT_EQ(node.clip_preferences().integer(name::kPropFrameVarying), 1);
    std::atomic<int> wrong{0};
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t)
        threads.emplace_back([&, t] {
            for (int k = 0; k < 8; ++k) {
                const int frame = (t + k) % 4;
                // Tiles of one frame by several threads, several frames at once.
                const OfxRectI tile{(k % 2) * 31, 5, 31 + (k % 2) * 49, 48};
                std::unique_ptr<Image> image;
                if (node.render({.time = static_cast<double>(frame), .window = tile}, image) != kOk ||
                    pixels(*image) != crop(wanted[static_cast<std::size_t>(frame)], kWidth, kFrame, tile))
                    ++wrong;
            }
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(wrong, 0) << node.instance().message;
    EXPECT_EQ(render(node, {.time = 7, .window = kFrame}, got), kFailed);
    EXPECT_NE(node.instance().message.find("shot.0007.exr"), std::string::npos) << node.instance().message;
}

TEST_F(OfxFilesTest, ProxiesAreMeansOfTheFrame) {
    const fs::path file = write("shot.exr");
    const std::vector<float> whole = by_library(file, Rig::load(rig_file));
    Node node(host, name::kContextGenerator);
    node.set("gbuffer_file", file.string());
    node.set("rig", rig_file);
    ASSERT_EQ(render(node, {.window = {0, 0, 40, 24}, .scale = 0.5}, got), kOk);
    for (int y = 0; y < 24; ++y)
        for (int x = 0; x < 40; ++x)
            for (int c = 0; c < 4; ++c) {
                double sum = 0;
                for (int k = 0; k < 4; ++k)
                    sum += static_cast<double>(
                        whole[static_cast<std::size_t>(4 * ((2 * y + k / 2) * kWidth + 2 * x + k % 2) + c)]);
                ASSERT_NEAR(static_cast<double>(got[static_cast<std::size_t>(4 * (y * 40 + x) + c)]), sum / 4, 1e-6);
            }
    // A scale that divides nothing: the light that arrives stays.
    ASSERT_EQ(render(node, {.window = {0, 0, 24, 15}, .scale = 0.3}, got), kOk);
    double small = 0, large = 0;
    for (std::size_t k = 0; k < got.size(); k += 4) small += static_cast<double>(got[k]) / 0.09;
    for (std::size_t k = 0; k < whole.size(); k += 4) large += static_cast<double>(whole[k]);
    EXPECT_NEAR(small / large, 1, 1e-5);
    const std::vector<float> all = got;
    ASSERT_EQ(render(node, {.window = {5, 3, 20, 9}, .scale = 0.3}, got), kOk);
    EXPECT_EQ(got, crop(all, 24, {0, 0, 24, 15}, {5, 3, 20, 9}));
}

/// The scene again, as a crop of a larger display window.
void write_crop(const fs::path& from, const fs::path& to, const Window& data, const Window& display) {
    const io::ExrReader reader(from, {});
    io::Header header = reader.header();
    io::Part& part = header.parts.at(0);
    const auto count =
        static_cast<std::size_t>(part.data_window.width) * static_cast<std::size_t>(part.data_window.height);
    std::vector<std::vector<float>> pixels(part.channels.size(), std::vector<float>(count));
    std::vector<io::ReadTarget> targets;
    std::vector<ConstPlane> planes;
    for (std::size_t k = 0; k < pixels.size(); ++k) {
        const Plane plane{reinterpret_cast<std::byte*>(pixels[k].data()), PixelType::float32, 4,
                          std::ptrdiff_t{4} * part.data_window.width};
        targets.push_back({0, static_cast<int>(k), plane});
        planes.push_back(plane);
    }
    reader.read(part.data_window, targets);
    part.data_window = data;
    part.display_window = display;
    io::ExrWriter writer(to, header);
    writer.write(0, data.y, data.height, planes);
    writer.commit();
}

TEST_F(OfxFilesTest, ScalesAndAspectsThatAreNoneAreOne) {
    const fs::path file = write("shot.exr");
    Node node(host, name::kContextGenerator);
    node.set("gbuffer_file", file.string());
    node.set("rig", rig_file);
    const std::vector<float> wanted = by_library(file, Rig::load(rig_file));
    const double infinity = std::numeric_limits<double>::infinity();
    for (const double none : {0.0, -1.0, std::nan(""), infinity, -infinity}) {
        node.set_project(1920, 1080, none, none, none);
        node.clip(name::kClipOutput).properties.set<double>(name::kPropImageAspect, 0, none);
        if (none == -1) node.set_project(1920, 1080);  // a place like any other
        ASSERT_EQ(render(node, {.window = kFrame, .scale = none}, got), kOk) << node.instance().message;
        EXPECT_EQ(got, wanted) << none;
    }
}

TEST_F(OfxFilesTest, DataWindowBesideTheDisplayWindow) {
    const fs::path plain = write("plain.exr"), file = folder / "crop.exr";
    // Overscan to the left and above, a crop to the right and below.
    write_crop(plain, file, {-7, -5, kWidth, kHeight}, {0, 0, 100, 60});
    Node node(host, name::kContextGenerator);
    node.set("gbuffer_file", file.string());
    node.set("rig", rig_file);
    const auto region = node.region_of_definition();
    ASSERT_TRUE(region.has_value());
    EXPECT_EQ(region->x1, -7);
    EXPECT_EQ(region->x2, 73);
    EXPECT_EQ(region->y1, 17);
    EXPECT_EQ(region->y2, 65);
    const std::vector<float> wanted = by_library(file, Rig::load(rig_file));
    const OfxRectI data{-7, 17, 73, 65}, part{-3, 20, 40, 64};
    ASSERT_EQ(render(node, {.window = data}, got), kOk) << node.instance().message;
    EXPECT_EQ(got, wanted);
    ASSERT_EQ(render(node, {.window = part}, got), kOk);
    EXPECT_EQ(got, crop(wanted, kWidth, data, part));
    ASSERT_EQ(render(node, {.window = {80, 0, 90, 10}}, got), kOk);
    EXPECT_EQ(std::count(got.begin(), got.end(), 0.f), 400);
}

TEST_F(OfxFilesTest, FileThatChangesIsReadAgain) {
    const Rig rig = Rig::load(rig_file);
    Node node(host, name::kContextFilter);
    node.connect("Source", Picture(kFrame, [](int, int, int) { return 0.5f; }));
    node.set("rig", rig_file);
    for (int k = 0; k < 3; ++k) {
        // Another file under the same name, as renderers write them: it shows whatever the clock's ticks are.
        const fs::path file = write("shot.exr", 1.3 * k);
        node.set("gbuffer_file", file.string());
        ASSERT_EQ(render(node, {.window = kFrame}, got), kOk) << node.instance().message;
        EXPECT_EQ(got, by_library(file, rig)) << k;
        ASSERT_EQ(render(node, {.window = kFrame}, got), kOk);
        EXPECT_EQ(got, by_library(file, rig)) << k;
    }
    // A rig that changes.
    const fs::path own_rig = folder / "own.relume";
    const auto write_rig = [&](const std::string& text) { std::ofstream(own_rig) << text; };
    node.set("rig", own_rig.string());
    for (const char* text :
         {"[[light]]\ntype = \"sun\"\ndirection = [0, -1, 0.3]\n", "[[light]]\ntype = \"ambient\"\n"}) {
        write_rig(text);
        ASSERT_EQ(render(node, {.window = kFrame}, got), kOk) << node.instance().message;
        EXPECT_EQ(got, by_library(folder / "shot.exr", Rig::loads(text)));
    }
}

TEST_F(OfxFilesTest, RigWithAFileForEachChannel) {
    // Normals alone in one file, colours in another; the time of day decides the frame.
    for (int frame = 0; frame < 2; ++frame) {
        write("shot.000" + std::to_string(frame) + ".exr", 0.7 * frame);
        write("paint.000" + std::to_string(frame) + ".exr", 0.7 * frame + 0.2);
    }
    const fs::path own = folder / "channels.relume";
    std::ofstream(own) << "[gbuffer.channels]\nnormal = \"shot.####.exr\"\nbase_color = \"paint.####.exr\"\n"
                          "[[light]]\ntype = \"sun\"\ndirection = [0.2, -1, 0.3]\n";
    Node node(host, name::kContextGenerator);
    node.set("rig", own.string());
    for (int frame = 0; frame < 2; ++frame) {
        const Rig rig = Rig::load(own).of_frame(frame);
        ASSERT_EQ(render(node, {.time = 1.0 * frame, .window = kFrame}, got), kOk) << node.instance().message;
        EXPECT_EQ(got, by_library(rig.main_file().value(), rig));
    }
    EXPECT_EQ(node.clip_preferences().integer(name::kPropFrameVarying), 1);
    // The file of a channel that changes.
    const std::vector<float> before = got;
    write("paint.0001.exr", 2.5);
    const Rig rig = Rig::load(own).of_frame(1);
    ASSERT_EQ(render(node, {.time = 1, .window = kFrame}, got), kOk) << node.instance().message;
    EXPECT_EQ(got, by_library(rig.main_file().value(), rig));
    EXPECT_NE(got, before);
}

TEST_F(OfxFilesTest, WhatIsWrongIsSaidAndTheNextPictureIsRight) {
    const fs::path good = write("good.exr");
    const std::vector<float> wanted = by_library(good, Rig::load(rig_file));
    Node node(host, name::kContextGenerator);
    const auto fails = [&](const std::string& gbuffer, const std::string& rig, const std::string& word) {
        node.set("gbuffer_file", gbuffer);
        node.set("rig", rig);
        EXPECT_EQ(render(node, {.window = kFrame}, got), kFailed) << word;
        EXPECT_NE(node.instance().message.find(word), std::string::npos) << word << ": " << node.instance().message;
        node.region_of_definition();  // says nothing, and stays up
        node.clip_preferences();
        node.set("gbuffer_file", good.string());
        node.set("rig", rig_file);
        EXPECT_EQ(render(node, {.window = kFrame}, got), kOk) << node.instance().message;
        EXPECT_EQ(node.instance().message, "");
        EXPECT_EQ(got, wanted);
    };
    fails("", rig_file, "G-buffer file");
    fails((folder / "none.exr").string(), rig_file, "none.exr");
    fails(folder.string(), rig_file, folder.filename().string());
    const fs::path cut = folder / "cut.exr";
    fs::copy_file(good, cut);
    fs::resize_file(cut, fs::file_size(good) / 2);
    fails(cut.string(), rig_file, "cut.exr");
    std::ofstream(folder / "text.exr") << "no picture";
    fails((folder / "text.exr").string(), rig_file, "text.exr");
    // An EXR without normals.
    const fs::path bare = folder / "bare.exr";
    io::Header header;
    io::Part& part = header.parts.emplace_back();
    part.data_window = part.display_window = {0, 0, 4, 4};
    for (const char* channel : {"B", "G", "R"}) part.channels.push_back({channel, PixelType::float32});
    const std::vector<float> zeros(16);
    {
        io::ExrWriter writer(bare, header);
        const ConstPlane plane{reinterpret_cast<const std::byte*>(zeros.data()), PixelType::float32, 4, 16};
        writer.write(0, 0, 4, std::vector<ConstPlane>{plane, plane, plane});
        writer.commit();
    }
    fails(bare.string(), rig_file, "normal");
    std::ofstream(folder / "bad.relume") << "[[light]]\ntype = \"sunn\"\n";
    fails(good.string(), (folder / "bad.relume").string(), "bad.relume:2");
    fails(good.string(), (folder / "absent.relume").string(), "absent.relume");
}

TEST_F(OfxFilesTest, TextsAreTakenAsTheyAre) {
    const fs::path file = write("shot.exr");
    Node node(host, name::kContextGenerator);
    node.set("gbuffer_file", file.string());
    node.set("rig", rig_file);
    // What TOML has to escape is no mistake of the knob's: the file has no such part.
    node.set("gbuffer_part", "a\n\"b\" \\c");
    EXPECT_EQ(render(node, {.window = kFrame}, got), kFailed);
    EXPECT_NE(node.instance().message.find(R"(in part 'a\n"b" \c')"), std::string::npos) << node.instance().message;
}

/// A locale whose numbers have commas, as hosts choose one for the whole process. Systems bring few: it is made here.
class CommaLocale {
public:
    explicit CommaLocale(const fs::path& folder) {
        if (!fs::exists("/usr/share/i18n/locales/de_DE")) return;
        const std::string command = "localedef -i de_DE -f UTF-8 '" + (folder / "de_DE.UTF-8").string() + "'";
        if (std::system(command.c_str()) != 0 || setenv("LOCPATH", folder.c_str(), 1) != 0) return;
        chosen = std::setlocale(LC_ALL, "de_DE.UTF-8") != nullptr;
    }
    ~CommaLocale() {
        std::setlocale(LC_ALL, "C");
        unsetenv("LOCPATH");
    }
    CommaLocale(const CommaLocale&) = delete;
    CommaLocale& operator=(const CommaLocale&) = delete;
    bool chosen = false;
};

TEST_F(OfxFilesTest, NumbersHavePointsInEveryLocale) {
    const fs::path file = write("shot.exr");
    Node node(host, name::kContextGenerator);
    node.set("gbuffer_file", file.string());
    node.set("rig", rig_file);
    node.set("camera_fov", 41.5);
    node.set("camera_matrix", "1, 0, 0, +0.25, 0, 1, 0, 1.5, 0, 0, 1, 4.75, 0, 0, 0, 1");
    node.choose("light1_type", "spot");
    node.set("light1_position", std::vector{0.5, 2.5, 1.25});
    node.set("light1_direction", std::vector{-0.1, -0.9, -0.3});
    node.set("light1_power", 40.5);
    node.set("overrides", "light.sun.exposure = -0.5");
    ASSERT_EQ(render(node, {.window = kFrame}, got), kOk) << node.instance().message;
    const std::vector<float> wanted = got;
    const CommaLocale locale(folder);
    if (!locale.chosen) GTEST_SKIP() << "no localedef, or no sources of locales";
    std::array<char, 8> text{};
    std::snprintf(text.data(), text.size(), "%.1f", 0.5);
    ASSERT_STREQ(text.data(), "0,5");
    node.act(name::kActionPurgeCaches, &node.instance());
    ASSERT_EQ(render(node, {.window = kFrame}, got), kOk) << node.instance().message;
    EXPECT_EQ(got, wanted);
    node.set("camera_matrix", "1,0 0");
    EXPECT_EQ(render(node, {.window = kFrame}, got), kFailed);
}

TEST_F(OfxFilesTest, OverridesThatAreWrongAreSaid) {
    const fs::path good = write("good.exr");
    Node node(host, name::kContextGenerator);
    node.set("gbuffer_file", good.string());
    node.set("rig", rig_file);
    for (const auto& [text, word] :
         {std::pair("light.sun.exposur = 1", "exposure"), std::pair("light.sun.exposure", "line 1"),
          std::pair("camera.fov = wide", "fov")}) {
        node.set("overrides", text);
        EXPECT_EQ(render(node, {.window = kFrame}, got), kFailed) << text;
        EXPECT_NE(node.instance().message.find(word), std::string::npos) << node.instance().message;
    }
}

}  // namespace
}  // namespace relume::ofx::test
