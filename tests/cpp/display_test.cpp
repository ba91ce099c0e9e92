// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "io/pixel_convert.h"
#include "relume/display.h"
#include "relume/error.h"

namespace relume {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// float against double, in units of the last place of the double's value as a float.
double ulps(float got, double wanted) {
    const float rounded = static_cast<float>(wanted);
    const double unit = std::nextafter(std::abs(rounded), kInfinity) - static_cast<double>(std::abs(rounded));
    return std::abs(static_cast<double>(got) - wanted) / unit;
}

TEST(Display, SrgbHasTheStandardsConstants) {
    EXPECT_EQ(srgb_encode(0.0), 0);
    EXPECT_NEAR(srgb_encode(1.0), 1, 1e-15);
    EXPECT_DOUBLE_EQ(srgb_encode(0.002), 0.02584);
    EXPECT_DOUBLE_EQ(srgb_encode(-0.5), -6.46);
    // 18 % grey is code 118 of 255, and 0.5 is 0.73536.
    EXPECT_EQ(quantize8(srgb_encode(0.18f)), 118);
    EXPECT_NEAR(srgb_encode(0.5), 0.7353569830524495, 1e-15);
    EXPECT_NEAR(srgb_decode(0.5), 0.21404114048223255, 1e-15);
    // The document's slip: a decode that returns its input.
    EXPECT_NE(srgb_decode(0.5), 0.5);
    // The two pieces meet to the standard's four digits.
    EXPECT_NEAR(12.92 * 0.0031308, 1.055 * std::pow(0.0031308, 1 / 2.4) - 0.055, 3e-8);
    EXPECT_TRUE(std::isnan(srgb_encode(kNaN)));
}

TEST(Display, SrgbRoundTrips) {
    double worst = 0;
    for (int k = -2000; k <= 40000; ++k) {
        const double x = k / 10000.0;
        worst = std::max(worst, std::abs(srgb_decode(srgb_encode(x)) - x));
        worst = std::max(worst, std::abs(srgb_encode(srgb_decode(x)) - x));
    }
    EXPECT_LT(worst, 4e-8) << "only where the pieces meet";
    for (int code = 0; code < 256; ++code)
        EXPECT_EQ(quantize8(srgb_encode(srgb_decode(dequantize8(static_cast<std::uint8_t>(code))))), code);
    for (int code = 0; code < 65536; ++code)
        ASSERT_EQ(quantize16(srgb_encode(srgb_decode(dequantize16(static_cast<std::uint16_t>(code))))), code);
}

TEST(Display, CurvesInFloatAreThoseInDouble) {
    std::mt19937 engine(5);
    std::uniform_real_distribution<float> stops(-20, 12);
    double srgb = 0, gamma = 0, tone = 0, film = 0;
    for (int k = 0; k < 20000; ++k) {
        const float x = std::exp2(stops(engine));
        srgb = std::max(srgb, ulps(srgb_encode(x), srgb_encode(static_cast<double>(x))));
        gamma = std::max(gamma, ulps(gamma22_encode(x), gamma22_encode(static_cast<double>(x))));
        // 1 − 1/(1 + x) cancels near 0: an absolute bound there.
        tone = std::max(tone, std::abs(reinhard(x) - reinhard(static_cast<double>(x))));
        film = std::max(film, ulps(aces_film(x), aces_film(static_cast<double>(x))));
    }
    EXPECT_LE(srgb, 8);
    EXPECT_LE(gamma, 5);
    EXPECT_LE(tone, 1.3e-7);
    EXPECT_LE(film, 5);
}

TEST(Display, GammaAndReinhardRoundTrip) {
    for (int k = 0; k <= 3000; ++k) {
        const double x = k / 1000.0;
        EXPECT_NEAR(gamma22_decode(gamma22_encode(x)), x, 1e-14);
        EXPECT_NEAR(reinhard_inverse(reinhard(x)), x, 1e-14);
    }
    EXPECT_EQ(reinhard(1.0), 0.5);
    EXPECT_EQ(reinhard(3.0), 0.75);
    EXPECT_EQ(reinhard(kInfinity), 1);
    EXPECT_EQ(reinhard_inverse(1.0f), kInfinity);
    EXPECT_EQ(gamma22_encode(-1.0), 0);
    EXPECT_NEAR(gamma22_encode(0.5), 0.7297400528407231, 1e-15);
}

TEST(Display, FilmCurve) {
    EXPECT_EQ(aces_film(0.0), 0);
    EXPECT_NEAR(aces_film(1.0), 2.54 / 3.16, 1e-15);
    EXPECT_NEAR(aces_film(0.18), 0.18 * (2.51 * 0.18 + 0.03) / (0.18 * (2.43 * 0.18 + 0.59) + 0.14), 1e-15);
    // 2.51x² + 0.03x = 2.43x² + 0.59x + 0.14 at x = 7.2416.
    EXPECT_LT(aces_film(7.24), 1);
    EXPECT_EQ(aces_film(7.25), 1);
    for (const float x : {1e10f, 1e30f, 3e38f, kInfinity}) EXPECT_EQ(aces_film(x), 1);
    double before = 0;
    for (int k = 1; k < 800; ++k) {
        EXPECT_GE(aces_film(k / 100.0), before);
        before = aces_film(k / 100.0);
    }
}

TEST(Display, NothingIsNaNOrOutsideTheScreen) {
    for (const ToneCurve tone : {ToneCurve::none, ToneCurve::reinhard, ToneCurve::aces})
        for (const DisplayEncoding encoding :
             {DisplayEncoding::srgb, DisplayEncoding::gamma22, DisplayEncoding::linear})
            for (const double exposure : {-2000.0, -1.0, 0.0, 3.0, 2000.0}) {
                const DisplayTransform transform{exposure, tone, encoding};
                for (const float x :
                     {kNaN, -kInfinity, -1.0f, -0.0f, 0.0f, 1e-45f, 0.5f, 1.0f, 65504.0f, 3e38f, kInfinity}) {
                    const float y = transform(x);
                    EXPECT_TRUE(y >= 0 && y <= 1) << x << " " << exposure << " " << y;
                    EXPECT_TRUE(x > 0 || y == 0) << x;
                }
                EXPECT_TRUE(exposure < 0 || transform(kInfinity) == 1) << exposure;
            }
}

TEST(Display, ExposureIsAFactorBeforeTheCurves) {
    for (const ToneCurve tone : {ToneCurve::none, ToneCurve::reinhard, ToneCurve::aces}) {
        const DisplayTransform one{1, tone, DisplayEncoding::srgb}, none{0, tone, DisplayEncoding::srgb};
        for (const float x : {0.001f, 0.1f, 0.4f, 2.0f}) EXPECT_EQ(one(x), none(2 * x));
    }
    EXPECT_FLOAT_EQ((DisplayTransform{-1, ToneCurve::aces, DisplayEncoding::srgb})(0.8f),
                    static_cast<float>(srgb_encode(aces_film(0.4))));
}

TEST(Display, QuantizingRoundsToTheNearest) {
    for (int code = 0; code < 256; ++code) EXPECT_EQ(quantize8(dequantize8(static_cast<std::uint8_t>(code))), code);
    for (int code = 0; code < 65536; ++code)
        ASSERT_EQ(quantize16(dequantize16(static_cast<std::uint16_t>(code))), code);
    // Between two codes the border is where the exact product passes a half.
    for (int code = 0; code < 65535; ++code) {
        const double border = (code + 0.5) / 65535;
        float above = static_cast<float>(border);
        while (static_cast<long double>(above) * 65535 < code + 0.5L) above = std::nextafter(above, 2.0f);
        const float below = std::nextafter(above, 0.0f);
        ASSERT_EQ(quantize16(above), code + 1);
        ASSERT_EQ(quantize16(below), static_cast<long double>(below) * 65535 >= code + 0.5L ? code + 1 : code);
    }
    for (const float x : {kNaN, -1.0f, -kInfinity, 0.0f, 1e-4f}) EXPECT_EQ(quantize8(x), 0) << x;
    for (const float x : {1.0f, 1.5f, kInfinity, 0.9999f}) EXPECT_EQ(quantize8(x), 255) << x;
    EXPECT_EQ(quantize16(kInfinity), 65535);
    EXPECT_EQ(quantize16(kNaN), 0);
    EXPECT_EQ(quantize8(0.5f), 128) << "127.5: up";
}

Plane plane_of(float* data, std::ptrdiff_t x_stride, std::ptrdiff_t y_stride) {
    return {reinterpret_cast<std::byte*>(data), PixelType::float32, x_stride * 4, y_stride * 4};
}

TEST(Display, InterleavedPlanarAndBackwardsAreTheSame) {
    constexpr int kWidth = 7, kHeight = 3;
    const DisplayTransform transform{0.5, ToneCurve::reinhard, DisplayEncoding::srgb};
    std::mt19937 engine(2);
    std::uniform_real_distribution<float> random(-0.1f, 4);
    std::vector<float> interleaved(kWidth * kHeight * 4);
    for (float& x : interleaved) x = random(engine);
    const std::vector<float> before = interleaved;
    std::vector<float> planar(3 * kWidth * kHeight);
    for (std::size_t i = 0; i < kWidth * kHeight; ++i)
        for (std::size_t c = 0; c < 3; ++c) planar[c * kWidth * kHeight + i] = before[4 * i + c];

    std::vector<Plane> planes;
    for (int c = 0; c < 3; ++c) planes.push_back(plane_of(interleaved.data() + c, 4, 4 * kWidth));
    transform.apply(planes, kWidth, kHeight);
    std::vector<Plane> separate;
    for (int c = 0; c < 3; ++c)
        separate.push_back(plane_of(planar.data() + (c + 1) * kWidth * kHeight - 1, -1, -kWidth));
    transform.apply(separate, kWidth, kHeight);

    for (std::size_t i = 0; i < kWidth * kHeight; ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            EXPECT_EQ(interleaved[4 * i + c], transform(before[4 * i + c]));
            EXPECT_EQ(planar[c * kWidth * kHeight + i], interleaved[4 * i + c]);
        }
        EXPECT_EQ(interleaved[4 * i + 3], before[4 * i + 3]) << "the fourth was not asked for";
    }
}

TEST(Display, TheCurveIsForTheColourNotForItsShareOfThePixel) {
    const DisplayTransform transform{0, ToneCurve::none, DisplayEncoding::srgb};
    const auto through = [&](std::array<float, 4> pixel, AlphaMode in, AlphaMode out) {
        std::vector<Plane> planes;
        for (std::size_t c = 0; c < 4; ++c) planes.push_back(plane_of(pixel.data() + c, 4, 4));
        transform.apply(planes, 1, 1, in, out);
        return pixel;
    };
    using enum AlphaMode;
    const float shown = transform(0.5f);
    EXPECT_EQ(through({0.125f, 0.125f, 0.125f, 0.25f}, premultiplied, straight)[0], shown);
    EXPECT_EQ(through({0.125f, 0.125f, 0.125f, 0.25f}, premultiplied, premultiplied)[0], shown * 0.25f);
    EXPECT_EQ(through({0.5f, 0.5f, 0.5f, 0.25f}, straight, straight)[0], shown);
    EXPECT_EQ(through({0.5f, 0.5f, 0.5f, 0.25f}, straight, premultiplied)[0], shown * 0.25f);
    // A glow: light without a surface.
    for (const float alpha : {0.0f, -1.0f, kNaN}) {
        EXPECT_EQ(through({0.5f, 0.5f, 0.5f, alpha}, premultiplied, premultiplied)[1], shown) << alpha;
        EXPECT_EQ(through({0.5f, 0.5f, 0.5f, alpha}, premultiplied, straight)[1], shown) << alpha;
    }
    EXPECT_EQ(through({0.5f, 0.5f, 0.5f, 0.25f}, premultiplied, straight)[3], 0.25f);
}

TEST(Display, Halves) {
    std::array<std::uint16_t, 3> pixel{};
    for (std::size_t c = 0; c < 3; ++c) pixel[c] = io::float_to_half(0.25f * static_cast<float>(c + 1));
    std::vector<Plane> planes;
    for (std::uint16_t& half : pixel) planes.push_back({reinterpret_cast<std::byte*>(&half), PixelType::half, 6, 6});
    const DisplayTransform transform;
    transform.apply(planes, 1, 1);
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_EQ(pixel[c], io::float_to_half(transform(0.25f * static_cast<float>(c + 1))));
}

TEST(Display, PlanesThatCannotBe) {
    float x[4] = {};
    const Plane good = plane_of(x, 1, 1);
    Plane ids = good;
    ids.type = PixelType::uint32;
    const DisplayTransform transform;
    EXPECT_THROW(transform.apply(std::vector<Plane>{good, good}, 1, 1), Error);
    EXPECT_THROW(transform.apply(std::vector<Plane>{good, good, good, good, good}, 1, 1), Error);
    EXPECT_THROW(transform.apply(std::vector<Plane>{good, good, Plane{}}, 1, 1), Error);
    EXPECT_THROW(transform.apply(std::vector<Plane>{good, good, ids}, 1, 1), Error);
    EXPECT_THROW(transform.apply(std::vector<Plane>{good, good, good}, -1, 1), Error);
    EXPECT_NO_THROW(transform.apply(std::vector<Plane>{good, good, good}, 0, 0));
}

}  // namespace
}  // namespace relume
