// SPDX-License-Identifier: Apache-2.0
// principled against Burley's course notes and the public disney.brdf's formulas, written here once more in double
// precision in the variables of that text; the base color arrives linear.

#include <gtest/gtest.h>

#include "shader_model.h"

namespace relume::testing {
namespace {

struct Disney {
    V3 base{0.82, 0.67, 0.16};
    double metallic = 0, subsurface = 0, specular = 0.5, roughness = 0.5, specular_tint = 0, anisotropic = 0, sheen = 0,
           sheen_tint = 0.5, clearcoat = 0, clearcoat_gloss = 1;

    Model model() const {
        Model m("principled");
        m.set("base_color", base)
            .set("metallic", metallic)
            .set("subsurface", subsurface)
            .set("specular", specular)
            .set("roughness", roughness);
        m.set("specular_tint", specular_tint)
            .set("anisotropic", anisotropic)
            .set("sheen", sheen)
            .set("sheen_tint", sheen_tint);
        m.set("clearcoat", clearcoat).set("clearcoat_gloss", clearcoat_gloss);
        return m;
    }
};

double schlick(double u) { return std::pow(std::clamp(1 - u, 0., 1.), 5); }

double gtr1(double ndoth, double a) {
    if (a >= 1) return 1 / kPi;
    return (a * a - 1) / (kPi * std::log(a * a) * (1 + (a * a - 1) * ndoth * ndoth));
}

double gtr2_aniso(const V3& h, double ax, double ay) {
    return 1 / (kPi * ax * ay * std::pow(std::pow(h[0] / ax, 2) + std::pow(h[1] / ay, 2) + h[2] * h[2], 2));
}

double smith_ggx(double ndotv, double alpha) {
    const double a = alpha * alpha, b = ndotv * ndotv;
    return 1 / (ndotv + std::sqrt(a + b - a * b));
}

double smith_ggx_aniso(const V3& v, double ax, double ay) {
    return 1 / (v[2] + std::sqrt(std::pow(v[0] * ax, 2) + std::pow(v[1] * ay, 2) + v[2] * v[2]));
}

/// Diffuse and specular part, tangent along x.
Answer burley(const Disney& m, const V3& v, const V3& l) {
    const V3 h = unit(l + v), white{1, 1, 1};
    const double ndotl = l[2], ndotv = v[2], ldoth = dot(l, h);
    const double luminance = 0.3 * m.base[0] + 0.6 * m.base[1] + 0.1 * m.base[2];
    const V3 tint = luminance > 0 ? m.base * (1 / luminance) : white;
    const V3 specular0 = mix(mix(white, tint, m.specular_tint) * (m.specular * 0.08), m.base, m.metallic);
    const V3 sheen = mix(white, tint, m.sheen_tint);

    const double fl = schlick(ndotl), fv = schlick(ndotv), fh = schlick(ldoth);
    const double fd90 = 0.5 + 2 * ldoth * ldoth * m.roughness;
    const double fd = mix(1., fd90, fl) * mix(1., fd90, fv);
    const double fss90 = ldoth * ldoth * m.roughness;
    const double fss = mix(1., fss90, fl) * mix(1., fss90, fv);
    const double ss = 1.25 * (fss * (1 / (ndotl + ndotv) - 0.5) + 0.5);

    const double aspect = std::sqrt(1 - m.anisotropic * 0.9);
    const double ax = std::max(.001, m.roughness * m.roughness / aspect),
                 ay = std::max(.001, m.roughness * m.roughness * aspect);
    const double lobe = gtr2_aniso(h, ax, ay) * smith_ggx_aniso(l, ax, ay) * smith_ggx_aniso(v, ax, ay);
    const double coat = 0.25 * m.clearcoat * gtr1(h[2], mix(.1, .001, m.clearcoat_gloss)) * mix(.04, 1., fh) *
                        smith_ggx(ndotl, .25) * smith_ggx(ndotv, .25);

    Answer out;
    out.diffuse = (m.base * (mix(fd, ss, m.subsurface) / kPi) + sheen * (fh * m.sheen)) * ((1 - m.metallic) * ndotl);
    out.specular = (mix(specular0, white, fh) * lobe + white * coat) * ndotl;
    return out;
}

double fresnel(double cosine, double eta) {
    const double t = std::sqrt(1 - (1 - cosine * cosine) / (eta * eta));
    const double s = (cosine - eta * t) / (cosine + eta * t), p = (eta * cosine - t) / (eta * cosine + t);
    return (s * s + p * p) / 2;
}

/// The variant: exact Fresnel, tints by Rec.709, a clearcoat with G1·G1 in the place of G1·G1/(4·NdotL·NdotV).
Answer mitsuba(const Disney& m, const V3& v, const V3& l) {
    const V3 h = unit(l + v), white{1, 1, 1};
    const double ldoth = dot(l, h), fh = schlick(ldoth);
    const double luminance = 0.2126 * m.base[0] + 0.7152 * m.base[1] + 0.0722 * m.base[2];
    const V3 tint = luminance > 0 ? m.base * (1 / luminance) : white;
    Disney without_sheen = m;
    without_sheen.sheen = 0;
    Answer out = burley(without_sheen, v, l);
    out.diffuse = out.diffuse + mix(white, tint, m.sheen_tint) * (fh * m.sheen * (1 - m.metallic) * l[2]);
    const double aspect = std::sqrt(1 - m.anisotropic * 0.9);
    const double ax = std::max(.001, m.roughness * m.roughness / aspect),
                 ay = std::max(.001, m.roughness * m.roughness * aspect);
    const double lobe = gtr2_aniso(h, ax, ay) * smith_ggx_aniso(l, ax, ay) * smith_ggx_aniso(v, ax, ay) * l[2];
    const double r0 = 0.08 * m.specular, eta = 2 / (1 - std::sqrt(r0)) - 1;
    V3 f = mix(m.base, white, fh) * m.metallic;
    if (r0 > 0)
        f = f + white * ((1 - m.metallic) * (1 - m.specular_tint) * fresnel(ldoth, eta)) +
            mix(tint * r0, white, fh) * ((1 - m.metallic) * m.specular_tint);
    const double g1 = 2 * v[2] * smith_ggx(v[2], .25) * 2 * l[2] * smith_ggx(l[2], .25);
    const double coat =
        0.25 * m.clearcoat * gtr1(h[2], mix(.1, .001, m.clearcoat_gloss)) * mix(.04, 1., fh) * g1 * l[2];
    out.specular = f * lobe + white * coat;
    return out;
}

Disney random_material(std::mt19937& random, int trial) {
    std::uniform_real_distribution<double> uniform(0, 1);
    const auto sometimes = [&](int every, double otherwise) {
        return trial % every == 0 ? uniform(random) : otherwise;
    };
    Disney m;
    m.base = trial % 40 == 0 ? V3{0, 0, 0} : V3{uniform(random), uniform(random), uniform(random)};
    m.metallic = sometimes(2, 0);
    m.subsurface = sometimes(3, 0);
    m.specular = trial % 11 == 0 ? 0 : uniform(random);
    m.roughness = trial % 13 == 0 ? 0 : uniform(random);
    m.specular_tint = sometimes(4, 0);
    m.anisotropic = sometimes(3, 0);
    m.sheen = sometimes(5, 0);
    m.sheen_tint = uniform(random);
    m.clearcoat = sometimes(3, 0);
    m.clearcoat_gloss = uniform(random);
    return m;
}

template <class Reference> void compare(const char* variant, Reference&& reference) {
    std::mt19937 random(41);
    for (int trial = 0; trial < 20000; ++trial) {
        const Disney m = random_material(random, trial);
        V3 v = random_direction(random), l = random_direction(random);
        if (trial % 3 == 1)
            l = unit(V3{-v[0], -v[1], v[2]} +
                     (random_direction(random) - V3{0, 0, 0.5}) * std::max(1e-3, m.roughness * m.roughness));
        if (v[2] < 1e-3 || l[2] <= 0) continue;
        const Model model = m.model().choose("variant", variant);
        const Answer got = model.at(v, l), want = reference(m, v, l);
        for (std::size_t k = 0; k < 3; ++k) {
            ASSERT_NEAR(got.diffuse[k], want.diffuse[k], 1e-9 * std::max(1e-3, want.diffuse[k])) << model.describe();
            ASSERT_NEAR(got.specular[k], want.specular[k], 1e-9 * std::max(1e-3, want.specular[k])) << model.describe();
            ASSERT_EQ(got.transmission[k], 0);
        }
    }
}

TEST(Principled, IsBurleys) { compare("burley", burley); }

TEST(Principled, MitsubaVariant) { compare("mitsuba", mitsuba); }

TEST(Principled, ExactlyElevenParametersAndTheirDefaults) {
    const Disney defaults;
    Model fresh("principled");
    EXPECT_EQ(fresh.params(), defaults.model().params());
    int numbers = 0;
    for (const Parameter& p : fresh.info().parameters) numbers += p.name != "emission" && !p.is_option();
    EXPECT_EQ(numbers, 11);
}

}  // namespace
}  // namespace relume::testing
