// SPDX-License-Identifier: Apache-2.0
#include "cryptomatte/cryptomatte.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <fstream>
#include <random>

#include "gbuffer_files.h"
#include "relume/error.h"

namespace relume {
namespace {

using cryptomatte::id_bits;
using cryptomatte::ids_of;
using cryptomatte::matches;
using cryptomatte::murmur3;
using cryptomatte::parse_manifest;

TEST(Cryptomatte, HashesAsTheSpecificationDoes) {
    EXPECT_EQ(id_bits("torus"), 0xf19c73fdu);
    EXPECT_EQ(id_bits("равнина"), 0x9623511eu);
    // A layer's key is the first seven digits of its name's hash.
    EXPECT_EQ(murmur3("ViewLayer.CryptoObject") >> 4, 0x542cafau);
    EXPECT_EQ(murmur3("ViewLayer.CryptoMaterial") >> 4, 0xc7dbf5eu);
    EXPECT_EQ(murmur3(""), 0u);
}

TEST(Cryptomatte, EveryIdIsANormalFloat) {
    int flipped = 0;
    for (int i = 0; i < 20000; ++i) {
        const std::string name = "object_" + std::to_string(i);
        const std::uint32_t id = id_bits(name);
        ASSERT_TRUE(std::isnormal(std::bit_cast<float>(id))) << name;
        flipped += id != murmur3(name);
    }
    // Two exponents of 256 are flipped.
    EXPECT_NEAR(flipped, 20000 * 2 / 256, 60);
}

TEST(Cryptomatte, ReadsManifests) {
    EXPECT_TRUE(parse_manifest("{}", "x").empty());
    const auto manifest =
        parse_manifest(R"( { "a\"\\\/\b\n" : "0000000f", "\u0440\ud83d\ude00":"F19C73FD" ,"b":"1"} )", "x");
    ASSERT_EQ(manifest.size(), 3u);
    EXPECT_EQ(manifest.at("a\"\\/\b\n"), 15u);
    EXPECT_EQ(manifest.at("р😀"), 0xf19c73fdu);
    EXPECT_EQ(manifest.at("b"), 1u);
    EXPECT_EQ(parse_manifest("{\"caf\xe9\":\"2\"}", "x").at("caf\u00e9"), 2u) << "Latin-1";
}

TEST(Cryptomatte, DamagedManifestsAreNamed) {
    for (const char* text :
         {"", "{", "[]", "{\"a\"}", "{\"a\":1}", "{\"a\":\"xyz\"}", "{\"a\":\"123456789\"}", "{\"a\":\"\"}",
          "{\"a\":\"1\",}", "{\"a\":\"1\"} x", "{\"a", "{\"\\q\":\"1\"}", "{\"\\u12\":\"1\"}", "{\"\\ud800\":\"1\"}",
          "{\"\\udc00\":\"1\"}", "{\"\\ud800\\u0041\":\"1\"}", "{\"a\\"}) {
        try {
            parse_manifest(text, "file.exr");
            ADD_FAILURE() << text;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::format);
            EXPECT_NE(std::string(error.what()).find("file.exr"), std::string::npos) << error.what();
        }
    }
    // Bytes at random end in an error or a map, never in a crash.
    std::mt19937 random(7);
    const std::string letters = "{}[]\":,\\u0aF\n";
    for (int i = 0; i < 20000; ++i) {
        std::string text = "{";
        for (int k = 0; k < 20; ++k) text += letters[random() % letters.size()];
        try {
            parse_manifest(text, "x");
        } catch (const Error&) {
        }
    }
}

TEST(Cryptomatte, Globs) {
    EXPECT_TRUE(matches("car_*", "car_body"));
    EXPECT_TRUE(matches("*", ""));
    EXPECT_TRUE(matches("a*b*c", "aXbYbZc"));
    EXPECT_FALSE(matches("a*b*c", "aXbYbZ"));
    EXPECT_TRUE(matches("wheel.00?", "wheel.001"));
    EXPECT_FALSE(matches("wheel.00?", "wheel.00"));
    EXPECT_TRUE(matches("[a-c]x", "bx"));
    EXPECT_FALSE(matches("[!a-c]x", "bx"));
    EXPECT_TRUE(matches("[]]", "]"));
    EXPECT_TRUE(matches("[ab", "[ab"));  // no set: as it stands
    EXPECT_TRUE(matches("?", "р"));      // one character, though two bytes
    EXPECT_TRUE(matches("рав*", "равнина"));
    EXPECT_FALSE(matches("Car", "car"));
    EXPECT_FALSE(matches("", "a"));
    // The walk is not exponential.
    EXPECT_FALSE(matches("*a*a*a*a*a*a*a*a*a*a*b", std::string(400, 'a')));
}

TEST(Cryptomatte, NamesNeedNoManifest) {
    const std::vector<std::string> patterns{"torus"};
    EXPECT_EQ(ids_of(patterns, "crypto_object", {}), std::vector<std::uint32_t>{0xf19c73fdu});
    const std::vector<std::string> wild{"t*", "cube"};
    const std::map<std::string, std::uint32_t> manifest{{"torus", 7}, {"tree", 3}, {"cube", 9}};
    const std::vector<std::uint32_t> ids = ids_of(wild, "crypto_object", manifest);
    // "cube" by the manifest, and by its hash.
    EXPECT_EQ(ids.size(), 4u);
    EXPECT_TRUE(std::is_sorted(ids.begin(), ids.end()));
}

TEST(Cryptomatte, AKindKeepsNamesApart) {
    // An object and a material of one name have one ID, each in its own layer.
    using Ids = std::vector<std::uint32_t>;
    const auto of = [](std::string pattern, std::string_view layer) {
        return ids_of(std::vector<std::string>{std::move(pattern)}, layer, {{"gold", 5}, {"golf", 6}});
    };
    for (const std::string_view layer : {"crypto_material", "View.Layer.CryptoMaterial", "material.uCryptomaterial"}) {
        EXPECT_EQ(of("material:gol?", layer), (Ids{5, 6})) << layer;
        EXPECT_EQ(of("object:gol?", layer), Ids{}) << layer;
    }
    EXPECT_EQ(of("object:gol?", "material.CryptoObject"), (Ids{5, 6}));
    EXPECT_EQ(of("material:gol?", "material.CryptoObject"), Ids{});
    EXPECT_EQ(of("asset:gol*", "CryptoAsset"), (Ids{5, 6}));
    // By its hash, where there is no manifest.
    const Ids torus = ids_of(std::vector<std::string>{"object:torus"}, "crypto_object", {});
    EXPECT_TRUE(std::ranges::count(torus, 0xf19c73fdu) == 1);
    // A name that begins so is found as it stands.
    EXPECT_EQ(ids_of(std::vector<std::string>{"object:*"}, "crypto_material", {{"object:a", 7}}), Ids{7});
}

test::MadePart crypto_part(const std::string& extra_layer = "crypto_object") {
    using test::MadeChannel;
    const auto id = [](const char* name) { return static_cast<double>(std::bit_cast<float>(id_bits(name))); };
    test::MadePart part;
    part.channels = {{"N.X"},
                     {"N.Y"},
                     {"N.Z", [](int, int) { return 1.0; }},
                     // Left half: all "torus"; right half: 0.5 cube, 0.25 torus, 0.25 car_body.
                     {extra_layer + "00.red", [=](int x, int) { return x < 24 ? id("torus") : id("cube"); }},
                     {extra_layer + "00.green", [](int x, int) { return x < 24 ? 1.0 : 0.5; }},
                     {extra_layer + "00.blue", [=](int x, int) { return x < 24 ? 0.0 : id("torus"); }},
                     {extra_layer + "00.alpha", [](int x, int) { return x < 24 ? 0.0 : 0.25; }},
                     {extra_layer + "01.red", [=](int x, int) { return x < 24 ? 0.0 : id("car_body"); }},
                     {extra_layer + "01.green", [](int x, int) { return x < 24 ? 0.0 : 0.25; }},
                     {extra_layer + "01.blue"},
                     {extra_layer + "01.alpha"}};
    return part;
}

std::pair<float, float> matte(const GBuffer& gbuffer, const std::vector<std::string>& patterns) {
    ChannelRequest request;
    request.kind = ChannelRequest::Kind::matte;
    request.patterns = patterns;
    const test::Answer answer = test::ask(gbuffer, request);
    return {answer[0][5][3], answer[0][5][40]};
}

TEST(Cryptomatte, MattesSumTheRanksOfMatchingNames) {
    const io::TemporaryFolder folder;
    test::MadePart part = crypto_part();
    part.attributes = {
        test::text("cryptomatte/1234567/name", "crypto_object"),
        test::text("cryptomatte/1234567/manifest",
                   R"({"torus":"f19c73fd","cube":")" + std::string("00000000") + R"(","car_body":"00000001"})")};
    // The manifest's IDs are what counts for patterns, the hash for plain names.
    test::write_exr(folder / "a.exr", {part});
    const GBuffer gbuffer = GBuffer::read(folder / "a.exr");
    EXPECT_EQ(gbuffer.cryptomatte().at("crypto_object").size(), 3u);
    using Pair = std::pair<float, float>;
    EXPECT_EQ(matte(gbuffer, {"torus"}), Pair(1.0f, 0.25f));
    EXPECT_EQ(matte(gbuffer, {"t?rus"}), Pair(1.0f, 0.25f));
    EXPECT_EQ(matte(gbuffer, {"cube"}), Pair(0.0f, 0.5f));
    EXPECT_EQ(matte(gbuffer, {"cube", "car_body", "torus"}), Pair(1.0f, 1.0f));
    EXPECT_EQ(matte(gbuffer, {"nothing"}), Pair(0.0f, 0.0f));
    EXPECT_EQ(matte(gbuffer, {}), Pair(0.0f, 0.0f));
}

TEST(Cryptomatte, ManifestFilesStandBesideTheExr) {
    const io::TemporaryFolder folder;
    std::ofstream(folder / "names.json") << R"({"car_body":")" << std::hex << id_bits("car_body") << R"("})";
    test::MadePart part = crypto_part();
    part.attributes = {test::text("exr/cryptomatte/1234567/name", "crypto_object"),
                       test::text("exr/cryptomatte/1234567/manif_file", "names.json")};
    test::write_exr(folder / "a.exr", {part});
    const GBuffer gbuffer = GBuffer::read(folder / "a.exr");
    EXPECT_EQ(matte(gbuffer, {"car_*"}), std::pair(0.0f, 0.25f));

    std::filesystem::create_directory(folder / "inner");
    for (const std::string& escape :
         {std::string("../names.json"), (folder / "names.json").string(), std::string("no.json")}) {
        part.attributes[1] = test::text("exr/cryptomatte/1234567/manif_file", escape);
        const std::filesystem::path path = folder.path() / "inner" / "b.exr";
        test::write_exr(path, {part});
        const GBuffer other = GBuffer::read(path);
        EXPECT_TRUE(other.cryptomatte().at("crypto_object").empty()) << escape;
        EXPECT_TRUE(test::mentions(other.notes(), "crypto_object")) << escape;
        EXPECT_EQ(matte(other, {"car_*"}), std::pair(0.0f, 0.0f));
        EXPECT_EQ(matte(other, {"car_body"}), std::pair(0.0f, 0.25f));
    }
}

TEST(Cryptomatte, LayersMayHaveAnyName) {
    const io::TemporaryFolder folder;
    test::MadePart part = crypto_part("my mattes");
    part.attributes = {test::text("cryptomatte/1234567/name", "my mattes")};
    test::write_exr(folder / "a.exr", {part});
    const GBuffer gbuffer = GBuffer::read(folder / "a.exr");
    EXPECT_EQ(matte(gbuffer, {"torus"}), std::pair(1.0f, 0.25f));
    EXPECT_EQ(gbuffer.find("my_mattes00"), nullptr);
}

TEST(Cryptomatte, WithoutALayerAMatteIsAnError) {
    const io::TemporaryFolder folder;
    test::write_exr(folder / "a.exr",
                    {{.channels = {{"N.X"}, {"N.Y"}, {"N.Z"}}, .name = {}, .view = {}, .attributes = {}}});
    const GBuffer gbuffer = GBuffer::read(folder / "a.exr");
    EXPECT_THROW(matte(gbuffer, {"torus"}), Error);
}

}  // namespace
}  // namespace relume
