// SPDX-License-Identifier: Apache-2.0
// The classic models, normalised and plain, and the microfacet kit against their textbook formulas, written here a
// second time with angles and tangents.

#include <gtest/gtest.h>

#include "shader_model.h"

namespace relume::testing {
namespace {

/// A pair of random directions and what the textbooks make of it.
struct Pair {
    V3 v, l, h, r;
    double nl, nv, nh, vh, theta_h;
    explicit Pair(std::mt19937& random) : v(random_direction(random)), l(random_direction(random)) {
        if (random() % 2) l = unit(V3{-v[0], -v[1], v[2]} + (random_direction(random) - V3{0, 0, 0.4}) * 0.3);
        if (l[2] < 1e-3) l = unit(V3{l[0], l[1], 1e-3});
        if (v[2] < 1e-3) v = unit(V3{v[0], v[1], 1e-3});
        h = unit(v + l);
        r = V3{-l[0], -l[1], l[2]};
        nl = l[2];
        nv = v[2];
        nh = h[2];
        vh = dot(v, h);
        theta_h = std::atan2(std::hypot(h[0], h[1]), h[2]);
    }
};

constexpr V3 kBase{0.2, 0.5, 0.9}, kSpecular{0.7, 0.4, 0.1};

void expect_near(const V3& got, const V3& want, double relative, const std::string& what) {
    for (std::size_t k = 0; k < 3; ++k)
        EXPECT_NEAR(got[k], want[k], relative * std::max(1e-3, std::fabs(want[k]))) << what;
}

Model classic(const char* name, bool normalised) {
    return Model(name).set("base_color", kBase).set("specular_color", kSpecular).set("energy_conserving", normalised);
}

TEST(Classic, Phong) {
    std::mt19937 random(11);
    for (int k = 0; k < 2000; ++k) {
        const Pair p(random);
        const double e = k % 2 ? 32 : 300. * k / 2000, cosine = std::pow(std::max(0., dot(p.r, p.v)), e);
        const Answer normalised = classic("phong", true).set("exponent", e).at(p.v, p.l),
                     plain = classic("phong", false).set("exponent", e).at(p.v, p.l);
        expect_near(normalised.diffuse, kBase * (p.nl / kPi), 1e-12, "");
        expect_near(plain.diffuse, kBase * p.nl, 1e-12, "");
        if (std::fabs(dot(p.r, p.v)) < 2e-6) continue;  // the power ends there
        expect_near(normalised.specular, kSpecular * ((e + 2) / (2 * kPi) * cosine * p.nl), 1e-9, "normalised");
        expect_near(plain.specular, kSpecular * cosine, 1e-9, "plain");
    }
}

TEST(Classic, BlinnPhong) {
    std::mt19937 random(12);
    for (int k = 0; k < 2000; ++k) {
        const Pair p(random);
        const double e = 4 + 252. * k / 2000, cosine = std::pow(p.nh, e);
        const double exact = (e + 2) * (e + 4) / (8 * kPi * (std::pow(2, -e / 2) + e)), s0 = (e + 8) / (8 * kPi);
        Model model = classic("blinn_phong", true).set("exponent", e);
        expect_near(model.at(p.v, p.l).specular, kSpecular * (exact * cosine * p.nl), 1e-9, "exact");
        expect_near(model.choose("normalization", "s0").at(p.v, p.l).specular, kSpecular * (s0 * cosine * p.nl), 1e-9,
                    "s0");
        const Answer plain = classic("blinn_phong", false).set("exponent", e).at(p.v, p.l);
        expect_near(plain.specular, kSpecular * cosine, 1e-9, "plain");
        expect_near(plain.diffuse, kBase * p.nl, 1e-12, "plain");
    }
}

TEST(Classic, GaussianAndBeckmann) {
    std::mt19937 random(13);
    for (int k = 0; k < 2000; ++k) {
        const Pair p(random);
        const double w = 0.02 + 0.98 * k / 2000, w2 = w * w, shape = std::exp(-std::pow(p.theta_h / w, 2));
        const double n = kPi * w2 / (1 + 0.6667 * w2 + 0.2023 * w2 * w2 - 0.0417 * w2 * w2 * w2);
        Model gaussian = classic("gaussian", true).set("width", w);
        expect_near(gaussian.at(p.v, p.l).specular, kSpecular * (shape / n * p.nl / 4), 1e-9, "gaussian");
        expect_near(gaussian.at(p.v, p.l).diffuse, kBase * (p.nl / kPi), 1e-12, "gaussian");
        gaussian.set("energy_conserving", 0);
        expect_near(gaussian.at(p.v, p.l).specular, kSpecular * shape, 1e-9, "gaussian plain");
        expect_near(gaussian.at(p.v, p.l).diffuse, {0, 0, 0}, 0, "gaussian plain");

        const double d = std::exp(-std::pow(std::tan(p.theta_h) / w, 2)) / (kPi * w2 * std::pow(p.nh, 4));
        Model beckmann = classic("beckmann", true).set("width", w);
        expect_near(beckmann.at(p.v, p.l).specular, kSpecular * (d * p.nl / 4), 1e-9, "beckmann");
        beckmann.set("energy_conserving", 0);
        expect_near(beckmann.at(p.v, p.l).specular, kSpecular * d, 1e-9, "beckmann plain");
    }
}

TEST(Classic, Ggx) {
    std::mt19937 random(14);
    for (int k = 0; k < 2000; ++k) {
        const Pair p(random);
        const double roughness = 0.05 + 0.95 * k / 2000, alpha = roughness * roughness, kk = alpha / 2;
        const double d = std::pow(alpha / (1 + (alpha * alpha - 1) * p.nh * p.nh), 2) / kPi;
        const double v = 1 / (p.nl * (1 - kk) + kk) / (p.nv * (1 - kk) + kk) / 4;
        const V3 f0{0.04, 0.5, 0.9}, f = f0 + (V3{1, 1, 1} - f0) * std::pow(1 - p.vh, 5);
        Model model = Model("ggx").set("base_color", kBase).set("roughness", roughness).set("f0", f0);
        expect_near(model.at(p.v, p.l).diffuse, kBase * (p.nl / kPi), 1e-12, "");
        expect_near(model.at(p.v, p.l).specular, f * (d * v * p.nl), 1e-8, "");
        model.set("energy_conserving", 0);
        expect_near(model.at(p.v, p.l).diffuse, {0, 0, 0}, 0, "");
        expect_near(model.at(p.v, p.l).specular, f * (4 * d * v * p.nl), 1e-8, "");
    }
}

double smith_lambda(int distribution, double alpha, double cosine) {
    const double tangent = std::sqrt(1 - cosine * cosine) / cosine;
    if (distribution == 0) return (std::sqrt(1 + alpha * alpha * tangent * tangent) - 1) / 2;
    const double q = 1 / (alpha * tangent);
    return q < 1.6 ? (1 - 1.259 * q + 0.396 * q * q) / (3.535 * q + 2.181 * q * q) : 0;
}

TEST(Classic, CookTorrance) {
    std::mt19937 random(15);
    for (int k = 0; k < 4000; ++k) {
        const Pair p(random);
        const double roughness = 0.1 + 0.9 * k / 4000, alpha = roughness * roughness, a2 = alpha * alpha;
        const double metallic = k % 3 == 0 ? 0 : k % 3 == 1 ? 1 : 0.4, specular = 0.5 + 0.5 * (k % 2);
        const double f0_dielectric = 0.08 * specular;
        const V3 white{1, 1, 1}, f0 = mix(white * f0_dielectric, kBase, metallic);
        const double e = 2 / a2 - 2;
        const double n = kPi * a2 / (1 + 0.6667 * a2 + 0.2023 * a2 * a2 - 0.0417 * a2 * a2 * a2);
        const double distributions[] = {
            std::pow(alpha / (1 + (a2 - 1) * p.nh * p.nh), 2) / kPi,
            std::exp(-std::pow(std::tan(p.theta_h) / alpha, 2)) / (kPi * a2 * std::pow(p.nh, 4)),
            std::exp(-std::pow(p.theta_h / alpha, 2)) / n, (e + 2) / (2 * kPi) * std::pow(p.nh, e)};
        const auto schlick_g = [&](double kk) { return p.nl / (p.nl * (1 - kk) + kk) * p.nv / (p.nv * (1 - kk) + kk); };
        const double sine_t = std::sqrt(1 - p.vh * p.vh) / (2 / (1 - std::sqrt(f0_dielectric)) - 1),
                     ior = 2 / (1 - std::sqrt(f0_dielectric)) - 1, t = std::sqrt(1 - sine_t * sine_t);
        const double rs = (p.vh - ior * t) / (p.vh + ior * t), rp = (ior * p.vh - t) / (ior * p.vh + t);
        const double rises[] = {std::pow(1 - p.vh, 5), 0,
                                ((rs * rs + rp * rp) / 2 - f0_dielectric) / (1 - f0_dielectric)};
        for (int d = 0; d < 4; ++d)
            for (int g = 0; g < 5; ++g)
                for (int f = 0; f < 3; ++f) {
                    const double lv = smith_lambda(d, alpha, p.nv), ll = smith_lambda(d, alpha, p.nl);
                    const double maskings[] = {
                        1 / (1 + lv + ll), schlick_g((roughness + 1) * (roughness + 1) / 8), schlick_g(alpha / 2),
                        std::min({1., 2 * p.nh * p.nv / p.vh, 2 * p.nh * p.nl / p.vh}), 1 / ((1 + lv) * (1 + ll))};
                    const V3 fresnel = f0 + (white - f0) * rises[f];
                    Model model = Model("cook_torrance")
                                      .set("base_color", kBase)
                                      .set("metallic", metallic)
                                      .set("specular", specular)
                                      .set("roughness", roughness);
                    model.set("distribution", d).set("masking", g).set("fresnel", f);
                    const V3 kd = (f == 1 ? white : white - fresnel) * (1 - metallic);
                    const Answer got = model.at(p.v, p.l);
                    expect_near(got.specular, fresnel * (distributions[d] * maskings[g] / (4 * p.nv)), 1e-8,
                                model.describe());
                    expect_near(got.diffuse, kd * kBase * (p.nl / kPi), 1e-8, model.describe());
                    model.set("energy_conserving", 0);
                    expect_near(model.at(p.v, p.l).diffuse, kd * kBase * ((1 - metallic) * p.nl / kPi), 1e-8,
                                model.describe());
                    if (HasFailure()) return;
                }
    }
}

TEST(Classic, SssOptionAddsItsPhaseFunction) {
    std::mt19937 random(16);
    for (int k = 0; k < 300; ++k) {
        const Pair p(random);
        const double g = -0.9 + 1.8 * k / 300,
                     phase = (1 - g * g) / (4 * kPi * std::pow(1 + g * g - 2 * g * dot(p.v, p.l), 1.5));
        const V3 colour{0.1, 0.4, 0.3};
        for (const auto* name : {"lambert", "cook_torrance"}) {
            Model model = Model(name).set("base_color", kBase);
            const V3 without = model.at(p.v, p.l).total();
            expect_near(model.set("sss_color", colour).set("sss_anisotropy", g).at(p.v, p.l).total() - without,
                        colour * (phase * p.nl), 1e-9, name);
        }
    }
}

TEST(Classic, OrenNayarByItsAngles) {
    std::mt19937 random(17);
    for (int k = 0; k < 3000; ++k) {
        const Pair p(random);
        // Oren–Nayar 1994, eq. 30: A + B·max(0, cos(φv − φl))·sin α·tan β, α, β the larger and smaller of the two
        // angles.
        const double sigma = 1.5 * k / 3000, s2 = sigma * sigma;
        const double theta_v = std::acos(p.nv), theta_l = std::acos(p.nl),
                     phi = std::atan2(p.v[1], p.v[0]) - std::atan2(p.l[1], p.l[0]);
        const double alpha = std::max(theta_v, theta_l), beta = std::min(theta_v, theta_l);
        const double a = 1 - 0.5 * s2 / (s2 + 0.33), b = 0.45 * s2 / (s2 + 0.09);
        Model model = Model("oren_nayar").set("base_color", kBase).set("sigma", sigma);
        expect_near(model.at(p.v, p.l).diffuse,
                    kBase * (p.nl / kPi * (a + b * std::max(0., std::cos(phi)) * std::sin(alpha) * std::tan(beta))),
                    1e-8, "1994");
        // Fujii: s = cos(φv − φl)·sinθv·sinθl, over the larger cosine where positive.
        const double sigma1 = std::min(sigma, 1.), s = std::cos(phi) * std::sin(theta_v) * std::sin(theta_l),
                     aa = 1 / (kPi + (kPi / 2 - 2. / 3) * sigma1);
        model.choose("form", "fujii");
        expect_near(model.at(p.v, p.l).diffuse,
                    kBase * (p.nl * aa * (1 + sigma1 * s / (s > 0 ? std::max(p.nl, p.nv) : 1))), 1e-8, "fujii");
    }
}

TEST(DefaultLit, ByItsFormulas) {
    std::mt19937 random(18);
    for (int k = 0; k < 3000; ++k) {
        const Pair p(random);
        const double roughness = 0.1 + 0.9 * k / 3000, a = roughness * roughness, metallic = 0.5 * (k % 3),
                     specular = k % 5 == 0 ? 0.1 : 0.5;
        const double anisotropy = k % 2 ? -0.9 + 1.8 * k / 3000 : 0;
        const V3 white{1, 1, 1}, f0 = mix(white * (0.08 * specular), kBase, metallic);
        const double x = std::pow(1 - p.vh, 5);
        const V3 f = white * (std::min(1., 50 * f0[1]) * x) + f0 * (1 - x);
        double lobe;
        if (anisotropy == 0) {
            lobe = std::pow(a / (1 + (a * a - 1) * p.nh * p.nh), 2) / kPi * 0.5 /
                   (p.nl * (p.nv * (1 - a) + a) + p.nv * (p.nl * (1 - a) + a));
        } else {
            const double ax = a * (1 + anisotropy), ay = a * (1 - anisotropy);
            const auto length = [&](const V3& d) { return std::hypot(ax * d[0], ay * d[1], d[2]); };
            lobe = 1 /
                   (kPi * ax * ay * std::pow(std::pow(p.h[0] / ax, 2) + std::pow(p.h[1] / ay, 2) + p.nh * p.nh, 2)) *
                   0.5 / (p.nl * length(p.v) + p.nv * length(p.l));
        }
        const Model model = Model("default_lit")
                                .set("base_color", kBase)
                                .set("metallic", metallic)
                                .set("specular", specular)
                                .set("roughness", roughness)
                                .set("anisotropy", anisotropy);
        expect_near(model.at(p.v, p.l).diffuse, kBase * ((1 - metallic) * p.nl / kPi), 1e-12, model.describe());
        expect_near(model.at(p.v, p.l).specular, f * (lobe * p.nl), 1e-8, model.describe());
    }
}

TEST(Unlit, ReflectsNothing) {
    std::mt19937 random(19);
    EXPECT_EQ(Model("unlit").set("emission", 3).at(random_direction(random), random_direction(random)).total(),
              (V3{0, 0, 0}));
}

}  // namespace
}  // namespace relume::testing
