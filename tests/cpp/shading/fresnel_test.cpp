// SPDX-License-Identifier: Apache-2.0
// The exact Fresnel law in float against Snell and Fresnel in long double, near ior 1 and grazing too, and colours that
// are no reflectances.

#include "relume/shading/fresnel.h"

#include <gtest/gtest.h>

#include <limits>

#include "../physics/shader_model.h"
#include "relume/shading/tint.h"

namespace relume::testing {
namespace {

double by_snell(double cosine, double eta) {
    const long double x = cosine, n = eta, t = std::sqrt(1 - (1 - x * x) / (n * n));
    const long double s = (x - n * t) / (x + n * t), p = (n * x - t) / (n * x + t);
    return static_cast<double>((s * s + p * p) / 2);
}

TEST(Fresnel, DielectricFollowsSnell) {
    for (const float eta : {1.0001f, 1.001f, 1.01f, 1.1f, 1.33f, 1.5f, 2.f, 5.f, 100.f})
        for (double log_cosine = -5; log_cosine <= 0; log_cosine += 0.01) {
            const auto x = static_cast<float>(std::pow(10, log_cosine));
            const double want = by_snell(static_cast<double>(x), static_cast<double>(eta));
            EXPECT_NEAR(static_cast<double>(dielectric_fresnel(x, eta)), want, 3e-6 * want) << eta << ' ' << x;
            EXPECT_NEAR(dielectric_fresnel(static_cast<double>(x), static_cast<double>(eta)), want,
                        1e-12 * want + 1e-16);
        }
}

TEST(Fresnel, NothingIsReflectedAtIorOne) {
    for (const float x : {0.f, 1e-8f, 1e-6f, 1e-4f, 1e-3f, 0.1f, 1.f}) {
        EXPECT_LT(dielectric_fresnel(x, 1.f), 1e-9f) << x;
        EXPECT_LT(dielectric_rise(0.f)(x), 1e-9f) << x;
        EXPECT_LT(dielectric_fresnel(static_cast<double>(x), 1.), 1e-9) << x;
    }
    EXPECT_EQ(eta_from_f0(0.f), 1.f);
    EXPECT_NEAR(eta_from_f0(0.04), 1.5, 1e-12);
}

TEST(Tint, OfNegativeColoursIsBounded) {
    // A denoised base color may dip below 0; its luminance may then be next to nothing beside its components.
    for (const LuminanceWeights& weights : {kLuminanceBurley, kLuminanceRec709})
        for (const Color<float>& c : {Color<float>{1.f, -0.5f, 0.f}, Color<float>{0.3f, -0.1499999f, 0.f},
                                      Color<float>{-1.f, -1.f, -1.f}, Color<float>{-0.2f, 0.5f, 0.1f}}) {
            const Color<float> tint = tint_of(c, weights);
            for (const float x : {tint.x, tint.y, tint.z})
                EXPECT_TRUE(x >= 0 && x <= 1 / static_cast<float>(std::min(weights.b, weights.r)) * 1.0001f) << x;
        }
    const Color<float> tint = tint_of(Color<float>{0.2f, 0.4f, 0.6f}, kLuminanceBurley);
    EXPECT_FLOAT_EQ(tint.y / tint.x, 2);
    EXPECT_FLOAT_EQ(luminance(tint, kLuminanceBurley), 1);
}

TEST(DefaultLit, TakesANegativeSpecularForNone) {
    const V3 v = direction(0.6, 0), l = direction(0.5, 2.5);
    EXPECT_EQ(Model("default_lit").set("specular", -0.5).at(v, l).specular,
              Model("default_lit").set("specular", 0).at(v, l).specular);
}

}  // namespace
}  // namespace relume::testing
