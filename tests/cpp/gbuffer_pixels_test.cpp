// SPDX-License-Identifier: Apache-2.0
// What the reader answers, against the formulas in double precision.
#include <gtest/gtest.h>

#include "gbuffer/pixel_steps.h"
#include "gbuffer/planes.h"
#include "made_scene.h"
#include "relume/error.h"

namespace relume {
namespace {

using test::add_vector;
using test::MadeChannel;
using test::MadePart;
using test::Vector3;

/// A disk before a background, as Blender writes it: averages are premultiplied by coverage, samples hit or miss.
class Disk : public testing::Test {
protected:
    /// Share of the pixel that the disk covers: 1 inside, falling to 0 over two pixels.
    static double coverage(int x, int y) {
        const double r = std::hypot(x + 0.5 - 24, y + 0.5 - 16);
        // Eighths, as of eight samples.
        return std::round(std::clamp((13 - r) / 2 + 0.5, 0.0, 1.0) * 8) / 8;
    }
    /// Whether the single sample hit: by chance at the edge.
    static bool hit(int x, int y) { return coverage(x, y) > (((x * 73 + y * 31) % 8) + 0.5) / 8; }

    test::VectorFunction averaged(const test::VectorFunction& value) const {
        return [=](int x, int y) { return gbuffer::scaled(value(x, y), coverage(x, y)); };
    }
    test::VectorFunction sampled(const test::VectorFunction& value) const {
        return [=](int x, int y) { return hit(x, y) ? value(x, y) : Vector3{}; };
    }

    MadePart blender() {
        MadePart part;
        part.attributes = {test::text("BlenderMultiChannel", "Blender V2.55.1 and newer")};
        add_vector(part, "V.Combined", averaged(test::constant(3, 2, 1)), "RGB");
        add_vector(part, "V.Normal", averaged([this](int x, int y) { return scene.world_normal(x, y); }));
        add_vector(part, "V.Position", sampled([this](int x, int y) { return scene.position(x, y); }));
        add_vector(part, "V.albedo", averaged(test::constant(0.25, 0.5, 0.75)), "RGB");
        part.channels.push_back({"V.albedo.A", [](int x, int y) { return coverage(x, y); }, PixelType::float32});
        part.channels.push_back({"V.Combined.A", [](int, int) { return 1.0; }, PixelType::float32});
        part.channels.push_back(
            {"V.roughness.X", [](int x, int y) { return 0.6 * coverage(x, y); }, PixelType::float32});
        part.channels.push_back(
            {"V.Depth.Z", [this](int x, int y) { return hit(x, y) ? scene.depth(x, y) : 1e10; }, PixelType::float32});
        part.channels.push_back(
            {"V.IndexOB.X", [](int x, int y) { return hit(x, y) ? 5.0 : 0.0; }, PixelType::float32});
        return part;
    }

    GBuffer read(const MadePart& part, const GBufferOptions& options = {}) {
        test::write_exr(folder / "a.exr", {part}, scene.windows);
        return GBuffer::read(folder / "a.exr", options);
    }

    template <typename Check> void each(const Check& check) {
        const Window& w = scene.windows.data;
        for (int y = w.y; y < w.y_end(); ++y) {
            for (int x = w.x; x < w.x_end(); ++x)
                check(x, y, static_cast<std::size_t>(x - w.x), static_cast<std::size_t>(y - w.y));
        }
    }

    io::TemporaryFolder folder;
    test::MadeScene scene;
};

TEST_F(Disk, AveragesAreDividedByCoverage) {
    const GBuffer gbuffer = read(blender());
    const test::Answer share = test::ask(gbuffer, test::semantic("coverage")),
                       normal = test::ask(gbuffer, test::semantic("normal", 3)),
                       color = test::ask(gbuffer, test::semantic("base_color", 3)),
                       roughness = test::ask(gbuffer, test::semantic("roughness")),
                       beauty = test::ask(gbuffer, test::semantic("beauty", 3)),
                       alpha = test::ask(gbuffer, test::semantic("alpha"));
    each([&](int x, int y, std::size_t i, std::size_t j) {
        const double c = coverage(x, y);
        ASSERT_FLOAT_EQ(share[0][j][i], static_cast<float>(c));
        const Vector3 n = c > 0 ? scene.world_normal(x, y) : Vector3{};
        for (std::size_t k = 0; k < 3; ++k) {
            ASSERT_NEAR(static_cast<double>(normal[k][j][i]), n[k], 1e-6) << x << ' ' << y;
            ASSERT_NEAR(static_cast<double>(color[k][j][i]), c > 0 ? 0.25 * static_cast<double>(k + 1) : 0.0, 1e-6);
            // The beauty stays as it was rendered.
            ASSERT_NEAR(static_cast<double>(beauty[k][j][i]), c * static_cast<double>(3 - k), 1e-6);
        }
        ASSERT_NEAR(static_cast<double>(roughness[0][j][i]), c > 0 ? 0.6 : 0.0, 1e-6);
        ASSERT_EQ(alpha[0][j][i], 1.0f);
    });
    // A channel asked for by name is divided too, then scaled.
    ChannelRequest raw;
    raw.kind = ChannelRequest::Kind::raw;
    raw.name = "roughness";
    raw.scale = 2;
    raw.offset = 0.25;
    EXPECT_NEAR(test::ask(gbuffer, raw)[0][16][12], 2 * 0.6f + 0.25f, 1e-6f);
    raw.name = "V.Combined.G";
    raw.scale = 1;
    raw.offset = 0;
    EXPECT_NEAR(static_cast<double>(test::ask(gbuffer, raw)[0][16][11]), 2 * coverage(11, 16), 1e-6);
    raw.name = "albedo";
    raw.components = 3;
    EXPECT_EQ(test::ask(gbuffer, raw).size(), 3u);
    EXPECT_NEAR(test::ask(gbuffer, raw)[2][16][12], 0.75f, 1e-6f);
    raw.name = "nothing";
    EXPECT_THROW(test::ask(gbuffer, raw), Error);
}

TEST_F(Disk, SamplesThatMissedAreRepaired) {
    const GBuffer gbuffer = read(blender());
    const test::Answer position = test::ask(gbuffer, test::semantic("position", 3)),
                       depth = test::ask(gbuffer, test::semantic("depth"));
    ChannelRequest request = test::semantic("object_id");
    request.kind = ChannelRequest::Kind::id;
    const test::Answer id = test::ask(gbuffer, request);
    int repaired = 0;
    each([&](int x, int y, std::size_t i, std::size_t j) {
        if (coverage(x, y) == 0) return;
        const Vector3 p = scene.position(x, y);
        Vector3 error{};
        for (std::size_t k = 0; k < 3; ++k) error[k] = static_cast<double>(position[k][j][i]) - p[k];
        repaired += !hit(x, y);
        // A neighbour's depth along the pixel's own ray: off along the ray alone, by what the hills rise over few
        // pixels.
        ASSERT_LT(gbuffer::length(error), hit(x, y) ? 1e-4 : 2.5) << x << ' ' << y;
        const Vector3 eye{scene.camera.camera_to_world[3], scene.camera.camera_to_world[7],
                          scene.camera.camera_to_world[11]};
        const Vector3 ray = gbuffer::scaled(gbuffer::minus(p, eye), 1 / gbuffer::length(gbuffer::minus(p, eye)));
        ASSERT_LT(gbuffer::length(gbuffer::cross(error, ray)), 1e-4) << x << ' ' << y;
        ASSERT_NEAR(static_cast<double>(depth[0][j][i]), scene.depth(x, y), hit(x, y) ? 1e-4 : 2.5);
        ASSERT_EQ(std::bit_cast<std::uint32_t>(id[0][j][i]), 5u) << x << ' ' << y;
    });
    EXPECT_GT(repaired, 30);
    // However it is cut.
    for (const auto& [rows, step] : {std::pair(1, 1), std::pair(1, 48), std::pair(3, 5), std::pair(32, 17)}) {
        EXPECT_TRUE(position == test::ask(gbuffer, test::semantic("position", 3), rows, step)) << rows;
        EXPECT_TRUE(depth == test::ask(gbuffer, test::semantic("depth"), rows, step));
    }
}

TEST_F(Disk, CoverageComesFromWhatThereIs) {
    const auto reason = [](const GBuffer& gbuffer) {
        return gbuffer.find("coverage") ? gbuffer.find("coverage")->reason : "none";
    };
    MadePart part = blender();
    EXPECT_NE(reason(read(part)).find("albedo AOV"), std::string::npos);

    // An AOV that half of the surfaces do not write is no coverage; the transparent film is.
    const auto channel = [&](const std::string& name) -> MadeChannel& {
        return *std::find_if(part.channels.begin(), part.channels.end(),
                             [&](const MadeChannel& c) { return c.name == name; });
    };
    channel("V.albedo.A").value = [](int x, int y) { return x < 24 ? coverage(x, y) : 0.0; };
    channel("V.Combined.A").value = [](int x, int y) { return coverage(x, y); };
    GBuffer gbuffer = read(part);
    EXPECT_NE(reason(gbuffer).find("film is transparent"), std::string::npos) << reason(gbuffer);
    EXPECT_TRUE(test::mentions(gbuffer.notes(), "not taken as coverage"));

    // An opaque film says nothing; Cryptomatte does.
    channel("V.Combined.A").value = [](int, int) { return 1.0; };
    for (const char* letter : {"r", "g", "b", "a"}) {
        const bool share = letter[0] == 'g' || letter[0] == 'a';
        part.channels.push_back({std::string("V.CryptoObject00.") + letter,
                                 [=](int x, int y) { return share ? coverage(x, y) / 2 : 1.0; }, PixelType::float32});
    }
    gbuffer = read(part);
    EXPECT_NE(reason(gbuffer).find("Cryptomatte"), std::string::npos) << reason(gbuffer);
    EXPECT_NEAR(test::ask(gbuffer, test::semantic("roughness"))[0][16][12], 0.6f, 1e-6f);

    // A channel of its own beats all.
    part.channels.push_back({"V.coverage.X", [](int x, int y) { return coverage(x, y); }, PixelType::float32});
    EXPECT_EQ(read(part).find("coverage")->sources, std::vector<std::string>{"V.coverage.X"});

    // Nothing: said so, and 1 everywhere.
    MadePart bare;
    bare.attributes = part.attributes;
    add_vector(bare, "V.Normal", averaged(test::constant(0, 0, 1)));
    gbuffer = read(bare);
    EXPECT_TRUE(test::mentions(gbuffer.notes(), "nothing tells how much"));
    EXPECT_EQ(test::ask(gbuffer, test::semantic("coverage"))[0][0][0], 1.0f);
    EXPECT_EQ(test::ask(gbuffer, test::semantic("alpha"))[0][0][0], 1.0f);
}

TEST_F(Disk, WhatIsNoNumberStaysSo) {
    MadePart part = blender();
    const double nan = std::nan("");
    for (MadeChannel& channel : part.channels) {
        const auto value = channel.value;
        channel.value = [=](int x, int y) {
            return x == 24 && y == 16 ? nan : x == 25 && y == 16 ? HUGE_VAL : value(x, y);
        };
    }
    const GBuffer gbuffer = read(part);
    for (const auto& [name, components] : {std::pair("normal", 3), std::pair("position", 3), std::pair("base_color", 3),
                                           std::pair("roughness", 1), std::pair("beauty", 3), std::pair("depth", 1)}) {
        const test::Answer answer = test::ask(gbuffer, test::semantic(name, components));
        for (const auto& component : answer) {
            EXPECT_FALSE(std::isfinite(component[16][24])) << name;
            EXPECT_FALSE(std::isfinite(component[16][25])) << name;
            // Its neighbours do not suffer.
            EXPECT_TRUE(std::isfinite(component[16][23]) && std::isfinite(component[15][24]) &&
                        std::isfinite(component[16][26]))
                << name;
        }
    }
    ChannelRequest id = test::semantic("object_id");
    id.kind = ChannelRequest::Kind::id;
    EXPECT_EQ(std::bit_cast<std::uint32_t>(test::ask(gbuffer, id)[0][16][24]), 0u);
}

TEST_F(Disk, CodedNormalsAreTakenOutOfTheBackgroundFirst) {
    // (n + 1)/2 averaged with the background's 0.
    MadePart part;
    add_vector(part, "WorldNormal", averaged([this](int x, int y) {
                   const Vector3 n = scene.world_normal(x, y);
                   return Vector3{0.5 * n[0] + 0.5, 0.5 * n[1] + 0.5, 0.5 * n[2] + 0.5};
               }),
               "RGB");
    part.channels.push_back({"A", [](int x, int y) { return coverage(x, y); }, PixelType::float32});
    add_vector(part, "", averaged(test::constant(1, 1, 1)), "RGB");
    const GBuffer gbuffer = read(part);
    const test::Answer normal = test::ask(gbuffer, test::semantic("normal", 3));
    each([&](int x, int y, std::size_t i, std::size_t j) {
        const Vector3 n = coverage(x, y) > 0 ? scene.world_normal(x, y) : Vector3{};
        for (std::size_t k = 0; k < 3; ++k)
            ASSERT_NEAR(static_cast<double>(normal[k][j][i]), n[k], 1e-5) << x << ' ' << y;
    });
}

TEST_F(Disk, StraightAlphaIsMultipliedIn) {
    MadePart part;
    add_vector(part, "N", test::constant(0, 0, 1));
    add_vector(part, "", test::constant(3, 2, 1), "RGB");
    part.channels.push_back({"A", [](int x, int y) { return coverage(x, y); }, PixelType::float32});
    GBufferOptions options;
    options.alpha = AlphaMode::straight;
    const test::Answer beauty = test::ask(read(part, options), test::semantic("beauty", 3));
    each([&](int x, int y, std::size_t i, std::size_t j) {
        ASSERT_NEAR(static_cast<double>(beauty[0][j][i]), 3 * coverage(x, y), 1e-6);
    });
}

TEST_F(Disk, ViewsAndDepthsFollowTheCamera) {
    const GBuffer gbuffer = read(blender());
    const test::Answer view = test::ask(gbuffer, test::semantic("view", 3));
    each([&](int x, int y, std::size_t i, std::size_t j) {
        const Vector3 to_eye =
            gbuffer::minus(gbuffer.camera()->position(), test::at_depth(*gbuffer.camera(), x + 0.5, y + 0.5, 1));
        for (std::size_t k = 0; k < 3; ++k) {
            ASSERT_NEAR(static_cast<double>(view[k][j][i]), to_eye[k] / gbuffer::length(to_eye), 3e-7);
        }
    });

    // Depth alone, along the axis and along the ray, with a camera from the user.
    for (const bool ray : {false, true}) {
        for (const bool parallel : {false, true}) {
            if (ray && parallel) continue;
            test::MadeScene other;
            if (parallel) {
                other.camera.projection = Projection::orthographic;
                test::set_lens(other.camera, other.windows.display, 4);
            }
            MadePart part;
            add_vector(part, "N", test::constant(0, 0, 1));
            part.channels.push_back({"Z",
                                     [&](int x, int y) { return ray ? other.ray_distance(x, y) : other.depth(x, y); },
                                     PixelType::float32});
            GBufferOptions options;
            options.camera_matrix = other.camera.camera_to_world;
            options.channels["depth"].kind = ray ? DepthKind::ray : DepthKind::planar;
            if (parallel) {
                options.width = 8;
            } else {
                options.fov = 2 * std::atan(0.45) * 180 / M_PI;
            }
            const GBuffer deep = read(part, options);
            EXPECT_LT(test::largest_difference(test::ask(deep, test::semantic("position", 3)), other.windows.data,
                                               [&](int x, int y) { return other.position(x, y); }),
                      1e-5)
                << ray << parallel;
            EXPECT_NEAR(static_cast<double>(test::ask(deep, test::semantic("depth"))[0][4][5]), other.depth(5, 4),
                        1e-5);
        }
    }
}

TEST_F(Disk, DataAndDisplayWindowsMayDiffer) {
    scene.windows.data = {-5, 7, 48, 32};
    scene.windows.display = {0, 0, 64, 48};
    test::set_lens(scene.camera, scene.windows.display, 0.45);
    MadePart part;
    add_vector(part, "N", [this](int x, int y) { return scene.world_normal(x, y); });
    add_vector(part, "P", [this](int x, int y) { return scene.position(x, y); });
    const GBuffer gbuffer = read(part);
    EXPECT_EQ(gbuffer.data_window(), scene.windows.data);
    EXPECT_EQ(gbuffer.display_window(), scene.windows.display);
    EXPECT_LT(test::largest_pixel_difference(scene.camera, *gbuffer.camera(), scene.windows.data, 8), 2e-3);
    EXPECT_LT(test::largest_difference(test::ask(gbuffer, test::semantic("position", 3), 5, 11), scene.windows.data,
                                       [this](int x, int y) { return scene.position(x, y); }),
              1e-5);
}

TEST(Pixels, IdentifiersAreRounded) {
    EXPECT_EQ(gbuffer::to_identifier(2.4999f), 2u);
    EXPECT_EQ(gbuffer::to_identifier(2.5f), 3u);
    EXPECT_EQ(gbuffer::to_identifier(-1.0f), 0u);
    EXPECT_EQ(gbuffer::to_identifier(std::nanf("")), 0u);
    EXPECT_EQ(gbuffer::to_identifier(HUGE_VALF), 4294967040u);
    EXPECT_EQ(gbuffer::to_identifier(16777216.0f), 16777216u);
}

TEST(Pixels, StandInsAreCodedApart) {
    std::set<std::int32_t> codes;
    for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -gbuffer::kRepairReach; dx <= gbuffer::kRepairReach; ++dx) {
            const std::int32_t code = gbuffer::stand_in(dx, dy);
            EXPECT_NE(code, 0);
            EXPECT_EQ(gbuffer::stand_in_column(code), dx);
            EXPECT_EQ(gbuffer::stand_in_row(code), dy);
            EXPECT_TRUE(codes.insert(code).second);
        }
    }
}

TEST(Pixels, ACompressionThatChangesNumbersIsNamed) {
    const io::TemporaryFolder folder;
    const auto noted = [&](io::Compression compression, PixelType type) {
        MadePart part;
        for (const char* name : {"N.X", "N.Y", "N.Z"})
            part.channels.push_back({name, [](int, int) { return 0.6; }, type});
        test::write_exr(folder / "made.exr", {part}, {}, compression);
        return test::mentions(GBuffer::read(folder / "made.exr").notes(),
                              "the compression '" + std::string(io::name_of(compression)) + "' changes numbers");
    };
    using enum io::Compression;
    for (const io::Compression exact : {none, rle, zips, zip, piz}) EXPECT_FALSE(noted(exact, PixelType::float32));
    EXPECT_TRUE(noted(pxr24, PixelType::float32));
    EXPECT_FALSE(noted(pxr24, PixelType::half));
    EXPECT_TRUE(noted(b44, PixelType::half));
    EXPECT_FALSE(noted(b44a, PixelType::float32));
    if (io::is_supported(dwab)) {
        EXPECT_TRUE(noted(dwaa, PixelType::half));
        EXPECT_TRUE(noted(dwab, PixelType::float32));
    }
}

}  // namespace
}  // namespace relume
