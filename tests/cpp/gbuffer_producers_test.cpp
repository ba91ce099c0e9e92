// SPDX-License-Identifier: Apache-2.0
// One G-buffer in every producer's words: all must come out the same.
#include <gtest/gtest.h>

#include "made_scene.h"
#include "relume/error.h"

namespace relume {
namespace {

using test::add_vector;
using test::MadeChannel;
using test::MadePart;
using test::Vector3;

class Producers : public testing::Test {
protected:
    const test::VectorFunction normal = [this](int x, int y) { return scene.world_normal(x, y); };
    const test::VectorFunction seen_normal = [this](int x, int y) { return scene.camera_normal(x, y); };
    const test::VectorFunction position = [this](int x, int y) { return scene.position(x, y); };
    const test::VectorFunction seen_position = [this](int x, int y) { return scene.camera_position(x, y); };
    const test::VectorFunction color = test::constant(0.25, 0.5, 0.125);
    const test::VectorFunction light = test::constant(3, 2, 1);

    static MadeChannel one(const std::string& name, double value) {
        return {name, [=](int, int) { return value; }, PixelType::float32};
    }
    MadeChannel depth(const std::string& name) {
        return {name, [this](int x, int y) { return scene.depth(x, y); }, PixelType::float32};
    }
    static test::VectorFunction flipped(const test::VectorFunction& value, double x, double y, double z) {
        return [=](int i, int j) {
            const Vector3 v = value(i, j);
            return Vector3{x * v[0], y * v[1], z * v[2]};
        };
    }
    static test::VectorFunction coded(const test::VectorFunction& value) {
        return [=](int i, int j) {
            const Vector3 v = value(i, j);
            return Vector3{0.5 * v[0] + 0.5, 0.5 * v[1] + 0.5, 0.5 * v[2] + 0.5};
        };
    }

    GBuffer read(const std::vector<MadePart>& parts, const GBufferOptions& options = {}) {
        test::write_exr(folder / "a.exr", parts, scene.windows);
        return GBuffer::read(folder / "a.exr", options);
    }

    double error_of(const GBuffer& gbuffer, const std::string& name, const test::VectorFunction& expected) {
        return test::largest_difference(test::ask(gbuffer, test::semantic(name, 3)), scene.windows.data, expected);
    }

    /// The file is understood: its producer, and world normals, positions, depths, colours as the scene has them.
    void check(const GBuffer& gbuffer, std::string_view producer, std::initializer_list<const char*> channels) {
        EXPECT_EQ(gbuffer.producer(), producer);
        for (const char* name : channels) EXPECT_TRUE(gbuffer.find(name)) << name;
        ASSERT_TRUE(gbuffer.find("normal"));
        const auto told = [&](const char* name) {
            const ChannelInfo* info = gbuffer.find(name);
            return info->interpretation + "; " + info->reason + "; camera: " + std::string(gbuffer.camera_reason());
        };
        EXPECT_LT(error_of(gbuffer, "normal", normal), 1e-5) << told("normal");
        if (gbuffer.camera()) {
            EXPECT_LT(test::largest_pixel_difference(scene.camera, *gbuffer.camera(), scene.windows.data, 8), 2e-3)
                << gbuffer.camera_reason();
        }
        if (gbuffer.find("position")) {
            EXPECT_LT(error_of(gbuffer, "position", position), 1e-4) << told("position");
        }
        if (gbuffer.find("base_color")) {
            EXPECT_LT(error_of(gbuffer, "base_color", color), 1e-6) << told("base_color");
        }
        if (gbuffer.find("beauty")) {
            EXPECT_LT(error_of(gbuffer, "beauty", light), 1e-6) << told("beauty");
        }
        if (gbuffer.find("roughness")) {
            EXPECT_FLOAT_EQ(test::ask(gbuffer, test::semantic("roughness"))[0][3][4], 0.25f) << told("roughness");
        }
        if (gbuffer.find("depth")) {
            EXPECT_NEAR(static_cast<double>(test::ask(gbuffer, test::semantic("depth"))[0][7][9]), scene.depth(9, 7),
                        1e-4)
                << told("depth");
        }
    }

    io::TemporaryFolder folder;
    test::MadeScene scene;
};

TEST_F(Producers, BlenderOfOnePart) {
    MadePart part;
    part.attributes = {test::text("BlenderMultiChannel", "Blender V2.55.1 and newer")};
    add_vector(part, "View Layer.v2.Combined", light, "RGB");
    add_vector(part, "View Layer.v2.Normal", normal);
    add_vector(part, "View Layer.v2.Position", position);
    add_vector(part, "View Layer.v2.Base Color", color, "RGB");
    add_vector(part, "View Layer.v2.DiffCol", test::constant(9, 9, 9), "RGB");
    part.channels.insert(part.channels.end(),
                         {depth("View Layer.v2.Depth.Z"), one("View Layer.v2.Roughness.X", 0.25),
                          one("View Layer.v2.Coat Weight.X", 0.5), one("View Layer.v2.SheenTint.X", 0.75),
                          one("View Layer.v2.IndexOB.X", 3), one("View Layer.v2.IndexMA.X", 4)});
    const GBuffer gbuffer = read({part});
    check(gbuffer, "Blender",
          {"beauty", "position", "depth", "base_color", "roughness", "object_id", "material_id", "view"});
    // Any parameter of any shader by a layer of its name, however it is spelt.
    ASSERT_TRUE(gbuffer.find("coat_weight"));
    EXPECT_FLOAT_EQ(test::ask(gbuffer, test::semantic("coat_weight"))[0][0][0], 0.5f);
    ASSERT_TRUE(gbuffer.find("sheen_tint"));
    EXPECT_FLOAT_EQ(test::ask(gbuffer, test::semantic("sheen_tint"))[0][0][0], 0.75f);
    ChannelRequest id = test::semantic("material_id");
    id.kind = ChannelRequest::Kind::id;
    EXPECT_EQ(std::bit_cast<std::uint32_t>(test::ask(gbuffer, id)[0][0][0]), 4u);
    EXPECT_EQ(gbuffer.find("diffcol"), nullptr);
    EXPECT_TRUE(test::mentions(gbuffer.notes(), "DiffCol"));
    EXPECT_FALSE(gbuffer.find("specular"));
    EXPECT_TRUE(test::mentions(gbuffer.notes(), "no specular"));
}

TEST_F(Producers, BlenderOfManyParts) {
    std::vector<MadePart> parts;
    const auto layer = [&](const std::string& pass, const test::VectorFunction& value, const char* letters) {
        MadePart& part = parts.emplace_back();
        part.name = "ViewLayer." + pass;
        add_vector(part, part.name, value, letters);
        const bool data = std::string(letters) == "XYZ";
        part.attributes = {test::text("colorInteropID", data ? "data" : "lin_ap1_scene")};
    };
    layer("Combined", light, "RGB");
    layer("Normal", normal, "XYZ");
    layer("Position", position, "XYZ");
    layer("albedo", color, "RGB");
    parts[0].attributes.push_back(test::text("Software", "Blender 5.0.1"));
    MadePart& rough = parts.emplace_back();
    rough.name = "ViewLayer.roughness";
    rough.channels = {one("ViewLayer.roughness.X", 0.25)};
    const GBuffer gbuffer = read(parts);
    check(gbuffer, "Blender 5.0.1", {"beauty", "position", "depth", "base_color", "roughness"});
    EXPECT_EQ(gbuffer.working_space(), "lin_ap1");
    EXPECT_EQ(gbuffer.find("normal")->part, "ViewLayer.Normal");
}

TEST_F(Producers, BlenderDiffuseColourIsALastResort) {
    MadePart part;
    part.attributes = {test::text("BlenderMultiChannel", "Blender V2.55.1 and newer")};
    add_vector(part, "ViewLayer.Normal", normal);
    // A metal: all of its colour is in the glossy pass.
    add_vector(
        part, "ViewLayer.DiffCol",
        [](int x, int) {
            return x < 24 ? Vector3{0.25, 0.5, 0.125} : Vector3{};
        },
        "RGB");
    add_vector(
        part, "ViewLayer.GlossCol",
        [](int x, int) {
            return x < 24 ? Vector3{0.04, 0.04, 0.04} : Vector3{0.25, 0.5, 0.125};
        },
        "RGB");
    std::vector<MadePart> parts{part};
    const GBuffer plain = read(parts);
    EXPECT_TRUE(test::mentions(plain.notes(), "albedo AOV"));
    EXPECT_FLOAT_EQ(test::ask(plain, test::semantic("base_color", 3))[1][5][40], 0.0f);
    parts[0].channels.push_back(
        {"ViewLayer.metallic.X", [](int x, int) { return x < 24 ? 0.0 : 1.0; }, PixelType::float32});
    const GBuffer metal = read(parts);
    EXPECT_LT(error_of(metal, "base_color", color), 1e-6) << metal.find("base_color")->reason;
    EXPECT_NE(metal.find("base_color")->reason.find("metallic"), std::string::npos);
    // Grey everywhere, so it is no tinted pass.
    for (MadeChannel& channel : parts[0].channels) {
        if (channel.name.find("GlossCol") != std::string::npos) channel.value = [](int, int) { return 0.5; };
    }
    EXPECT_FLOAT_EQ(test::ask(read(parts), test::semantic("base_color", 3))[1][5][40], 0.0f);
    // An albedo in the file beats all of that.
    add_vector(parts[0], "ViewLayer.albedo", color, "RGB");
    EXPECT_LT(error_of(read(parts), "base_color", color), 1e-6);
}

TEST_F(Producers, Arnold) {
    MadePart part;
    part.attributes = {test::text("arnold/version", "7.2"), test::text("arnold/host/name", "maya")};
    add_vector(part, "", light, "RGB");
    part.channels.push_back(one("A", 1));
    add_vector(part, "N", normal);
    add_vector(part, "P", position);
    add_vector(part, "albedo", color, "RGB");
    add_vector(part, "specular", light, "RGB");
    part.channels.insert(part.channels.end(), {depth("Z"), one("ID", 7), one("specular_roughness.R", 0.25)});
    const GBuffer gbuffer = read({part});
    check(gbuffer, "Arnold", {"beauty", "alpha", "position", "depth", "base_color", "roughness", "object_id"});
    // The light that speculars reflect is no specular level.
    EXPECT_FALSE(gbuffer.find("specular"));
}

TEST_F(Producers, VRay) {
    MadePart part;
    part.attributes = {test::text("vrayInfo/vrayversion", "Version of V-Ray for 3ds Max"),
                       test::number("cameraFov", 2 * std::atan(0.45) * 180 / M_PI),
                       test::matrix("cameraTransform", scene.camera.camera_to_world)};
    add_vector(part, "", light, "RGB");
    part.channels.push_back(one("A", 1));
    add_vector(part, "normals", flipped(seen_normal, -1, 1, 1));
    add_vector(part, "diffuse", color, "RGB");
    part.channels.push_back(one("VRayMtlID.R", 12));
    GBuffer gbuffer = read({part});
    check(gbuffer, "V-Ray", {"beauty", "base_color", "material_id"});
    EXPECT_NE(gbuffer.find("normal")->interpretation.find("x flipped"), std::string::npos);
    EXPECT_NE(gbuffer.camera_reason().find("cameraTransform"), std::string_view::npos);

    // Through OpenImageIO the matrix has another name, and still goes from the camera to the world.
    part.attributes[2].name = "worldToCamera";
    gbuffer = read({part});
    check(gbuffer, "V-Ray", {});
    EXPECT_NE(gbuffer.camera_reason().find("camera to world"), std::string_view::npos) << gbuffer.camera_reason();

    // V-Ray for Maya turns the camera's frame a quarter about X.
    std::array<double, 16> quarter{1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1};
    part.attributes[2] = test::matrix("cameraTransform", test::product(scene.camera.camera_to_world, quarter));
    part.attributes[0] = test::text("vrayInfo/vrayversion", "Version of V-Ray for Maya Next");
    check(read({part}), "V-Ray", {});
    // With positions the header need not say who wrote it.
    part.attributes[0] = test::text("vrayInfo/vrayversion", "?");
    add_vector(part, "point_position", position);
    gbuffer = read({part});
    check(gbuffer, "V-Ray", {"position"});
    EXPECT_NE(gbuffer.camera_reason().find("positions confirm"), std::string_view::npos) << gbuffer.camera_reason();
}

TEST_F(Producers, RenderMan) {
    MadePart part;
    part.attributes = {test::text("renderman/version", "26.0")};
    add_vector(part, "", light, "RGB");
    add_vector(part, "__Nworld", normal, "rgb");
    add_vector(part, "__Pworld", position, "rgb");
    add_vector(part, "albedo", color, "rgb");
    part.channels.push_back(depth("__depth.r"));
    check(read({part}), "RenderMan", {"beauty", "position", "depth", "base_color"});

    // P and Nn in camera space, which looks along +Z; the world's frame from the header.
    MadePart seen;
    seen.attributes = part.attributes;
    std::array<double, 16> view = scene.view_matrix();
    for (std::size_t k = 0; k < 4; ++k) view[8 + k] = -view[8 + k];  // +Z forward
    seen.attributes.push_back(test::matrix("worldToCamera", test::transposed(view)));
    add_vector(seen, "Nn", flipped(seen_normal, 1, 1, -1), "rgb");
    add_vector(seen, "P", flipped(seen_position, 1, 1, -1), "rgb");
    const GBuffer gbuffer = read({seen});
    check(gbuffer, "RenderMan", {"position"});
    EXPECT_NE(gbuffer.find("position")->interpretation.find("camera space"), std::string::npos);

    // The same names in world space are recognised by the camera that they determine.
    MadePart world;
    world.attributes = part.attributes;
    add_vector(world, "Nn", normal, "rgb");
    add_vector(world, "P", position, "rgb");
    check(read({world}), "RenderMan", {"position"});
}

TEST_F(Producers, Mitsuba) {
    MadePart part;
    part.attributes = {test::text("generatedBy", "Mitsuba version 3.5.0")};
    add_vector(part, "", light, "RGB");
    // Not turned to the viewer: half of them point away.
    add_vector(part, "nn", [this](int x, int y) { return gbuffer::scaled(scene.world_normal(x, y), x % 2 ? -1 : 1); });
    add_vector(part, "pos", position);
    add_vector(part, "albedo", color, "RGB");
    const double near = 0.3;
    part.channels.push_back({"dd.T",
                             [=, this](int x, int y) {
                                 const double cosine = scene.depth(x, y) / scene.ray_distance(x, y);
                                 return scene.ray_distance(x, y) - near / cosine;
                             },
                             PixelType::float32});
    const GBuffer gbuffer = read({part});
    check(gbuffer, "Mitsuba", {"beauty", "position", "depth", "base_color"});
    EXPECT_NE(gbuffer.find("depth")->interpretation.find("near plane at 0.3"), std::string::npos)
        << gbuffer.find("depth")->interpretation;
    EXPECT_NE(gbuffer.find("normal")->interpretation.find("turned"), std::string::npos);

    // Without positions the near plane is Mitsuba's own default, unless it is given.
    std::erase_if(part.channels, [](const MadeChannel& channel) { return channel.name.starts_with("pos."); });
    GBufferOptions options;
    options.camera_matrix = scene.camera.camera_to_world;
    options.fov = 2 * std::atan(0.45) * 180 / M_PI;
    const auto depth_at = [&] {
        return static_cast<double>(test::ask(read({part}, options), test::semantic("depth"))[0][7][9]);
    };
    EXPECT_NEAR(depth_at(), scene.depth(9, 7) - near + 0.01, 1e-4);
    options.channels["depth"].near = near;
    EXPECT_NEAR(depth_at(), scene.depth(9, 7), 1e-4);
}

TEST_F(Producers, Pbrt) {
    MadePart part;
    std::array<double, 16> view = scene.view_matrix();
    for (std::size_t k = 0; k < 4; ++k) view[8 + k] = -view[8 + k];
    // pbrt stores its matrices the other way round.
    part.attributes = {test::number("samplesPerPixel", 16), test::matrix("worldToCamera", view)};
    add_vector(part, "", light, "RGB");
    add_vector(part, "Ns", flipped(seen_normal, 1, 1, -1));
    add_vector(part, "N", flipped(seen_normal, 1, 1, -1));
    add_vector(part, "P", flipped(seen_position, 1, 1, -1));
    add_vector(part, "Albedo", color, "RGB");
    const GBuffer gbuffer = read({part});
    check(gbuffer, "pbrt", {"beauty", "position", "base_color"});
    EXPECT_EQ(gbuffer.find("normal")->sources.front(), "Ns.X");
}

TEST_F(Producers, UnrealMovieRenderQueue) {
    MadePart part;
    // Unreal's world is left-handed: X forward, Y right, Z up, here with the camera's pitch and yaw.
    const double pitch = -20, yaw = 35;
    const double sp = std::sin(pitch * M_PI / 180), cp = std::cos(pitch * M_PI / 180), sy = std::sin(yaw * M_PI / 180),
                 cy = std::cos(yaw * M_PI / 180);
    const Vector3 forward{cp * cy, cp * sy, sp}, right{-sy, cy, 0}, up{-sp * cy, -sp * sy, cp};
    const std::array<double, 3> place{120, -40, 300};
    for (std::size_t i = 0; i < 3; ++i) {
        scene.camera.camera_to_world[4 * i] = right[i];
        scene.camera.camera_to_world[4 * i + 1] = up[i];
        scene.camera.camera_to_world[4 * i + 2] = -forward[i];
        scene.camera.camera_to_world[4 * i + 3] = place[i];
    }
    part.attributes = {test::text("unreal/camera/curPos/x", "120.0"),
                       test::text("unreal/camera/curPos/y", "-40.0"),
                       test::text("unreal/camera/curPos/z", "300.0"),
                       test::text("unreal/camera/curRot/pitch", "-20.0"),
                       test::text("unreal/camera/curRot/yaw", "35.0"),
                       test::text("unreal/camera/curRot/roll", "0.0"),
                       test::text("unreal/camera/FinalImage/fov", std::to_string(2 * std::atan(0.45) * 180 / M_PI))};
    add_vector(part, "", light, "RGB");
    const std::string queue = "FinalImageMovieRenderQueue_";
    add_vector(part, queue + "WorldNormal", coded(normal), "RGB");
    add_vector(part, queue + "BaseColor", color, "RGB");
    add_vector(
        part, queue + "WorldDepth",
        [this](int x, int y) {
            return Vector3{scene.depth(x, y), scene.depth(x, y), scene.depth(x, y)};
        },
        "RGB");
    add_vector(part, queue + "Roughness", test::constant(0.25, 0.25, 0.25), "RGB");
    const GBuffer gbuffer = read({part});
    check(gbuffer, "Unreal Engine", {"beauty", "depth", "position", "base_color", "roughness"});
    EXPECT_NE(gbuffer.find("normal")->interpretation.find("0..1"), std::string::npos);
    EXPECT_NE(gbuffer.find("normal")->reason.find("(v + 1)/2"), std::string::npos);

    // With world positions the camera that they determine confirms the header's.
    add_vector(part, queue + "WorldPosition", position, "RGB");
    const GBuffer placed = read({part});
    check(placed, "Unreal Engine", {"position"});
    EXPECT_NE(placed.camera_reason().find("confirm"), std::string_view::npos) << placed.camera_reason();
}

TEST_F(Producers, Karma) {
    MadePart part;
    part.attributes = {test::text("husk:render_stats", "{}")};
    add_vector(part, "C", light, "RGB");
    add_vector(part, "N", normal);
    add_vector(part, "P", position);
    add_vector(part, "CDA", color, "RGB");
    check(read({part}), "Karma", {"beauty", "position", "base_color"});
}

TEST_F(Producers, OthersByTheirNames) {
    MadePart part;
    add_vector(part, "", light, "RGB");
    add_vector(part, "normal_map", test::constant(0, 0, 1));
    add_vector(part, "World Normal", normal, "RGB");
    add_vector(part, "world_position", position, "RGB");
    add_vector(part, "BaseColor", color, "RGB");
    part.channels.push_back(one("GLOSSINESS", 0.75));
    const GBuffer gbuffer = read({part});
    check(gbuffer, "unknown", {"beauty", "position", "base_color", "roughness"});
    EXPECT_NE(gbuffer.find("roughness")->interpretation.find("1 - value"), std::string::npos);
}

TEST_F(Producers, PartsMayNameTheLayers) {
    // Nuke's and V-Ray's way: every part holds R, G, B and its name says what they are.
    std::vector<MadePart> parts;
    const auto layer = [&](const std::string& name, const test::VectorFunction& value) {
        parts.emplace_back().name = name;
        add_vector(parts.back(), "", value, "RGB");
    };
    layer("normals", coded(normal));
    layer("rgba", light);
    layer("base_color", color);
    layer("position", position);
    check(read(parts), "unknown", {"beauty", "base_color", "position"});
}

TEST_F(Producers, CameraSpaceIsSeenFromTheNormals) {
    MadePart part;
    add_vector(part, "N", seen_normal);
    add_vector(part, "P", position);
    const GBuffer gbuffer = read({part});
    check(gbuffer, "unknown", {"position"});
    EXPECT_NE(gbuffer.find("normal")->reason.find("face the camera"), std::string::npos);
    GBufferOptions options;
    options.channels["normal"].space = Space::world;
    const GBuffer insisted = read({part}, options);
    EXPECT_LT(error_of(insisted, "normal", seen_normal), 1e-5);
}

TEST_F(Producers, EstimatorsAreCodedAndInCameraSpace) {
    // DirectX's green points down; 8 bits are coarse, so nothing is quite of unit length.
    MadePart part;
    part.attributes = {test::text("Software", "Beeble SwitchLight")};
    add_vector(
        part, "normal",
        [this](int x, int y) {
            const Vector3 n = coded(flipped(seen_normal, 1, -1, 1))(x, y);
            return Vector3{std::round(n[0] * 255) / 255, std::round(n[1] * 255) / 255, std::round(n[2] * 255) / 255};
        },
        "RGB");
    add_vector(part, "Base Color", color, "RGB");
    part.channels.push_back(
        {"depth.R", [this](int x, int y) { return (scene.depth(x, y) - 2) / 18; }, PixelType::float32});
    GBufferOptions options;
    options.channels["normal"].flip = "y";
    options.channels["depth"].near = 2;
    options.channels["depth"].far = 20;
    options.fov = 2 * std::atan(0.45) * 180 / M_PI;
    const GBuffer gbuffer = read({part}, options);
    EXPECT_EQ(gbuffer.producer(), "a learned estimator");
    EXPECT_LT(error_of(gbuffer, "normal", seen_normal), 0.012);
    EXPECT_LT(error_of(gbuffer, "position", seen_position), 1e-4);
    EXPECT_NE(gbuffer.find("depth")->interpretation.find("2 to 20"), std::string::npos);
    EXPECT_NE(gbuffer.camera_reason().find("field of view"), std::string_view::npos);

    // A depth without its range places nothing.
    options.channels.erase("depth");
    const GBuffer flat = read({part}, options);
    EXPECT_FALSE(flat.find("depth"));
    EXPECT_FALSE(flat.find("position"));
    EXPECT_TRUE(test::mentions(flat.notes(), "between 0 and 1"));

    // Without a camera one is assumed, and said so.
    options.fov.reset();
    const GBuffer assumed = read({part}, options);
    EXPECT_FALSE(assumed.camera());
    EXPECT_TRUE(test::mentions(assumed.notes(), "39.6"));
    EXPECT_EQ(test::ask(assumed, test::semantic("view", 3)).size(), 3u);
}

TEST_F(Producers, WorkingSpacesByChromaticities) {
    const std::vector<std::pair<std::array<double, 8>, const char*>> spaces{
        {{0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290}, "lin_rec709"},
        {{0.713, 0.293, 0.165, 0.830, 0.128, 0.044, 0.32168, 0.33767}, "lin_ap1"},
        {{0.7347, 0.2653, 0.0, 1.0, 0.0001, -0.0770, 0.32168, 0.33767}, "lin_ap0"},
        {{0.708, 0.292, 0.170, 0.797, 0.131, 0.046, 0.3127, 0.3290}, "lin_rec2020"},
        {{0.5, 0.4, 0.3, 0.5, 0.2, 0.1, 0.33, 0.33}, "unknown"}};
    for (const auto& [xy, space] : spaces) {
        MadePart part;
        add_vector(part, "N", normal);
        part.attributes = {test::chromaticities(xy)};
        EXPECT_EQ(read({part}).working_space(), space);
        GBufferOptions options;
        options.working_space = "ACEScg";
        EXPECT_EQ(read({part}, options).working_space(), "lin_ap1");
    }
}

TEST_F(Producers, LayersAndViewsAreChosen) {
    MadePart part;
    part.attributes = {{"multiView", "stringvector", std::vector<std::string>{"left", "right"}}};
    const test::VectorFunction other = test::constant(0, 0, 1);
    add_vector(part, "N", normal);  // the default view needs no name
    add_vector(part, "N.right", other);
    GBufferOptions options;
    EXPECT_LT(error_of(read({part}), "normal", normal), 1e-5);
    options.view = "right";
    EXPECT_LT(error_of(read({part}, options), "normal", other), 1e-5);
    options.view = "middle";
    try {
        read({part}, options);
        ADD_FAILURE();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("left, right"), std::string::npos) << error.what();
    }

    MadePart layers;
    layers.attributes = {test::text("BlenderMultiChannel", "")};
    add_vector(layers, "back.Normal", other);
    add_vector(layers, "back.albedo", color, "RGB");
    add_vector(layers, "char.Normal", normal);
    options = {};
    options.part = "char";
    const GBuffer chosen = read({layers}, options);
    EXPECT_LT(error_of(chosen, "normal", normal), 1e-5);
    EXPECT_FALSE(chosen.find("base_color"));  // another layer's picture
    options.part = "nobody";
    try {
        read({layers}, options);
        ADD_FAILURE();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("back, char"), std::string::npos) << error.what();
    }
}

TEST_F(Producers, ChannelsAreNamedByTheUser) {
    MadePart part;
    add_vector(part, "bumpy", coded(normal), "RGB");
    add_vector(part, "N", test::constant(0, 0, 1));
    add_vector(part, "layer.one", color, "RGB");
    part.channels.push_back(one("misc.X", 0.25));
    GBufferOptions options;
    options.channels["normal"].channel = "bumpy";
    options.channels["base_color"].channel = "layer.one";
    options.channels["roughness"].channel = "misc.X";
    options.channels["coat_weight"].channel = "misc";
    const GBuffer gbuffer = read({part}, options);
    check(gbuffer, "unknown", {"base_color", "roughness", "coat_weight"});
    EXPECT_NE(gbuffer.find("normal")->reason.find("named by the user"), std::string::npos);
    options.channels["normal"].channel = "bumpi";
    try {
        read({part}, options);
        ADD_FAILURE();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::channel);
        EXPECT_NE(std::string(error.what()).find("bumpi"), std::string::npos);
    }
}

}  // namespace
}  // namespace relume
