// SPDX-License-Identifier: Apache-2.0
// Every kernel of every shader: each instruction set against the scalar reference, and what a kernel promises on its
// own (bits that depend on the pixel alone, bad input counted and black).

#include <gtest/gtest.h>

#include <cstring>

#include "random_tile.h"
#include "relume/isa.h"

namespace relume::testing {
namespace {

class Kernels : public ::testing::TestWithParam<std::string> {
protected:
    const ShaderInfo& shader() const { return require_shader(GetParam()); }

    /// The kernels that this CPU runs, the scalar reference first.
    std::vector<ShaderKernel> kernels() const {
        const auto isas = available_isas();
        std::vector<ShaderKernel> out;
        for (int k = 0; k < shader().abi->kernel_count; ++k)
            if (std::find(isas.begin(), isas.end(), shader().abi->kernels[k].isa) != isas.end())
                out.push_back(shader().abi->kernels[k]);
        return out;
    }

    static bool same_bits(float a, float b) { return std::memcmp(&a, &b, sizeof a) == 0; }
};

std::vector<std::string> names() {
    std::vector<std::string> out;
    for (const ShaderInfo& s : shaders()) out.emplace_back(s.name);
    return out;
}

/// Largest |a − b|/max(1, |a|).
double difference(const RandomTile::Result& a, const RandomTile::Result& b) {
    double most = 0;
    for (std::size_t k = 0; k < 12; ++k)
        for (std::size_t i = 0; i < a.planes[k].size(); ++i) {
            const double x = a.planes[k][i], y = b.planes[k][i];
            if (!std::isfinite(x) || !std::isfinite(y)) return std::numeric_limits<double>::infinity();
            most = std::max(most, std::fabs(x - y) / std::max(1., std::fabs(x)));
        }
    return most;
}

// Lobes of 0.2 rad and wider, no grazing view: 1e-5. Reciprocals and roots of a batch are good to 2 ulp, and a lobe of
// that width multiplies an error of h by ten; 5e-6 is the worst seen.
TEST_P(Kernels, EveryIsaFollowsTheScalarReference) {
    for (std::uint32_t seed = 0; seed < 150; ++seed) {
        RandomTile tile(shader(), static_cast<int>(1 + seed % 50), seed, Regime::typical);
        const auto reference = tile.shade(kernels().front().shade);
        for (const ShaderKernel& kernel : kernels()) {
            const auto result = tile.shade(kernel.shade);
            EXPECT_LE(difference(reference, result), 1e-5) << kernel.isa << " seed " << seed;
            EXPECT_EQ(result.nonfinite, 0) << kernel.isa;
        }
    }
}

// Everything else: mirror-like lobes amplify the last bits of h by 1/alpha, grazing angles by 1/cosine: 1 % of the
// value (0.7 % seen), as far as float itself is from double there (tests/cpp/physics, FloatFollowsDouble).
TEST_P(Kernels, EveryIsaFollowsTheReferenceAtTheExtremes) {
    for (std::uint32_t seed = 0; seed < 300; ++seed) {
        RandomTile tile(shader(), static_cast<int>(1 + seed % 70), 1000 + seed, Regime::extreme);
        const auto reference = tile.shade(kernels().front().shade);
        for (const ShaderKernel& kernel : kernels()) {
            const auto result = tile.shade(kernel.shade);
            EXPECT_LE(difference(reference, result), 1e-2) << kernel.isa << " seed " << seed;
            EXPECT_EQ(result.nonfinite, reference.nonfinite) << kernel.isa << " seed " << seed;
        }
    }
}

TEST_P(Kernels, APixelsBitsDependOnThePixelAlone) {
    for (const ShaderKernel& kernel : kernels()) {
        for (std::uint32_t seed = 0; seed < 12; ++seed) {
            RandomTile tile(shader(), 70, 2000 + seed, Regime::extreme);
            const auto whole = tile.shade(kernel.shade);
            // Every length of tail, at every offset from the batch.
            for (int count = 1; count <= 33; ++count) {
                const int begin = static_cast<int>((seed * 7 + static_cast<std::uint32_t>(count) * 5) % 37);
                const auto part = tile.shade(kernel.shade, begin, count);
                for (std::size_t k = 0; k < 12; ++k)
                    for (int i = 0; i < count; ++i)
                        ASSERT_TRUE(same_bits(part.planes[k][static_cast<std::size_t>(i)],
                                              whole.planes[k][static_cast<std::size_t>(begin + i)]))
                            << kernel.isa << " seed " << seed << " begin " << begin << " count " << count << " pixel "
                            << i << " plane " << k;
            }
            // Other neighbours, some with NaN.
            const int begin = static_cast<int>(seed * 3), end = begin + 5;
            tile.disturb_outside(begin, end);
            const auto disturbed = tile.shade(kernel.shade);
            for (std::size_t k = 0; k < 12; ++k)
                for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
                    ASSERT_TRUE(same_bits(disturbed.planes[k][i], whole.planes[k][i]))
                        << kernel.isa << " seed " << seed << " pixel " << i << " plane " << k;
        }
    }
}

TEST_P(Kernels, NonfiniteInputIsCountedAndBlack) {
    for (const ShaderKernel& kernel : kernels()) {
        for (std::uint32_t seed = 0; seed < 20; ++seed) {
            const int count = static_cast<int>(1 + seed * 3 % 41);
            RandomTile tile(shader(), count, 3000 + seed, Regime::typical);
            const auto clean = tile.shade(kernel.shade);
            std::mt19937 random(seed);
            std::vector<bool> poisoned(static_cast<std::size_t>(count));
            for (int k = 0; k < 1 + count / 5; ++k) {
                const int pixel = static_cast<int>(random() % static_cast<unsigned>(count));
                tile.poison(pixel);
                poisoned[static_cast<std::size_t>(pixel)] = true;
            }
            const auto result = tile.shade(kernel.shade);
            EXPECT_EQ(result.nonfinite, std::count(poisoned.begin(), poisoned.end(), true))
                << kernel.isa << " seed " << seed;
            for (std::size_t k = 0; k < 12; ++k)
                for (int i = 0; i < count; ++i) {
                    const auto at = static_cast<std::size_t>(i);
                    const float want = !poisoned[at]        ? clean.planes[k][at]
                                       : tile.accumulates() ? tile.before(k, i)
                                                            : 0.f;
                    EXPECT_TRUE(same_bits(result.planes[k][at], want) || (poisoned[at] && result.planes[k][at] == want))
                        << kernel.isa << " seed " << seed << " pixel " << i << " plane " << k << ": "
                        << result.planes[k][at] << " for " << want;
                }
        }
    }
}

// Finite inputs whose product is not.
TEST_P(Kernels, AmbientLightThatOverflowsIsCountedAndBlack) {
    if (std::none_of(shader().parameters.begin(), shader().parameters.end(),
                     [](const Parameter& p) { return p.name == "base_color"; }))
        return;
    const Model model = Model(shader()).set("base_color", 1e38);
    std::vector<float> constants;
    for (const double x : model.params()) constants.push_back(static_cast<float>(x));
    std::vector<const float*> slots(constants.size(), nullptr);
    const std::vector<TableView> tables = default_tables(shader());
    AmbientLight light{};
    for (std::size_t k = 0; k < 3; ++k) light.low[k] = light.high[k] = 100;
    const float zero = 0, one = 1;
    for (const ShaderKernel& kernel : kernels()) {
        float out[3] = {-1, -1, -1};
        ShaderTile tile{};
        tile.size = sizeof tile;
        tile.count = 1;
        tile.normal[0] = tile.normal[1] = &zero;
        tile.normal[2] = &one;
        tile.constant_view = 1;
        tile.eye[2] = 1;
        tile.slots = slots.data();
        tile.constants = constants.data();
        tile.options = model.options().data();
        tile.tables = tables.data();
        tile.ambients = &light;
        tile.ambient_count = 1;
        for (std::size_t k = 0; k < 3; ++k) tile.total[k] = &out[k];
        kernel.shade(&tile);
        EXPECT_EQ(tile.nonfinite, 1) << kernel.isa;
        for (const float x : out) EXPECT_EQ(x, 0) << kernel.isa;
    }
}

INSTANTIATE_TEST_SUITE_P(Shaders, Kernels, ::testing::ValuesIn(names()), [](const auto& test) { return test.param; });

}  // namespace
}  // namespace relume::testing
