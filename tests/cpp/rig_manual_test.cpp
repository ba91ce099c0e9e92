// SPDX-License-Identifier: Apache-2.0
// docs/rig.md against the tables: its key tables are made from them, and its examples load. With RELUME_WRITE_DOCS set
// in the environment the tables in the file are written anew.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include "gbuffer/channel_rules.h"
#include "relume/error.h"
#include "relume/light.h"
#include "relume/rig.h"
#include "rig/value_text.h"

namespace relume {
namespace {

const std::string kManual = std::string(RELUME_SOURCE_DIR) + "/docs/rig.md";

std::string read(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    EXPECT_TRUE(file) << path;
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

std::string number(double x) { return rigfile::short_number_text(x); }

std::string takes(const Parameter& row) {
    std::string text;
    switch (row.type) {
        case ParameterType::scalar:
            text = "number";
            break;
        case ParameterType::color:
            text = "number or [r, g, b]";
            break;
        case ParameterType::vector:
            text = "[x, y, z]";
            break;
        case ParameterType::boolean:
            return "true or false";
        case ParameterType::integer:
            text = "whole number";
            break;
        case ParameterType::choice: {
            for (const auto choice : rigfile::split_choices(row.choices))
                text += (text.empty() ? "`\"" : ", `\"") + std::string(choice) + "\"`";
            return text;
        }
        case ParameterType::text:
            return "string";
        case ParameterType::text_list:
            return "list of strings, or one";
        case ParameterType::number_list:
            text = row.count > 0 ? std::to_string(row.count) + " numbers" : "list of numbers";
            break;
        case ParameterType::table:
            return "file, or rows of numbers";
    }
    if (!row.unit.empty()) text += ", " + std::string(row.unit);
    if (std::isfinite(row.min) && std::isfinite(row.max))
        text += row.min == row.max ? "" : ", " + number(row.min) + " … " + number(row.max);
    else if (std::isfinite(row.min)) text += ", ≥ " + number(row.min);
    return text;
}

std::string default_of(const Parameter& row) {
    if (!row.has_default) return row.type == ParameterType::vector ? "required" : "–";
    const auto triple = [&] {
        return row.value[0] == row.value[1] && row.value[1] == row.value[2] && row.type == ParameterType::color
                   ? number(row.value[0])
                   : "[" + number(row.value[0]) + ", " + number(row.value[1]) + ", " + number(row.value[2]) + "]";
    };
    switch (row.type) {
        case ParameterType::color:
        case ParameterType::vector:
            return triple();
        case ParameterType::boolean:
            return row.value[0] != 0 ? "true" : "false";
        case ParameterType::choice:
            return "\"" + std::string(rigfile::split_choices(row.choices).at(static_cast<std::size_t>(row.value[0]))) +
                   "\"";
        case ParameterType::text:
            return "\"" + std::string(row.text) + "\"";
        case ParameterType::text_list:
        case ParameterType::number_list:
            return "[]";
        default:
            return number(row.value[0]);
    }
}

std::string table(std::span<const Parameter> rows) {
    std::string out = "| key | takes | default | meaning |\n| --- | --- | --- | --- |\n";
    for (const Parameter& row : rows)
        out += "| `" + std::string(row.name) + "` | " + takes(row) + " | " + default_of(row) + " | " +
               std::string(row.help) + " |\n";
    return out;
}

bool in_all_types(const Parameter& row) {
    return std::all_of(light_types().begin(), light_types().end(), [&](const LightType& type) {
        return std::any_of(type.parameters.begin(), type.parameters.end(),
                           [&](const Parameter& p) { return p.name == row.name && p.help == row.help; });
    });
}

std::vector<Parameter> rows_of(const LightType& type, bool common) {
    std::vector<Parameter> rows;
    for (const Parameter& row : type.parameters)
        if (in_all_types(row) == common) rows.push_back(row);
    return rows;
}

std::string generated(const std::string& name) {
    if (name == "rig") return table(rig_parameters());
    if (name == "gbuffer") return table(gbuffer_parameters());
    if (name == "channel_rule") return table(channel_rule_parameters());
    if (name == "camera") return table(camera_parameters());
    if (name == "light_keys") return table(light_key_parameters());
    if (name == "light_common") return table(rows_of(light_types()[0], true));
    if (name == "shader_keys") return table(shader_key_parameters());
    if (name == "channel_ref") return table(channel_ref_parameters());
    if (name == "output") return table(output_parameters());
    std::string out;
    if (name == "lights")
        for (const LightType& type : light_types())
            out += (out.empty() ? "" : "\n") + ("### " + std::string(type.name)) + "\n\n" + std::string(type.help) +
                   "\n\n" + table(rows_of(type, false));
    return out;
}

const std::string kNames[] = {"rig",          "gbuffer", "channel_rule", "camera",      "light_keys",
                              "light_common", "lights",  "shader_keys",  "channel_ref", "output"};

TEST(RigManual, ItsTablesAreTheTables) {
    std::string manual = read(kManual);
    for (const std::string& name : kNames) {
        const std::string start = "<!-- table: " + name + " -->\n", end = "<!-- end -->";
        const std::size_t from = manual.find(start);
        ASSERT_NE(from, std::string::npos) << start;
        const std::size_t first = from + start.size();
        const std::size_t last = manual.find(end, first);
        ASSERT_NE(last, std::string::npos) << start;
        const std::string wanted = generated(name);
        if (std::getenv("RELUME_WRITE_DOCS") != nullptr) manual.replace(first, last - first, wanted);
        else
            EXPECT_EQ(manual.substr(first, last - first), wanted)
                << "docs/rig.md: table " << name << " is not up to date; run this test with RELUME_WRITE_DOCS=1";
    }
    if (std::getenv("RELUME_WRITE_DOCS") != nullptr) std::ofstream(kManual, std::ios::binary) << manual;
}

TEST(RigManual, ItsExamplesLoad) {
    const std::string manual = read(kManual);
    const std::string start = "```toml\n";
    int count = 0;
    for (std::size_t at = 0; (at = manual.find(start, at)) != std::string::npos; ++count) {
        at += start.size();
        const std::string example = manual.substr(at, manual.find("```", at) - at);
        EXPECT_NO_THROW(Rig::loads(example)) << example;
    }
    EXPECT_GE(count, 4);
}

TEST(RigManual, ItNamesEveryShadingModelAndSemanticChannel) {
    const std::string manual = read(kManual);
    for (std::size_t id = 0; id < shading_model_names().size(); ++id)
        EXPECT_NE(manual.find(std::to_string(id) + " `" + std::string(shading_model_names()[id]) + "`"),
                  std::string::npos)
            << id;
    for (const auto& semantic : gbuffer::semantic_names())
        EXPECT_NE(manual.find("`" + std::string(semantic.name) + "`"), std::string::npos) << semantic.name;
    EXPECT_NE(manual.find("`cryptomatte`"), std::string::npos);
    for (const BuiltinRig& rig : builtin_rigs())
        EXPECT_NE(manual.find("`" + std::string(rig.name) + "`"), std::string::npos);
}

}  // namespace
}  // namespace relume
