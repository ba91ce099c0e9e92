// SPDX-License-Identifier: Apache-2.0
// specular_mix's lobe against its definition: directions normalize((1−t)·rv + t·d), d cosine-distributed, counted in
// bins around the mirror direction.

#include <gtest/gtest.h>

#include "quadrature.h"

namespace relume::testing {
namespace {

constexpr int kRings = 12, kSectors = 8;

struct Frame {
    V3 axis, x, y;
    explicit Frame(const V3& rv) : axis(rv), x(unit(cross({0, 1, 0}, rv))), y(cross(rv, x)) {}
    V3 at(double chi, double psi) const {
        return axis * std::cos(chi) + x * (std::sin(chi) * std::cos(psi)) + y * (std::sin(chi) * std::sin(psi));
    }
};

/// Shares of the definition's directions, by stratified sampling of d: ring of angle to rv, sector around it.
std::vector<double> histogram(double t, const Frame& frame, double chi_end) {
    constexpr int kGrid = 600;
    std::vector<double> shares(kRings * kSectors);
    for (int i = 0; i < kGrid; ++i)
        for (int j = 0; j < kGrid; ++j) {
            const double u = (i + 0.5) / kGrid, phi = 2 * kPi * (j + std::fmod(i * 0.6180339887, 1.)) / kGrid,
                         r = std::sqrt(u);
            const V3 d{r * std::cos(phi), r * std::sin(phi), std::sqrt(1 - u)};
            const V3 l = unit(frame.axis * (1 - t) + d * t);
            const V3 across = cross(frame.axis, l);
            const double chi = std::atan2(std::sqrt(dot(across, across)), dot(l, frame.axis));
            const double psi = std::atan2(dot(l, frame.y), dot(l, frame.x)) + kPi;
            const int ring = std::min(kRings - 1, static_cast<int>(chi / chi_end * kRings));
            const int sector = std::min(kSectors - 1, static_cast<int>(psi / (2 * kPi) * kSectors));
            shares[static_cast<std::size_t>(ring * kSectors + sector)] += 1. / (kGrid * kGrid);
        }
    return shares;
}

/// The same shares from the shader. The last ring ends in a pole 1/√(end − χ): nodes are dense there, x = 1 − (1 − u)².
std::vector<double> integrated(const Model& model, const V3& v, const Frame& frame, double chi_end) {
    const auto nodes = gauss_legendre(24);
    std::vector<double> shares(kRings * kSectors);
    for (int ring = 0; ring < kRings; ++ring)
        for (int sector = 0; sector < kSectors; ++sector) {
            std::vector<V3> directions;
            std::vector<double> weights;
            for (const auto& [u, wu] : nodes)
                for (const auto& [p, wp] : nodes) {
                    const double x = 1 - (1 - u) * (1 - u), chi = chi_end * (ring + x) / kRings,
                                 psi = 2 * kPi * (sector + p) / kSectors - kPi;
                    directions.push_back(frame.at(chi, psi));
                    weights.push_back(std::sin(chi) * chi_end / kRings * wu * 2 * (1 - u) * wp * 2 * kPi / kSectors);
                }
            const auto values = model.evaluate({{0, 0, 1}}, {v}, directions);
            double& share = shares[static_cast<std::size_t>(ring * kSectors + sector)];
            for (std::size_t i = 0; i < values.size(); ++i) share += values[i].specular[0] * weights[i];
        }
    return shares;
}

TEST(SpecularMix, LobeIsTheDensityOfItsDirections) {
    for (const double roughness : {0.1, 0.3, 0.5, 0.65, 0.75, 0.9, 1.})
        for (const double degrees : {10., 50., 80.}) {
            const double t = roughness * roughness;
            const V3 v = direction(radians(degrees), 0);
            const Frame frame(V3{-v[0], -v[1], v[2]});
            const bool disk = t < 0.5;
            const double chi_end = disk ? std::asin(t / (1 - t)) : radians(degrees) + kPi / 2;
            const Model model =
                Model("specular_mix").set("base_color", 0).set("percent_specular", 1).set("roughness", roughness);
            const auto counted = histogram(t, frame, chi_end), shares = integrated(model, v, frame, chi_end);
            double total = 0;
            for (std::size_t k = 0; k < shares.size(); ++k) {
                total += shares[k];
                // Of a disk the pole at the edge is cut, where abs(l·d) < 0.05.
                const bool edge = disk && k >= (kRings - 1) * kSectors;
                EXPECT_NEAR(shares[k], counted[k], (edge ? 0.07 : 0.012) * counted[k] + 4e-4)
                    << roughness << ' ' << degrees << " bin " << k;
            }
            EXPECT_GE(total, disk ? 0.965 : 0.998) << roughness << ' ' << degrees;
            EXPECT_LE(total, 1.002) << roughness << ' ' << degrees;
        }
}

TEST(SpecularMix, EndsAreLambertAndMirror) {
    std::mt19937 random(7);
    for (int trial = 0; trial < 200; ++trial) {
        const V3 v = random_direction(random), l = random_direction(random);
        const Model rough = Model("specular_mix")
                                .set("percent_specular", 1)
                                .set("roughness", 1)
                                .set("specular_color", V3{0.2, 0.5, 0.7});
        for (std::size_t k = 0; k < 3; ++k)
            EXPECT_NEAR(rough.at(v, l).specular[k], V3({0.2, 0.5, 0.7})[k] * l[2] / kPi, 1e-12);
        const Model mixed =
            Model("specular_mix").set("percent_specular", 0.3).set("base_color", 0.6).set("roughness", 0.4);
        EXPECT_NEAR(mixed.at(v, l).diffuse[0], 0.7 * 0.6 * l[2] / kPi, 1e-15);
    }
    const V3 v = direction(0.5, 0);
    EXPECT_EQ(Model("specular_mix").set("roughness", 0).at(v, direction(0.5, kPi)).specular, (V3{0, 0, 0}));
    // Outside the disk around the mirror direction: nothing.
    const double t = 0.25, chi = std::asin(t / (1 - t));
    const Model disk = Model("specular_mix").set("roughness", 0.5);
    EXPECT_GT(disk.at(v, direction(0.5 - 0.99 * chi, kPi)).specular[0], 0);
    EXPECT_EQ(disk.at(v, direction(0.5 - 1.01 * chi, kPi)).specular[0], 0);
}

}  // namespace
}  // namespace relume::testing
