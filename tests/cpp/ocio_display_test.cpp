// SPDX-License-Identifier: Apache-2.0
// relume::ocio against closed forms, by a config that is made of them.
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "relume/display.h"
#include "relume/error.h"
#include "relume/ocio_display.h"
#include "relume/working_space.h"

namespace relume {
namespace {

constexpr const char* kConfig = R"(ocio_profile_version: 2
search_path: ""
strictparsing: true
roles:
  default: raw
  scene_linear: Linear Rec.709 (sRGB)
displays:
  sRGB:
    - !<View> {name: Plain, colorspace: sRGB}
    - !<View> {name: Dim, colorspace: sRGB, looks: dim}
    - !<View> {name: Broken, colorspace: with a missing file}
  Gamma 2.2:
    - !<View> {name: Plain, colorspace: gamma}
active_displays: [Gamma 2.2, sRGB]
active_views: []
looks:
  - !<Look> {name: dim, process_space: Linear Rec.709 (sRGB), transform: !<ExponentWithLinearTransform> {gamma: 1, offset: 0}}
  - !<Look> {name: half, process_space: Linear Rec.709 (sRGB), transform: !<MatrixTransform> {matrix: [0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 1]}}
colorspaces:
  - !<ColorSpace> {name: raw, isdata: true}
  - !<ColorSpace>
    name: Linear Rec.709 (sRGB)
    aliases: [scene light]
  - !<ColorSpace>
    name: ACEScg
    to_scene_reference: !<GroupTransform>
      children:
        - !<BuiltinTransform> {style: UTILITY - ACES-AP1_to_CIE-XYZ-D65_BFD}
        - !<MatrixTransform> {matrix: [3.240969941904522, -1.537383177570093, -0.498610760293003, 0, -0.969243636280880, 1.875967501507721, 0.041555057407176, 0, 0.055630079696994, -0.203976958888977, 1.056971514242879, 0, 0, 0, 0, 1]}
  - !<ColorSpace>
    name: sRGB
    from_scene_reference: !<ExponentWithLinearTransform> {gamma: 2.4, offset: 0.055, direction: inverse}
  - !<ColorSpace>
    name: gamma
    from_scene_reference: !<ExponentTransform> {value: 2.2, direction: inverse}
  - !<ColorSpace>
    name: with a missing file
    from_scene_reference: !<FileTransform> {src: nowhere.cube}
)";

class Ocio : public testing::Test {
protected:
    void SetUp() override {
        folder_ = std::filesystem::temp_directory_path() / ("relume_ocio_" + std::to_string(::getpid()));
        std::filesystem::create_directories(folder_);
        config_ = (folder_ / "config.ocio").string();
        std::ofstream(config_) << kConfig;
        ::unsetenv("OCIO");
    }
    void TearDown() override {
        ::unsetenv("OCIO");
        std::filesystem::remove_all(folder_);
    }

    OcioChoice choice(const std::string& display = {}, const std::string& view = {},
                      const std::string& space = {}) const {
        OcioChoice out;
        out.config = config_;
        out.display = display;
        out.view = view;
        out.space = space;
        return out;
    }

    template <class Make> std::string refusal(ErrorKind kind, Make make) const {
        try {
            make();
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), kind) << error.what();
            EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
            return error.what();
        }
        return "accepted";
    }

    std::filesystem::path folder_;
    std::string config_;
};

TEST_F(Ocio, DisplaysAndViewsDefaultFirst) {
    const auto displays = ocio_displays(config_);
    ASSERT_EQ(displays.size(), 2u);
    EXPECT_EQ(displays[0].name, "Gamma 2.2");
    EXPECT_EQ(displays[1].name, "sRGB");
    EXPECT_EQ(displays[1].views, (std::vector<std::string>{"Plain", "Dim", "Broken"}));
    ::setenv("OCIO", config_.c_str(), 1);
    EXPECT_EQ(ocio_displays().size(), 2u);
}

TEST_F(Ocio, ViewsAreTheirClosedForms) {
    const auto srgb = OcioTransform::display(choice("sRGB", "Plain"));
    const auto gamma = OcioTransform::display(choice());
    EXPECT_EQ(gamma.choice().display, "Gamma 2.2");
    EXPECT_EQ(gamma.choice().view, "Plain");
    EXPECT_EQ(gamma.choice().space, "scene_linear");
    for (int k = 0; k <= 300; ++k) {
        const float x = static_cast<float>(k) / 100;
        std::array<float, 3> a{x, x / 2, x / 4}, b = a;
        srgb.apply(a);
        gamma.apply(b);
        for (std::size_t c = 0; c < 3; ++c) {
            const double in = static_cast<double>(x) / std::exp2(static_cast<double>(c));
            // OpenColorIO's powers are approximations.
            EXPECT_NEAR(a[c], srgb_encode(in), 3e-5 * std::max(1.0, srgb_encode(in))) << in;
            EXPECT_NEAR(b[c], gamma22_encode(in), 3e-5 * std::max(1.0, gamma22_encode(in))) << in;
        }
    }
}

TEST_F(Ocio, ConversionsAgreeWithTheMatrices) {
    const auto convert = OcioTransform::conversion(config_, "lin_ap1", "lin_rec709");
    EXPECT_EQ(convert.choice().space, "ACEScg") << "found by another of its names";
    const ColorMatrix matrix =
        rgb_to_rgb(find_working_space("ACEScg")->chromaticities, find_working_space("lin_rec709")->chromaticities);
    for (const std::array<float, 3> color :
         {std::array{1.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, {0.0f, 0.0f, 1.0f}, {0.2f, 0.5f, 3.0f}}) {
        std::array<float, 3> got = color;
        convert.apply(got);
        const auto wanted = transformed(matrix, {color[0], color[1], color[2]});
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(got[c], wanted[c], 3e-5 * std::max(1.0f, color[c])) << c;
    }
    // Roles and aliases of the config.
    std::array<float, 3> same{0.25f, 0.5f, 2.0f};
    OcioTransform::conversion(config_, "scene_linear", "scene light").apply(same);
    EXPECT_EQ(same, (std::array<float, 3>{0.25f, 0.5f, 2.0f}));
}

TEST_F(Ocio, ALookComesBeforeTheView) {
    OcioChoice looked = choice("sRGB", "Plain");
    looked.look = "half";
    std::array<float, 3> color{0.5f, 0.5f, 0.5f};
    OcioTransform::display(looked).apply(color);
    EXPECT_NEAR(color[0], srgb_encode(0.25), 3e-5);
}

TEST_F(Ocio, PicturesWithAlpha) {
    const auto srgb = OcioTransform::display(choice("sRGB", "Plain"));
    float pixels[8] = {0.125f, 0.25f, 0.5f, 0.5f, 0.25f, 0.5f, 1.0f, 1.0f};
    std::vector<Plane> planes;
    for (int c = 0; c < 4; ++c)
        planes.push_back({reinterpret_cast<std::byte*>(pixels + c), PixelType::float32, 16, 32});
    srgb.apply(planes, 2, 1, AlphaMode::premultiplied, AlphaMode::straight);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(pixels[c], pixels[4 + c], 1e-6) << "both are the same colour";
    EXPECT_NEAR(pixels[0], srgb_encode(0.25), 3e-5);
    EXPECT_EQ(pixels[3], 0.5f);
}

TEST_F(Ocio, NothingBecomesNaN) {
    const auto srgb = OcioTransform::display(choice("sRGB", "Plain"));
    std::array<float, 6> colors{std::nanf(""), -HUGE_VALF, HUGE_VALF, 3e38f, -1, 0};
    srgb.apply(colors);
    for (const float x : colors) EXPECT_TRUE(std::isfinite(x)) << x;
    std::array<float, 4> odd{};
    EXPECT_THROW(srgb.apply(odd), Error);
    srgb.apply(std::span<float>{});
}

TEST_F(Ocio, MistakesNameTheNearest) {
    EXPECT_EQ(refusal(ErrorKind::parameter, [&] { OcioTransform::display(choice("sRBG")); }),
              "the OpenColorIO config has no display 'sRBG'; did you mean 'sRGB'?");
    EXPECT_EQ(refusal(ErrorKind::parameter, [&] { OcioTransform::display(choice("sRGB", "Plane")); }),
              "the OpenColorIO config has no view 'Plane' for display 'sRGB'; did you mean 'Plain'?");
    EXPECT_EQ(refusal(ErrorKind::parameter, [&] { OcioTransform::display(choice("sRGB", "Plain", "ACESg")); }),
              "the OpenColorIO config has no colour space 'ACESg'; did you mean 'ACEScg'?");
    EXPECT_EQ(
        refusal(ErrorKind::parameter, [&] { OcioTransform::conversion(config_, "lin_ap0", "sRGB"); }).substr(0, 53),
        "the OpenColorIO config has no colour space 'lin_ap0';");
    OcioChoice looked = choice("sRGB", "Plain");
    looked.look = "halve";
    EXPECT_EQ(refusal(ErrorKind::parameter, [&] { OcioTransform::display(looked); }),
              "the OpenColorIO config has no look 'halve'; did you mean 'half'?");
    EXPECT_EQ(refusal(ErrorKind::value, [&] { OcioTransform::display(choice("sRGB", "Broken")); }).substr(0, 41),
              "OpenColorIO cannot make the transform: Th");
}

TEST_F(Ocio, ConfigsThatAreNone) {
    EXPECT_EQ(
        refusal(ErrorKind::file, [] { ocio_displays(); }),
        "no OpenColorIO config: the environment variable OCIO is not set; set it to a config's file, or name one");
    ::setenv("OCIO", "/nowhere/config.ocio", 1);
    EXPECT_EQ(refusal(ErrorKind::file, [] { ocio_displays(); }),
              "/nowhere/config.ocio (named by the environment variable OCIO): no such OpenColorIO config");
    const std::string bad = (folder_ / "bad.ocio").string();
    std::ofstream(bad) << "this is: [no config";
    EXPECT_EQ(refusal(ErrorKind::file, [&] { ocio_displays(bad); }).substr(0, bad.size() + 27),
              bad + ": not an OpenColorIO config");
    EXPECT_EQ(refusal(ErrorKind::file, [&] { ocio_displays(folder_.string()); }),
              folder_.string() + ": is a directory; an OpenColorIO config is a file");
}

}  // namespace
}  // namespace relume
