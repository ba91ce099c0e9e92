// SPDX-License-Identifier: Apache-2.0
// Cameras in headers: the same camera in every convention, with and without positions to test it against.
#include <gtest/gtest.h>

#include "gbuffer/camera_header.h"
#include "made_scene.h"
#include "relume/error.h"

namespace relume {
namespace {

using test::add_vector;
using test::MadePart;

using Matrix4 = std::array<double, 16>;

class HeaderCamera : public testing::Test {
protected:
    MadePart part(bool positions) {
        MadePart made;
        add_vector(made, "N", [this](int x, int y) { return scene.world_normal(x, y); });
        if (positions) add_vector(made, "P", [this](int x, int y) { return scene.position(x, y); });
        return made;
    }
    GBuffer read(const MadePart& made, const GBufferOptions& options = {}) {
        test::write_exr(folder / "a.exr", {made}, scene.windows);
        return GBuffer::read(folder / "a.exr", options);
    }
    double difference(const GBuffer& gbuffer) {
        if (!gbuffer.camera()) return 1e30;
        return test::largest_pixel_difference(scene.camera, *gbuffer.camera(), scene.windows.data, 8);
    }

    /// World to the picture, −1..1 with y up over the display window, for column vectors.
    Matrix4 screen_matrix() const {
        const Camera& c = scene.camera;
        const Window& w = scene.windows.display;
        // X at the window's left and right edge, Y at its bottom and top.
        const double left = w.x * c.x_scale + c.x_offset, right = w.x_end() * c.x_scale + c.x_offset;
        const double bottom = w.y_end() * c.y_scale + c.y_offset, top = w.y * c.y_scale + c.y_offset;
        const double sx = 2 / (right - left), sy = 2 / (top - bottom), ox = (left + right) / 2, oy = (bottom + top) / 2;
        Matrix4 p{};
        if (c.projection == Projection::perspective) {
            p = {sx, 0, sx * ox, 0, 0, sy, sy * oy, 0, 0, 0, -1.002, -0.2002, 0, 0, -1, 0};
        } else {
            p = {sx, 0, 0, -sx * ox, 0, sy, 0, -sy * oy, 0, 0, -0.02, -1, 0, 0, 0, 1};
        }
        return test::product(p, scene.view_matrix());
    }

    /// −1..1 with y up to another convention.
    static Matrix4 other(const Matrix4& screen, bool zero_to_one, bool down) {
        Matrix4 to{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
        if (down) to[5] = -1;
        if (zero_to_one) to = test::product({0.5, 0, 0, 0.5, 0, 0.5, 0, 0.5, 0, 0, 1, 0, 0, 0, 0, 1}, to);
        return test::product(to, screen);
    }

    io::TemporaryFolder folder;
    test::MadeScene scene;
};

TEST_F(HeaderCamera, WorldToNdcInEveryConvention) {
    for (const bool orthographic : {false, true}) {
        if (orthographic) {
            scene.camera.projection = Projection::orthographic;
            test::set_lens(scene.camera, scene.windows.display, 4);
        }
        for (const bool zero_to_one : {false, true}) {
            for (const bool down : {false, true}) {
                for (const bool turned : {false, true}) {
                    for (const bool positions : {false, true}) {
                        SCOPED_TRACE(testing::Message()
                                     << "orthographic " << orthographic << " 0..1 " << zero_to_one << " down " << down
                                     << " transposed " << turned << " positions " << positions);
                        MadePart made = part(positions);
                        const Matrix4 m = other(screen_matrix(), zero_to_one, down);
                        made.attributes = {test::matrix("worldToNDC", turned ? m : test::transposed(m))};
                        const GBuffer gbuffer = read(made);
                        EXPECT_LT(difference(gbuffer), 1e-3) << gbuffer.camera_reason();
                        EXPECT_NE(gbuffer.camera_reason().find("worldToNDC"), std::string_view::npos);
                        if (positions) {
                            EXPECT_NE(gbuffer.camera_reason().find("confirm"), std::string_view::npos)
                                << gbuffer.camera_reason();
                            EXPECT_LT(gbuffer.camera_error(), 1e-3);
                        }
                    }
                }
            }
        }
    }
}

TEST_F(HeaderCamera, CropAndOverscanFollowTheDisplayWindow) {
    scene.windows.display = {10, 20, 64, 40};
    scene.windows.data = {4, 24, 48, 32};
    scene.windows.pixel_aspect = 2;
    test::set_lens(scene.camera, scene.windows.display, 0.45, 2);
    for (const bool positions : {false, true}) {
        MadePart made = part(positions);
        made.attributes = {test::matrix("exr/worldToScreen", test::transposed(screen_matrix()))};
        EXPECT_LT(difference(read(made)), 1e-3);
    }
    MadePart made = part(true);
    EXPECT_LT(difference(read(made)), 2e-3);
}

TEST_F(HeaderCamera, WorldToCameraTakesItsLensFromElsewhere) {
    Matrix4 view = scene.view_matrix();
    // Positions: the lens is theirs, and the header's pose is confirmed.
    MadePart made = part(true);
    made.attributes = {test::matrix("worldToCamera", test::transposed(view))};
    GBuffer gbuffer = read(made);
    EXPECT_LT(difference(gbuffer), 2e-3) << gbuffer.camera_reason();
    EXPECT_NE(gbuffer.camera_reason().find("lens is recovered"), std::string_view::npos) << gbuffer.camera_reason();

    // OpenEXR's own words: a left-handed frame that looks along +Z.
    Matrix4 left = view;
    for (std::size_t k = 8; k < 12; ++k) left[k] = -left[k];
    for (const bool positions : {false, true}) {
        made = part(positions);
        made.attributes = {test::matrix("worldToCamera", test::transposed(left)), test::number("CameraFocalLength", 50),
                           test::number("CameraFilmApertureHorizontal", 45)};
        gbuffer = read(made);
        EXPECT_LT(difference(gbuffer), 2e-3) << gbuffer.camera_reason();
    }

    // +X to the left: the positions tell.
    Matrix4 mirrored = left;
    for (std::size_t k = 0; k < 4; ++k) mirrored[k] = -mirrored[k];
    made = part(true);
    made.attributes = {test::matrix("worldToCamera", test::transposed(mirrored))};
    gbuffer = read(made);
    EXPECT_LT(difference(gbuffer), 2e-3) << gbuffer.camera_reason();
    EXPECT_NE(gbuffer.camera_reason().find("to the left"), std::string_view::npos) << gbuffer.camera_reason();

    // A field of view from the user.
    made = part(false);
    made.attributes = {test::matrix("worldToCamera", test::transposed(view))};
    GBufferOptions options;
    options.fov = 2 * std::atan(0.45) * 180 / M_PI;
    EXPECT_LT(difference(read(made, options)), 1e-3);
    // None at all: assumed, and said.
    EXPECT_NE(read(made).camera_reason().find("assumed"), std::string_view::npos);
}

TEST_F(HeaderCamera, AHeaderThatThePositionsDenyIsNotUsed) {
    MadePart made = part(true);
    Matrix4 wrong = screen_matrix();
    wrong[3] += 3;
    made.attributes = {test::matrix("worldToNDC", test::transposed(wrong))};
    const GBuffer gbuffer = read(made);
    EXPECT_LT(difference(gbuffer), 2e-3);
    EXPECT_NE(gbuffer.camera_reason().find("recovered"), std::string_view::npos);
    EXPECT_TRUE(test::mentions(gbuffer.notes(), "does not fit the positions"));
}

TEST_F(HeaderCamera, NonsenseIsSurvived) {
    const double nan = std::nan(""), inf = HUGE_VAL;
    for (const double value : {0.0, nan, inf, 1e300, -1e-300}) {
        Matrix4 m{};
        m.fill(value);
        for (const char* name : {"worldToNDC", "worldToCamera", "cameraTransform", "worldToScreen"}) {
            MadePart made = part(true);
            made.attributes = {test::matrix(name, m), test::number("cameraFov", value)};
            EXPECT_LT(difference(read(made)), 2e-3) << name << value;
            made = part(false);
            made.attributes = {test::matrix(name, m)};
            const GBuffer gbuffer = read(made);
            if (!gbuffer.camera()) continue;
            for (const double v : gbuffer.camera()->camera_to_world) EXPECT_TRUE(std::isfinite(v)) << name << value;
        }
    }
    MadePart made = part(false);
    made.attributes = {{"worldToNDC", "string", std::string("1 0 0")},
                       {"worldToCamera", "v3f", std::vector<double>{1, 2, 3}}};
    EXPECT_FALSE(read(made).camera());
}

TEST_F(HeaderCamera, OptionsOverrideAndAreChecked) {
    GBufferOptions options;
    options.camera_matrix = scene.camera.camera_to_world;
    options.fov = 2 * std::atan(0.45) * 180 / M_PI;
    EXPECT_LT(difference(read(part(false), options)), 1e-6);
    options.fov.reset();
    options.focal_length = 40;
    options.horizontal_aperture = 36;
    EXPECT_LT(difference(read(part(false), options)), 1e-6);
    options.focal_length.reset();
    // The lens from the positions.
    EXPECT_LT(difference(read(part(true), options)), 2e-3);
    options.projection = Projection::orthographic;
    options.width = 8;
    const GBuffer parallel = read(part(false), options);
    EXPECT_EQ(parallel.camera()->projection, Projection::orthographic);
    EXPECT_NEAR(parallel.camera()->x_scale * scene.windows.display.width, 8, 1e-9);

    // A camera that does not see the positions where they are is used, but not in silence.
    options = {};
    options.camera_matrix = scene.camera.camera_to_world;
    (*options.camera_matrix)[3] += 1;
    EXPECT_TRUE(test::mentions(read(part(true), options).notes(), "pixels"));
    // A field of view that is not needed is compared.
    options = {};
    options.fov = 20;
    EXPECT_TRUE(test::mentions(read(part(true), options).notes(), "not used"));

    const auto throws = [&](const GBufferOptions& wrong) { EXPECT_THROW(read(part(false), wrong), Error); };
    options.fov = 180;
    throws(options);
    options.fov = -3;
    throws(options);
    options.fov.reset();
    options.projection = Projection::orthographic;
    throws(options);
    options = {};
    options.focal_length = 0;
    throws(options);
    options = {};
    options.camera_matrix = Matrix4{};
    throws(options);
    options.camera_matrix = test::transposed(scene.camera.camera_to_world);
    throws(options);
    options.camera_matrix = scene.camera.camera_to_world;
    (*options.camera_matrix)[0] = std::nan("");
    throws(options);
}

TEST_F(HeaderCamera, BrokenPixelsDoNotPoisonTheFit) {
    MadePart made = part(true);
    for (test::MadeChannel& channel : made.channels) {
        const auto value = channel.value;
        channel.value = [=](int x, int y) {
            if ((x * 7 + y * 13) % 41 == 0) return std::nan("");
            if ((x * 5 + y * 3) % 53 == 0) return HUGE_VAL;
            return value(x, y);
        };
    }
    const GBuffer gbuffer = read(made);
    EXPECT_LT(difference(gbuffer), 2e-3) << gbuffer.camera_reason();
    EXPECT_NE(gbuffer.find("normal")->interpretation.find("-1..1"), std::string::npos);
}

TEST_F(HeaderCamera, FewPixelsAreFoundWhereverTheyAre) {
    // A small object in a large picture, between the rows that are looked at first.
    scene.windows.data = scene.windows.display = {0, 0, 400, 600};
    test::set_lens(scene.camera, scene.windows.display, 0.45);
    MadePart made = part(true);
    for (test::MadeChannel& channel : made.channels) {
        const auto value = channel.value;
        channel.value = [=](int x, int y) { return x >= 50 && x < 90 && y >= 64 && y < 80 ? value(x, y) : 0.0; };
    }
    const GBuffer gbuffer = read(made);
    ASSERT_TRUE(gbuffer.camera()) << gbuffer.camera_reason();
    EXPECT_LT(test::largest_pixel_difference(scene.camera, *gbuffer.camera(), {50, 64, 40, 16}, 8), 0.02);
}

}  // namespace
}  // namespace relume
