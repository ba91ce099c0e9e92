// SPDX-License-Identifier: Apache-2.0
// The shared terms themselves, at T = double: ∫D·cosθ dω = 1, Smith's Λ against its definition, Fresnel against Snell.

#include <gtest/gtest.h>

#include "quadrature.h"
#include "relume/shading/distributions.h"
#include "relume/shading/fresnel.h"
#include "relume/shading/masking.h"
#include "relume/shading/phase.h"

namespace relume::testing {
namespace {

HalfVector<double> half_at(double theta) {
    const double s = 2 * std::sin(theta / 2);
    return {s * s, std::cos(theta), 1};
}

/// ∫D(θ)·cosθ dω over the hemisphere.
template <class D> double projected(D&& distribution, double width) {
    double sum = 0;
    for (const auto& [theta, w] : sinh_nodes(kPi / 2, width, 96))
        sum += w * 2 * kPi * std::sin(theta) * std::cos(theta) * distribution(half_at(theta));
    return sum;
}

TEST(Distributions, IntegrateToOneWithTheCosine) {
    for (const double a : {0.001, 0.01, 0.1, 0.3, 0.5, 0.8, 1.}) {
        EXPECT_NEAR(projected([&](const auto& h) { return ggx_distribution(a * a, h.sin2_h()); }, a), 1, 1e-6) << a;
        EXPECT_NEAR(projected([&](const auto& h) { return beckmann_distribution(1 / (a * a), h); }, a), 1, 1e-5) << a;
        EXPECT_NEAR(projected([&](const auto& h) { return blinn_phong_distribution(exponent_from_alpha(a), h); }, a), 1,
                    1e-5)
            << a;
        EXPECT_NEAR(projected([&](const auto& h) { return gtr1(a)(h.sin2_h()); }, a), 1, 1e-5) << a;
        EXPECT_NEAR(
            projected([&](const auto& h) { return gaussian_normalisation(a * a) * gaussian_shape(1 / (a * a), h); }, a),
            1, 8e-4)
            << a;
    }
    EXPECT_NEAR(gtr1(1.)(0.3), 1 / kPi, 1e-6);
    EXPECT_NEAR(gtr1(2.)(0.3), 1 / kPi, 1e-6);
}

TEST(Distributions, AnisotropicGgxIntegratesToOne) {
    for (const auto& [ax, ay] : {std::pair{0.3, 0.3}, {0.1, 0.6}, {0.9, 0.05}}) {
        double sum = 0;
        for (const auto& [x, wx] : gauss_legendre(160))
            for (const auto& [theta, w] : sinh_nodes(kPi / 2, std::min(ax, ay), 96)) {
                const V3 h = direction(theta, x * kPi / 2);
                sum += 4 * wx * kPi / 2 * w * std::sin(theta) * h[2] *
                       ggx_distribution_anisotropic(ax, ay, h[0], h[1], h[2] * h[2]);
            }
        EXPECT_NEAR(sum, 1, 1e-5) << ax << ' ' << ay;
    }
}

/// Λ from its definition (Heitz 2014, eq. 58): the slopes steeper than the direction, seen from it.
/// Λ = (1/μ)·∫_μ^∞ (s − μ)·P(s) ds, μ = cotθ, P the distribution of slopes along one axis.
template <class P> double lambda_by_definition(P&& slope_density, double cosine) {
    const double mu = cosine / std::sqrt(1 - cosine * cosine);
    double sum = 0;
    for (const auto& [u, w] : sinh_nodes(1e7, 0.05, 190)) sum += w * u * slope_density(mu + u);
    return sum / mu;
}

TEST(Masking, SmithLambdaByItsDefinition) {
    for (const double a : {0.1, 0.3, 0.6, 1.})
        for (const double cosine : {0.05, 0.2, 0.5, 0.8, 0.97}) {
            const auto ggx = [&](double s) { return a * a / (2 * std::pow(a * a + s * s, 1.5)); };
            const auto beckmann = [&](double s) { return std::exp(-s * s / (a * a)) / (a * std::sqrt(kPi)); };
            const double exact = lambda_by_definition(ggx, cosine);
            EXPECT_NEAR(ggx_lambda(a * a, cosine), exact, 1e-3 * exact + 1e-6) << a << ' ' << cosine;
            // The separable half: G1/(2x) with G1 = 1/(1 + Λ).
            EXPECT_NEAR(ggx_half_masking(a * a, cosine), 1 / (1 + ggx_lambda(a * a, cosine)) / (2 * cosine), 1e-12);
            // Walter's fit: G1 to 3e-3.
            EXPECT_NEAR(1 / (1 + beckmann_lambda(a, cosine)), 1 / (1 + lambda_by_definition(beckmann, cosine)), 4e-3)
                << a << ' ' << cosine;
        }
}

TEST(Fresnel, DielectricIsSnellAndItsPolarisations) {
    for (const double eta : {1., 1.05, 1.33, 1.5, 2.4, 5.})
        for (const double x : {0.001, 0.1, 0.3, 0.6, 0.9, 1.}) {
            const double t = std::sqrt(1 - (1 - x * x) / (eta * eta));
            const double s = (x - eta * t) / (x + eta * t), p = (eta * x - t) / (eta * x + t);
            EXPECT_NEAR(dielectric_fresnel(x, eta), (s * s + p * p) / 2, 1e-12) << eta << ' ' << x;
        }
    for (const double f0 : {0., 0.02, 0.04, 0.08, 0.2, 0.33}) {
        EXPECT_NEAR(dielectric_fresnel(1., eta_from_f0(f0)), f0, 1e-12);
        EXPECT_NEAR(dielectric_rise(f0)(1.), 0, 1e-12);
        EXPECT_NEAR(f0 + (1 - f0) * dielectric_rise(f0)(0.3), dielectric_fresnel(0.3, eta_from_f0(f0)), 1e-12);
    }
    EXPECT_NEAR(eta_from_f0(0.04), 1.5, 1e-12);
}

TEST(Phase, HenyeyGreensteinIsADistributionOfItsMeanCosine) {
    for (const double g : {-0.7, 0., 0.5, 0.9}) {
        double sum = 0, mean = 0;
        for (const auto& [x, w] : gauss_legendre(128)) {
            const double c = 2 * x - 1, p = henyey_greenstein(g)(c);
            sum += 4 * kPi * w * p;
            mean += 4 * kPi * w * p * c;
        }
        EXPECT_NEAR(sum, 1, 1e-6);
        EXPECT_NEAR(mean, g, 1e-6);
    }
}

TEST(CosinePower, IsThePower) {
    for (const double c : {-0.5, 0., 1e-3, 0.3, 0.9, 0.999999, 1.})
        for (const double e : {0., 0.5, 1., 30., 5000.})
            EXPECT_NEAR(cosine_power(1 - c, e), c <= 1e-6 ? 0. : std::pow(c, e), 1e-9) << c << ' ' << e;
    // In float, where 1 − x is what is known well: x^20000 at x = 1 − 1e-5.
    EXPECT_NEAR(cosine_power(1e-5f, 20000.f), std::exp(20000 * std::log1p(-1e-5)), 1e-6);
}

}  // namespace
}  // namespace relume::testing
