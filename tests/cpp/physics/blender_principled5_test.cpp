// SPDX-License-Identifier: Apache-2.0
// blender_principled, generation 5: what its layers and tables must add up to, by quadrature and closed forms. Against
// the renderer and a second implementation it is compared in tests/truth.

#include <gtest/gtest.h>

#include "quadrature.h"

namespace relume::testing {
namespace {

Model generation5() { return Model("blender_principled").choose("generation", "5"); }

/// No layer but the diffuse one.
Model matte() { return generation5().set("base_color", 1).set("specular", 0).set("roughness", 1); }

constexpr double kViews[] = {0, 25, 45, 60, 75, 82};

TEST(BlenderPrincipled5, CompensatedWhiteMetalReflectsAll) {
    // In the table's nodes and between them.
    for (const double roughness : {0.15, 0.3, 0.43, 0.5, 0.68, 0.85, 1.})
        for (const double degrees : kViews) {
            Model metal = generation5().set("base_color", 1).set("metallic", 1).set("roughness", roughness);
            const double width = roughness * roughness;
            EXPECT_LE(albedo(metal, radians(degrees), width).specular[0], 1.0001);
            metal.choose("distribution", "multi_ggx");
            EXPECT_NEAR(albedo(metal, radians(degrees), width).specular[0], 1, 1.5e-3) << roughness << ' ' << degrees;
        }
}

TEST(BlenderPrincipled5, RoughDiffuseLosesNothing) {
    for (const double sigma : {0., 1e-4, 0.2, 0.6, 1.})
        for (const double degrees : kViews)
            EXPECT_NEAR(albedo(matte().set("diffuse_roughness", sigma), radians(degrees), 1).diffuse[0], 1,
                        5e-4)  // the fit has a kink, which the quadrature sees
                << sigma << ' ' << degrees;
}

TEST(BlenderPrincipled5, SheenTakesWhatItReflects) {
    for (const double roughness : {0.2, 0.5, 0.77, 1.})
        for (const double degrees : kViews) {
            const Model both = matte().set("sheen_weight", 1).set("sheen_roughness", roughness);
            EXPECT_NEAR(albedo(both, radians(degrees), 1).diffuse[0], 1, 2e-3) << roughness << ' ' << degrees;
        }
}

TEST(BlenderPrincipled5, NoStackGainsEnergy) {
    for (const auto* distribution : {"ggx", "multi_ggx"})
        for (const double roughness : {0.1, 0.35, 0.7, 1.})
            for (const double degrees : kViews)
                for (const double metallic : {0., 0.5}) {
                    Model all = generation5()
                                    .choose("distribution", distribution)
                                    .set("base_color", 1)
                                    .set("metallic", metallic)
                                    .set("roughness", roughness)
                                    .set("coat_weight", 0.8)
                                    .set("coat_roughness", 0.6 * roughness)
                                    .set("sheen_weight", 0.5)
                                    .set("diffuse_roughness", 0.5);
                    EXPECT_LE(albedo(all, radians(degrees), 0.36 * roughness * roughness).total()[0], 1.002)
                        << all.describe() << ' ' << degrees;
                }
}

/// Mean of (F − R0)/(1 − R0) over the normals of GGX that are visible from v, over their own solid angle: those that
/// mirror below the horizon count as 0.
double mean_rise(double degrees, double roughness, double ior) {
    const double alpha = roughness * roughness, r0 = std::pow((ior - 1) / (ior + 1), 2);
    const V3 v = direction(radians(degrees), 0);
    const double tan2 = 1 / (v[2] * v[2]) - 1, g1 = 2 / (1 + std::sqrt(1 + alpha * alpha * tan2));
    double sum = 0;
    constexpr int kTheta = 1500, kPhi = 360;
    for (int i = 0; i < kTheta; ++i) {
        // tan θ = alpha·√(u/(1 − u)): u is uniform under D·cos.
        const double u = (i + 0.5) / kTheta, theta = std::atan(alpha * std::sqrt(u / (1 - u)));
        for (int k = 0; k < kPhi; ++k) {
            const V3 h = direction(theta, 2 * kPi * (k + 0.5) / kPhi);
            const double c = dot(v, h);
            if (c <= 0 || 2 * c * h[2] - v[2] <= 0) continue;
            const double inside = std::sqrt(1 - (1 - c * c) / (ior * ior));
            const double s = (c - ior * inside) / (c + ior * inside), p = (ior * c - inside) / (ior * c + inside);
            sum += g1 * c / (v[2] * h[2]) * std::max(((s * s + p * p) / 2 - r0) / (1 - r0), 0.);
        }
    }
    return sum / (kTheta * kPhi);
}

TEST(BlenderPrincipled5, SpecularTakesItsMeanRiseFromTheDiffuseLight) {
    for (const double ior : {1.33, 1.5, 1.9})
        for (const double roughness : {0.2, 0.4, 0.6, 0.9})  // nodes of the table and not
            for (const double degrees : {0., 36.87, 53.13, 66.42}) {
                const Model model = generation5().set("base_color", 1).set("ior", ior).set("roughness", roughness);
                const V3 l = direction(radians(20), 1);
                const double left = model.at(direction(radians(degrees), 0), l).diffuse[0] * kPi / l[2];
                const double r0 = std::pow((ior - 1) / (ior + 1), 2);
                const double want = 1 - (r0 + (1 - r0) * mean_rise(degrees, roughness, ior));
                EXPECT_NEAR(left, want, 1.5e-3) << ior << ' ' << roughness << ' ' << degrees;
            }
}

TEST(BlenderPrincipled5, LevelScalesTheReflectanceOfTheIor) {
    const V3 up{0, 0, 1};
    const auto peak = [&](double level, double ior) {
        return generation5().set("specular", level).set("ior", ior).set("roughness", 0.5).at(up, up).specular[0];
    };
    EXPECT_NEAR(peak(1, 1.4) / peak(0.5, 1.4), 2, 1e-9);
    EXPECT_NEAR(peak(0.25, 1.4) / peak(0.5, 1.4), 0.5, 1e-9);
    EXPECT_EQ(peak(0, 1.4), 0);
    EXPECT_NEAR(peak(0.5, 2) / peak(0.5, 1.5), (1 / 9.) / 0.04, 1e-9);
}

TEST(BlenderPrincipled5, MetalsTintIsWhatIsLeftAt82Degrees) {
    const double theta = std::acos(1 / 7.);
    const V3 v = direction(theta, 0), l = direction(theta, kPi), tint{0.9, 0.5, 0.1}, f0{0.9, 0.6, 0.3};
    const auto metal = [&](const V3& c) {
        return generation5()
            .set("metallic", 1)
            .set("base_color", f0)
            .set("roughness", 0.4)
            .set("specular_tint", c)
            .at(v, l)
            .specular;
    };
    const V3 plain = metal({1, 1, 1}), tinted = metal(tint);
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(tinted[k] / plain[k], tint[k], 1e-9);
        EXPECT_NEAR(plain[k] / plain[0],
                    (f0[k] + (1 - f0[k]) * std::pow(6 / 7., 5)) / (f0[0] + (1 - f0[0]) * std::pow(6 / 7., 5)), 1e-9);
    }
}

TEST(BlenderPrincipled5, CoatTintIsTheLightsPathThroughIt) {
    // A coat that bends and reflects nothing: its path is 1/cos long.
    const V3 l = direction(0.3, 2), tint{0.8, 0.5, 0.2};
    for (const double degrees : kViews) {
        const V3 v = direction(radians(degrees), 0);
        Model coated = matte().set("coat_weight", 0.6).set("coat_ior", 1).set("coat_tint", tint);
        const V3 got = coated.at(v, l).diffuse;
        for (std::size_t k = 0; k < 3; ++k)
            EXPECT_NEAR(got[k] * kPi / l[2], 0.4 + 0.6 * std::pow(tint[k], 1 / v[2]), 1e-6) << degrees;
    }
}

TEST(BlenderPrincipled5, CoatAndSheenDarkenEmissionUnlessItIsWhatIsSeen) {
    // Shaded as the kernel does: one pixel, no light.
    const auto emitted = [](const char* is, double coat) {
        const Model model = generation5()
                                .choose("emission_is", is)
                                .set("emission", V3{3, 2, 1})
                                .set("coat_weight", coat)
                                .set("coat_tint", V3{0.5, 1, 1})
                                .set("coat_ior", 1);
        std::vector<float> constants(model.params().begin(), model.params().end());
        std::vector<const float*> slots(constants.size(), nullptr);
        const float zero = 0, one = 1;
        V3 out{};
        float planes[3] = {};
        ShaderTile tile{};
        tile.size = sizeof tile;
        tile.count = 1;
        for (int k = 0; k < 3; ++k) {
            tile.normal[k] = k == 2 ? &one : &zero;
            tile.total[k] = &planes[k];
        }
        tile.eye[2] = 1;
        tile.constant_view = 1;
        tile.slots = slots.data();
        tile.constants = constants.data();
        tile.options = model.options().data();
        tile.emission = 1;
        model.info().abi->kernels[0].shade(&tile);
        for (std::size_t k = 0; k < 3; ++k) out[k] = planes[k];
        return out;
    };
    EXPECT_EQ(emitted("emitted", 0), (V3{3, 2, 1}));
    EXPECT_EQ(emitted("seen", 1), (V3{3, 2, 1}));
    const V3 coated = emitted("emitted", 1);
    EXPECT_NEAR(coated[0], 1.5, 1e-5);
    EXPECT_NEAR(coated[1], 2, 1e-5);
}

TEST(BlenderPrincipled5, BumpTerminator) {
    std::mt19937 random(7);
    for (int trial = 0; trial < 200; ++trial) {
        const V3 smooth = unit(V3{0, 0, 1} + (random_direction(random) - V3{0, 0, 0.5}) * 0.3);
        const V3 v = random_direction(random), l = random_direction(random);
        const double ns = smooth[2], sl = dot(smooth, l);
        if (std::acos(ns) < 1e-3) continue;
        const Model bumped = matte().set("geometric_normal", smooth);
        const double k = std::min((1 / (ns * ns) - 1) / 8, 1.);
        const double want = sl <= 0 ? 0 : 2 / (1 + std::sqrt(1 + k * (1 / (sl * sl) - 1)));
        EXPECT_NEAR(bumped.at(v, l).diffuse[1], matte().at(v, l).diffuse[1] * want, sl > 1e-3 || sl <= 0 ? 1e-9 : 1e-3);
    }
}

TEST(BlenderPrincipled5, ANormalThatIsNotBumpedChangesNothing) {
    std::mt19937 random(8);
    Model model = generation5();
    for (int trial = 0; trial < 100; ++trial) {
        model.randomize(random).choose("generation", "5").set("geometric_normal", 0);
        const V3 v = random_direction(random), l = random_direction(random);
        const V3 plain = model.at(v, l).total();
        // Half floats' rounding, and a mean over an edge, are no bump either.
        for (const V3& normal : {V3{0, 0, 1}, V3{2e-4, -1e-4, 1}, V3{0.6, 0, 0.7}}) {
            model.set("geometric_normal", normal);
            EXPECT_EQ(model.at(v, l).total(), plain);
        }
    }
}

TEST(BlenderPrincipled5, TheBumpUnderACoatIsRecoveredFromTheMeanOfTheNormals) {
    // A smooth coat without a reflection of its own (weight 1 of its closure) over a white metal (weight 1): the pass
    // holds n + s, and the metal must look as it does bare.
    std::mt19937 random(9);
    for (int trial = 0; trial < 200; ++trial) {
        const V3 smooth = unit(random_direction(random) + V3{0, 0, 1});
        const V3 bumped = unit(smooth + (random_direction(random) - V3{0, 0, 0.5}) * 0.2);
        const V3 v = unit(smooth + (random_direction(random) - V3{0, 0, 0.5}) * 1.2);
        const V3 l = unit(smooth + (random_direction(random) - V3{0, 0, 0.5}) * 1.2);
        if (dot(bumped, v) < 0.05 || dot(bumped, l) < 0.05) continue;
        const Model bare = generation5().set("base_color", 1).set("metallic", 1).set("roughness", 0.4);
        Model coated = bare;
        coated.set("coat_weight", 1).set("coat_ior", 1).set("coat_roughness", 0.01).set("geometric_normal", smooth);
        const double want = bare.evaluate({bumped}, {v}, {l})[0].specular[0];
        EXPECT_NEAR(coated.evaluate({unit(bumped + smooth)}, {v}, {l})[0].specular[0], want,
                    5e-4 * std::max(want, 1.));  // two steps of an iteration
    }
}

TEST(BlenderPrincipled5, ALayerOfWeightZeroIsNotThere) {
    std::mt19937 random(10);
    for (int trial = 0; trial < 200; ++trial) {
        Model with = generation5().randomize(random).choose("generation", "5").set("geometric_normal", 0);
        with.set("coat_weight", 0).set("sheen_weight", 0).set("metallic", 0);
        Model without = with;
        without.set("coat_roughness", 0.7).set("coat_ior", 2).set("coat_tint", 0.1).set("sheen_roughness", 0.1);
        without.set("sheen_tint", 0.3);
        const V3 v = random_direction(random), l = random_direction(random);
        EXPECT_EQ(with.at(v, l).total(), without.at(v, l).total());
    }
}

TEST(BlenderPrincipled5, RotationTurnsTheTangent) {
    std::mt19937 random(11);
    Model plain = generation5(), turned = generation5();
    for (Model* m : {&plain, &turned}) m->set("anisotropic", 0.8).set("roughness", 0.4);
    for (int trial = 0; trial < 100; ++trial) {
        const double turns = std::uniform_real_distribution<double>(0, 1)(random), angle = 2 * kPi * turns;
        turned.set("anisotropic_rotation", turns);
        const V3 v = random_direction(random), l = random_direction(random);
        const Answer a = turned.at(v, l, {1, 0, 0}), b = plain.at(v, l, {std::cos(angle), std::sin(angle), 0});
        EXPECT_NEAR(a.specular[0], b.specular[0], 1e-9 * std::max(1., b.specular[0]));
    }
}

TEST(BlenderPrincipled5, MirrorIsBlackUnderLightsWithoutExtent) {
    const V3 v = direction(0.7, 0), l = direction(0.7, kPi);
    for (const auto* coat : {"0", "1"}) {
        Model model = generation5().set("base_color", 0);
        model.set(*coat == '1' ? "coat_weight" : "metallic", 1);
        if (*coat == '1') model.set("specular", 0);
        else model.set("base_color", 1);
        const auto* roughness = *coat == '1' ? "coat_roughness" : "roughness";
        EXPECT_EQ(model.set(roughness, 0).at(v, l).total(), (V3{0, 0, 0}));
        EXPECT_EQ(model.set(roughness, 0.0037).at(v, l).total(), (V3{0, 0, 0}));
        EXPECT_GT(model.set(roughness, 0.0038).at(v, l).specular[0], 1e6);
    }
}

}  // namespace
}  // namespace relume::testing
