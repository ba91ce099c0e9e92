// SPDX-License-Identifier: Apache-2.0
// Every registered shader, with random parameters from its own table: values, reciprocity, float against double.

#include <gtest/gtest.h>

#include "promises.h"

namespace relume::testing {
namespace {

class EveryShader : public ::testing::TestWithParam<std::string> {};

std::vector<std::string> names() {
    std::vector<std::string> out;
    for (const ShaderInfo& s : shaders()) out.emplace_back(s.name);
    return out;
}

V3 tangent_of(std::mt19937& random) {
    return random() % 4 == 0 ? V3{0, 0, 0} : random_direction(random) - V3{0, 0, 0.3};
}

/// To float. Through memory: g++ 12 leaves double → float → double out at -O3.
double rounded(double x) {
    const volatile auto single = static_cast<float>(x);
    return static_cast<double>(single);
}

TEST_P(EveryShader, IsFiniteAndNotNegative) {
    std::mt19937 random(1);
    for (int trial = 0; trial < 400; ++trial) {
        const Model model = Model(GetParam()).randomize(random);
        std::vector<V3> v, l;
        for (int k = 0; k < 40; ++k) {
            v.push_back(random_direction(random));
            l.push_back(random_direction(random));
            if (k % 4 == 0) l.back()[2] *= -1;  // from below
            if (k % 5 == 0)
                l.back() =
                    unit(V3{-v.back()[0], -v.back()[1], v.back()[2]} + l.back() * 1e-3);  // near the mirror direction
            if (k % 10 == 0) l.back() = v.back();                                         // along the view
            if (k % 20 == 1) l.back() = v.back() * -1;                                    // against it: h is 0
            if (k % 20 == 2) v.back() = {0, 0, 1};
        }
        const V3 tangent = tangent_of(random);
        for (const auto& answers :
             {model.evaluate<double>({{0, 0, 1}}, v, l, tangent), model.evaluate<float>({{0, 0, 1}}, v, l, tangent)})
            for (std::size_t i = 0; i < answers.size(); ++i)
                for (const V3& lobe : {answers[i].diffuse, answers[i].specular, answers[i].transmission})
                    for (const double x : lobe)
                        ASSERT_TRUE(std::isfinite(x) && x >= 0)
                            << x << ' ' << model.describe() << " v.z " << v[i][2] << " l.z " << l[i][2];
    }
}

TEST_P(EveryShader, IsReciprocalWherePromised) {
    std::mt19937 random(2);
    double most = 0;
    bool never = false;
    for (int trial = 0; trial < 2000; ++trial) {
        Model model = Model(GetParam()).randomize(random);
        V3 v = random_direction(random), l = random_direction(random);
        if (trial % 2) l = unit(V3{-v[0], -v[1], v[2]} + (random_direction(random) - V3{0, 0, 0.5}) * 0.2);
        if (v[2] < 2e-4 || l[2] < 2e-4) continue;  // nearer to the horizon denominators are bounded
        const V3 tangent = tangent_of(random);
        const V3 there = model.at(v, l, tangent).total() * (1 / l[2]),
                 back = model.at(l, v, tangent).total() * (1 / v[2]);
        const Reciprocity promise = reciprocity(model);
        if (promise == Reciprocity::unspecified) return;
        never = never || promise == Reciprocity::never;
        for (std::size_t k = 0; k < 3; ++k) {
            const double difference = std::fabs(there[k] - back[k]) / std::max({there[k], back[k], 1e-3});
            if (promise == Reciprocity::promised)
                ASSERT_LE(difference, 1e-9) << model.describe() << " v.z " << v[2] << " l.z " << l[2];
            else most = std::max(most, difference);
        }
    }
    if (never) {
        EXPECT_GT(most, 0.1) << "documented as not reciprocal, and it is: correct the manual page";
    }
}

// Float's directions are 1e-7 off, which a highlight of width alpha feels as 1e-7/alpha, a cosine x in a denominator as
// 1e-7/x, and the length of v + l, seen through 1 + v·l, as 1e-7/(1 + v·l): |float − double| ≤ k·1e-7·(10 + 1/alpha +
// 1/min(NdotL, NdotV) + 1/(1 + v·l))·max(1, |double|) with k = 32.
TEST_P(EveryShader, FloatFollowsDouble) {
    std::mt19937 random(3);
    double worst = 0;
    std::string where;
    for (int trial = 0; trial < 3000; ++trial) {
        Model model = Model(GetParam()).randomize(random);
        for (double& x : model.params()) x = rounded(x);
        V3 v = random_direction(random), l = random_direction(random);
        if (trial % 2)
            l = unit(V3{-v[0], -v[1], v[2]} +
                     (random_direction(random) - V3{0, 0, 0.5}) * std::pow(10., -(trial % 8) / 2.));
        for (V3* d : {&v, &l})
            for (double& x : *d) x = rounded(x);
        if (l[2] <= 0) continue;
        const V3 tangent{1, 0, 0};
        const Answer a = model.evaluate<float>({{0, 0, 1}}, {v}, {l}, tangent)[0],
                     b = model.evaluate<double>({{0, 0, 1}}, {v}, {l}, tangent)[0];
        const double alpha = narrowest_width(model);
        const double unit_bound =
            1e-7 * (10 + 1 / alpha + 1 / std::max(1e-4, std::min(v[2], l[2])) + 1 / std::max(1e-8, 1 + dot(v, l)));
        const V3 both[2][3] = {{a.diffuse, a.specular, a.transmission}, {b.diffuse, b.specular, b.transmission}};
        for (std::size_t lobe = 0; lobe < 3; ++lobe)
            for (std::size_t k = 0; k < 3; ++k) {
                const double error =
                    std::fabs(both[0][lobe][k] - both[1][lobe][k]) / (unit_bound * std::max(1., both[1][lobe][k]));
                if (error > worst) {
                    worst = error;
                    where = model.describe() + " got " + std::to_string(both[0][lobe][k]) + " want " +
                            std::to_string(both[1][lobe][k]) + " v.z " + std::to_string(v[2]) + " l.z " +
                            std::to_string(l[2]);
                }
            }
    }
    RecordProperty("worst_k", std::to_string(worst));
    EXPECT_LE(worst, 32) << where;
}

INSTANTIATE_TEST_SUITE_P(Shaders, EveryShader, ::testing::ValuesIn(names()),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace relume::testing
