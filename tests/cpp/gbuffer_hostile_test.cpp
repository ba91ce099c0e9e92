// SPDX-License-Identifier: Apache-2.0
// Headers and names that nobody would write in good faith: an error or an answer, never a crash, and never long.
#include <gtest/gtest.h>

#include <ctime>
#include <random>

#include "gbuffer/names.h"
#include "gbuffer/select.h"
#include "made_scene.h"
#include "relume/error.h"

namespace relume {
namespace {

using test::MadePart;

/// Everything that a reader of the file may ask for.
void use(const std::filesystem::path& path, const GBufferOptions& options = {}) {
    try {
        const GBuffer gbuffer = GBuffer::read(path, options);
        for (const ChannelInfo& info : gbuffer.channels()) {
            for (const int components : {1, 3}) {
                try {
                    test::ask(gbuffer, test::semantic(info.name, components), 0, 13);
                } catch (const Error& error) {
                    EXPECT_FALSE(std::string(error.what()).empty());
                }
            }
        }
        ChannelRequest matte;
        matte.kind = ChannelRequest::Kind::matte;
        matte.patterns = {"*", "[", "a"};
        ChannelRequest id = test::semantic("object_id");
        id.kind = ChannelRequest::Kind::id;
        for (const ChannelRequest& request : {matte, id}) {
            try {
                test::ask(gbuffer, request);
            } catch (const Error&) {
            }
        }
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find(path.string()), std::string::npos) << error.what();
    }
}

TEST(HostileGBuffer, NamesAtRandom) {
    const io::TemporaryFolder folder;
    const std::vector<std::string> words{"N",         "Normal",     "normal",  "P",        "position",
                                         "Depth",     "Z",          "X",       "Y",        "R",
                                         "G",         "B",          "A",       "red",      "T",
                                         "V",         "",           " ",       ".",        "..",
                                         "*",         "left",       "right",   "crypto00", "CryptoObject01",
                                         "albedo",    "Base Color", "DiffCol", "GlossCol", "metallic",
                                         "roughness", "coverage",   "alpha",   "Combined", "rgba",
                                         "ViewLayer", "a.b",        "IndexOB"};
    std::mt19937 random(11);
    const auto word = [&] { return words[random() % words.size()]; };
    for (int round = 0; round < 150; ++round) {
        SCOPED_TRACE(round);
        std::vector<MadePart> parts(1 + random() % 3);
        for (std::size_t p = 0; p < parts.size(); ++p) {
            MadePart& part = parts[p];
            part.name = word() + std::to_string(p);
            part.view = random() % 4 == 0 ? word() : "";
            std::set<std::string> names;
            const std::size_t channels = 1 + random() % 24;
            for (std::size_t c = 0; c < channels; ++c) {
                std::string name = word();
                for (std::size_t k = random() % 3; k > 0; --k) name += "." + word();
                if (name.empty() || !names.insert(name).second) continue;
                const int kind = static_cast<int>(random() % 5);
                const PixelType type = kind == 4 ? PixelType::uint32 : kind == 3 ? PixelType::half : PixelType::float32;
                part.channels.push_back({name,
                                         [=](int x, int y) {
                                             if (kind == 0) return 0.0;
                                             if (kind == 1)
                                                 return (x + y) % 7 == 0 ? std::nan("") : std::sin(x * 0.1 + y);
                                             if (kind == 2) return x * 1e30 - y * 1e30;
                                             return static_cast<double>((x * 3 + y) % 5);
                                         },
                                         type});
            }
            if (part.channels.empty()) part.channels = {{"N.X"}};
            switch (random() % 6) {
                case 0:
                    part.attributes.push_back(
                        {"multiView", "stringvector", std::vector<std::string>{word(), word(), "left"}});
                    break;
                case 1:
                    part.attributes.push_back(test::text("BlenderMultiChannel", word()));
                    break;
                case 2:
                    part.attributes.push_back(test::text("cryptomatte/abc/name", word()));
                    break;
                case 3:
                    part.attributes.push_back(test::text("vrayInfo/x", word()));
                    break;
                case 4:
                    part.attributes.push_back(test::text("colorInteropID", word()));
                    break;
                default:
                    break;
            }
        }
        const std::filesystem::path path = folder / "a.exr";
        try {
            test::write_exr(path, parts, {{0, 0, 20, 9}, {0, 0, 20, 9}, 1});
        } catch (const Error&) {
            continue;  // names that no EXR may have
        }
        GBufferOptions options;
        if (random() % 3 == 0) options.part = word();
        if (random() % 3 == 0) options.view = word();
        if (random() % 3 == 0) options.channels["normal"].channel = word();
        if (random() % 3 == 0) options.channels["roughness"].channel = word();
        use(path, options);
    }
}

TEST(HostileGBuffer, PartsFarApartAreRefused) {
    const io::TemporaryFolder folder;
    gbuffer::SourceFile file;
    file.path = folder / "far.exr";
    for (const int x : {-1'000'000'000, 1'000'000'000}) {
        io::Part& part = file.header.parts.emplace_back();
        part.name = x < 0 ? "normal" : "rgba";
        part.data_window = {x, x, 4, 4};
        part.display_window = {0, 0, 4, 4};
        for (const char* name : {"B", "G", "R"}) part.channels.push_back({name, PixelType::half, 1, 1, false});
    }
    file.layers = gbuffer::index_layers(file.header, 0, "far");
    file.producer = gbuffer::detect_producer(file.header, file.layers);
    try {
        gbuffer::understand(std::move(file), {}, 1);
        ADD_FAILURE();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::format);
        EXPECT_NE(std::string(error.what()).find("far.exr"), std::string::npos);
    }
}

TEST(HostileGBuffer, ThousandsOfLayersTakeNoTime) {
    io::Header header;
    io::Part& part = header.parts.emplace_back();
    part.data_window = part.display_window = {0, 0, 4, 4};
    std::string deep;
    for (int i = 0; i < 60; ++i) deep += "a.";
    for (int i = 0; i < 4000; ++i)
        part.channels.push_back({deep + std::to_string(i) + ".X", PixelType::half, 1, 1, false});
    const std::clock_t start = std::clock();
    gbuffer::SourceFile file;
    file.path = "many.exr";
    file.header = header;
    file.layers = gbuffer::index_layers(file.header, 0, "many");
    file.producer = gbuffer::detect_producer(file.header, file.layers);
    EXPECT_THROW(gbuffer::understand(std::move(file), {}, 1), Error);
    EXPECT_LT(std::clock() - start, 5 * CLOCKS_PER_SEC);
}

TEST(HostileGBuffer, OtherFilesAreNamed) {
    const io::TemporaryFolder folder;
    MadePart part;
    test::add_vector(part, "N", test::constant(0, 0, 1));
    test::write_exr(folder / "a.exr", {part});
    const auto kind = [&](const std::string& channel, std::string& message) {
        GBufferOptions options;
        options.channels["roughness"].channel = channel;
        try {
            GBuffer::read(folder / "a.exr", options);
        } catch (const Error& error) {
            message = error.what();
            return error.kind();
        }
        return ErrorKind::cancelled;
    };
    std::string message;
    EXPECT_EQ(kind((folder / "missing.exr").string(), message), ErrorKind::file);
    EXPECT_NE(message.find("missing.exr"), std::string::npos);
    std::ofstream(folder / "not.exr") << "PNG it is not, EXR neither";
    EXPECT_EQ(kind((folder / "not.exr").string(), message), ErrorKind::format);
    EXPECT_NE(message.find("not.exr"), std::string::npos);
    EXPECT_EQ(kind((folder / "rough.png").string(), message), ErrorKind::format);
    EXPECT_NE(message.find("OpenImageIO"), std::string::npos) << message;
    EXPECT_EQ(kind("no such layer", message), ErrorKind::channel);
    EXPECT_THROW(GBuffer::read(folder / "missing.exr"), Error);
    EXPECT_THROW(GBuffer::read(folder / "not.exr"), Error);
    EXPECT_THROW(GBuffer::read(folder.path()), Error);
}

TEST(LayerNames, FitPatternsFromTheirEnd) {
    using gbuffer::Fit;
    using gbuffer::match_layer;
    EXPECT_EQ(match_layer("Normal", "Normal").fit, Fit::exact);
    EXPECT_EQ(match_layer("set.v2 main.Normal", "Normal").fit, Fit::exact);
    EXPECT_EQ(match_layer("set.v2 main.Normal", "Normal").group, "set.v2 main");
    EXPECT_EQ(match_layer("a.base_color", "Base Color").fit, Fit::tolerant);
    EXPECT_EQ(match_layer("albedo.diffuse", "albedo").fit, Fit::qualified);
    EXPECT_EQ(match_layer("albedo.diffuse", "albedo").group, "");
    EXPECT_EQ(match_layer("abnormal", "Normal").fit, Fit::none);
    EXPECT_EQ(match_layer("", "Normal").fit, Fit::none);
    EXPECT_EQ(match_layer("FinalImageMovieRenderQueue_WorldNormal", "*WorldNormal").fit, Fit::exact);
    EXPECT_EQ(match_layer("v.Combined_key", "Combined_*").fit, Fit::exact);
    EXPECT_EQ(match_layer("v.Combined_key", "Combined_*").group, "v");
    EXPECT_EQ(match_layer("v.Combined", "Combined_*").fit, Fit::tolerant);
    EXPECT_EQ(match_layer("x.dd.y", "dd.y").group, "x");
    EXPECT_EQ(gbuffer::fold("Base Color-x_Y"), "basecolorxy");
    EXPECT_EQ(gbuffer::component_letter("red"), 'R');
    EXPECT_EQ(gbuffer::component_letter("a"), 'A');
    EXPECT_EQ(gbuffer::component_letter("rough"), '\0');
    EXPECT_EQ(gbuffer::component_letter(""), '\0');
}

}  // namespace
}  // namespace relume
