// SPDX-License-Identifier: Apache-2.0
// Directional albedo, white, view 0…89°: what each model promises, and the figures its manual page quotes.

#include <gtest/gtest.h>

#include "quadrature.h"

namespace relume::testing {
namespace {

constexpr double kRoughnesses[] = {0, 0.05, 0.1, 0.2, 0.35, 0.5, 0.7, 0.85, 1};
constexpr double kQuadrature = 2e-4;  // of the quadrature itself at grazing view, alpha 1e-3

double alpha_of(double roughness) { return std::max(roughness * roughness, 1e-3); }

Model white(std::string_view name) { return Model(name).set("base_color", 1); }

TEST(Albedo, TheQuadratureItself) {
    // Lambert, any view and warp; a Lambert of colour is that colour.
    for (const double degrees : {0., 40., 80., 89.})
        for (const double width : {1e-3, 0.1, 1.}) {
            const V3 colour{0.2, 0.5, 0.9};
            const V3 total = albedo(Model("lambert").set("base_color", colour), radians(degrees), width).diffuse;
            for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(total[k], colour[k], 1e-9);
        }
    // Twice the nodes changes nothing.
    for (const double roughness : {0.0, 0.05, 0.3, 1.})
        for (const double degrees : {0., 60., 89.}) {
            const Model model = white("cook_torrance").set("roughness", roughness).set("metallic", 1);
            EXPECT_NEAR(albedo(model, radians(degrees), alpha_of(roughness)).specular[0],
                        albedo(model, radians(degrees), alpha_of(roughness), 96).specular[0], kQuadrature);
        }
}

TEST(Albedo, GgxAtAlphaOneInClosedForm) {
    // Height-correlated GGX, alpha 1, normal view, F = 1: 1 − ln 2.
    const Model correlated = white("cook_torrance").set("metallic", 1).set("roughness", 1);
    EXPECT_NEAR(albedo(correlated, 0, 1).specular[1], 1 - std::numbers::ln2, 1e-9);
    // Separable: D = 1/π, V = ½·½/(2·½·…): ∫ over μ of 2πμ/π · (1/2)/(1+1) · 1/(μ+1) at NdotV = 1, so (1 − ln 2) as
    // well.
    Model separable = correlated;
    separable.choose("masking", "smith_separable");
    EXPECT_NEAR(albedo(separable, 0, 1).specular[1], 1 - std::numbers::ln2, 1e-9);
    // Hable's form, k = ½: G1(x)/x = 2/(1+x): f = 1/π·1·1·2/(1+μ)/4 → ∫ = 1 − ln 2 again.
    EXPECT_NEAR(albedo(Model("ggx").set("base_color", 0).set("f0", 1).set("roughness", 1), 0, 1).specular[0],
                1 - std::numbers::ln2, 1e-9);
    // default_lit's joint approximation is exact at alpha 1: 0.5/(NdotL + NdotV).
    EXPECT_NEAR(albedo(white("default_lit").set("metallic", 1).set("roughness", 1), 0, 1).specular[0],
                1 - std::numbers::ln2, 1e-9);
    // principled, F = 1.
    EXPECT_NEAR(albedo(white("principled").set("metallic", 1).set("roughness", 1), 0, 1).specular[0],
                1 - std::numbers::ln2, 1e-9);
}

TEST(Albedo, LambertWrappedIsTheBaseColorFromEverySide) {
    // Lit from below too: over the whole sphere of lights, in n·l.
    const auto nodes = gauss_legendre(96);
    for (const double wrap : {0., 0.25, 0.5, 1.})
        for (const double power : {0.5, 1., 2., 3.7}) {
            const Model model = white("lambert_wrapped").set("wrap", wrap).set("power", power);
            double total = 0;
            for (const auto& [x, w] : nodes) {
                const double z = (1 + wrap) * x - wrap;  // where it is lit
                const V3 l{std::sqrt(1 - z * z), 0, z};
                total += 2 * kPi * (1 + wrap) * w * model.at({0, 0, 1}, l).diffuse[0];
            }
            EXPECT_NEAR(total, 1, 1e-4) << wrap << ' ' << power;
        }
    // Half-Lambert, plain: n·l/2 + 1/2.
    const Model half = white("lambert_wrapped").set("wrap", 1).set("energy_conserving", 0);
    for (const double z : {-1., -0.5, 0., 0.3, 1.})
        EXPECT_NEAR(half.at({0, 0, 1}, {std::sqrt(1 - z * z), 0, z}).diffuse[0], 0.5 * z + 0.5, 1e-15);
    EXPECT_EQ(white("lambert_wrapped").set("wrap", 0.5).at({0, 0, 1}, direction(radians(121), 0)).diffuse[0], 0);
    EXPECT_GT(white("lambert_wrapped").set("wrap", 0.5).at({0, 0, 1}, direction(radians(119), 0)).diffuse[0], 0);
}

TEST(Albedo, ClassicHighlights) {
    for (const double e : {0., 1., 4., 8., 16., 32., 256., 4096.}) {
        Model phong = Model("phong").set("base_color", 0).set("specular_color", 1).set("exponent", e);
        Model blinn = Model("blinn_phong").set("base_color", 0).set("specular_color", 1).set("exponent", e);
        const double width = std::sqrt(2 / (e + 2));
        // Exact at normal view, at most 1 elsewhere. Phong's edge r·v = 0 lies at h = 45°, where the quadrature ends.
        EXPECT_NEAR(albedo(phong, 0, width / 2).specular[0], 1, 1e-6) << e;
        EXPECT_NEAR(albedo(blinn, 0, width).specular[0], 1, 1e-6) << e;
        EXPECT_LE(highest_albedo(phong, width / 2), 1 + kQuadrature) << e;
        EXPECT_LE(highest_albedo(blinn, width), 1 + kQuadrature) << e;
    }
    // The customary normalisation is up to 7.5 % too bright.
    double highest = 0;
    for (double e = 4; e < 20; e += 0.5)
        highest = std::max(highest, albedo(Model("blinn_phong")
                                               .set("base_color", 0)
                                               .set("specular_color", 1)
                                               .set("exponent", e)
                                               .choose("normalization", "s0"),
                                           0, std::sqrt(2 / (e + 2)))
                                        .specular[0]);
    EXPECT_NEAR(highest, 1.075, 5e-4);
    // An exponent from roughness is that exponent.
    const Model direct = Model("blinn_phong").set("exponent", 30),
                from_roughness = Model("blinn_phong").choose("exponent_from", "roughness").set("roughness", 0.5);
    const V3 v = direction(0.4, 0), l = direction(0.5, 3);
    EXPECT_NEAR(direct.at(v, l).specular[0], from_roughness.at(v, l).specular[0], 1e-12);
    for (const double w : {0.01, 0.1, 0.3, 0.5, 1.}) {
        for (const auto* name : {"gaussian", "beckmann"}) {
            Model model = Model(name).set("base_color", 0).set("specular_color", 1).set("width", w);
            EXPECT_LE(highest_albedo(model, w), 1) << name << w;
        }
    }
    EXPECT_NEAR(highest_albedo(Model("beckmann")
                                   .set("base_color", 0)
                                   .set("specular_color", 1)
                                   .set("width", 0.1)
                                   .set("energy_conserving", 0),
                               0.1),
                4, 1e-3);
    EXPECT_NEAR(
        highest_albedo(
            Model("ggx").set("base_color", 0).set("f0", 1).set("roughness", 0.05).set("energy_conserving", 0), 0.0025),
        4, 1e-3);
}

TEST(Albedo, OrenNayar) {
    double highest = 0;
    for (double sigma = 0; sigma <= 1; sigma += 0.05) {
        EXPECT_LE(highest_albedo(white("oren_nayar").choose("form", "fujii").set("sigma", sigma), 1), 1 + 1e-6)
            << sigma;
        highest = std::max(highest, highest_albedo(white("oren_nayar").set("sigma", sigma), 1));
    }
    EXPECT_NEAR(highest, 1.0144, 5e-4);  // at sigma 0.2; 1.004 at 0.3
    for (const auto* form : {"1994", "fujii"})
        EXPECT_NEAR(highest_albedo(white("oren_nayar").choose("form", form).set("sigma", 0), 1), 1, 1e-6);
}

TEST(Albedo, GgxOfMetalLosesEnergyAndNeverGainsIt) {
    for (const double roughness : kRoughnesses) {
        const double width = alpha_of(roughness);
        EXPECT_LE(highest_albedo(white("default_lit").set("metallic", 1).set("roughness", roughness), width),
                  1 + kQuadrature);
        EXPECT_LE(highest_albedo(white("principled").set("metallic", 1).set("roughness", roughness), width),
                  1 + kQuadrature);
        for (const auto* generation : {"3", "5"})
            EXPECT_LE(highest_albedo(white("blender_principled")
                                         .choose("generation", generation)
                                         .set("metallic", 1)
                                         .set("roughness", roughness),
                                     width),
                      1 + kQuadrature);
        EXPECT_LE(highest_albedo(Model("ggx").set("base_color", 0).set("f0", 1).set("roughness", roughness), width),
                  1 + kQuadrature);
        for (const auto* masking :
             {"smith_correlated", "smith_schlick", "smith_schlick_hable", "v_cavity", "smith_separable"})
            EXPECT_LE(
                highest_albedo(
                    white("cook_torrance").set("metallic", 1).set("roughness", roughness).choose("masking", masking),
                    width),
                1 + kQuadrature)
                << masking << roughness;
    }
}

TEST(Albedo, CookTorrance) {
    for (const auto* distribution : {"ggx", "beckmann", "gaussian", "blinn_phong"})
        for (const auto* masking :
             {"smith_correlated", "smith_schlick", "smith_schlick_hable", "v_cavity", "smith_separable"})
            for (const auto* fresnel : {"schlick", "none", "dielectric"})
                for (const double roughness : {0.05, 0.5, 1.}) {
                    const Model model = white("cook_torrance")
                                            .choose("distribution", distribution)
                                            .choose("masking", masking)
                                            .choose("fresnel", fresnel)
                                            .set("roughness", roughness);
                    EXPECT_LE(highest_albedo(model, alpha_of(roughness)), 2) << model.describe();
                }
    EXPECT_NEAR(highest_albedo(white("cook_torrance").set("roughness", 0.05), 0.0025), 1.84, 5e-3);
    // Under Smith Blinn–Phong passes 1 by itself, under the cavity not.
    Model blinn = white("cook_torrance").choose("distribution", "blinn_phong").set("metallic", 1);
    EXPECT_NEAR(highest_albedo(blinn.set("roughness", 0.7), 0.49), 1.09, 5e-3);
    EXPECT_NEAR(highest_albedo(blinn.set("roughness", 1), 1), 1.64, 5e-3);
    for (const double roughness : kRoughnesses)
        EXPECT_LE(highest_albedo(blinn.choose("masking", "v_cavity").set("roughness", roughness), alpha_of(roughness)),
                  1 + kQuadrature)
            << roughness;
    // Without Fresnel: Lambert + a lobe of constant F0.
    EXPECT_NEAR(highest_albedo(white("cook_torrance").choose("fresnel", "none").set("roughness", 0.05), 0.0025), 1.04,
                1e-3);
}

TEST(Albedo, Uebershaders) {
    EXPECT_NEAR(highest_albedo(white("default_lit").set("roughness", 0.05), 0.0025), 1.80, 5e-3);
    EXPECT_NEAR(highest_albedo(white("principled").set("roughness", 0.05).set("sheen", 1).set("clearcoat", 1), 1e-3),
                1.58, 6e-3);
    for (const double roughness : kRoughnesses) {
        EXPECT_LE(highest_albedo(white("default_lit").set("roughness", roughness), alpha_of(roughness)), 2)
            << roughness;
        for (const double aniso : {0., 0.9}) {
            // Clearcoat, sheen and highlight together; subsurface on top of them reaches 1.83.
            Model all = white("principled")
                            .set("roughness", roughness)
                            .set("anisotropic", aniso)
                            .set("sheen", 1)
                            .set("clearcoat", 1);
            EXPECT_LE(highest_albedo(all, 1e-3), 1.7) << roughness;
            EXPECT_LE(highest_albedo(all.set("subsurface", 1), 1e-3), 1.9) << roughness;
            Model blender = white("blender_principled")
                                .choose("generation", "3")
                                .set("roughness", roughness)
                                .set("anisotropic", aniso)
                                .set("sheen", 1)
                                .set("clearcoat", 1);
            EXPECT_LE(highest_albedo(blender, 3e-4), 1.7) << roughness;
        }
    }
    // f_ss alone.
    double highest = 0;
    for (const double roughness : kRoughnesses)
        for (const double degrees : {0., 30., 60., 80., 86., 89.})
            highest = std::max(highest, albedo(white("principled").set("subsurface", 1).set("roughness", roughness),
                                               radians(degrees), 1)
                                            .diffuse[0]);
    EXPECT_LE(highest, 1.6);
}

}  // namespace
}  // namespace relume::testing
