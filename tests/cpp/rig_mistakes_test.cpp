// SPDX-License-Identifier: Apache-2.0
// What a user is told about a rig that is wrong: the words, the place, the way out.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>

#include "relume/error.h"
#include "relume/light.h"
#include "relume/rig.h"
#include "relume/shader.h"

namespace relume {
namespace {

std::string refusal(const std::string& text, ErrorKind kind = ErrorKind::rig) {
    try {
        Rig::loads(text, "key.relume");
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), kind) << error.what();
        return error.what();
    }
    return "accepted";
}

/// After the start of a light 'key' of type sun, which takes three lines.
std::string in_light(const std::string& line, ErrorKind kind = ErrorKind::rig) {
    return refusal("[[light]]\nname = 'key'\ntype = 'sun'\n" + line, kind);
}

std::string in_shader(const std::string& line, ErrorKind kind = ErrorKind::rig) {
    return refusal("[[shader]]\nuse = 'ggx'\n" + line, kind);
}

TEST(RigMistakes, Keys) {
    EXPECT_EQ(in_light("  exposur = 1"),
              "unknown key 'exposur' in light 'key' at key.relume:4:3; did you mean 'exposure'?");
    EXPECT_EQ(in_light("cone_angle = 1").substr(0, 58), "unknown key 'cone_angle' in light 'key' at key.relume:4:1;");
    EXPECT_EQ(in_shader("roughnes = 1"),
              "unknown key 'roughnes' in shader 'ggx' at key.relume:3:1; did you mean 'roughness'?");
    EXPECT_EQ(in_shader("objectid = 1"),
              "unknown key 'objectid' in shader 'ggx' at key.relume:3:1; did you mean 'object_id'?");
    EXPECT_EQ(in_shader("roughness = { chanel = 'x' }"),
              "unknown key 'chanel' in shader 'ggx': roughness at key.relume:3:15; did you mean 'channel'?");
    EXPECT_EQ(refusal("[gbuffer]\nfiel = 'x'"),
              "unknown key 'fiel' in [gbuffer] at key.relume:2:1; did you mean 'file'?");
    EXPECT_EQ(refusal("[gbuffer.channels]\nnorml = 'x'"),
              "unknown channel 'norml' in [gbuffer.channels] at key.relume:2:1; did you mean 'normal'?");
    EXPECT_EQ(refusal("[gbuffer.channels]\nnormal = { space = 'view' }"),
              "channel 'normal': space has no choice 'view' at key.relume:2:12; there are world, camera");
    EXPECT_EQ(refusal("[camera]\nfow = 3"), "unknown key 'fow' in [camera] at key.relume:2:1; did you mean 'fov'?");
    EXPECT_EQ(refusal("[output]\ncompresion = 'zip'"),
              "unknown key 'compresion' in [output] at key.relume:2:1; did you mean 'compression'?");
}

TEST(RigMistakes, ValuesThatAreImpossibleTogether) {
    EXPECT_EQ(in_light("direction = [0, 0, 0]"),
              "light 'key': direction must not be the zero vector at key.relume:1:1");
    EXPECT_EQ(in_light("direction = [0, 0, 1e-9]"), "accepted");
    EXPECT_EQ(refusal("[[light]]\nname = 'lamp'\ntype = 'point'\nposition = [0, 0, 1]\nattenuation = [0, 0, 0]"),
              "light 'lamp': attenuation must not be all 0 at key.relume:1:1");
    EXPECT_EQ(refusal("[[light]]\ntype = 'sky'\nup = [0, 0, 0]"),
              "light 'sky': up must not be the zero vector at key.relume:1:1");
}

TEST(RigMistakes, Sections) {
    EXPECT_EQ(refusal("version = 1\n[[lights]]\n"),
              "unknown section [[lights]] at key.relume:2:3; did you mean 'light'?");
    EXPECT_EQ(refusal("[outputs]\n"), "unknown section [outputs] at key.relume:1:2; did you mean 'output'?");
    EXPECT_EQ(
        refusal("exposure = 1\n"),
        "unknown key 'exposure' at key.relume:1:1; there are version, include, gbuffer, camera, light, shader, output");
    EXPECT_EQ(refusal("[light]\ntype = 'sun'\n"),
              "'light' is a table at key.relume:1:2; write [[light]], once for each");
    EXPECT_EQ(refusal("light = 3\n"), "'light' is the number 3 at key.relume:1:1; write [[light]], once for each");
    EXPECT_EQ(refusal("[[output]]\n"),
              "'output' is a list of tables at key.relume:1:3; it is a section: write [output]");
    EXPECT_EQ(refusal("camera = 'wide'\n"),
              "'camera' is the string 'wide' at key.relume:1:1; it is a section: write [camera]");
    EXPECT_EQ(refusal("[gbuffer]\nchannels = 'N'\n"),
              "'channels' is the string 'N' at key.relume:2:1; it is a section: write [gbuffer.channels]");
}

TEST(RigMistakes, WhatLaterVersionsBring) {
    EXPECT_EQ(
        refusal("[output]\nmode = 'ratio'\n"),
        "[output]: mode \"ratio\" is not in this version of relume at key.relume:2:1; it has \"replace\" and \"add\"");
    EXPECT_EQ(refusal("[[original_light]]\nname = 'x'\n"),
              "[[original_light]] at key.relume:1:3 is not in this version of relume; remove it");
    EXPECT_EQ(refusal("version = 2\n[[whatever]]\n"), "version is 2 at key.relume:1:1; this relume reads version 1");
    EXPECT_EQ(refusal("version = '1'\n"), "version takes the number 1, not the string '1' at key.relume:1:1");
}

TEST(RigMistakes, NamesOfTypesAndModels) {
    EXPECT_EQ(refusal("[[light]]\ntype = 'sunn'\n"),
              "light 'sunn' has the unknown type 'sunn' at key.relume:2:1; did you mean 'sun'?");
    EXPECT_EQ(refusal("[[light]]\nname = 'key'\n").substr(0, 57),
              "light 'key' has no type at key.relume:1:1; give type, one");
    EXPECT_EQ(refusal("[[light]]\ntype = 3\n"), "a light: type takes a string, not the number 3 at key.relume:2:1");
    EXPECT_EQ(refusal("[[shader]]\nuse = 'gxg'\n"), "unknown shader 'gxg' at key.relume:2:1; did you mean 'ggx'?");
    EXPECT_EQ(refusal("[[shader]]\nroughness = 1\n"),
              "a [[shader]] has no use at key.relume:1:1; give use, the name of a shading model");
    EXPECT_EQ(refusal("[[shader]]\nuse = ['ggx']\n"),
              "[[shader]]: use takes a string, not a list of 1 string at key.relume:2:1");
    EXPECT_EQ(refusal("[[light]]\nname = 'key'\ntype = 'sun'\n[[light]]\nname = 'key'\ntype = 'sky'\n"),
              "two lights are named 'key' at key.relume:5:1; the first is at key.relume:2:1: names are unique");
    EXPECT_EQ(refusal("[[light]]\nname = ''\ntype = 'sun'\n"), "[[light]]: name is empty at key.relume:2:1");
}

TEST(RigMistakes, Types) {
    EXPECT_EQ(in_light("exposure = 'bright'"),
              "light 'key': exposure takes a number, not the string 'bright' at key.relume:4:1");
    EXPECT_EQ(in_light("enabled = 1"), "light 'key': enabled takes true or false, not the number 1 at key.relume:4:1");
    EXPECT_EQ(in_light("direction = 1"),
              "light 'key': direction takes 3 numbers [x, y, z], not the number 1 at key.relume:4:1");
    EXPECT_EQ(
        in_light("irradiance = [1, 2]"),
        "light 'key': irradiance takes a number or 3 numbers [r, g, b], not a list of 2 numbers at key.relume:4:1");
    EXPECT_EQ(in_light("irradiance = [1, 'a', 2]"),
              "light 'key': irradiance cannot be a list of mixed values at key.relume:4:1");
    EXPECT_EQ(in_light("irradiance = [[1, 2, 3]]"),
              "light 'key': irradiance takes a number or 3 numbers [r, g, b], not a list of lists at key.relume:4:1");
    EXPECT_EQ(in_light("irradiance = { r = 1 }"), "light 'key': irradiance cannot be a table at key.relume:4:1");
    EXPECT_EQ(in_light("exposure = 1979-05-27"), "light 'key': exposure cannot be a date at key.relume:4:1");
    EXPECT_EQ(in_light("exposure = 07:32:00"), "light 'key': exposure cannot be a time at key.relume:4:1");
    EXPECT_EQ(in_light("include = [1]"),
              "light 'key': include takes a list of strings, not a list of 1 number at key.relume:4:1");
    EXPECT_EQ(in_light("space = 1"),
              "light 'key': space takes one of \"world\", \"camera\", not the number 1 at key.relume:4:1");
    EXPECT_EQ(in_shader("roughness = { scale = 2 }").substr(0, 66),
              "shader 'ggx': roughness is a table without channel at key.relume:3");
    EXPECT_EQ(in_shader("object_id = [1, 1.5]"),
              "shader 'ggx': object_id holds 1.5 at key.relume:3:1; IDs are whole numbers");
}

TEST(RigMistakes, WhatIsOftenMeant) {
    EXPECT_EQ(in_light("strength = 3"),
              "unknown key 'strength' in light 'key' at key.relume:4:1; a sun light has irradiance");
    EXPECT_EQ(refusal("[[light]]\ntype = 'spot'\nposition = [0, 0, 0]\nenergy = 3\n"),
              "unknown key 'energy' in light 'spot' at key.relume:4:1; a spot light has intensity or power");
    EXPECT_EQ(refusal("[[light]]\ntype = 'spot'\nangle = 3\n"),
              "unknown key 'angle' in light 'spot' at key.relume:3:1; did you mean 'cone_angle'?");
    EXPECT_EQ(refusal("[[light]]\ntype = 'directional'\n"),
              "light 'directional' has the unknown type 'directional' at key.relume:2:1; did you mean 'sun'?");
    EXPECT_EQ(
        in_shader("roughness = 'coat.X'"),
        "shader 'ggx': roughness takes a number, not the string 'coat.X' at key.relume:3:1; a channel is written { channel = \"coat.X\" }");
    EXPECT_EQ(refusal("[gbuffer]\nnormal = 'N'\n"),
              "unknown key 'normal' in [gbuffer] at key.relume:2:1; channels stand under [gbuffer.channels]");
    EXPECT_EQ(refusal("[gbuffer.channels]\nN = 'normal'\n"),
              "unknown channel 'N' in [gbuffer.channels] at key.relume:2:1; what it is stands first: normal = \"N\"");
}

TEST(RigMistakes, Ranges) {
    EXPECT_EQ(in_light("irradiance = -1", ErrorKind::parameter),
              "light 'key': irradiance is -1 at key.relume:4:1; it must be at least 0 W/m²");
    EXPECT_EQ(in_light("exposure = inf", ErrorKind::parameter),
              "light 'key': exposure is inf at key.relume:4:1; it must be finite");
    EXPECT_EQ(in_shader("roughness = 1.5", ErrorKind::parameter),
              "shader 'ggx': roughness is 1.5 at key.relume:3:1; it must be within 0 … 1");
    EXPECT_EQ(in_shader("object_id = -1", ErrorKind::parameter),
              "shader 'ggx': object_id is -1 at key.relume:3:1; it must be within 0 … 4294967295");
    EXPECT_EQ(
        refusal("[gbuffer.channels]\nnormal = { flip = 'u' }", ErrorKind::parameter),
        "channel 'normal': flip is 'u' at key.relume:2:12; it is made of x, y and z, each once, as \"y\" or \"xy\"");
}

TEST(RigMistakes, Cameras) {
    EXPECT_EQ(refusal("[camera]\nfov = 3\nfocal_length = 50\n"),
              "[camera] has fov and focal_length at key.relume:2:1; give one of the two");
    EXPECT_EQ(refusal("[camera]\nfocal_length = 50\n"),
              "[camera] has focal_length without horizontal_aperture at key.relume:1:2; give both, or fov");
    EXPECT_EQ(refusal("[camera]\nmatrix = [1, 0]\n"),
              "[camera]: matrix takes a list of 16 numbers, not a list of 2 numbers at key.relume:2:1");
    // Column-major, as many libraries print it.
    EXPECT_EQ(refusal("[camera]\nmatrix = [1,0,0,0, 0,1,0,0, 0,0,1,0, 4,5,6,1]\n", ErrorKind::parameter).substr(0, 62),
              "[camera]: matrix does not end in 0, 0, 0, 1 at key.relume:2:1;");
    EXPECT_EQ(refusal("[camera]\nmatrix = [1,0,0,0, 0,1,0,0, 1,1,0,0, 0,0,0,1]\n", ErrorKind::parameter).substr(0, 57),
              "[camera]: matrix cannot be inverted at key.relume:2:1; it");
    EXPECT_EQ(refusal("[[light]]\ntype = 'point'\nposition = [0, 0, 0]\npower = 3\nintensity = 1\n"),
              "light 'point' has both power and intensity at key.relume:4:1; give one of the two");
}

TEST(RigMistakes, Syntax) {
    EXPECT_EQ(refusal("version = 1\nlight = = 3\n"),
              "not valid TOML at key.relume:2:9: parsing value: could not determine value type, in 'light = = 3'");
    EXPECT_EQ(
        refusal("[output]\n  type = half  # of the precision\n"),
        "not valid TOML at key.relume:2:10: parsing value: could not determine value type, in 'type = half  # of the precision'; "
        "a string stands in quotes: \"half\"");
    EXPECT_EQ(
        in_light("enabled = True"),
        "not valid TOML at key.relume:4:11: parsing boolean: expected 'true', saw 'T', in 'enabled = True'; write true or false");
    EXPECT_EQ(refusal("[output]\ntype = 'half'\ntype = 'half'\n").substr(0, 32), "not valid TOML at key.relume:3:8");
    EXPECT_EQ(refusal("a = 'x").substr(0, 30), "not valid TOML at key.relume:1");
    EXPECT_EQ(refusal("version = 1\n\n[ . ]\ny = 2\n"), "not valid TOML at key.relume:3:1");
    for (const char* text :
         {"{", "[", "[[light]", "a", "= 1", "a = \"\\q\"", "a = 1 b = 2", "\x01", "a = 'x\ny'", "<xml/>", "x = 1\n[ .",
          "é = 1", "a = ϛ", "a = 1ж", "a = [1 é]", "ж", "[[ .]]", "{\"json\": 1}", "version: 1"}) {
        const std::string message = refusal(text);
        EXPECT_NE(message.find("key.relume:"), std::string::npos) << text << ": " << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
}

TEST(RigMistakes, KeysWithLineBreaksStayOnOneLine) {
    const std::string key = "\"a\\nb\"";
    for (const std::string& text :
         {key + " = 1", "[" + key + "]", "[[" + key + "]]", "[[shader]]\nuse = 'ggx'\n" + key + " = { x = 1 }",
          "[[shader]]\nuse = 'ggx'\n" + key + " = { channel = 'x' }",
          "[[light]]\ntype = 'sun'\n" + key + " = { x = 1 }", "[[light]]\ntype = 'sun'\nname = " + key + "\nx = 1",
          "[gbuffer]\n" + key + " = 1979-05-27", "[gbuffer.channels]\n" + key + " = { x = 1 }",
          "[output]\n" + key + " = []", "[camera]\n" + key + " = {}"}) {
        const std::string message = refusal(text);
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
        EXPECT_NE(message.find("a\\nb"), std::string::npos) << message;
    }
}

TEST(RigMistakes, TheFirstOfSeveralIsTold) {
    EXPECT_EQ(refusal("[output]\nzzz = 1\naaa = 2\n").substr(0, 51),
              "unknown key 'zzz' in [output] at key.relume:2:1; th");
    EXPECT_EQ(refusal("[[shader]]\nuse='gxg'\n[[light]]\ntype='sunn'\n").substr(0, 21), "unknown shader 'gxg' ");
}

TEST(RigMistakes, DeepNestsAndLongKeysAreRefusedNotSuffered) {
    const auto repeat = [](const std::string& piece, int count) {
        std::string out;
        for (int k = 0; k < count; ++k) out += piece;
        return out;
    };
    constexpr int kMany = 300'000;
    for (const std::string& text :
         {"a = " + repeat("[", kMany), "a = " + repeat("{a=", kMany), "a" + repeat(".a", kMany) + " = 1",
          "[a" + repeat(".a", kMany) + "]", "[[a" + repeat(" . a", kMany) + "]]",
          "a = { b" + repeat(".\"c\"", kMany) + " = 1 }", "x = \"\"\"\"\"\"\"\na" + repeat(".a", kMany) + " = 1",
          "x = '''a.b''\n'''''\na" + repeat(".'q'", kMany) + " = 1", repeat("[[light]]\n", 100000)})
        EXPECT_NE(refusal(text), "accepted") << text.substr(0, 20);
    // Dots in strings and comments are no key's.
    EXPECT_EQ(refusal("# " + repeat("....", 100) + "\n[gbuffer]\nfile = '" + repeat("../", 50) +
                      "a.exr'\nview = \"\"\"" + repeat(".", 100) + "\"\"\"\n"),
              "accepted");
    // As many lights as 16 MiB hold are read in a time that grows with their number.
    std::string lights;
    for (int k = 0; k < 50000; ++k) lights += "[[light]]\ntype='sun'\n";
    EXPECT_EQ(refusal(lights), "accepted");
}

TEST(RigMistakes, DamagedTextsGiveErrorsOfTheFamily) {
    const std::string good =
        Rig::builtin("outdoor").to_toml() +
        "[gbuffer.channels]\nnormal = { channel = 'N', flip = 'y' }\n[[shader]]\nuse = 'ggx'\nroughness = { channel = 'x' }\n";
    std::mt19937 engine(11);
    const auto below = [&](std::size_t count) {
        return std::uniform_int_distribution<std::size_t>(0, count - 1)(engine);
    };
    constexpr std::string_view kPieces = "[]{}=.,\"'#\n\\0-e_ \xC3\xFF\x00";
    int accepted = 0;
    for (int k = 0; k < 3000; ++k) {
        std::string text = good;
        for (std::size_t edits = 1 + below(3); edits > 0; --edits) {
            const std::size_t at = below(text.size());
            switch (below(3)) {
                case 0:
                    text.erase(at, 1 + below(5));
                    break;
                case 1:
                    text.insert(at, 1, kPieces[below(kPieces.size())]);
                    break;
                default:
                    text[at] = kPieces[below(kPieces.size())];
            }
        }
        try {
            const Rig rig = Rig::loads(text);
            ASSERT_TRUE(Rig::loads(rig.to_toml()) == rig) << text;
            ++accepted;
        } catch (const Error& error) {
            const std::string message = error.what();
            EXPECT_EQ(message.find('\n'), std::string::npos) << message;
            EXPECT_LT(message.size(), 600u) << message;
        }
    }
    EXPECT_GT(accepted, 0);
}

TEST(RigMistakes, EveryMisspeltKeyIsGivenBack) {
    // Each key of each table with a letter left out: the message names the key, or one that is as near.
    const auto check = [](const std::string& before, std::span<const Parameter> table) {
        for (const Parameter& row : table) {
            if (row.name.size() < 4) continue;
            std::string wrong(row.name);
            wrong.erase(wrong.size() / 2, 1);
            const std::string message = refusal(before + wrong + " = 1\n");
            EXPECT_NE(message.find("did you mean '" + std::string(row.name) + "'?"), std::string::npos) << message;
        }
    };
    for (const LightType& type : light_types())
        check("[[light]]\ntype = '" + std::string(type.name) + "'\n", type.parameters);
    for (const ShaderInfo& shader : shaders())
        check("[[shader]]\nuse = '" + std::string(shader.name) + "'\n", shader.parameters);
    check("[output]\n", output_parameters());
    check("[camera]\n", camera_parameters());
    check("[gbuffer]\n", gbuffer_parameters());
}

TEST(RigTables, NoShaderTakesAKeyOfTheSection) {
    for (const ShaderInfo& shader : shaders())
        for (const Parameter& own : shader.parameters)
            for (const Parameter& key : shader_key_parameters()) EXPECT_NE(own.name, key.name) << shader.name;
    for (const LightType& type : light_types())
        for (const Parameter& own : type.parameters)
            for (const Parameter& key : light_key_parameters()) EXPECT_NE(own.name, key.name) << type.name;
}

TEST(RigTables, EveryRowIsComplete) {
    for (const auto table :
         {rig_parameters(), gbuffer_parameters(), channel_rule_parameters(), camera_parameters(),
          light_key_parameters(), shader_key_parameters(), channel_ref_parameters(), output_parameters()})
        for (const Parameter& row : table) {
            EXPECT_FALSE(row.label.empty()) << row.name;
            EXPECT_TRUE(row.help.ends_with('.')) << row.name;
            EXPECT_EQ(row.type == ParameterType::choice, !row.choices.empty()) << row.name;
            EXPECT_LE(row.min, row.max) << row.name;
            EXPECT_EQ(std::count_if(table.begin(), table.end(),
                                    [&](const Parameter& other) { return other.name == row.name; }),
                      1)
                << row.name;
        }
}

}  // namespace
}  // namespace relume
