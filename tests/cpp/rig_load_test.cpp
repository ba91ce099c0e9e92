// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "relume/error.h"
#include "relume/light.h"
#include "relume/rig.h"
#include "relume/shader.h"

namespace relume {
namespace {

namespace fs = std::filesystem;
using Triple = std::array<double, 3>;

ChannelRule from_channel(const char* name) {
    ChannelRule rule;
    rule.channel = name;
    return rule;
}

/// A folder for the files of one test.
class RigFiles : public testing::Test {
protected:
    void SetUp() override {
        const auto* info = testing::UnitTest::GetInstance()->current_test_info();
        folder_ =
            fs::temp_directory_path() / ("relume_rig_" + std::string(info->name()) + "_" + std::to_string(::getpid()));
        fs::create_directories(folder_ / "sub");
    }
    void TearDown() override { fs::remove_all(folder_); }

    fs::path write(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name, std::ios::binary) << text;
        return folder_ / name;
    }

    /// The error of loading, with the folder's name taken out.
    std::string refusal(const std::string& name, ErrorKind kind = ErrorKind::rig) const {
        try {
            Rig::load(folder_ / name);
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), kind) << error.what();
            std::string text = error.what();
            for (std::size_t at; (at = text.find(folder_.string() + "/")) != std::string::npos;)
                text.erase(at, folder_.string().size() + 1);
            return text;
        }
        return "accepted";
    }

    fs::path folder_;
};

TEST(RigLoad, EverySectionIsRead) {
    const Rig rig = Rig::loads(R"(
version = 1
[gbuffer]
file = "shot.####.exr"
part = "ViewLayer"
view = "left"
alpha = "straight"
working_space = "lin_rec709"
normal_variance = "on"
[gbuffer.channels]
normal = "N"
base_color = { channel = "albedo", premultiplied = false }
depth = { channel = "Z", kind = "ray", near = 0.1, far = 100 }
roughness = { channel = "gloss", invert = true, part = "extra" }
tangent = { encoding = "0..1", space = "camera", flip = "xy" }
[camera]
matrix = [1, 0, 0, 4, 0, 1, 0, 5, 0, 0, 1, 6, 0, 0, 0, 1]
focal_length = 50
horizontal_aperture = 36
projection = "orthographic"
width = 12
[[light]]
name = "key"
type = "sun"
direction = [0.3563, 0.8144, -0.4581]
irradiance = 3.0
[[light]]
name = "fill"
type = "spot"
position = [1, 2, 3]
power = 100
falloff = "blender3"
include = "car_*"
[[shader]]
cryptomatte = ["car_*", "wheel"]
object_id = 4
material_id = [1, 2]
shading_model_id = [0]
use = "ggx"
roughness = 0.05
base_color = { channel = "paint", scale = 0.5, offset = 0.25 }
[[shader]]
use = "default_lit"
[output]
mode = "add"
aovs = ["light:key", "diffuse"]
type = "float"
compression = "dwaa"
compression_level = 30
metadata = "none"
)");
    EXPECT_EQ(rig.gbuffer_file, "shot.####.exr");
    EXPECT_EQ(rig.gbuffer.part, "ViewLayer");
    EXPECT_EQ(rig.gbuffer.view, "left");
    EXPECT_EQ(rig.gbuffer.alpha, AlphaMode::straight);
    EXPECT_EQ(rig.gbuffer.working_space, "lin_rec709");
    EXPECT_EQ(rig.gbuffer.normal_variance, NormalVariance::on);
    const auto& channels = rig.gbuffer.channels;
    EXPECT_EQ(channels.at("normal"), from_channel("N"));
    EXPECT_EQ(channels.at("base_color").premultiplied, false);
    EXPECT_EQ(channels.at("depth").kind, DepthKind::ray);
    EXPECT_EQ(channels.at("depth").near, 0.1);
    EXPECT_EQ(channels.at("depth").far, 100);
    EXPECT_EQ(channels.at("roughness").invert, true);
    EXPECT_EQ(channels.at("roughness").part, "extra");
    EXPECT_EQ(channels.at("tangent").encoding, Encoding::zero_to_one);
    EXPECT_EQ(channels.at("tangent").space, Space::camera);
    EXPECT_EQ(channels.at("tangent").flip, "xy");
    EXPECT_EQ((*rig.gbuffer.camera_matrix)[3], 4);
    EXPECT_EQ((*rig.gbuffer.camera_matrix)[11], 6);
    EXPECT_EQ(rig.gbuffer.focal_length, 50);
    EXPECT_EQ(rig.gbuffer.horizontal_aperture, 36);
    EXPECT_EQ(rig.gbuffer.projection, Projection::orthographic);
    EXPECT_EQ(rig.gbuffer.width, 12);

    ASSERT_EQ(rig.lights.size(), 2u);
    const Light& key = *rig.light("key");
    const auto sun = find_light_type("sun")->parameters;
    EXPECT_EQ(key.values.triple(sun, "direction"), (Triple{0.3563, 0.8144, -0.4581}));
    EXPECT_EQ(key.values.triple(sun, "irradiance"), (Triple{3, 3, 3})) << "a number is grey";
    EXPECT_EQ(key.values.number(sun, "exposure"), 0) << "the default";
    const Light& fill = *rig.light("fill");
    const auto spot = find_light_type("spot")->parameters;
    EXPECT_EQ(fill.values.number(spot, "power"), 100);
    EXPECT_EQ(fill.values.choice(spot, "falloff"), 1);
    EXPECT_EQ(fill.values.texts(spot, "include"), std::vector<std::string>{"car_*"});
    EXPECT_EQ(rig.light("rim"), nullptr);

    ASSERT_EQ(rig.shaders.size(), 2u);
    const ShaderUse& paint = rig.shaders[0];
    EXPECT_EQ(paint.use, "ggx");
    EXPECT_EQ(paint.cryptomatte, (std::vector<std::string>{"car_*", "wheel"}));
    EXPECT_EQ(paint.object_id, std::vector<std::int64_t>{4});
    EXPECT_EQ(paint.material_id, (std::vector<std::int64_t>{1, 2}));
    EXPECT_EQ(paint.shading_model_id, std::vector<std::int64_t>{0});
    EXPECT_EQ(*paint.values.find("roughness"), Value(0.05));
    EXPECT_EQ(*paint.values.find("base_color"), Value(ChannelRef{"paint", 0.5, 0.25}));
    EXPECT_FALSE(paint.matches_all());
    EXPECT_TRUE(rig.shaders[1].matches_all());

    const auto& output = rig.output.values;
    EXPECT_EQ(output.choice(output_parameters(), "mode"), 1);
    EXPECT_EQ(output.texts(output_parameters(), "aovs"), (std::vector<std::string>{"light:key", "diffuse"}));
    EXPECT_EQ(output.text(output_parameters(), "type"), "float");
    EXPECT_EQ(output.text(output_parameters(), "compression"), "dwaa");
    EXPECT_EQ(output.number(output_parameters(), "compression_level"), 30);
    EXPECT_EQ(output.text(output_parameters(), "metadata"), "none");
}

TEST(RigLoad, AnEmptyRigIsAllDefaults) {
    const Rig rig = Rig::loads("# nothing\n");
    EXPECT_TRUE(rig == Rig{});
    EXPECT_EQ(rig.output.values.text(output_parameters(), "mode"), "replace");
    EXPECT_EQ(rig.output.values.text(output_parameters(), "type"), "half");
    EXPECT_EQ(rig.output.values.text(output_parameters(), "compression"), "zip");
    EXPECT_EQ(rig.output.values.text(output_parameters(), "metadata"), "keep");
    EXPECT_TRUE(Rig::loads("\xEF\xBB\xBFversion = 1\r\n") == rig)
        << "a byte order mark, and lines as Windows ends them";
    EXPECT_TRUE(Rig::loads("light = []\nshader = []") == rig);
}

TEST(RigLoad, LightsWithoutANameGetTheirTypes) {
    const Rig rig = Rig::loads(
        "[[light]]\ntype='sun'\n[[light]]\ntype='sun'\n[[light]]\nname='sun_2'\ntype='sky'\n[[light]]\ntype='sky'\n");
    std::vector<std::string> names;
    for (const Light& light : rig.lights) names.push_back(light.name);
    EXPECT_EQ(names, (std::vector<std::string>{"sun", "sun_3", "sun_2", "sky"}));
}

TEST(RigLoad, OutdoorIsPiTimesThePlainRig) {
    const Rig rig = Rig::load("outdoor");
    EXPECT_TRUE(rig == Rig::builtin("outdoor"));
    EXPECT_TRUE(rig == Rig::loads("include = 'outdoor'"));
    EXPECT_TRUE(rig == Rig::load(std::string(RELUME_SOURCE_DIR) + "/examples/rigs/outdoor.relume"));
    EXPECT_TRUE(rig.path.empty());
    const auto expect = [&](const char* name, const char* key, Triple plain) {
        const Light& light = *rig.light(name);
        const auto value = light.values.triple(find_light_type(light.type)->parameters, key);
        for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(value[k], std::numbers::pi * plain[k], 1e-6) << name;
    };
    expect("sun", "irradiance", {1.64, 1.27, 0.99});
    expect("sky", "sky_color", {0.16, 0.20, 0.28});
    expect("bounce", "irradiance", {0.40, 0.28, 0.20});
    // The bounce comes from the side opposite the sun, level.
    const auto sun = rig.light("sun")->values.triple(find_light_type("sun")->parameters, "direction");
    const auto bounce = rig.light("bounce")->values.triple(find_light_type("bounce")->parameters, "direction");
    EXPECT_DOUBLE_EQ(bounce[0], -sun[0]);
    EXPECT_DOUBLE_EQ(bounce[1], -sun[1]);
    EXPECT_EQ(bounce[2], 0);
    EXPECT_THROW(Rig::builtin("outdor"), Error);
}

TEST(RigLoad, FromMaterialExpressionTakesWhatItsModelsShare) {
    const Rig rig = Rig::loads("[[shader]]\nuse = 'from_material_expression'\nroughness = 0.3\n");
    EXPECT_EQ(*rig.shaders[0].values.find("roughness"), Value(0.3));
    for (const std::string_view name : shading_model_names()) {
        const ShaderInfo* shader = find_shader(name);
        if (shader == nullptr) continue;
        for (const Parameter& row : shader_use_parameters(kFromMaterialExpression))
            for (const Parameter& own : shader->parameters)
                EXPECT_TRUE(own.name != row.name || own.type == row.type) << name << " " << row.name;
    }
    EXPECT_EQ(shading_model_names()[0], "unlit");
    EXPECT_EQ(shading_model_names()[11], "thin_translucent");
    EXPECT_EQ(shading_model_names().size(), 12u);
}

TEST_F(RigFiles, NamesOfFilesAreRelativeToTheRig) {
    write(
        "sub/base.relume",
        "[gbuffer]\nfile = '../shot.####.exr'\n[gbuffer.channels]\nroughness = 'maps/rough.####.PNG'\nnormal = 'N.left'\nmetallic = {channel = '/abs/m.exr'}\n");
    write("main.relume", "include = 'sub/base.relume'\n[gbuffer.channels]\nopacity = 'o.tif'\n");
    const Rig rig = Rig::load(folder_ / "main.relume");
    EXPECT_EQ(rig.path, folder_ / "main.relume");
    EXPECT_EQ(rig.gbuffer_file, (folder_ / "shot.####.exr").string());
    EXPECT_EQ(rig.gbuffer.channels.at("roughness").channel, (folder_ / "sub/maps/rough.####.PNG").string());
    EXPECT_EQ(rig.gbuffer.channels.at("normal").channel, "N.left") << "a channel is no file";
    EXPECT_EQ(rig.gbuffer.channels.at("metallic").channel, "/abs/m.exr");
    EXPECT_EQ(rig.gbuffer.channels.at("opacity").channel, (folder_ / "o.tif").string());
    // So that a rig that was written elsewhere still finds them, they are absolute even where the rig was not.
    const fs::path before = fs::current_path();
    fs::current_path(folder_ / "sub");
    const Rig relative = Rig::load("../main.relume");
    fs::current_path(before);
    EXPECT_EQ(relative.gbuffer_file, fs::weakly_canonical(folder_ / "shot.####.exr").string());
}

TEST_F(RigFiles, IncludesAreOverriddenKeyByKey) {
    write("base.relume", R"(
[gbuffer]
part = "A"
view = "left"
[gbuffer.channels]
normal = { channel = "N", encoding = "0..1" }
[camera]
fov = 40
[[light]]
name = "key"
type = "point"
position = [1, 2, 3]
intensity = 5
exposure = 1
[[light]]
name = "fill"
type = "sky"
[[shader]]
object_id = 1
use = "lambert"
[[shader]]
use = "ggx"
[output]
type = "float"
aovs = ["diffuse"]
)");
    write("main.relume", R"(
include = ["base.relume"]
[gbuffer]
part = "B"
[gbuffer.channels]
normal = "Normal"
[camera]
focal_length = 50
horizontal_aperture = 36
[[light]]
name = "rim"
type = "sun"
[[light]]
name = "key"
power = 100
color = [1, 0, 0]
[[shader]]
object_id = 2
use = "default_lit"
[[shader]]
use = "lambert"
[output]
aovs = ["specular"]
)");
    const Rig rig = Rig::load(folder_ / "main.relume");
    EXPECT_EQ(rig.gbuffer.part, "B");
    EXPECT_EQ(rig.gbuffer.view, "left");
    EXPECT_EQ(rig.gbuffer.channels.at("normal"), from_channel("Normal"));
    EXPECT_FALSE(rig.gbuffer.fov.has_value());
    EXPECT_EQ(rig.gbuffer.focal_length, 50);
    ASSERT_EQ(rig.lights.size(), 3u);
    EXPECT_EQ(rig.lights[0].name, "key");
    EXPECT_EQ(rig.lights[1].name, "fill");
    EXPECT_EQ(rig.lights[2].name, "rim");
    EXPECT_EQ(rig.get("light.key.type"), "\"point\"");
    EXPECT_EQ(rig.get("light.key.exposure"), "1.0");
    EXPECT_EQ(rig.get("light.key.power"), "100.0");
    EXPECT_FALSE(rig.lights[0].values.given("intensity"));
    // Its own matches before the included ones, its own default after.
    ASSERT_EQ(rig.shaders.size(), 4u);
    EXPECT_EQ(rig.shaders[0].object_id, std::vector<std::int64_t>{2});
    EXPECT_EQ(rig.shaders[1].object_id, std::vector<std::int64_t>{1});
    EXPECT_EQ(rig.shaders[3].use, "lambert");
    EXPECT_EQ(rig.get("output.type"), "\"float\"");
    EXPECT_EQ(rig.get("output.aovs"), "[\"specular\"]");
}

TEST_F(RigFiles, AnIncludedLightMayBeCompletedLater) {
    write("base.relume", "[[light]]\nname = 'key'\ntype = 'point'\n");
    EXPECT_EQ(refusal("base.relume"),
              "light 'key' has no position at base.relume:1:1; a point light needs one: position = [x, y, z]");
    write("main.relume", "include = 'base.relume'\n[[light]]\nname = 'key'\nposition = [1, 2, 3]\n");
    EXPECT_EQ(Rig::load(folder_ / "main.relume").get("light.key.position"), "[1, 2, 3]");
}

TEST_F(RigFiles, AFileGoesBeforeABuiltInRigAndAFolderDoesNot) {
    const fs::path before = fs::current_path();
    fs::current_path(folder_);
    fs::create_directory("outdoor");
    EXPECT_EQ(Rig::load("outdoor").lights.size(), 3u);
    fs::remove("outdoor");
    write("outdoor", "[[light]]\ntype = 'sun'\n");
    EXPECT_EQ(Rig::load("outdoor").lights.size(), 1u);
    fs::current_path(before);
}

TEST_F(RigFiles, IncludesThatGoWrong) {
    write("a.relume", "include = 'b.relume'\n");
    write("b.relume", "include = ['sub/../a.relume']\n");
    EXPECT_EQ(refusal("a.relume"), "rigs include each other in a circle: a.relume → b.relume → a.relume");
    write("self.relume", "include = 'self.relume'\n");
    EXPECT_EQ(refusal("self.relume"), "rigs include each other in a circle: self.relume → self.relume");
    write("missing.relume", "\ninclude = ['nowhere.relume']\n");
    EXPECT_EQ(refusal("missing.relume", ErrorKind::file),
              "nowhere.relume: no such rig file (included at missing.relume:2:1)");
    write("typo.relume", "include = 'outdor'\n");
    EXPECT_EQ(refusal("typo.relume", ErrorKind::file),
              "outdor: no such rig file (included at typo.relume:1:1); did you mean the built-in rig 'outdoor'?");
    write("folder.relume", "include = 'sub'\n");
    EXPECT_EQ(refusal("folder.relume", ErrorKind::file), "sub: is a directory; a rig is a file");
    write("inner.relume", "[[light]]\nname = 'key'\ntype = 'sun'\nexposur = 1\n");
    write("outer.relume", "include = 'inner.relume'\n");
    EXPECT_EQ(refusal("outer.relume"),
              "unknown key 'exposur' in light 'key' at inner.relume:4:1; did you mean 'exposure'?");
    write("number.relume", "include = 3\n");
    EXPECT_EQ(refusal("number.relume"),
              "the rig: include takes a list of strings, not the number 3 at number.relume:1:1");
    // Twice the same is no circle.
    write("leaf.relume", "[[light]]\nname = 'key'\ntype = 'sun'\n");
    write("twice.relume", "include = ['leaf.relume', 'leaf.relume']\n");
    EXPECT_EQ(refusal("twice.relume"), "accepted");
    // Each includes the next twice: 2^30 files.
    for (int k = 0; k < 30; ++k) {
        const std::string next = "'d" + std::to_string(k + 1) + ".relume'";
        write("d" + std::to_string(k) + ".relume", "include = [" + next + ", " + next + "]\n");
    }
    write("d30.relume", "");
    EXPECT_EQ(refusal("d0.relume").substr(0, 22), "more than 256 includes");
}

TEST_F(RigFiles, FilesThatAreNoRigs) {
    EXPECT_EQ(refusal("nowhere.relume", ErrorKind::file), "nowhere.relume: no such rig file");
    EXPECT_EQ(refusal("sub", ErrorKind::file), "sub: is a directory; a rig is a file");
    write("empty.relume", "");
    EXPECT_EQ(refusal("empty.relume"), "accepted");
    write("huge.relume", "#" + std::string(17u << 20, 'x'));
    EXPECT_EQ(refusal("huge.relume", ErrorKind::file), "huge.relume: is larger than 16 MiB; that is no rig");
    write("image.relume", std::string("\x76\x2f\x31\x01\x02\x00\x00\x00", 8));
    EXPECT_EQ(refusal("image.relume").substr(0, 33), "not valid TOML at image.relume:1:");
    write("utf16.relume", std::string("\xFF\xFEv\0 \0=\0 \0001\0", 12));
    EXPECT_EQ(refusal("utf16.relume"), "utf16.relume is UTF-16 text; a rig is UTF-8: save it again as that");
    write("latin1.relume", "[gbuffer]\npart = \"caf\xe9\"\n");
    EXPECT_EQ(refusal("latin1.relume").substr(0, 34), "not valid TOML at latin1.relume:2:");
    EXPECT_THROW(Rig::load("/dev/zero"), Error);
}

}  // namespace
}  // namespace relume
