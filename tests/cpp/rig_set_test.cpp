// SPDX-License-Identifier: Apache-2.0
// Rig::set and Rig::get: what --set on the command line does.
#include <gtest/gtest.h>

#include "relume/error.h"
#include "relume/light.h"
#include "relume/rig.h"

namespace relume {
namespace {

Rig some_rig() {
    return Rig::loads(R"(
        [[light]]
        name = "key"
        type = "sun"
        irradiance = 3.0
        [[light]]
        name = "a.b"
        type = "spot"
        position = [1, 2, 3]
        intensity = 5
        [[light]]
        name = "0"
        type = "ambient"
        [[shader]]
        cryptomatte = ["car_*"]
        use = "ggx"
        roughness = 0.2
        [camera]
        fov = 40
    )");
}

std::string refusal(std::string_view path, std::string_view value) {
    Rig rig = some_rig();
    try {
        rig.set(path, value);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::parameter) << path;
        EXPECT_TRUE(rig == some_rig()) << path << " changed the rig and failed";
        return error.what();
    }
    return "accepted";
}

std::string set_and_get(std::string_view path, std::string_view value) {
    Rig rig = some_rig();
    rig.set(path, value);
    // Whatever can be set leaves a rig that can be written and read.
    EXPECT_TRUE(Rig::loads(rig.to_toml()) == rig) << path;
    return rig.get(path);
}

TEST(RigSet, LightsByNameAndIndex) {
    EXPECT_EQ(set_and_get("light.key.exposure", "1"), "1.0");
    EXPECT_EQ(set_and_get("light.key.exposure", " -1.5 "), "-1.5");
    EXPECT_EQ(set_and_get("light.1.blend", "0.5"), "0.5");
    EXPECT_EQ(set_and_get("light.\"a.b\".blend", "0.5"), "0.5");
    EXPECT_EQ(set_and_get("light.'a.b'.blend", "0.5"), "0.5");
    EXPECT_EQ(set_and_get("light.key.irradiance", "[1, 0.5, 0.25]"), "[1, 0.5, 0.25]");
    EXPECT_EQ(set_and_get("light.key.enabled", "false"), "false");
    EXPECT_EQ(set_and_get("light.key.include", "car_*"), "[\"car_*\"]");
    EXPECT_EQ(set_and_get("light.key.include", "[\"car_*\", \"tree\"]"), "[\"car_*\", \"tree\"]");
    EXPECT_EQ(set_and_get("light.key.space", "camera"), "\"camera\"");
    EXPECT_EQ(set_and_get("light.key.space", "\"camera\""), "\"camera\"");
    // A name goes before an index.
    Rig rig = some_rig();
    rig.set("light.0.exposure", "2");
    EXPECT_TRUE(rig.lights[2].values.given("exposure"));
    EXPECT_FALSE(rig.lights[0].values.given("exposure"));
}

TEST(RigSet, OtherSections) {
    EXPECT_EQ(set_and_get("output.type", "float"), "\"float\"");
    EXPECT_EQ(set_and_get("output.compression", "none"), "\"none\"");
    EXPECT_EQ(set_and_get("output.aovs", "[\"diffuse\", \"light:key\"]"), "[\"diffuse\", \"light:key\"]");
    EXPECT_EQ(set_and_get("output.aovs", "diffuse"), "[\"diffuse\"]");
    EXPECT_EQ(set_and_get("output.aovs", "[]"), "[]");
    EXPECT_EQ(set_and_get("shader.0.roughness", "0.4"), "0.4");
    EXPECT_EQ(set_and_get("shader.0.roughness", "{ channel = \"coat.X\", scale = 2 }"),
              "{ channel = \"coat.X\", scale = 2.0, offset = 0.0 }");
    EXPECT_EQ(set_and_get("shader.0.object_id", "7"), "[7]");
    EXPECT_EQ(set_and_get("shader.0.object_id", "[7, 8]"), "[7, 8]");
    EXPECT_EQ(set_and_get("shader.0.use", "lambert"), "\"lambert\"");
    EXPECT_EQ(set_and_get("gbuffer.file", "2024"), "\"2024\"");
    EXPECT_EQ(set_and_get("gbuffer.part", "true"), "\"true\"");
    EXPECT_EQ(set_and_get("gbuffer.channels.normal", "N"), "\"N\"");
    EXPECT_EQ(set_and_get("gbuffer.channels.depth", "{ channel = \"Z\", kind = \"ray\" }"), "\"Z\"");
    EXPECT_EQ(set_and_get("gbuffer.channels.depth.kind", "ray"), "\"ray\"");
    EXPECT_EQ(set_and_get("camera.projection", "orthographic"), "\"orthographic\"");
}

TEST(RigSet, OneWayToSayItReplacesTheOther) {
    Rig rig = some_rig();
    rig.set("camera.focal_length", "35");
    EXPECT_FALSE(rig.gbuffer.fov.has_value());
    rig.set("camera.fov", "50");
    EXPECT_FALSE(rig.gbuffer.focal_length.has_value());
    rig.set("light.1.power", "100");
    EXPECT_FALSE(rig.lights[1].values.given("intensity"));
    rig.set("light.1.intensity", "2");
    EXPECT_FALSE(rig.lights[1].values.given("power"));
}

TEST(RigSet, AnotherTypeKeepsWhatItHas) {
    Rig rig = some_rig();
    rig.set("light.1.exposure", "2");
    rig.set("light.1.cone_angle", "30");
    rig.set("light.1.type", "point");
    EXPECT_EQ(rig.lights[1].type, "point");
    EXPECT_EQ(rig.get("light.1.exposure"), "2.0");
    EXPECT_EQ(rig.get("light.1.position"), "[1, 2, 3]");
    EXPECT_FALSE(rig.lights[1].values.given("cone_angle"));
    rig.set("shader.0.use", "lambert");
    EXPECT_EQ(rig.shaders[0].cryptomatte, std::vector<std::string>{"car_*"});
    EXPECT_FALSE(rig.shaders[0].values.given("roughness"));
}

TEST(RigSet, TheDefaultShaderCanBeGivenParameters) {
    Rig rig = Rig::loads("");
    if (rig.get("shader.0.use") != "\"principled\"") FAIL() << rig.get("shader.0.use");
    rig.set("shader.0.use", "ggx");
    rig.set("shader.0.roughness", "0.3");
    ASSERT_EQ(rig.shaders.size(), 1u);
    EXPECT_EQ(rig.shaders[0].use, "ggx");
    EXPECT_TRUE(rig.shaders[0].matches_all());
}

TEST(RigSet, MistakesNameTheNearest) {
    EXPECT_EQ(refusal("light.key.exposur", "1"), "unknown key 'exposur' in light 'key'; did you mean 'exposure'?");
    EXPECT_EQ(refusal("light.kei.exposure", "1"), "the rig has no light 'kei'; did you mean 'key'?");
    EXPECT_EQ(refusal("lights.key.exposure", "1"),
              "unknown section 'lights' in 'lights.key.exposure'; did you mean 'light'?");
    EXPECT_EQ(refusal("output.typ", "half"), "unknown key 'typ' in [output]; did you mean 'type'?");
    EXPECT_EQ(refusal("output.type", "haf"), "[output]: type has no choice 'haf'; did you mean 'half'?");
    EXPECT_EQ(refusal("camera.fow", "39"), "unknown key 'fow' in [camera]; did you mean 'fov'?");
    EXPECT_EQ(refusal("camera.fov", "180"), "[camera]: fov is 180; it must be within 0.001 … 179.999 degrees");
    EXPECT_EQ(refusal("gbuffer.parts", "x"), "unknown key 'parts' in [gbuffer]; did you mean 'part'?");
    EXPECT_EQ(refusal("gbuffer.channels.normall", "N"),
              "unknown channel 'normall' in [gbuffer.channels]; did you mean 'normal'?");
    EXPECT_EQ(refusal("gbuffer.channels.normal.encodin", "0..1"),
              "unknown key 'encodin' in channel 'normal'; did you mean 'encoding'?");
    EXPECT_EQ(refusal("gbuffer.channels.normal.encoding", "0.1"),
              "channel 'normal': encoding has no choice '0.1'; did you mean '0..1'?");
    EXPECT_EQ(refusal("shader.1.roughness", "0.4"), "the rig has no shader '1'; its one shader is shader.0");
    EXPECT_EQ(refusal("shader.0.use", "blin_phongg").substr(0, 29), "unknown shader 'blin_phongg';");
    EXPECT_EQ(refusal("light.key.name", "a.b"), "the rig has a light 'a.b' already");
    EXPECT_EQ(refusal("light.key.type", "sky_"), "light 'key' has the unknown type 'sky_'; did you mean 'sky'?");
}

TEST(RigSet, MistakesOfForm) {
    EXPECT_EQ(refusal("light.key", "1"), "'light.key' is not a key; write light.NAME.KEY");
    EXPECT_EQ(refusal("light", "1"), "'light' is not a key; write light.NAME.KEY");
    EXPECT_EQ(refusal("output.type.x", "1"), "'output.type.x' is not a key; write output.KEY");
    EXPECT_EQ(refusal("version", "1"), "'version' cannot be set; it belongs to the file");
    for (const char* value : {"\xff", "caf\xe9", "\xc0\x80", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xe2\x82"})
        EXPECT_EQ(refusal("gbuffer.part", value), "the value of 'gbuffer.part' is not UTF-8; a rig holds nothing else");
    EXPECT_EQ(set_and_get("gbuffer.part", "caf\u00e9 \u0436 \u20ac \U0001F600"),
              "\"caf\u00e9 \u0436 \u20ac \U0001F600\"");
    EXPECT_LT(refusal("shader.0.roughness", std::string(100000, 'x')).size(), 300u);
    EXPECT_EQ(refusal("a\nb", "[\"x\"]"),
              "unknown section 'a\\nb' in 'a\\nb'; there are gbuffer, camera, light, shader, output");
    for (const char* path :
         {"", ".", "light.", ".light", "light..exposure", "light.\"key.exposure", "light.\"key\"x.exposure",
          "light.key.exposure.more", "gbuffer.channels", "gbuffer.channels.normal.encoding.x"})
        EXPECT_NE(refusal(path, "1"), "accepted") << path;
    for (const char* value : {"", "[1, 2", "{", "bright", "\"1\"", "[1, 2, 3]", "1979-05-27", "nan", "inf",
                              "1\nexposure = 2", "{ channel = \"x\" }", "1 2"})
        EXPECT_NE(refusal("light.key.exposure", value), "accepted") << value;
    EXPECT_NE(refusal("light.key.direction", "1"), "accepted");
    EXPECT_NE(refusal("light.key.name", ""), "accepted");
    EXPECT_NE(refusal("shader.0.energy_conservin", "{ channel = \"x\" }"), "accepted");
    EXPECT_NE(refusal("shader.0.object_id", "1.5"), "accepted");
    EXPECT_NE(refusal("shader.0.object_id", "-1"), "accepted");
    EXPECT_NE(refusal("gbuffer.channels.normal", "{ flip = \"w\" }"), "accepted");
    EXPECT_NE(refusal("camera.matrix", "[1, 2]"), "accepted");
}

TEST(RigGet, WhatIsNotThereIsAnError) {
    const Rig rig = some_rig();
    EXPECT_THROW(rig.get("light.key.exposur"), Error);
    EXPECT_THROW(rig.get("camera.width"), Error);
    EXPECT_THROW(rig.get("gbuffer.file"), Error);
    EXPECT_THROW(rig.get("nowhere.at"), Error);
    EXPECT_EQ(rig.get("version"), "1");
    EXPECT_EQ(rig.get("light.key.type"), "\"sun\"");
    EXPECT_EQ(rig.get("light.0.name"), "\"0\"");
    EXPECT_EQ(rig.get("output.mode"), "\"replace\"");
    EXPECT_EQ(rig.get("shader.0.cryptomatte"), "[\"car_*\"]");
}

}  // namespace
}  // namespace relume
