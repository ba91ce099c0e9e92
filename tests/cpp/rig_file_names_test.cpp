// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "relume/rig.h"

namespace relume {
namespace {

constexpr const char* kRig = R"(
[gbuffer]
file = "shot.####.exr"
[gbuffer.channels]
normal = "sub/../normal.exr"
roughness = "Rough"
metallic = "/elsewhere/metallic.exr"
[[shader]]
use = "cook_torrance"
distribution = "texture"
distribution_table = "lobe.exr"
[[shader]]
use = "cook_torrance"
)";

TEST(RigFileNames, RelativeNamesBecomeThoseOfTheFolder) {
    Rig rig = Rig::loads(kRig);
    rig.resolve_files("/work");
    std::vector<std::filesystem::path> files = rig.input_files();
    std::sort(files.begin(), files.end());
    const std::vector<std::filesystem::path> expected{"/elsewhere/metallic.exr", "/work/lobe.exr", "/work/normal.exr",
                                                      "/work/shot.####.exr"};
    EXPECT_EQ(files, expected);
    EXPECT_EQ(rig.gbuffer.channels.at("roughness").channel, "Rough") << "a layer is no file";
    const Rig once = rig;
    rig.resolve_files("/other");
    EXPECT_EQ(rig, once) << "absolute names stay";
}

TEST(RigFileNames, WhatIsAbsoluteStays) {
    Rig rig = Rig::loads("[gbuffer.channels]\nnormal = '/a/n.exr'\n");
    const Rig before = rig;
    rig.resolve_files("/work");
    EXPECT_EQ(rig, before);
}

}  // namespace
}  // namespace relume
