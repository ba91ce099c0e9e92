// SPDX-License-Identifier: Apache-2.0
// Depths, components, bounds, rows, scales and pixel aspects of images.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "io/pixel_convert.h"
#include "ofx_scene.h"

namespace relume::ofx::test {
namespace {

const SceneClips& scene() {
    static const SceneClips made(75, 41);
    return made;
}

class OfxFormatsTest : public testing::Test {
protected:
    void TearDown() override { EXPECT_EQ(complaints(host), ""); }

    std::vector<float> rendered(const RenderJob& job) {
        EXPECT_EQ(node.render(job, image), kOk) << node.instance().message;
        return pixels(*image);
    }

    Host host;
    Node node{host, name::kContextGeneral};
    std::unique_ptr<Image> image;
};

TEST_F(OfxFormatsTest, OutputsOfEveryDepthAreRoundedOnce) {
    scene().connect(node);
    light_one(node);
    const std::vector<float> exact = rendered({.window = scene().bounds});
    for (const char* depth : {name::kDepthByte, name::kDepthShort, name::kDepthHalf}) {
        const std::vector<float> got = rendered({.window = scene().bounds, .depth = depth});
        for (std::size_t k = 0; k < got.size(); ++k) {
            const double clamped = std::clamp(static_cast<double>(exact[k]), 0.0, 1.0);
            double wanted = clamped, slack = 0;
            if (depth == name::kDepthByte) wanted = std::round(clamped * 255) / 255, slack = 1e-7;
            if (depth == name::kDepthShort) wanted = std::round(clamped * 65535) / 65535, slack = 1.6e-5;
            if (depth == name::kDepthHalf) wanted = static_cast<double>(io::half_to_float(io::float_to_half(exact[k])));
            ASSERT_NEAR(static_cast<double>(got[k]), wanted, slack) << depth << " " << k;
        }
    }
}

TEST_F(OfxFormatsTest, OutputOfThreeComponents) {
    scene().connect(node);
    light_one(node);
    const std::vector<float> four = rendered({.window = scene().bounds});
    for (const char* depth : {name::kDepthFloat, name::kDepthByte}) {
        const std::vector<float> three = rendered({.window = scene().bounds, .depth = depth, .components = name::kRgb});
        for (std::size_t k = 0; k < three.size(); ++k) {
            if (k % 4 == 3) continue;
            const float wanted = depth == name::kDepthFloat ? four[k] : std::clamp(four[k], 0.f, 1.f);
            ASSERT_NEAR(three[k], wanted, depth == name::kDepthFloat ? 0 : 0.00197) << k;
        }
    }
}

TEST_F(OfxFormatsTest, HalfInputs) {
    for (const char* clip : kAllClips) node.clip(clip).depth = name::kDepthHalf;
    scene().connect(node);
    light_one(node);
    EXPECT_EQ(rendered({.window = scene().bounds}),
              relit(scene().arrays(kAllClips), scene().frame(), rig_one(), {}, PixelType::half));
}

TEST_F(OfxFormatsTest, ByteAndShortInputsWithPackedNormals) {
    for (const char* depth : {name::kDepthByte, name::kDepthShort}) {
        const double levels = depth == name::kDepthByte ? 255 : 65535;
        Arrays arrays = scene().arrays({"Source", "Normal", "BaseColor", "Roughness"});
        for (auto& [name, planes] : arrays)
            for (auto& plane : planes)
                for (float& v : plane) {
                    const double packed = name == "normal" ? (static_cast<double>(v) + 1) / 2 : static_cast<double>(v);
                    const auto level = static_cast<float>(std::lround(std::clamp(packed, 0.0, 1.0) * levels));
                    v = level / static_cast<float>(levels);
                }
        const Picture normal(scene().bounds, [&](int x, int y, int c) {
            const auto at =
                static_cast<std::size_t>(scene().bounds.y2 - 1 - y) * static_cast<std::size_t>(scene().width) +
                static_cast<std::size_t>(x);
            return c == 3 ? 1.f : arrays["normal"][static_cast<std::size_t>(c)][at];
        });
        for (const char* clip : {"Source", "Normal", "BaseColor", "Roughness"}) node.clip(clip).depth = depth;
        scene().connect(node, {"Source", "BaseColor", "Roughness"});
        node.connect("Normal", normal);
        light_one(node);
        EXPECT_EQ(rendered({.window = scene().bounds}), relit(arrays, scene().frame(), rig_one())) << depth;
    }
}

TEST_F(OfxFormatsTest, PaddedAndTurnedRows) {
    scene().connect(node);
    light_one(node);
    const std::vector<float> plain = rendered({.window = scene().bounds});
    for (const bool top_down : {false, true})
        for (const char* depth : {name::kDepthFloat, name::kDepthHalf}) {
            for (const char* clip : kAllClips) {
                node.clip(clip).padding = 20;
                node.clip(clip).top_down = top_down;
            }
            const std::vector<float> got =
                rendered({.window = scene().bounds, .depth = depth, .padding = 12, .top_down = !top_down});
            if (depth == name::kDepthFloat) {
                EXPECT_EQ(got, plain) << top_down;
                continue;
            }
            for (std::size_t k = 0; k < got.size(); ++k) ASSERT_NEAR(got[k], plain[k], 1e-3f * (1 + plain[k]));
        }
}

TEST_F(OfxFormatsTest, BoundsAnywhere) {
    for (const auto& [x, y] : {std::pair(-37, 211), std::pair(1000, -9), std::pair(-300, -200)}) {
        const SceneClips moved(75, 41, x, y);
        moved.connect(node);
        light_one(node);
        EXPECT_EQ(rendered({.window = moved.bounds}), moved.relit(rig_one(), kAllClips)) << x << " " << y;
        // A part of it into an image that is larger than the window.
        const OfxRectI part{x + 5, y + 7, x + 60, y + 30};
        const RenderJob job{.window = part, .bounds = {x - 3, y - 2, x + 90, y + 50}};
        ASSERT_EQ(node.render(job, image), kOk);
        const std::vector<float> whole = moved.relit(rig_one(), kAllClips);
        const std::vector<float> got = pixels(*image);
        EXPECT_EQ(crop(got, 93, job.bounds, part), crop(whole, 75, moved.bounds, part));
        // Beside the window nothing is touched.
        EXPECT_EQ(image->number(x + 4, y + 7, 0), 0.25f);
        EXPECT_EQ(image->number(x + 60, y + 29, 2), 0.25f);
        EXPECT_EQ(image->number(x + 5, y + 30, 1), 0.25f);
    }
}

TEST_F(OfxFormatsTest, WindowBeyondTheSourceIsTransparentBlack) {
    scene().connect(node);
    light_one(node);
    const OfxRectI wide{-10, -6, 85, 47};
    for (const char* depth : {name::kDepthFloat, name::kDepthShort}) {
        const std::vector<float> got = rendered({.window = wide, .depth = depth});
        for (int y = wide.y1; y < wide.y2; ++y)
            for (int x = wide.x1; x < wide.x2; ++x) {
                if (x >= 0 && x < 75 && y >= 0 && y < 41) continue;
                for (int c = 0; c < 4; ++c) ASSERT_EQ(image->number(x, y, c), 0.f) << x << " " << y;
            }
        if (depth == name::kDepthFloat) {
            EXPECT_EQ(crop(got, 95, wide, scene().bounds), scene().relit(rig_one(), kAllClips));
        }
    }
    // Wholly beside it.
    const std::vector<float> beside = rendered({.window = {100, 100, 110, 105}});
    EXPECT_EQ(std::count(beside.begin(), beside.end(), 0.f), 4 * 10 * 5);
}

TEST_F(OfxFormatsTest, LayersSmallerAndLargerThanTheSource) {
    scene().connect(node);
    light_one(node);
    Arrays cropped = scene().arrays(kAllClips);
    const OfxRectI part{9, 4, 70, 33};
    const Picture whole = scene().picture("Normal");
    node.connect("Normal", Picture(part, [&](int x, int y, int c) { return whole.at(x, y, c); }));
    for (int y = 0; y < 41; ++y)
        for (int x = 0; x < 75; ++x)
            if (x < part.x1 || x >= part.x2 || y < part.y1 || y >= part.y2)
                for (auto& plane : cropped["normal"]) plane[static_cast<std::size_t>((40 - y) * 75 + x)] = 0;
    EXPECT_EQ(rendered({.window = scene().bounds}), relit(cropped, scene().frame(), rig_one()));
    scene().connect(node);
    for (const char* clip : kAllClips) node.clip(clip).margin = 6;
    for (const char* clip : kAllClips)  // the clip defines what it did; its images just have more
        node.clip(clip).region_of_definition = OfxRectD{0, 0, 75, 41};
    EXPECT_EQ(rendered({.window = scene().bounds}), scene().relit(rig_one(), kAllClips));
}

TEST_F(OfxFormatsTest, SourceWithoutEnd) {
    // A constant defines everything: the project's format is what there is.
    node.set_project(75, 41);
    scene().connect(node);
    node.clip("Source").region_of_definition = OfxRectD{-2147483648.0, -2147483648.0, 2147483647.0, 2147483647.0};
    light_one(node);
    EXPECT_EQ(rendered({.window = scene().bounds}), scene().relit(rig_one(), kAllClips));
    const auto region = node.region_of_definition();
    ASSERT_TRUE(region.has_value());
    EXPECT_EQ(region->x2, 75);
    EXPECT_EQ(region->y2, 41);
}

TEST_F(OfxFormatsTest, SourceThatNobodyCanHold) {
    scene().connect(node);
    light_one(node);
    node.clip("Source").region_of_definition = OfxRectD{-9e6, -9e6, 9e6, 9e6};
    EXPECT_EQ(node.render({.window = scene().bounds}, image), kFailed);
    EXPECT_NE(node.instance().message.find("'Source'"), std::string::npos) << node.instance().message;
}

TEST_F(OfxFormatsTest, PixelAspectReachesTheCamera) {
    for (const double aspect : {1.0, 2.0, 0.5}) {
        for (const char* clip : kAllClips) node.clip(clip).aspect = aspect;
        scene().connect(node, {"Source", "Normal", "BaseColor", "Roughness", "Depth"});
        node.set_project(75 * aspect, 41, 0, 0, aspect);
        light_one(node);
        node.set("camera_fov", 50.0);
        node.choose("light2_type", "point");
        node.set("light2_position", std::vector{0.5, 1.0, 0.2});
        MemoryFrame frame{{0, 0, 75, 41}, {0, 0, 75, 41}, static_cast<float>(aspect)};
        GBufferOptions options;
        options.fov = 50;
        Rig rig = rig_one();
        Light point;
        point.name = "light2";
        point.type = "point";
        rig.lights.push_back(point);
        rig.set("light.light2.position", "[0.5, 1.0, 0.2]");
        EXPECT_EQ(rendered({.window = scene().bounds}),
                  relit(scene().arrays({"Source", "Normal", "BaseColor", "Roughness", "Depth"}), frame, rig, options))
            << aspect;
    }
}

TEST_F(OfxFormatsTest, FormatInTheProjectIsWhatAFieldOfViewGoesAcross) {
    const SceneClips moved(75, 41, 300, 200);
    moved.connect(node, {"Source", "Normal", "BaseColor", "Roughness"});
    light_one(node);
    node.set("camera_fov", 50.0);
    GBufferOptions options;
    options.fov = 50;
    EXPECT_EQ(rendered({.window = moved.bounds}),
              relit(moved.arrays({"Source", "Normal", "BaseColor", "Roughness"}), moved.frame(), rig_one(), options));
}

TEST_F(OfxFormatsTest, ProxiesNormaliseTheirNormals) {
    // Lambert, by hand: albedo/π · max(0, n·l) · E of the normal that the filter made, at unit length.
    const SceneClips large(80, 48);
    large.connect(node, {"Source", "Normal"});
    node.choose("shader", "lambert");
    node.set("lambert_base_color", std::vector{0.5, 0.25, 0.125});
    node.choose("light1_type", "sun");
    node.set("light1_direction", std::vector{-0.6, -0.8, 0.5});
    node.set("light1_irradiance", std::vector{2.0, 2.0, 2.0});
    const std::vector<float> got = rendered({.window = {0, 0, 40, 24}, .scale = 0.5});
    const Picture normal = large.picture("Normal");
    const double length = std::sqrt(0.6 * 0.6 + 0.8 * 0.8 + 0.5 * 0.5);
    int shortened = 0;
    for (int y = 0; y < 24; ++y)
        for (int x = 0; x < 40; ++x) {
            double n[3] = {}, size = 0, cosine = 0;
            for (int c = 0; c < 3; ++c) {
                for (int k = 0; k < 4; ++k) n[c] += static_cast<double>(normal.at(2 * x + k % 2, 2 * y + k / 2, c)) / 4;
                size += n[c] * n[c];
            }
            size = std::sqrt(size);
            if (size < 1e-3) continue;
            shortened += size < 0.99;
            const double l[3] = {0.6 / length, 0.8 / length, -0.5 / length};
            for (int c = 0; c < 3; ++c) cosine += n[c] / size * l[c];
            const double wanted = 0.5 / 3.14159265358979 * std::max(0.0, cosine) * 2;
            ASSERT_NEAR(static_cast<double>(image->number(x, y, 0)), wanted, 1e-5) << x << " " << y << " " << size;
        }
    EXPECT_GT(shortened, 5);
}

TEST_F(OfxFormatsTest, TilesOfAProxyGiveTheSameBits) {
    const SceneClips large(80, 48, -16, 8);
    large.connect(node);
    light_one(node);
    const OfxRectI half{-8, 4, 32, 28};
    const std::vector<float> whole = rendered({.window = half, .scale = 0.5});
    for (const OfxRectI& tile : {OfxRectI{-8, 4, 9, 11}, OfxRectI{9, 4, 32, 11}, OfxRectI{-8, 11, 32, 28}})
        EXPECT_EQ(rendered({.window = tile, .scale = 0.5}), crop(whole, 40, half, tile));
}

TEST_F(OfxFormatsTest, FilteredIdsAreNotTrusted) {
    // Objects 1 and 3 meet inside a proxy's pixels, whose mean is 2.
    const SceneClips large(80, 48);
    large.connect(node, {"Source", "Normal"});
    const auto ids = [](int edge, float left, float right) {
        return Picture({0, 0, 80, 48}, [=](int x, int, int c) { return c > 0 ? 0.f : x < edge ? left : right; });
    };
    node.connect("IDs", ids(41, 1, 3));
    light_one(node);
    node.set("overrides", "shader.0.use = unlit\nshader.0.object_id = [2]\nshader.0.emission = [9, 0, 0]");
    const auto red = [&](const RenderJob& job) {
        const std::vector<float> got = rendered(job);
        int count = 0;
        for (std::size_t k = 0; k < got.size(); k += 4) count += got[k] > 8;
        return count;
    };
    EXPECT_EQ(red({.window = {0, 0, 40, 24}, .scale = 0.5}), 0);
    EXPECT_EQ(red({.window = {0, 0, 80, 48}}), 0);
    // An object 2 of its own is one in the proxy too, up to its edge.
    node.connect("IDs", ids(40, 2, 3));
    const int at_full = red({.window = {0, 0, 80, 48}}), at_half = red({.window = {0, 0, 40, 24}, .scale = 0.5});
    EXPECT_GT(at_full, 100);
    EXPECT_NEAR(at_half, at_full / 4.0, at_full / 20.0);
}

TEST_F(OfxFormatsTest, RegionsAreTheWholeSource) {
    const SceneClips moved(75, 41, -20, 5);
    moved.connect(node);
    const auto regions = node.regions_of_interest({0, 10, 8, 12});
    for (const auto& [clip, region] : regions) {
        EXPECT_EQ(region.x1, -20) << clip;
        EXPECT_EQ(region.y1, 5) << clip;
        EXPECT_EQ(region.x2, 55) << clip;
        EXPECT_EQ(region.y2, 46) << clip;
    }
    EXPECT_EQ(node.clip_preferences().text(name::kPropPremultiplication), name::kPremultiplied);
    EXPECT_EQ(node.clip_preferences().integer(name::kPropFrameVarying), 0);
}

}  // namespace
}  // namespace relume::ofx::test
