// SPDX-License-Identifier: Apache-2.0
// half_vector() against h = (v + l)/|v + l| in double, where l comes from behind the surface's edge (l near −v), near
// the mirror direction and anywhere; in float, and in the kernels of every instruction set.

#include <gtest/gtest.h>

#include "../physics/shader_model.h"
#include "relume/isa.h"
#include "relume/shading/shading.h"

namespace relume::testing {
namespace {

V3 rounded(const V3& d) {
    V3 out;
    for (std::size_t k = 0; k < 3; ++k) {
        const volatile auto x = static_cast<float>(d[k]);  // g++ 12 leaves double → float → double out at -O3
        out[k] = static_cast<double>(x);
    }
    return out;
}

Vec3<float> single(const V3& d) {
    return {static_cast<float>(d[0]), static_cast<float>(d[1]), static_cast<float>(d[2])};
}

/// v and l at those elevations over the horizon of n, nearly opposite in azimuth, rounded to float.
struct Opposed {
    V3 n, v, l;
    Opposed(std::mt19937& random, double elevation_v, double elevation_l, double turn) {
        n = rounded(random_direction(random));
        const V3 x = unit(cross(n, V3{0.3, -0.8, 0.1})), y = cross(n, x);
        const auto at = [&](double elevation, double azimuth) {
            return rounded(unit(x * (std::cos(elevation) * std::cos(azimuth)) +
                                y * (std::cos(elevation) * std::sin(azimuth)) + n * std::sin(elevation)));
        };
        v = at(elevation_v, 1);
        l = at(elevation_l, 1 + kPi + turn);
    }
};

TEST(HalfVector, FollowsDoubleWhereLightComesFromBehind) {
    std::mt19937 random(41);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (int k = 0; k < 20000; ++k) {
        const double least = std::pow(10, -4 * uniform(random));  // of the elevations: 1 … 1e-4
        const Opposed p(random, least * (0.2 + uniform(random)), least * (0.2 + uniform(random)),
                        k % 3 == 0 ? 0 : least * (uniform(random) - 0.5));
        const V3 sum = p.v + p.l;
        const double length = std::sqrt(dot(sum, sum));
        if (length < 1e-4) continue;
        const V3 h = sum * (1 / length), across = h - p.n;
        Geometry<float> g;
        g.n = single(p.n);
        g.v = single(p.v);
        LightSample<float> s;
        s.l = single(p.l);
        const HalfVector<float> got = half_vector(g, s);
        // Each component of v + l is rounded once: h is 1e-7 off however short v + l is.
        const double q = dot(across, across);
        EXPECT_NEAR(static_cast<double>(got.q), q, 1e-6 * std::sqrt(q) + 1e-12) << length;
        EXPECT_NEAR(static_cast<double>(got.v_dot_h), length / 2, 3e-7 * length) << length;
        EXPECT_NEAR(static_cast<double>(got.inv_len) * length, 1, 3e-7 + 1e-16 / (length * length)) << length;
        // |v + l|/2 is v·h for unit vectors; those of float are 1e-7 off, and |v + l| feels it.
        EXPECT_NEAR(static_cast<double>(got.v_dot_h), dot(p.v, h), 2e-7 + 2e-7 / length) << length;
        const Vec3<float> direction = half_direction(g, s, got);
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(static_cast<double>(c == 0 ? direction.x : c == 1 ? direction.y : direction.z), h[c], 4e-7);
        if (HasFailure()) return;
    }
}

TEST(HalfVector, OfOppositeDirectionsIsFinite) {
    Geometry<float> g;
    g.n = {0, 0, 1};
    g.v = {0.6f, 0, 0.8f};
    LightSample<float> s;
    s.l = {-0.6f, 0, -0.8f};
    const HalfVector<float> h = half_vector(g, s);
    for (const float x : {h.q, h.v_dot_h, h.inv_len, h.n_dot_h(), h.sin2_h()}) EXPECT_TRUE(std::isfinite(x)) << x;
    EXPECT_GE(h.v_dot_h, 0);
    EXPECT_LT(h.v_dot_h, 1e-6);
}

/// f·NdotL of one pixel by a kernel, under a sun of irradiance 1 from l.
V3 shaded(ShadeFunction kernel, const Model& model, const Opposed& p) {
    std::vector<float> constants;
    for (const double x : model.params()) constants.push_back(static_cast<float>(x));
    constants.push_back(0);
    std::vector<const float*> slots(constants.size(), nullptr);
    const std::vector<TableView> tables = default_tables(model.info());
    float planes[2][3], out[3];
    DirectLight sun{};
    sun.kind = LightKind::sun;
    ShaderTile tile{};
    tile.size = sizeof tile;
    tile.count = 1;
    for (std::size_t k = 0; k < 3; ++k) {
        planes[0][k] = static_cast<float>(p.n[k]);
        planes[1][k] = static_cast<float>(p.v[k]);
        tile.normal[k] = &planes[0][k];
        tile.view[k] = &planes[1][k];
        sun.to_light[k] = static_cast<float>(p.l[k]);
        for (auto& lobe : sun.color) lobe[k] = 1;
        tile.total[k] = &out[k];
    }
    tile.slots = slots.data();
    tile.constants = constants.data();
    tile.options = model.options().data();
    tile.tables = tables.data();
    tile.lights = &sun;
    tile.light_count = 1;
    kernel(&tile);
    EXPECT_EQ(tile.nonfinite, 0);
    return {out[0], out[1], out[2]};
}

TEST(HalfVector, KernelsFollowDoubleWhereLightComesFromBehind) {
    std::mt19937 random(42);
    std::uniform_real_distribution<double> uniform(0, 1);
    const auto isas = available_isas();
    for (int k = 0; k < 600; ++k) {
        const double least = std::pow(10, -3 * uniform(random));
        Opposed p(random, least * (0.5 + uniform(random)), least * (0.5 + uniform(random)),
                  0.2 * least * uniform(random));
        const double roughness = 0.4 + 0.6 * uniform(random);
        for (const auto* name : {"default_lit", "ggx", "cook_torrance", "beckmann"}) {
            Model model = Model(name).set("base_color", 0);
            if (model.has("roughness")) model.set("roughness", roughness);
            if (model.has("width")) model.set("width", roughness * roughness);
            // In double on the same float directions, the normal made unit as the kernel does.
            const V3 want = model.evaluate<double>({unit(p.n)}, {p.v}, {p.l})[0].total();
            for (int i = 0; i < model.info().abi->kernel_count; ++i) {
                const ShaderKernel& kernel = model.info().abi->kernels[i];
                if (std::find(isas.begin(), isas.end(), kernel.isa) == isas.end()) continue;
                const V3 got = shaded(kernel.shade, model, p);
                // The cosines are good to 1e-7 of themselves over least, h to 1e-7 over alpha, v·h to 1e-7 over |v +
                // l|.
                EXPECT_NEAR(got[0], want[0], (1e-5 + 2e-6 / least) * std::max(want[0], 1e-3))
                    << name << ' ' << kernel.isa << ' ' << least << ' ' << roughness;
            }
            if (HasFailure()) return;
        }
    }
}

}  // namespace
}  // namespace relume::testing
