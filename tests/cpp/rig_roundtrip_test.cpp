// SPDX-License-Identifier: Apache-2.0
// Properties of random rigs: what the tables allow survives being written, read, set and got.
#include <gtest/gtest.h>

#include <bit>
#include <random>

#include "relume/error.h"
#include "rig/value_text.h"
#include "rig_random.h"

namespace relume {
namespace {

TEST(RigRoundTrip, LoadsOfToTomlIsTheSameRig) {
    for (unsigned seed = 0; seed < 400; ++seed) {
        test::RandomRig random(seed);
        const Rig rig = random.rig();
        const std::string text = rig.to_toml();
        try {
            const Rig back = Rig::loads(text);
            ASSERT_TRUE(back == rig) << "seed " << seed << "\n" << text << "\nread as\n" << back.to_toml();
            ASSERT_EQ(back.to_toml(), text) << "seed " << seed;
        } catch (const Error& error) {
            FAIL() << "seed " << seed << ": " << error.what() << "\n" << text;
        }
    }
}

TEST(RigRoundTrip, ComparisonSeesEveryKey) {
    // A round trip proves nothing if equality is blind: each value changed alone makes a different rig.
    test::RandomRig random(7);
    for (const LightType& type : light_types()) {
        Rig base;
        base.lights.push_back({"key", std::string(type.name), {}});
        for (const Parameter& row : type.parameters) {
            Rig changed = base;
            changed.lights[0].values.set(type.parameters, row.name, random.value(row), "light");
            EXPECT_FALSE(changed == base) << row.name;
            EXPECT_NE(changed.to_toml(), base.to_toml()) << row.name;
        }
    }
}

TEST(RigRoundTrip, NumbersKeepEveryBit) {
    std::mt19937_64 engine(3);
    for (int k = 0; k < 4000; ++k) {
        const double number = std::bit_cast<double>(engine());
        if (!std::isfinite(number)) continue;
        const Rig back = Rig::loads("[gbuffer.channels]\ndepth = { near = " + rigfile::number_text(number) + " }");
        const double read = back.gbuffer.channels.at("depth").near.value();
        ASSERT_EQ(std::bit_cast<std::uint64_t>(read), std::bit_cast<std::uint64_t>(number))
            << rigfile::number_text(number);
    }
}

/// Sets each row of a table by its dotted path to a random value, as text, and gets the same text back.
void set_and_get_all(Rig& rig, const std::string& prefix, std::span<const Parameter> table, test::RandomRig& random) {
    for (const Parameter& row : table) {
        ParameterValues one;
        one.set(table, row.name, random.value(row), "test");
        const std::string text = rigfile::value_text(*one.find(row.name), row.type);
        const std::string path = prefix + "." + std::string(row.name);
        rig.set(path, text);
        EXPECT_EQ(rig.get(path), text) << path;
    }
}

TEST(RigRoundTrip, EveryKeyCanBeSetAndGotByItsPath) {
    for (unsigned seed = 0; seed < 20; ++seed) {
        test::RandomRig random(seed);
        for (const LightType& type : light_types()) {
            Rig rig;
            rig.lights.push_back({"a key.1", std::string(type.name), {}});
            set_and_get_all(rig, "light.\"a key.1\"", type.parameters, random);
            set_and_get_all(rig, "light.0", type.parameters, random);
        }
        for (const ShaderInfo& shader : shaders()) {
            Rig rig;
            rig.shaders.emplace_back().use = shader.name;
            set_and_get_all(rig, "shader.0", shader.parameters, random);
        }
        Rig rig;
        set_and_get_all(rig, "output", output_parameters(), random);
        set_and_get_all(rig, "gbuffer", gbuffer_parameters(), random);
    }
}

TEST(RigRoundTrip, EveryDefaultCanBeGotAndWritesNothing) {
    for (const LightType& type : light_types()) {
        Rig rig;
        rig.lights.push_back({"key", std::string(type.name), {}});
        for (const Parameter& row : type.parameters) {
            const std::string path = "light.key." + std::string(row.name);
            if (!row.has_default) {
                EXPECT_THROW(rig.get(path), Error) << path;
                continue;
            }
            // The default is a value that its own row accepts.
            const std::string text = rig.get(path);
            Rig set = rig;
            set.set(path, text);
            EXPECT_EQ(set.get(path), text) << path;
        }
        EXPECT_TRUE(rig.lights[0].values.all().empty());
    }
}

}  // namespace
}  // namespace relume
