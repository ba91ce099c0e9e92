// SPDX-License-Identifier: Apache-2.0
// Parameters of type table: the look-up against a sum of tents in double, in every number type, at every edge; and what
// cook_torrance makes of it.

#include "relume/shading/table.h"

#include <gtest/gtest.h>

#include "random_tile.h"
#include "relume/error.h"
#include "relume/isa.h"
#include "relume/lookup_table.h"

namespace relume::testing {
namespace {

/// Bilinear interpolation as a sum over all texels: each weighs by a tent about its centre, the edge's beyond it.
double tents(const LookupTable& table, double u, double v) {
    const double x = std::clamp(u * table.width - 0.5, 0., table.width - 1.);
    const double y = std::clamp(v * table.height - 0.5, 0., table.height - 1.);
    double sum = 0;
    for (int j = 0; j < table.height; ++j)
        for (int i = 0; i < table.width; ++i)
            sum += static_cast<double>(table.texels[static_cast<std::size_t>(j * table.width + i)]) *
                   std::max(0., 1 - std::fabs(x - i)) * std::max(0., 1 - std::fabs(y - j));
    return sum;
}

TableView view(const LookupTable& table) { return {table.texels.data(), table.width, table.height}; }

LookupTable random_table(std::mt19937& random, int width, int height) {
    LookupTable table{width, height, {}};
    std::uniform_real_distribution<float> uniform(0, 1);
    for (int k = 0; k < width * height; ++k) table.texels.push_back(uniform(random));
    return table;
}

TEST(Table, IsInterpolatedBetweenTheCentresOfItsTexels) {
    std::mt19937 random(31);
    std::uniform_real_distribution<double> uniform(-0.2, 1.2);
    for (int trial = 0; trial < 2000; ++trial) {
        const LookupTable table =
            random_table(random, 1 + static_cast<int>(random() % 40), 1 + static_cast<int>(random() % 9));
        double u = uniform(random), v = uniform(random);
        if (trial % 10 == 0) u = std::array{0., 0.5, 1.}[random() % 3];
        if (trial % 7 == 0) v = std::array{0., 0.5, 1.}[random() % 3];
        EXPECT_NEAR(sample(view(table), u, v), tents(table, u, v), 1e-12) << u << ' ' << v;
        EXPECT_NEAR(static_cast<double>(sample(view(table), static_cast<float>(u), static_cast<float>(v))),
                    tents(table, u, v), 1e-5)
            << u << ' ' << v;
    }
}

TEST(Table, IsReadInsideWhateverIsAsked) {
    const LookupTable table{3, 2, {1, 2, 3, 4, 5, 6}};
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    EXPECT_EQ(sample(view(table), 0.f, 0.f), 1);
    EXPECT_EQ(sample(view(table), 1.f, 1.f), 6);
    EXPECT_EQ(sample(view(table), inf, -inf), 3);
    EXPECT_EQ(sample(view(table), -1e30f, 1e30f), 4);
    for (const float u : {nan, 0.5f})
        for (const float v : {nan, inf}) {
            const float value = sample(view(table), u, v);
            EXPECT_TRUE(value >= 1 && value <= 6) << u << ' ' << v << ' ' << value;
        }
    // The last texel of the largest table: its index is exact in float.
    LookupTable large{2048, 2048, std::vector<float>(static_cast<std::size_t>(kMostTexels), 0.f)};
    large.texels.back() = 7;
    EXPECT_EQ(sample(view(large), 1.f, 1.f), 7);
}

/// A pair of directions.
struct Painted {
    V3 v, l, h;
    double vh;
    explicit Painted(std::mt19937& random) : v(random_direction(random)), l(random_direction(random)) {
        for (V3* d : {&v, &l})
            if ((*d)[2] < 1e-3) *d = unit(V3{(*d)[0], (*d)[1], 1e-3});
        h = unit(v + l);
        vh = dot(v, h);
    }
};

TEST(Table, PaintsTheHighlightOfCookTorrance) {
    std::mt19937 random(32);
    const V3 base{0.2, 0.5, 0.9}, ks{0.9, 0.6, 0.3}, white{1, 1, 1};
    for (int k = 0; k < 1500; ++k) {
        const Painted p(random);
        const LookupTable table = random_table(random, 24, 6);
        const double roughness = k % 5 == 0   ? 0
                                 : k % 5 == 1 ? 1
                                              : k / 1500.,
                     alpha = std::max(roughness * roughness, 1e-3);
        const double metallic = 0.5 * (k % 3), power = 30. * k / 1500;
        const double t = tents(table, p.h[2] / 2 + 0.5, roughness);
        const V3 f0 = mix(white * 0.05, base, metallic), f = f0 + (white - f0) * std::pow(1 - p.vh, 5);
        const auto schlick = [&](double kk) {
            return p.l[2] / (p.l[2] * (1 - kk) + kk) * p.v[2] / (p.v[2] * (1 - kk) + kk);
        };
        const auto lambda = [&](double x) { return (std::sqrt(1 + alpha * alpha * (1 / (x * x) - 1)) - 1) / 2; };
        const double lv = lambda(p.v[2]), ll = lambda(p.l[2]);
        const double maskings[] = {
            1 / (1 + lv + ll), schlick((roughness + 1) * (roughness + 1) / 8), schlick(alpha / 2),
            std::min({1., 2 * p.h[2] * p.v[2] / p.vh, 2 * p.h[2] * p.l[2] / p.vh}), 1 / ((1 + lv) * (1 + ll))};
        for (int g = 0; g < 5; ++g) {
            Model model = Model("cook_torrance").set("base_color", base).set("metallic", metallic);
            model.set("specular", 0.625).set("roughness", roughness).set("specular_color", ks);
            model.set("spec_power", power).set("masking", g).choose("distribution", "texture");
            model.tables()[0] = view(table);
            const Answer got = model.at(p.v, p.l);
            const V3 specular = ks * f * (power * maskings[g] * t * t);
            const V3 diffuse = (white - f) * base * ((1 - metallic) * p.l[2] / kPi);
            for (std::size_t c = 0; c < 3; ++c) {
                EXPECT_NEAR(got.specular[c], specular[c], 1e-9 * std::max(1., specular[c])) << model.describe();
                EXPECT_NEAR(got.diffuse[c], diffuse[c], 1e-12) << model.describe();
            }
            if (HasFailure()) return;
        }
    }
}

TEST(Table, BuiltInIsGgxOverItsPeak) {
    const auto table = builtin_table(require_shader("cook_torrance"), "distribution_table");
    std::mt19937 random(33);
    for (int k = 0; k < 2000; ++k) {
        const Painted p(random);
        const double roughness = 0.45 + 0.55 * k / 2000, a2 = std::pow(roughness, 4), nh = p.h[2];
        const double d_over_peak = std::pow(a2 / (a2 + (1 - a2) * (1 - nh * nh)), 2);
        EXPECT_NEAR(std::pow(tents(*table, nh / 2 + 0.5, roughness), 2), d_over_peak, 0.04)  // half a texel
            << roughness << ' ' << nh;
    }
    // The mirror direction keeps its peak at every roughness, the narrowest included.
    for (const double roughness : {0., 0.1, 0.5, 1.}) EXPECT_NEAR(tents(*table, 1, roughness), 1, 1e-6) << roughness;
    EXPECT_THROW(builtin_table(require_shader("cook_torrance"), "roughness"), Error);
}

// T² changes by 94 times n·h at the least roughness of the regime (2·2(1 − a²)/a² with a = 0.45²), and n·h, a table's
// coordinate, is good to 3e-7: 3e-5.
TEST(Table, EveryIsaFollowsTheScalarReference) {
    const ShaderInfo& shader = require_shader("cook_torrance");
    const auto isas = available_isas();
    for (std::uint32_t seed = 0; seed < 200; ++seed) {
        RandomTile tile(shader, static_cast<int>(1 + seed % 70), 5000 + seed, Regime::typical);
        tile.choose("distribution", "texture");
        const auto reference = tile.shade(shader.abi->kernels[0].shade);
        for (int k = 1; k < shader.abi->kernel_count; ++k) {
            if (std::find(isas.begin(), isas.end(), shader.abi->kernels[k].isa) == isas.end()) continue;
            const auto result = tile.shade(shader.abi->kernels[k].shade);
            for (std::size_t c = 0; c < 12; ++c)
                for (std::size_t i = 0; i < result.planes[c].size(); ++i)
                    ASSERT_NEAR(result.planes[c][i], reference.planes[c][i],
                                3e-5f * std::max(1.f, std::fabs(reference.planes[c][i])))
                        << shader.abi->kernels[k].isa << " seed " << seed;
        }
    }
}

}  // namespace
}  // namespace relume::testing
