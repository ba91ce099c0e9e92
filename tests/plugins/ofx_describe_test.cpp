// SPDX-License-Identifier: Apache-2.0
// What the node says of itself, and that it can be loaded any number of times.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "ofx_node.h"
#include "relume/light.h"
#include "relume/shader.h"

namespace relume::ofx::test {
namespace {

std::string list_of(const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines) text += line + "\n";
    return text;
}

TEST(OfxDescribeTest, ExportsItsThreeSymbolsAlone) {
    std::FILE* pipe = popen("nm -D --defined-only " RELUME_OFX_BINARY, "r");
    ASSERT_NE(pipe, nullptr);
    std::vector<std::string> names;
    char line[512], kind = 0;
    char name[256];
    while (std::fgets(line, sizeof line, pipe))
        if (std::sscanf(line, "%*x %c %255s", &kind, name) == 2) names.emplace_back(name);
    ASSERT_EQ(pclose(pipe), 0);
    std::sort(names.begin(), names.end());
    EXPECT_EQ(names, (std::vector<std::string>{"OfxGetNumberOfPlugins", "OfxGetPlugin", "OfxSetHost"}));
}

TEST(OfxDescribeTest, BundleHasItsIcon) {
    const Binary binary;
    const std::filesystem::path bundle(RELUME_OFX_BUNDLE);
    EXPECT_TRUE(std::filesystem::exists(bundle / "Contents" / "Resources" /
                                        (std::string(binary.plugin()->pluginIdentifier) + ".png")));
    EXPECT_EQ(binary.plugin()->apiVersion, 1);
    EXPECT_STREQ(binary.plugin()->pluginApi, "OfxImageEffectPluginAPI");
}

TEST(OfxDescribeTest, EveryContextIsDescribedWithoutComplaint) {
    for (const char* context : {name::kContextGeneral, name::kContextFilter, name::kContextGenerator}) {
        Host host;
        Node node(host, context);
        EXPECT_EQ(list_of(host.complaints()), "") << context;
        const Effect& effect = node.descriptor();
        EXPECT_EQ(effect.properties.texts(name::kPropSupportedContexts).size(), 3u);
        EXPECT_EQ(effect.properties.texts(name::kPropSupportedDepths).size(), 4u);
        EXPECT_EQ(effect.properties.text(name::kPropThreadSafety), "OfxImageEffectRenderFullySafe");
        EXPECT_NE(effect.properties.text(name::kPropDescription), "");
        EXPECT_TRUE(effect.clips.contains("Output"));
        EXPECT_EQ(effect.clips.contains("Source"), std::string(context) != name::kContextGenerator);
        EXPECT_EQ(effect.clips.contains("Normal"), std::string(context) == name::kContextGeneral);
        for (const auto& [name, clip] : effect.clips) {
            EXPECT_EQ(clip->properties.text(name::kPropSupportedComponents), "OfxImageComponentRGBA") << name;
            EXPECT_EQ(clip->properties.integer(name::kPropOptional) != 0, name != "Source" && name != "Output") << name;
        }
    }
}

TEST(OfxDescribeTest, EveryParameterIsWhole) {
    Host host;
    Node node(host, name::kContextGeneral);
    std::set<std::string> in_pages;
    int shown = 0;
    for (const auto& [name, parameter] : node.descriptor().parameters) {
        const PropertySet& p = parameter->properties;
        EXPECT_NE(parameter->type, "OfxParamTypeInteger2D") << name;
        EXPECT_NE(parameter->type, "OfxParamTypeInteger3D") << name;
        EXPECT_NE(p.text(name::kPropLabel), "") << name;
        EXPECT_EQ(p.text(name::kPropScriptName), name);
        if (parameter->type == name::kParamPage)
            for (const std::string& child : p.texts(name::kPropPageChild)) in_pages.insert(child);
        if (const std::string parent = p.text(name::kPropParent); !parent.empty()) {
            ASSERT_TRUE(node.descriptor().parameters.contains(parent)) << name;
            EXPECT_EQ(node.descriptor().parameters.at(parent)->type, name::kParamGroup) << name;
        }
        const int components = parameter->type == name::kParamDouble                                           ? 1
                               : parameter->type == name::kParamDouble2D                                       ? 2
                               : parameter->type == name::kParamDouble3D || parameter->type == name::kParamRgb ? 3
                                                                                                               : 0;
        for (int k = 0; k < components; ++k) {
            EXPECT_LT(p.number(name::kPropMin, k), p.number(name::kPropMax, k)) << name;
            EXPECT_LT(p.number(name::kPropDisplayMin, k), p.number(name::kPropDisplayMax, k)) << name;
            EXPECT_LE(p.number(name::kPropMin, k), p.number(name::kPropDefault, k)) << name;
            EXPECT_GE(p.number(name::kPropMax, k), p.number(name::kPropDefault, k)) << name;
        }
        if (parameter->type == name::kParamInteger) {
            EXPECT_LT(p.integer(name::kPropDisplayMin), p.integer(name::kPropDisplayMax)) << name;
        }
        if (parameter->type == name::kParamChoice) {
            EXPECT_LT(p.integer(name::kPropDefault), static_cast<int>(p.texts(name::kPropChoiceOption).size())) << name;
        }
        // Nuke never shows what was secret at first: only what is for no eye may be.
        EXPECT_EQ(p.integer(name::kPropSecret) != 0, name.ends_with("_name")) << name;
        ++shown;
    }
    EXPECT_GT(shown, 200);
    for (const auto& [name, parameter] : node.descriptor().parameters)
        if (parameter->type != name::kParamPage && parameter->type != name::kParamGroup) {
            EXPECT_TRUE(in_pages.contains(name)) << name;
        }
}

TEST(OfxDescribeTest, TablesAreTheParameters) {
    Host host;
    Node node(host, name::kContextGeneral);
    const auto& parameters = node.descriptor().parameters;
    for (int k = 1; k <= 8; ++k) {
        const std::string prefix = "light" + std::to_string(k) + "_";
        const std::vector<std::string> types =
            parameters.at(prefix + "type")->properties.texts(name::kPropChoiceOption);
        ASSERT_EQ(types.size(), light_types().size() + 1);
        for (const LightType& type : light_types()) {
            EXPECT_NE(std::find(types.begin(), types.end(), type.name), types.end());
            for (const relume::Parameter& row : type.parameters)
                EXPECT_TRUE(parameters.contains(prefix + std::string(row.name))) << type.name << " " << row.name;
        }
    }
    const std::vector<std::string> models = parameters.at("shader")->properties.texts(name::kPropChoiceOption);
    for (const ShaderInfo& shader : shaders()) {
        EXPECT_NE(std::find(models.begin(), models.end(), shader.name), models.end()) << shader.name;
        for (const relume::Parameter& row : shader.parameters) {
            const std::string name = std::string(shader.name) + "_" + std::string(row.name);
            ASSERT_TRUE(parameters.contains(name)) << name;
            if (row.type == ParameterType::scalar) {
                EXPECT_EQ(parameters.at(name)->properties.number(name::kPropDefault), row.value[0]) << name;
            }
        }
    }
}

/// Projects store the index of a choice: what is there keeps its place.
TEST(OfxDescribeTest, LightTypesKeepTheirPlaces) {
    Host host;
    Node node(host, name::kContextGeneral);
    std::vector<std::string> types =
        node.descriptor().parameters.at("light1_type")->properties.texts(name::kPropChoiceOption);
    ASSERT_GE(types.size(), 7u);
    types.resize(7);
    EXPECT_EQ(types, (std::vector<std::string>{"off", "sun", "point", "spot", "sky", "bounce", "ambient"}));
}

TEST(OfxDescribeTest, LoadsAgainAndAgain) {
    Host host;
    for (int k = 0; k < 3; ++k) {
        Node node(host, "");
        ASSERT_EQ(node.loaded(), kOk);
        EXPECT_EQ(node.describe(name::kContextGeneral), kOk);
        EXPECT_EQ(node.unload(), kOk);
    }
    Binary kept;  // the library stays open: the same statics
    for (int k = 0; k < 2; ++k) {
        Node node(host, name::kContextFilter);
        EXPECT_EQ(node.loaded(), kOk);
    }
    EXPECT_EQ(list_of(host.complaints()), "");
}

TEST(OfxDescribeTest, KnobsFollowTheType) {
    Host host;
    Node node(host, name::kContextGeneral);
    const auto secret = [&](const std::string& name) {
        return node.parameter(name).properties.integer(name::kPropSecret) != 0;
    };
    EXPECT_TRUE(secret("light1_cone_angle"));
    EXPECT_TRUE(secret("light1_exposure"));
    EXPECT_TRUE(secret("ggx_roughness"));
    node.choose("light1_type", "spot");
    EXPECT_EQ(node.changed("light1_type"), kOk);
    EXPECT_FALSE(secret("light1_cone_angle"));
    EXPECT_FALSE(secret("light1_pick"));
    EXPECT_TRUE(secret("light1_irradiance"));
    EXPECT_TRUE(secret("light2_cone_angle"));
    node.choose("light1_type", "ambient");
    EXPECT_EQ(node.changed("light1_type"), kOk);
    EXPECT_TRUE(secret("light1_cone_angle"));
    EXPECT_TRUE(secret("light1_pick"));
    EXPECT_FALSE(secret("light1_irradiance"));
    node.choose("shader", "ggx");
    EXPECT_EQ(node.changed("shader"), kOk);
    EXPECT_FALSE(secret("ggx_roughness"));
    EXPECT_TRUE(secret("principled_roughness"));
    EXPECT_EQ(list_of(host.complaints()), "");
}

}  // namespace
}  // namespace relume::ofx::test
