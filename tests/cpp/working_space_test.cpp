// SPDX-License-Identifier: Apache-2.0
// The matrices against the figures that the standards print.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>

#include "relume/error.h"
#include "relume/working_space.h"

namespace relume {
namespace {

const Chromaticities& primaries(std::string_view name) { return find_working_space(name)->chromaticities; }

void expect_near(const ColorMatrix& got, const ColorMatrix& wanted, double bound, const char* what) {
    for (std::size_t k = 0; k < 9; ++k)
        EXPECT_NEAR(got[k], wanted[k], bound) << what << " [" << k / 3 << "][" << k % 3 << "]";
}

constexpr ColorMatrix kIdentity{1, 0, 0, 0, 1, 0, 0, 0, 1};

TEST(WorkingSpace, ToXyzAsTheStandardsPrint) {
    expect_near(rgb_to_xyz(primaries("lin_rec709")),
                {0.4124, 0.3576, 0.1805, 0.2126, 0.7152, 0.0722, 0.0193, 0.1192, 0.9505}, 6e-5, "IEC 61966-2-1");
    expect_near(rgb_to_xyz(primaries("lin_rec2020")),
                {0.636958, 0.144617, 0.168881, 0.262700, 0.677998, 0.059302, 0.000000, 0.028073, 1.060985}, 6e-7,
                "ITU-R BT.2020");
    expect_near(rgb_to_xyz(primaries("lin_ap0")),
                {0.9525523959, 0, 0.0000936786, 0.3439664498, 0.7281660966, -0.0721325464, 0, 0, 1.0088251844}, 6e-11,
                "SMPTE ST 2065-1");
    expect_near(rgb_to_xyz(primaries("lin_ap1")),
                {0.6624541811, 0.1340042065, 0.1561876870, 0.2722287168, 0.6740817658, 0.0536895174, -0.0055746495,
                 0.0040607335, 1.0103391003},
                6e-11, "ACES S-2014-004");
    expect_near(xyz_to_rgb(primaries("lin_ap1")),
                {1.6410233797, -0.3248032942, -0.2364246952, -0.6636628587, 1.6153315917, 0.0167563477, 0.0117218943,
                 -0.0082844420, 0.9883948585},
                6e-11, "ACES S-2014-004");
    // White's XYZ scaled to Y = 1 and nothing else.
    const ColorMatrix xyz = rgb_to_xyz(primaries("lin_ciexyzd65"));
    expect_near(xyz, {0.3127 / 0.3290, 0, 0, 0, 1, 0, 0, 0, 0.3583 / 0.3290}, 1e-15, "CIE XYZ");
}

TEST(WorkingSpace, BetweenSpacesAsTheStandardsPrint) {
    expect_near(rgb_to_rgb(primaries("lin_rec709"), primaries("lin_rec2020")),
                {0.6274, 0.3293, 0.0433, 0.0691, 0.9195, 0.0114, 0.0164, 0.0880, 0.8956}, 6e-5, "ITU-R BT.2087");
    expect_near(rgb_to_rgb(primaries("lin_ap0"), primaries("lin_ap1")),
                {1.4514393161, -0.2365107469, -0.2149285693, -0.0765537734, 1.1762296998, -0.0996759264, 0.0083161484,
                 -0.0060324498, 0.9977163014},
                6e-11, "ACES S-2014-004");
    // With Bradford from D65 to ACES' white.
    expect_near(rgb_to_rgb(primaries("lin_rec709"), primaries("lin_ap1")),
                {0.6130974024, 0.3395231462, 0.0473794514, 0.0701937225, 0.9163538791, 0.0134523985, 0.0206155929,
                 0.1095697729, 0.8698146342},
                1e-9, "ACES");
    expect_near(bradford({0.34567, 0.35850}, {0.3127, 0.3290}),
                {0.9555766, -0.0230393, 0.0631636, -0.0282895, 1.0099416, 0.0210077, 0.0122982, -0.0204830, 1.3299098},
                4e-4, "D50 to D65, as Lindbloom prints it of rounded whites");
}

TEST(WorkingSpace, PathsAgreeAndWhiteStaysWhite) {
    for (const WorkingSpace& from : working_spaces()) {
        expect_near(concatenated(rgb_to_xyz(from.chromaticities), xyz_to_rgb(from.chromaticities)), kIdentity, 2e-15,
                    "inverse");
        for (const WorkingSpace& to : working_spaces()) {
            const ColorMatrix there = rgb_to_rgb(from.chromaticities, to.chromaticities);
            expect_near(concatenated(rgb_to_rgb(to.chromaticities, from.chromaticities), there), kIdentity, 5e-15,
                        "there and back");
            const auto white = transformed(there, {1, 1, 1});
            for (const double x : white)
                EXPECT_NEAR(x, from.name == "lin_ciexyzd65" || to.name == "lin_ciexyzd65" ? x : 1, 3e-15)
                    << from.name << " " << to.name;
        }
    }
}

TEST(WorkingSpace, NamesThatProgramsUse) {
    const auto name_of = [](std::string_view name) {
        const WorkingSpace* space = find_working_space(name);
        return space == nullptr ? std::string_view("unknown") : space->name;
    };
    for (const char* name : {"lin_rec709", "lin_rec709_scene", "Linear Rec.709 (sRGB)", "Linear Rec.709",
                             "scene-linear Rec.709-sRGB", "Utility - Linear - sRGB", "LIN_SRGB"})
        EXPECT_EQ(name_of(name), "lin_rec709") << name;
    for (const char* name : {"lin_ap1", "ACEScg", "acescg", "ACES - ACEScg", "lin_ap1_scene"})
        EXPECT_EQ(name_of(name), "lin_ap1") << name;
    for (const char* name : {"lin_ap0", "ACES2065-1", "ACES - ACES2065-1"}) EXPECT_EQ(name_of(name), "lin_ap0") << name;
    for (const char* name : {"lin_rec2020", "Linear Rec.2020", "lin_rec2020_scene"})
        EXPECT_EQ(name_of(name), "lin_rec2020") << name;
    for (const char* name :
         {"lin_p3d65", "Linear DCI-P3 D65", "lin_adobergb", "lin_ciexyzd65_scene", "lin_p3d65_display"})
        EXPECT_NE(name_of(name), "unknown") << name;
    // What is not linear is none of them.
    for (const char* name : {"", "sRGB", "srgb_rec709_scene", "ACEScct", "lin", "scene", "Non-Color", "data"})
        EXPECT_EQ(name_of(name), "unknown") << name;
    // No alias stands for two.
    for (const WorkingSpace& space : working_spaces())
        for (std::string_view rest = space.aliases; !rest.empty();) {
            const std::size_t bar = std::min(rest.find('|'), rest.size());
            EXPECT_EQ(find_working_space(rest.substr(0, bar)), &space) << rest.substr(0, bar);
            rest = bar == rest.size() ? std::string_view{} : rest.substr(bar + 1);
        }
}

TEST(WorkingSpace, TheManualNamesEachAndItsAliases) {
    std::ifstream file(std::string(RELUME_SOURCE_DIR) + "/docs/color.md");
    std::size_t known = 0;
    for (std::string line; std::getline(file, line);) {
        if (!line.starts_with("| `lin_")) continue;
        const std::size_t end = line.find('`', 3);
        const WorkingSpace* space = find_working_space(line.substr(3, end - 3));
        ASSERT_NE(space, nullptr) << line;
        EXPECT_EQ(space, &working_spaces()[known++]) << line;
        std::istringstream aliases(line.substr(line.rfind("| ", line.size() - 2) + 2));
        for (std::string alias; std::getline(aliases, alias, ',');)
            EXPECT_EQ(find_working_space(alias.substr(0, alias.find(" |"))), space) << alias;
    }
    EXPECT_EQ(known, working_spaces().size());
}

TEST(WorkingSpace, ByChromaticities) {
    for (const WorkingSpace& space : working_spaces()) {
        Chromaticities floats = space.chromaticities;
        for (double& x : floats) x = static_cast<float>(x);  // as an EXR holds them
        EXPECT_EQ(find_working_space(floats), &space);
    }
    EXPECT_EQ(find_working_space(Chromaticities{0.5, 0.3, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329}), nullptr);
    Chromaticities nan = primaries("lin_rec709");
    nan[0] = std::nan("");
    EXPECT_EQ(find_working_space(nan), nullptr);
}

TEST(WorkingSpace, PrimariesOnALineAreRefused) {
    EXPECT_THROW(rgb_to_xyz({0.1, 0.1, 0.2, 0.2, 0.3, 0.3, 0.3127, 0.329}), Error);
    EXPECT_THROW(inverse(ColorMatrix{}), Error);
}

}  // namespace
}  // namespace relume
