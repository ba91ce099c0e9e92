// SPDX-License-Identifier: Apache-2.0
// G-buffers of arrays in memory.
#include <gtest/gtest.h>

#include <chrono>
#include <cstring>

#include "io/pixel_convert.h"
#include "made_scene.h"
#include "relume/error.h"

namespace relume {
namespace {

using test::Vector3;

/// An array of any layout, filled by a function of component, column and row.
class Array {
public:
    enum class Layout { planar, interleaved, upside_down, mirrored, columns };

    Array(int width, int height, int components, PixelType type, Layout layout,
          const std::function<double(int, int, int)>& value)
        : width_(width),
          height_(height),
          components_(components),
          type_(type),
          layout_(layout),
          bytes_(static_cast<std::size_t>(width) * height * components * size_of(type)) {
        for (int c = 0; c < components; ++c) {
            const ConstPlane at = plane(c);
            for (int y = 0; y < height; ++y) {
                for (int x = 0; x < width; ++x) {
                    auto* pixel = const_cast<std::byte*>(at.data + y * at.y_stride + x * at.x_stride);
                    const auto number = static_cast<float>(value(c, x, y));
                    if (type == PixelType::float32) std::memcpy(pixel, &number, 4);
                    if (type == PixelType::uint32) {
                        const auto integer = static_cast<std::uint32_t>(number);
                        std::memcpy(pixel, &integer, 4);
                    }
                    if (type == PixelType::half) {
                        // The tests' numbers are halves already, so their bits are those of the float, cut.
                        std::uint32_t bits = 0;
                        std::memcpy(&bits, &number, 4);
                        const std::uint32_t magnitude = bits & 0x7fffffffu;
                        const auto half = static_cast<std::uint16_t>(
                            (bits >> 16 & 0x8000u) | (magnitude == 0 ? 0 : (magnitude >> 13) - (112u << 10)));
                        std::memcpy(pixel, &half, 2);
                    }
                }
            }
        }
    }

    ConstPlane plane(int c) const {
        const auto size = static_cast<std::ptrdiff_t>(size_of(type_));
        const std::byte* data = bytes_.data();
        const std::ptrdiff_t w = width_, h = height_, n = components_;
        switch (layout_) {
            case Layout::planar:
                return {data + c * w * h * size, type_, size, w * size};
            case Layout::interleaved:
                return {data + c * size, type_, n * size, n * w * size};
            case Layout::upside_down:
                return {data + (c * w * h + (h - 1) * w) * size, type_, size, -w * size};
            case Layout::mirrored:
                return {data + (c * w * h + w - 1) * size, type_, -size, w * size};
            case Layout::columns:
                return {data + c * w * h * size, type_, h * size, size};
        }
        return {};
    }
    std::vector<ConstPlane> planes() const {
        std::vector<ConstPlane> all;
        for (int c = 0; c < components_; ++c) all.push_back(plane(c));
        return all;
    }

private:
    int width_, height_, components_;
    PixelType type_;
    Layout layout_;
    std::vector<std::byte> bytes_;
};

constexpr int kWidth = 37, kHeight = 21;

/// Numbers that a half holds exactly.
double number(int c, int x, int y) { return ((x * 5 + y * 3 + c * 11) % 64) / 64.0 - 0.25 * c; }
double up(int c, int, int) { return c == 2 ? 1 : 0; }

Array planar(int components, const std::function<double(int, int, int)>& value, PixelType type = PixelType::float32) {
    return {kWidth, kHeight, components, type, Array::Layout::planar, value};
}

TEST(MemoryGBuffer, EveryLayoutAndTypeIsRead) {
    const Array normal = planar(3, up);
    for (const auto layout : {Array::Layout::planar, Array::Layout::interleaved, Array::Layout::upside_down,
                              Array::Layout::mirrored, Array::Layout::columns}) {
        for (const PixelType type : {PixelType::float32, PixelType::half}) {
            const Array color(kWidth, kHeight, 3, type, layout, number);
            const GBuffer gbuffer = GBuffer::from_memory(
                kWidth, kHeight, {{"normal", {normal.planes(), {}}}, {"base_color", {color.planes(), {}}}});
            for (const int step : {0, 1, 8}) {
                const test::Answer answer = test::ask(gbuffer, test::semantic("base_color", 3), 4, step);
                for (int c = 0; c < 3; ++c) {
                    for (int y = 0; y < kHeight; ++y) {
                        for (int x = 0; x < kWidth; ++x) {
                            ASSERT_EQ(static_cast<double>(answer[static_cast<std::size_t>(c)][static_cast<std::size_t>(
                                          y)][static_cast<std::size_t>(x)]),
                                      number(c, x, y))
                                << static_cast<int>(layout) << ' ' << static_cast<int>(type);
                        }
                    }
                }
            }
        }
    }
}

TEST(MemoryGBuffer, FloatsAreUsedWhereTheyStand) {
    const Array normal = planar(3, up), color = planar(3, number), rough = planar(1, number);
    const Array turned(kWidth, kHeight, 3, PixelType::float32, Array::Layout::upside_down, number);
    const GBuffer gbuffer = GBuffer::from_memory(kWidth, kHeight,
                                                 {{"normal", {normal.planes(), {}}},
                                                  {"base_color", {color.planes(), {}}},
                                                  {"roughness", {rough.planes(), {}}},
                                                  {"position", {turned.planes(), {}}}});
    const std::vector<ChannelRequest> requests{test::semantic("normal", 3), test::semantic("base_color", 3),
                                               test::semantic("roughness"), test::semantic("position", 3)};
    const BandReader reader(gbuffer, requests);
    BandReader::Scratch scratch;
    EXPECT_GE(reader.band_rows(), 1);
    reader.load(0, kHeight, scratch);
    const std::span<const float* const> planes = reader.segment(9, 5, 20, scratch);
    ASSERT_EQ(planes.size(), 10u);
    const auto stands = [](const ConstPlane& plane) {
        return reinterpret_cast<const float*>(plane.data + 9 * plane.y_stride + 5 * plane.x_stride);
    };
    for (int c = 0; c < 3; ++c) {
        EXPECT_EQ(planes[static_cast<std::size_t>(c)], stands(normal.plane(c)));
        EXPECT_EQ(planes[static_cast<std::size_t>(c + 3)], stands(color.plane(c)));
        EXPECT_EQ(planes[static_cast<std::size_t>(c + 7)], stands(turned.plane(c)));
    }
    EXPECT_EQ(planes[6], stands(rough.plane(0)));
}

TEST(MemoryGBuffer, NormalsThatAreNotUnitAreMadeSo) {
    const Array normal = planar(3, [](int c, int x, int) { return x == 0 ? 0.0 : c == 0 ? 3.0 : c == 2 ? 4.0 : 0.0; });
    const GBuffer gbuffer = GBuffer::from_memory(kWidth, kHeight, {{"normal", {normal.planes(), {}}}});
    const test::Answer answer = test::ask(gbuffer, test::semantic("normal", 3));
    EXPECT_FLOAT_EQ(answer[0][4][7], 0.6f);
    EXPECT_FLOAT_EQ(answer[2][4][7], 0.8f);
    EXPECT_EQ(answer[2][4][0], 0.0f);
}

TEST(MemoryGBuffer, RulesAreFollowed) {
    const Array normal = planar(3, [](int c, int x, int) { return x == 0 ? 127 / 255.0 : c == 1 ? 1.0 : 128 / 255.0; });
    const Array gloss = planar(1, [](int, int, int) { return 0.25; });
    const Array depth = planar(1, [](int, int, int) { return 0.5; });
    std::map<std::string, MemoryChannel> channels{
        {"normal", {normal.planes(), {}}}, {"roughness", {gloss.planes(), {}}}, {"depth", {depth.planes(), {}}}};
    channels["normal"].rule.encoding = Encoding::zero_to_one;
    channels["normal"].rule.flip = "y";
    channels["normal"].rule.space = Space::camera;
    channels["roughness"].rule.invert = true;
    channels["depth"].rule.near = 1;
    channels["depth"].rule.far = 9;
    GBufferOptions options;
    // A camera on its side: its up is the world's left.
    options.camera_matrix = {0, -1, 0, 10, 1, 0, 0, 20, 0, 0, 1, 30, 0, 0, 0, 1};
    options.fov = 90;
    const GBuffer gbuffer = GBuffer::from_memory(kWidth, kHeight, channels, options);
    const test::Answer n = test::ask(gbuffer, test::semantic("normal", 3));
    EXPECT_NEAR(n[0][3][8], 1, 1e-3f);
    EXPECT_NEAR(n[1][3][8], 0, 1e-2f);
    EXPECT_EQ(n[0][3][0] * n[0][3][0] + n[1][3][0] * n[1][3][0] + n[2][3][0] * n[2][3][0], 0.0f);
    EXPECT_FLOAT_EQ(test::ask(gbuffer, test::semantic("roughness"))[0][3][3], 0.75f);
    EXPECT_FLOAT_EQ(test::ask(gbuffer, test::semantic("depth"))[0][3][3], 5.0f);
    const test::Answer p = test::ask(gbuffer, test::semantic("position", 3));
    const Vector3 middle = test::at_depth(*gbuffer.camera(), 18.5, 10.5, 5);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(static_cast<double>(p[k][10][18]), middle[k], 1e-5);

    // The options' rules come last.
    options.channels["roughness"].invert = false;
    EXPECT_FLOAT_EQ(
        test::ask(GBuffer::from_memory(kWidth, kHeight, channels, options), test::semantic("roughness"))[0][3][3],
        0.25f);
    channels["normal"].rule.flip = "w";
    EXPECT_THROW(GBuffer::from_memory(kWidth, kHeight, channels, options), Error);
}

TEST(MemoryGBuffer, CoverageDividesWhatIsPremultiplied) {
    const auto share = [](int, int x, int) { return x % 2 ? 0.5 : 0.0; };
    const Array normal = planar(3, up), coverage = planar(1, share),
                rough = planar(1, [&](int c, int x, int y) { return 0.5 * share(c, x, y); });
    std::map<std::string, MemoryChannel> channels{
        {"normal", {normal.planes(), {}}}, {"coverage", {coverage.planes(), {}}}, {"roughness", {rough.planes(), {}}}};
    EXPECT_FLOAT_EQ(test::ask(GBuffer::from_memory(kWidth, kHeight, channels), test::semantic("roughness"))[0][2][3],
                    0.25f);
    channels["roughness"].rule.premultiplied = true;
    const GBuffer gbuffer = GBuffer::from_memory(kWidth, kHeight, channels);
    EXPECT_FLOAT_EQ(test::ask(gbuffer, test::semantic("roughness"))[0][2][3], 0.5f);
    EXPECT_EQ(test::ask(gbuffer, test::semantic("normal", 3))[2][2][2], 0.0f);
    channels.erase("coverage");
    EXPECT_THROW(GBuffer::from_memory(kWidth, kHeight, channels), Error);
}

TEST(MemoryGBuffer, IdentifiersOfAnyType) {
    const auto id = [](int, int x, int y) { return static_cast<double>(x + 40 * y); };
    const Array normal = planar(3, up), integers = planar(1, id, PixelType::uint32), floats = planar(1, id);
    const GBuffer gbuffer = GBuffer::from_memory(kWidth, kHeight,
                                                 {{"normal", {normal.planes(), {}}},
                                                  {"object_id", {integers.planes(), {}}},
                                                  {"material_id", {floats.planes(), {}}}});
    for (const char* name : {"object_id", "material_id"}) {
        ChannelRequest request = test::semantic(name);
        request.kind = ChannelRequest::Kind::id;
        EXPECT_EQ(std::bit_cast<std::uint32_t>(test::ask(gbuffer, request)[0][7][5]), 285u);
    }
}

TEST(MemoryGBuffer, CamerasAreRecovered) {
    test::MadeScene scene;
    const int w = scene.windows.data.width, h = scene.windows.data.height;
    const Array normal(w, h, 3, PixelType::float32, Array::Layout::planar, up);
    const Array position(w, h, 3, PixelType::float32, Array::Layout::interleaved,
                         [&](int c, int x, int y) { return scene.position(x, y)[static_cast<std::size_t>(c)]; });
    const GBuffer gbuffer =
        GBuffer::from_memory(w, h, {{"normal", {normal.planes(), {}}}, {"position", {position.planes(), {}}}});
    ASSERT_TRUE(gbuffer.camera());
    EXPECT_LT(test::largest_pixel_difference(scene.camera, *gbuffer.camera(), scene.windows.data, 8), 2e-3);
}

TEST(MemoryGBuffer, AViewMayBeGiven) {
    const Array normal = planar(3, up), view = planar(3, [](int c, int, int) { return c == 0 ? 1.0 : 0.0; });
    const GBuffer gbuffer =
        GBuffer::from_memory(kWidth, kHeight, {{"normal", {normal.planes(), {}}}, {"view", {view.planes(), {}}}});
    EXPECT_EQ(test::ask(gbuffer, test::semantic("view", 3))[0][3][3], 1.0f);
}

TEST(MemoryGBuffer, MistakesAreNamed) {
    const Array normal = planar(3, up), one = planar(1, number);
    const auto message = [&](const std::map<std::string, MemoryChannel>& channels) -> std::string {
        try {
            GBuffer::from_memory(kWidth, kHeight, channels);
        } catch (const Error& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_NE(message({{"base_color", {normal.planes(), {}}}}).find("no normal"), std::string::npos);
    EXPECT_NE(message({{"normal", {one.planes(), {}}}}).find("normal has 1 plane"), std::string::npos);
    EXPECT_NE(message({{"normal", {normal.planes(), {}}}, {"roughness", {{one.plane(0), one.plane(0)}, {}}}})
                  .find("roughness has 2 planes"),
              std::string::npos);
    EXPECT_NE(message({{"normal", {normal.planes(), {}}}, {"roughness", {{ConstPlane{}}, {}}}}).find("without data"),
              std::string::npos);
    EXPECT_THROW(GBuffer::from_memory(-1, 2, {{"normal", {normal.planes(), {}}}}), Error);
    GBufferOptions options;
    options.max_pixels = 10;
    EXPECT_THROW(GBuffer::from_memory(kWidth, kHeight, {{"normal", {normal.planes(), {}}}}, options), Error);
    // Requests that nothing can answer.
    const GBuffer gbuffer = GBuffer::from_memory(kWidth, kHeight, {{"normal", {normal.planes(), {}}}});
    for (const char* name : {"position", "depth", "base_color", "object_id", "sheen"}) {
        EXPECT_THROW(test::ask(gbuffer, test::semantic(name)), Error) << name;
    }
}

TEST(MemoryGBuffer, OfNoPixelsAndOfOne) {
    const Array normal = planar(3, up);
    const GBuffer none = GBuffer::from_memory(0, 0, {{"normal", {normal.planes(), {}}}});
    EXPECT_TRUE(none.data_window().empty());
    EXPECT_TRUE(test::ask(none, test::semantic("normal", 3)).empty());
    const GBuffer one =
        GBuffer::from_memory(1, 1, {{"normal", {normal.planes(), {}}}, {"position", {normal.planes(), {}}}});
    EXPECT_EQ(test::ask(one, test::semantic("normal", 3))[2][0][0], 1.0f);
    EXPECT_EQ(test::ask(one, test::semantic("position", 3))[2][0][0], 1.0f);
}

}  // namespace
}  // namespace relume
