// SPDX-License-Identifier: Apache-2.0
// Tables from a rig: files and numbers, how they are found, and what is said of those that are wrong.

#include <gtest/gtest.h>

#include <fstream>
#include <functional>

#include "../exr_test_image.h"
#include "memory_frame.h"
#include "relume/error.h"
#include "relume/image_reader.h"
#include "relume/lookup_table.h"

namespace relume::test {
namespace {

constexpr const char* kSun = "[[light]]\ntype = 'sun'\nirradiance = 3\ndirection = [0.2, 0.1, -1]\n";
constexpr const char* kUse = "[[shader]]\nuse = 'cook_torrance'\ndistribution = 'texture'\n";

void write_exr(const std::filesystem::path& path, const std::vector<std::string>& channels, int width, int height,
               const std::vector<std::vector<float>>& planes) {
    io::Header header;
    io::Part part;
    part.data_window = part.display_window = {3, -2, width, height};
    std::vector<ConstPlane> views;
    for (std::size_t k = 0; k < channels.size(); ++k) {
        part.channels.push_back({.name = channels[k], .type = PixelType::float32});
        views.push_back({reinterpret_cast<const std::byte*>(planes[k].data()), PixelType::float32, 4, 4 * width});
    }
    header.parts.push_back(part);
    io::ExrWriter writer(path, header);
    writer.write(0, -2, height, views);
    writer.commit();
}

std::string refusal(const std::function<void()>& act, ErrorKind kind) {
    try {
        act();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), kind) << error.what();
        return error.what();
    }
    return "accepted";
}

std::string said_of(const std::string& rig, ErrorKind kind) {
    return refusal([&] { Rig::loads(rig, "key.relume"); }, kind);
}

TEST(TableFile, GreyAndColours) {
    const io::TemporaryFolder folder;
    write_exr(folder / "grey.exr", {"Y"}, 3, 2, {{1, 2, 3, 4, 5, 6}});
    EXPECT_EQ(*load_table(folder / "grey.exr"), (LookupTable{3, 2, {1, 2, 3, 4, 5, 6}}));
    write_exr(folder / "one.exr", {"lobe"}, 2, 1, {{0.5f, 8}});
    EXPECT_EQ(*load_table(folder / "one.exr"), (LookupTable{2, 1, {0.5f, 8}}));
    write_exr(folder / "rgb.exr", {"A", "B", "G", "R"}, 2, 1, {{0, 0}, {0.25f, 1}, {0.25f, 0}, {0.25f, 0}});
    EXPECT_EQ(*load_table(folder / "rgb.exr"), (LookupTable{2, 1, {0.25f, 0.0722f}}));
}

TEST(TableFile, OtherImagesComeAsTheyAreStoredAndOnce) {
    const io::TemporaryFolder folder;
    const auto path = folder / "lobe.png";
    std::ofstream(path) << "1";
    int reads = 0;
    set_image_reader([&](const std::filesystem::path&) {
        ++reads;
        return StoredImage{2, 1, {"Y"}, {0.5f, 1.f}, 8};
    });
    const Rig rig = Rig::loads(std::string(kSun) + kUse + "distribution_table = '" + path.string() + "'\n");
    const MemoryFrame frame(8, 8);
    for (int k = 0; k < 3; ++k) relit(frame.gbuffer(), rig);
    EXPECT_EQ(reads, 1);
    EXPECT_EQ(load_table(path)->texels, (std::vector<float>{0.5f, 1.f}));  // no sRGB curve
    std::ofstream(path) << "another";
    load_table(path);
    EXPECT_EQ(reads, 2) << "the file has changed";
    set_image_reader({});
}

TEST(TableFile, LightsLikeTheSameNumbers) {
    const io::TemporaryFolder folder;
    write_exr(folder / "lobe.exr", {"Y"}, 3, 2, {{0, 0.5f, 1, 0.25f, 0.5f, 0.75f}});
    std::ofstream(folder / "key.relume") << kSun << kUse << "distribution_table = 'lobe.exr'\n";
    const Rig by_file = Rig::load(folder / "key.relume");  // relative to the rig
    const Rig by_numbers =
        Rig::loads(std::string(kSun) + kUse + "distribution_table = [[0, 0.5, 1.0], [0.25, 0.5, 0.75]]\n");
    const Rig by_default = Rig::loads(std::string(kSun) + kUse);
    const MemoryFrame frame(16, 16);
    const auto a = relit(frame.gbuffer(), by_file), b = relit(frame.gbuffer(), by_numbers),
               c = relit(frame.gbuffer(), by_default);
    EXPECT_EQ(a("beauty", 0), b("beauty", 0));
    EXPECT_NE(a("beauty", 0), c("beauty", 0));
    // A rig from a rig shades the same.
    EXPECT_EQ(Rig::loads(by_numbers.to_toml()), by_numbers);
    EXPECT_EQ(relit(frame.gbuffer(), Rig::loads(by_file.to_toml()))("beauty", 0), a("beauty", 0));
    EXPECT_EQ(by_file.get("shader.0.distribution_table"), '"' + (folder / "lobe.exr").string() + '"');
    EXPECT_EQ(by_default.get("shader.0.distribution_table"), "\"\"");
}

TEST(TableFile, IsSetByADottedKey) {
    Rig rig = Rig::loads(std::string(kSun) + kUse);
    rig.set("shader.0.distribution_table", "lobes/soft.exr");
    EXPECT_EQ(rig.get("shader.0.distribution_table"), "\"lobes/soft.exr\"");
    rig.set("shader.0.distribution_table", "[[0, 1], [2, 3.5]]");
    EXPECT_EQ(rig.get("shader.0.distribution_table"), "[[0, 1], [2, 3.5]]");
    for (const char* wrong : {"[[[1, 2], [3, 4]]]", "[[1, 2], [3]]", "[1, 2]", "[1, 'a']"})
        EXPECT_THROW(rig.set("shader.0.distribution_table", wrong), Error) << wrong;
    rig.set("shader.0.use", "lambert");
    EXPECT_THROW(rig.get("shader.0.distribution_table"), Error);
}

TEST(TableFile, MistakesInARig) {
    const std::string use = kUse;
    EXPECT_EQ(said_of(use + "distribution_table = 3", ErrorKind::rig),
              "shader 'cook_torrance': distribution_table takes the name of a file, or rows of numbers [[…], […]], not "
              "the number 3 at key.relume:4:1");
    EXPECT_EQ(said_of(use + "distribution_table = [1, 2]", ErrorKind::rig),
              "shader 'cook_torrance': distribution_table takes the name of a file, or rows of numbers [[…], […]], not "
              "a list of 2 numbers at key.relume:4:1");
    EXPECT_EQ(said_of(use + "distribution_table = [[1, 2], [3]]", ErrorKind::rig),
              "shader 'cook_torrance': distribution_table cannot be a list of lists at key.relume:4:1");
    EXPECT_EQ(said_of(use + "distribution_table = [[1, 2], [3, nan]]", ErrorKind::parameter),
              "shader 'cook_torrance': distribution_table: the texel in column 1, row 1 is not finite at "
              "key.relume:4:1");
    EXPECT_EQ(said_of(use + "distribution_table = { channel = 'x' }", ErrorKind::rig),
              "shader 'cook_torrance': distribution_table takes the name of a file, or rows of numbers [[…], […]], not "
              "the channel 'x' at key.relume:4:1");
    EXPECT_EQ(said_of(use + "roughness = [[1, 2]]", ErrorKind::rig),
              "shader 'cook_torrance': roughness takes a number, not a list of lists at key.relume:4:1");
    EXPECT_EQ(said_of(use + "distribution_tabel = 'x.exr'", ErrorKind::rig),
              "unknown key 'distribution_tabel' in shader 'cook_torrance' at key.relume:4:1; did you mean "
              "'distribution_table'?");
}

TEST(TableFile, MistakesInAFile) {
    const io::TemporaryFolder folder;
    const MemoryFrame frame(4, 4);
    const auto said = [&](const std::string& file, ErrorKind kind) {
        const Rig rig =
            Rig::loads(std::string(kSun) + kUse + "distribution_table = '" + (folder / file).string() + "'\n");
        return refusal([&] { relit(frame.gbuffer(), rig); }, kind);
    };
    const auto expected = [&](const std::string& file, const std::string& why) {
        return "shader 'cook_torrance': distribution_table: " + (folder / file).string() + why;
    };
    EXPECT_EQ(said("lost.exr", ErrorKind::file), expected("lost.exr", ": no such file"));
    EXPECT_EQ(said("", ErrorKind::file), expected("", ": is a directory; a table is a file"));
    std::ofstream(folder / "text.exr") << "no picture";
    EXPECT_EQ(said("text.exr", ErrorKind::format).substr(0, expected("text.exr", "").size()), expected("text.exr", ""));
    write_exr(folder / "xy.exr", {"X", "Y2"}, 1, 1, {{1}, {1}});
    EXPECT_EQ(said("xy.exr", ErrorKind::format),
              expected("xy.exr", ": holds the channels X, Y2; a table is one channel (Y) or R, G, B"));
    write_exr(folder / "nan.exr", {"Y"}, 2, 2, {{1, 1, std::numeric_limits<float>::infinity(), 1}});
    EXPECT_EQ(said("nan.exr", ErrorKind::format), expected("nan.exr", ": the texel in column 0, row 1 is not finite"));
    write_exr(folder / "large.exr", {"Y"}, 2049, 2048, {std::vector<float>(2049 * 2048, 0.5f)});
    EXPECT_EQ(said("large.exr", ErrorKind::format).substr(0, expected("large.exr", "").size()),
              expected("large.exr", ""));
}

TEST(TableFile, LimitsAreThoseThatAreDocumented) {
    EXPECT_NO_THROW(check_table({2048, 2048, std::vector<float>(2048 * 2048)}, "t"));
    EXPECT_EQ(refusal(
                  [] {
                      check_table({2049, 2048, {}}, "t");
                  },
                  ErrorKind::value),
              "t: is 2049 × 2048; a table has at most 4194304 texels: it is smooth between them, so make it smaller");
    EXPECT_EQ(refusal([] { check_table({0, 2, {}}, "t"); }, ErrorKind::value), "t: a table of 0 × 2 has no texels");
    EXPECT_EQ(refusal([] { check_table({2, 2, {1, 2, 3}}, "t"); }, ErrorKind::value), "t: has 3 texels, not 2 × 2");
}

}  // namespace
}  // namespace relume::test
