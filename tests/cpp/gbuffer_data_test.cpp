// SPDX-License-Identifier: Apache-2.0
// The renderer's own files. Without them these tests say so and pass: what a clone must prove alone stands elsewhere.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>

#include "gbuffer/camera_fit.h"
#include "gbuffer_files.h"
#include "made_camera.h"
#include "relume/error.h"

namespace relume {
namespace {

#define NEED_DATA(folder)                                                                           \
  const std::filesystem::path folder = test::test_data();                                           \
  if (folder.empty()) {                                                                             \
    std::cout << "RELUME_TEST_DATA does not lead to the renderer's files: nothing to check here\n"; \
    return;                                                                                         \
  }

struct Expected {
    const char* file;
    std::set<std::string> channels;  ///< at least these
    const char* working_space = "lin_rec709";
    bool camera = true;
    const char* note = "";  ///< words of a note that must be there
};

const std::set<std::string> kBasic{"beauty", "alpha", "normal", "base_color", "roughness", "coverage", "view"};

std::set<std::string> with(std::set<std::string> base, const std::set<std::string>& more) {
    base.insert(more.begin(), more.end());
    return base;
}

TEST(GBufferData, EveryVariantIsUnderstood) {
    NEED_DATA(folder)
    const std::set<std::string> places = with(kBasic, {"position", "depth"});
    const std::vector<Expected> files{
        {"blender/variants/v_allpasses.exr", with(places, {"metallic", "specular", "emission", "ambient_occlusion"})},
        {"blender/variants/v_border.exr", with(places, {"metallic", "specular"})},
        {"blender/variants/v_fileoutput.exr", places},
        {"blender/variants/v_multiview.exr",
         {"beauty", "normal", "position", "depth", "coverage"},
         "lin_rec709",
         true,
         "views left, right"},
        {"blender/variants/v_twolayers.exr", with(places, {"metallic"}), "lin_rec709", true, "'char' is taken"},
        {"blender5/variants/v_allpasses_interleaved.exr",
         with(places, {"emission", "ambient_occlusion", "object_id", "material_id"})},
        {"blender5/variants/v_allpasses_parts.exr",
         with(places, {"emission", "ambient_occlusion", "object_id", "material_id"})},
        {"blender5/variants/v_border.exr", with(places, {"object_id"})},
        {"blender5/variants/v_border_crop.exr", with(places, {"object_id"})},
        {"blender5/variants/v_fileoutput_multilayer.exr", places},
        {"blender5/variants/v_fileoutput_multilayer_float.exr", places},
        {"blender5/variants/v_fileoutput_single_N.exr", {"normal", "view"}, "lin_rec709", false, "no base colour"},
        {"blender5/variants/v_override_acescg_multilayer.exr", kBasic, "lin_ap1", false, "no camera"},
        {"blender5/variants/v_stereo_interleaved.exr", places, "lin_rec709", true, "views left, right"},
        {"blender5/variants/v_stereo_parts.exr", places, "lin_rec709", true, "views left, right"},
        {"blender5/variants/v_twolayers_interleaved.exr", with(kBasic, {"depth", "object_id"}), "lin_rec709", false,
         "set.v2 main"},
        {"blender5/variants/v_twolayers_parts.exr", with(kBasic, {"depth", "object_id"}), "lin_rec709", false,
         "set.v2 main"},
        {"blender5/variants/v_working_acescg_interleaved.exr", kBasic, "lin_ap1", false},
        {"blender5/variants/v_working_acescg_parts.exr", kBasic, "lin_ap1", false},
        {"blender5/variants/v_working_linearrec2020_interleaved.exr", kBasic, "lin_rec2020", false},
        {"blender5/variants/v_working_linearrec2020_parts.exr", kBasic, "lin_rec2020", false},
    };
    std::set<std::string> seen;
    for (const Expected& expected : files) {
        SCOPED_TRACE(expected.file);
        seen.insert(expected.file);
        const GBuffer gbuffer = GBuffer::read(folder / expected.file);
        for (const std::string& name : expected.channels) EXPECT_TRUE(gbuffer.find(name)) << name;
        EXPECT_TRUE(gbuffer.producer().starts_with("Blender"));
        EXPECT_EQ(gbuffer.working_space(), expected.working_space);
        EXPECT_EQ(gbuffer.camera().has_value(), expected.camera) << gbuffer.camera_reason();
        EXPECT_TRUE(test::mentions(gbuffer.notes(), expected.note)) << expected.note;
        for (const ChannelInfo& info : gbuffer.channels()) {
            EXPECT_FALSE(info.reason.empty()) << info.name;
            EXPECT_FALSE(info.interpretation.empty()) << info.name;
        }
        // Nothing but the position may be outside, and every answer is finite.
        for (const char* name : {"normal", "view"}) {
            for (const auto& component : test::ask(gbuffer, test::semantic(name, 3))) {
                for (const auto& row : component) {
                    for (const float v : row) ASSERT_TRUE(std::abs(v) <= 1.00001f) << name;
                }
            }
        }
    }
    const std::vector<std::pair<const char*, const char*>> refused{
        {"blender/variants/v_plain_rgba_z.exr", "depth (Z)"},
        {"blender5/variants/v_fileoutput_single_P.exr", "position (X, Y, Z)"},
        {"blender5/variants/v_fileoutput_single_albedo.diffuse.exr", "beauty (R, G, B)"},
        {"blender5/variants/v_fileoutput_single_crypto_object00.exr", "Cryptomatte 'crypto_object'"},
        {"blender5/variants/v_fileoutput_single_depth.exr", "depth (R)"},
        {"blender5/variants/v_fileoutput_single_motion.exr", "motion"},
        {"blender5/variants/v_fileoutput_single_rgba.exr", "beauty (R, G, B)"},
        {"blender5/variants/v_fileoutput_single_roughness.exr", "roughness (R)"},
        {"blender5/variants/v_override_acescg_plain.exr", "beauty (R, G, B)"},
        {"blender5/variants/v_plain_bw.exr", "beauty (V)"},
        {"blender5/variants/v_plain_rgba.exr", "beauty (R, G, B)"},
    };
    for (const auto& [file, words] : refused) {
        seen.insert(file);
        try {
            GBuffer::read(folder / file);
            ADD_FAILURE() << file << " has no normal";
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::channel);
            const std::string message = error.what();
            EXPECT_NE(message.find("no normal channel"), std::string::npos) << message;
            EXPECT_NE(message.find(words), std::string::npos) << message;
            EXPECT_NE(message.find(std::filesystem::path(file).filename().string()), std::string::npos) << message;
        }
    }
    for (const char* set : {"blender", "blender5"}) {
        for (const auto& entry : std::filesystem::directory_iterator(folder / set / "variants")) {
            EXPECT_TRUE(seen.contains(std::string(set) + "/variants/" + entry.path().filename().string()))
                << entry.path();
        }
    }
}

TEST(GBufferData, OneFilePerChannelMakesAWhole) {
    NEED_DATA(folder)
    const std::filesystem::path files = folder / "blender5" / "variants";
    GBufferOptions options;
    const auto single = [&](const char* name) {
        return (files / ("v_fileoutput_single_" + std::string(name) + ".exr")).string();
    };
    options.channels["normal"].channel = single("N");
    options.channels["position"].channel = single("P");
    options.channels["depth"].channel = "v_fileoutput_single_depth.exr";  // beside the G-buffer
    options.channels["base_color"].channel = single("albedo.diffuse");
    options.channels["roughness"].channel = single("roughness");
    options.channels["cryptomatte"].channel = single("crypto_object00");
    const GBuffer gbuffer = GBuffer::read(single("rgba"), options);
    const GBuffer whole = GBuffer::read(files / "v_fileoutput_multilayer.exr");
    ASSERT_TRUE(gbuffer.camera());
    EXPECT_LT(test::largest_pixel_difference(*gbuffer.camera(), *whole.camera(), gbuffer.data_window(), 7), 1e-3);
    for (const auto& [name, components] :
         {std::pair("beauty", 3), std::pair("normal", 3), std::pair("base_color", 3), std::pair("roughness", 1)}) {
        const test::Answer a = test::ask(gbuffer, test::semantic(name, components)),
                           b = test::ask(whole, test::semantic(name, components));
        ASSERT_EQ(a.size(), b.size());
        float difference = 0;
        for (std::size_t k = 0; k < a.size(); ++k) {
            for (std::size_t j = 0; j < a[k].size(); ++j) {
                for (std::size_t i = 0; i < a[k][j].size(); ++i)
                    difference = std::max(difference, std::abs(a[k][j][i] - b[k][j][i]));
            }
        }
        // The two were rendered apart: their normals differ in the last bit.
        EXPECT_LE(difference, 2e-7f) << name;
    }
    ChannelRequest matte;
    matte.kind = ChannelRequest::Kind::matte;
    matte.patterns = {"Ball_*"};
    EXPECT_TRUE(test::ask(gbuffer, matte) == test::ask(whole, matte));

    options.channels["roughness"].channel = (folder / "blender" / "suzanne_gbuf_point.exr").string();
    try {
        GBuffer::read(single("rgba"), options);
        ADD_FAILURE() << "sizes differ";
    } catch (const Error& error) {
        const std::string message = error.what();
        EXPECT_NE(message.find("960x540"), std::string::npos) << message;
        EXPECT_NE(message.find("96x54"), std::string::npos) << message;
    }
}

/// What suzanne.json and materials5.json say of their cameras.
struct RealCamera {
    const char* file;
    std::array<double, 6> rows;  ///< cosine and sine of its pitch, as matrix_world has them, and its place
    int width, height;
    double median;
};

TEST(GBufferData, CamerasAreThoseOfTheScenes) {
    NEED_DATA(folder)
    const double c3 = 0.3956872820854187, s3 = 0.9183853268623352, c5 = 0.4075045585632324, s5 = 0.9132032990455627;
    const double y = -9.199999809265137, z = 4.599999904632568;
    const std::vector<RealCamera> cameras{{"blender/suzanne_gbuf_point.exr", {c3, s3, 0, y, z, 0}, 960, 540, 1e-4},
                                          {"blender/suzanne_gbuf_aa.exr", {c3, s3, 0, y, z, 0}, 960, 540, 1e-4},
                                          {"blender/suzanne_gbuf_1080.exr", {c3, s3, 0, y, z, 0}, 1920, 1080, 2e-4},
                                          {"blender5/materials5_gbuf_point.exr", {c5, s5, 0, y, z, 0}, 640, 360, 1e-4},
                                          {"blender5/materials5_gbuf_aa.exr", {c5, s5, 0, y, z, 0}, 640, 360, 1e-4}};
    for (const RealCamera& real : cameras) {
        SCOPED_TRACE(real.file);
        const GBuffer gbuffer = GBuffer::read(folder / real.file);
        ASSERT_TRUE(gbuffer.camera());
        Camera camera;
        const double c = real.rows[0], s = real.rows[1];
        camera.camera_to_world = {1, 0, 0, 0, 0, c, -s, real.rows[3], 0, s, c, real.rows[4], 0, 0, 0, 1};
        const Window window{0, 0, real.width, real.height};
        test::set_lens(camera, window, 36.0 / 38.0 / 2);
        EXPECT_EQ(gbuffer.display_window(), window);
        const Camera& found = *gbuffer.camera();
        EXPECT_LT(test::largest_pixel_difference(camera, found, window, 9), 1e-3);
        for (std::size_t k = 0; k < 16; ++k)
            EXPECT_NEAR(found.camera_to_world[k], camera.camera_to_world[k], 2e-6) << k;
        EXPECT_NEAR(found.x_scale / camera.x_scale, 1, 1e-6);
        EXPECT_LT(gbuffer.camera_error(), real.median);
        EXPECT_NE(gbuffer.camera_reason().find("recovered"), std::string_view::npos);
    }
}

TEST(GBufferData, PositionFromDepthIsThePosition) {
    NEED_DATA(folder)
    GBufferOptions options;
    const GBuffer whole = GBuffer::read(folder / "blender/suzanne_gbuf_point.exr");
    // The same file through its depth alone, with the camera given.
    const Camera& camera = *whole.camera();
    options.camera_matrix = camera.camera_to_world;
    options.fov = 2 * std::atan(36.0 / 38.0 / 2) * 180 / M_PI;
    const GBuffer plain = GBuffer::read(folder / "blender/suzanne_gbuf_point.exr", options);
    const test::Answer position = test::ask(plain, test::semantic("position", 3)),
                       depth = test::ask(plain, test::semantic("depth"));
    const test::Answer coverage = test::ask(plain, test::semantic("coverage"));
    std::vector<double> errors;
    for (std::size_t j = 0; j < 540; ++j) {
        for (std::size_t i = 0; i < 960; ++i) {
            if (coverage[0][j][i] < 1 || depth[0][j][i] > 1e8f) continue;
            const test::Vector3 p = test::at_depth(*plain.camera(), static_cast<double>(i) + 0.5,
                                                   static_cast<double>(j) + 0.5, static_cast<double>(depth[0][j][i]));
            double square = 0;
            for (std::size_t k = 0; k < 3; ++k) square += std::pow(p[k] - static_cast<double>(position[k][j][i]), 2);
            errors.push_back(std::sqrt(square));
        }
    }
    std::sort(errors.begin(), errors.end());
    ASSERT_GT(errors.size(), 100000u);
    EXPECT_LT(errors[errors.size() / 2], 2e-6);
    EXPECT_LT(errors[errors.size() * 99 / 100], 2e-5);
}

TEST(GBufferData, EdgesHoldWholeSurfaces) {
    NEED_DATA(folder)
    for (const char* file : {"blender/suzanne_gbuf_aa.exr", "blender5/materials5_gbuf_aa.exr"}) {
        SCOPED_TRACE(file);
        const GBuffer gbuffer = GBuffer::read(folder / file);
        const test::Answer coverage = test::ask(gbuffer, test::semantic("coverage"));
        const test::Answer normal = test::ask(gbuffer, test::semantic("normal", 3));
        const test::Answer position = test::ask(gbuffer, test::semantic("position", 3));
        const test::Answer roughness = test::ask(gbuffer, test::semantic("roughness"));
        const test::Answer color = test::ask(gbuffer, test::semantic("base_color", 3));
        std::int64_t edges = 0, unplaced = 0;
        float largest = 0, most_covered = 0;
        for (std::size_t j = 0; j < coverage[0].size(); ++j) {
            for (std::size_t i = 0; i < coverage[0][j].size(); ++i) {
                const float c = coverage[0][j][i];
                const auto square = [&](const test::Answer& a) {
                    return a[0][j][i] * a[0][j][i] + a[1][j][i] * a[1][j][i] + a[2][j][i] * a[2][j][i];
                };
                if (c == 0) {
                    ASSERT_EQ(square(normal), 0) << i << ' ' << j;
                    continue;
                }
                if (square(normal) == 0) continue;
                ASSERT_NEAR(square(normal), 1, 1e-5);
                edges += c < 1;
                if (square(position) == 0) {
                    ++unplaced;
                    most_covered = std::max(most_covered, c);
                }
                largest = std::max({largest, roughness[0][j][i], color[0][j][i], color[1][j][i], color[2][j][i]});
            }
        }
        EXPECT_GT(edges, 1000);
        // Every edge pixel finds a place for its surface among its neighbours, but for a handful that hardly show one.
        EXPECT_LE(unplaced, 20);
        EXPECT_LT(most_covered, 0.1f);
        // Albedo and roughness are at most 1 in these scenes; halves round.
        EXPECT_LT(largest, 1.01f);
    }
}

TEST(GBufferData, WhatAPixelGetsDependsOnNothingElse) {
    NEED_DATA(folder)
    const GBuffer gbuffer = GBuffer::read(folder / "blender5/materials5_gbuf_aa.exr");
    for (const auto& [name, components] :
         {std::pair("position", 3), std::pair("normal", 3), std::pair("view", 3), std::pair("depth", 1),
          std::pair("base_color", 3), std::pair("coverage", 1)}) {
        const test::Answer whole = test::ask(gbuffer, test::semantic(name, components));
        EXPECT_TRUE(whole == test::ask(gbuffer, test::semantic(name, components), 1, 7)) << name;
        EXPECT_TRUE(whole == test::ask(gbuffer, test::semantic(name, components), 37, 64)) << name;
        EXPECT_TRUE(whole == test::ask(gbuffer, test::semantic(name, components), 360, 0)) << name;
    }
    ChannelRequest id = test::semantic("object_id");
    id.kind = ChannelRequest::Kind::id;
    EXPECT_TRUE(test::ask(gbuffer, id) == test::ask(gbuffer, id, 5, 33));
}

}  // namespace
}  // namespace relume
