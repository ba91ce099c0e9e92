// SPDX-License-Identifier: Apache-2.0
// blender_principled, generation 3, against the formulas that a double-precision fit to Blender 3.4's renders
// confirmed, written here a second time (the tint's weights and the bound on alpha_x come from a fit to 14 of its
// materials, met to 2e-5), in the textbook's variables (tangents and angles) rather than the shader's.

#include <gtest/gtest.h>

#include "shader_model.h"

namespace relume::testing {
namespace {

struct Blender3 {
    V3 base{0.8, 0.8, 0.8};
    double metallic = 0, specular = 0.5, specular_tint = 0, roughness = 0.5, anisotropic = 0, sheen = 0,
           sheen_tint = 0.5, clearcoat = 0, clearcoat_roughness = 0.03;
};

Model generation3() { return Model("blender_principled").choose("generation", "3"); }

double fresnel_dielectric(double cosine, double eta) {
    // Snell and the two polarisations, as in any optics book.
    const double transmitted = std::sqrt(1 - (1 - cosine * cosine) / (eta * eta));
    const double s = (cosine - eta * transmitted) / (cosine + eta * transmitted);
    const double p = (eta * cosine - transmitted) / (eta * cosine + transmitted);
    return (s * s + p * p) / 2;
}

/// Smith's G1 of a GGX surface with slopes ax, ay for a direction in the tangent frame.
double masking(const V3& d, double ax, double ay) {
    const double slope2 = (ax * d[0] * ax * d[0] + ay * d[1] * ay * d[1]) / (d[2] * d[2]);
    return 2 / (1 + std::sqrt(1 + slope2));
}

Answer expected(const Blender3& m, const V3& v, const V3& l) {
    const V3 h = unit(v + l);
    const double nl = l[2], nv = v[2], lh = dot(l, h);
    const double fl = std::pow(1 - nl, 5), fv = std::pow(1 - nv, 5), rr = m.roughness * (dot(l, v) + 1);
    const double burley = (1 - fv / 2) * (1 - fl / 2) + rr * (fl + fv + fl * fv * (rr - 1));
    const double luminance = 0.3 * m.base[0] + 0.6 * m.base[1] + 0.1 * m.base[2];
    const V3 white{1, 1, 1}, tint = luminance > 0 ? m.base * (1 / luminance) : white;

    Answer out;
    out.diffuse = m.base * ((1 - m.metallic) / kPi * nl * burley) +
                  mix(white, tint, m.sheen_tint) * (m.sheen * (1 - m.metallic) * std::pow(1 - lh, 5) * nl);

    const double root = std::sqrt(0.08 * m.specular), ior = 2 / (1 - root) - 1;
    const double at_normal = fresnel_dielectric(1, ior);
    const double rise = (fresnel_dielectric(lh, ior) - at_normal) / (1 - at_normal);
    const V3 c0 = mix(mix(white, tint, m.specular_tint) * (0.08 * m.specular), m.base, m.metallic);
    const double aspect = std::sqrt(1 - 0.9 * m.anisotropic), ax = std::min(1., m.roughness * m.roughness / aspect),
                 ay = m.roughness * m.roughness * aspect;
    if (ax * ay > 1e-7) {
        const double bracket = h[0] * h[0] / (ax * ax) + h[1] * h[1] / (ay * ay) + h[2] * h[2];
        const double lobe = masking(v, ax, ay) * masking(l, ax, ay) / (kPi * ax * ay * bracket * bracket * 4 * nv);
        out.specular = (c0 + (white - c0) * rise) * lobe;
    }
    const double coat_alpha = m.clearcoat_roughness * m.clearcoat_roughness, a2 = coat_alpha * coat_alpha;
    if (a2 > 1e-7) {
        const double d = coat_alpha >= 1 ? 1 / kPi : (a2 - 1) / (kPi * std::log(a2) * (1 + (a2 - 1) * h[2] * h[2]));
        const double coat = m.clearcoat / 4 * d * masking(v, 0.25, 0.25) * masking(l, 0.25, 0.25) *
                            fresnel_dielectric(lh, 1.5) / (4 * nv);
        out.specular = out.specular + white * coat;
    }
    return out;
}

void expect_close(const Answer& got, const Answer& want, double relative, const std::string& what) {
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(got.diffuse[k], want.diffuse[k], relative * std::max(want.diffuse[k], 1e-3)) << what;
        EXPECT_NEAR(got.specular[k], want.specular[k], relative * std::max(want.specular[k], 1e-3)) << what;
        EXPECT_EQ(got.transmission[k], 0) << what;
    }
}

TEST(BlenderPrincipled, MatchesTheFormulasInDouble) {
    std::mt19937 random(31);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (int trial = 0; trial < 20000; ++trial) {
        Blender3 m;
        m.base = {uniform(random), uniform(random), uniform(random)};
        if (trial % 50 == 0) m.base = {0, 0, 0};
        m.roughness = trial % 7 == 0 ? uniform(random) * 0.03 : uniform(random);
        m.specular = uniform(random) * 2;
        if (trial % 2) m.metallic = trial % 3 ? uniform(random) : 1;
        if (trial % 3 == 0) m.anisotropic = uniform(random);
        if (trial % 4 == 0) m.specular_tint = uniform(random);
        if (trial % 5 == 0) m.sheen = uniform(random), m.sheen_tint = uniform(random);
        if (trial % 6 == 0) m.clearcoat = uniform(random), m.clearcoat_roughness = uniform(random);
        Model model = generation3();
        model.set("base_color", m.base)
            .set("metallic", m.metallic)
            .set("specular", m.specular)
            .set("specular_tint", V3{m.specular_tint, m.specular_tint, m.specular_tint});
        model.set("roughness", m.roughness)
            .set("anisotropic", m.anisotropic)
            .set("sheen", m.sheen)
            .set("sheen_tint", V3{m.sheen_tint, m.sheen_tint, m.sheen_tint});
        model.set("clearcoat", m.clearcoat).set("clearcoat_roughness", m.clearcoat_roughness);
        V3 v = random_direction(random), l = random_direction(random);
        if (trial % 3 == 1) {  // near the mirror direction, where the highlight is
            const V3 near = unit(V3{-v[0], -v[1], v[2]} +
                                 (random_direction(random) - V3{0, 0, 0.5}) * (2 * m.roughness * m.roughness));
            if (near[2] > 1e-3) l = near;
        }
        if (v[2] < 1e-3) continue;  // denominators are bounded there
        expect_close(model.at(v, l), expected(m, v, l), 1e-9, model.describe());
        if (HasFailure()) return;
    }
}

TEST(BlenderPrincipled, RotationTurnsTheTangent) {
    std::mt19937 random(32);
    Model plain = generation3(), turned = generation3();
    for (Model* m : {&plain, &turned}) m->set("anisotropic", 0.8).set("roughness", 0.4);
    for (int trial = 0; trial < 100; ++trial) {
        const double turns = std::uniform_real_distribution<double>(0, 1)(random), angle = 2 * kPi * turns;
        turned.set("anisotropic_rotation", turns);
        const V3 v = random_direction(random), l = random_direction(random);
        const Answer a = turned.at(v, l, {1, 0, 0}), b = plain.at(v, l, {std::cos(angle), std::sin(angle), 0});
        EXPECT_NEAR(a.specular[0], b.specular[0], 1e-9 * std::max(1., b.specular[0]));
    }
}

TEST(BlenderPrincipled, MirrorIsBlackUnderLightsWithoutExtent) {
    Model model = generation3();
    model.set("roughness", 0).set("metallic", 1);
    const V3 v = direction(0.7, 0), l = direction(0.7, kPi);
    EXPECT_EQ(model.at(v, l).total(), (V3{0, 0, 0}));
    model.set("roughness", 0.0177);
    EXPECT_EQ(model.at(v, l).total(), (V3{0, 0, 0}));
    model.set("roughness", 0.0179);
    EXPECT_GT(model.at(v, l).specular[0], 1e4);
}

}  // namespace
}  // namespace relume::testing
