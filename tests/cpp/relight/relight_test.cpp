// SPDX-License-Identifier: Apache-2.0
// The whole way of a pixel from memory to memory: against the models' double instantiation with the lights written out
// here, and against itself under every split of the work.
#include "relume/relight.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "relight/memory_frame.h"
#include "relume/error.h"
#include "relume/isa.h"
#include "relume/shader.h"
#include "shading/evaluate.h"

namespace relume {
namespace {

using test::MemoryFrame;
using test::Pictures;
using test::relit;
using V = std::array<double, 3>;

constexpr double kPi = std::numbers::pi;

double dot(const V& a, const V& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
V sub(const V& a, const V& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
V unit(const V& a) {
    const double l = std::sqrt(dot(a, a));
    return {a[0] / l, a[1] / l, a[2] / l};
}

const char* const kLights = R"(
version = 1
[[light]]
name = "key"
type = "sun"
direction = [-0.3, -0.4, -1.0]
irradiance = [3.0, 2.0, 1.0]
[[light]]
name = "lamp"
type = "point"
position = [1.0, 2.0, 3.0]
power = 100.0
color = [0.5, 1.0, 0.8]
exposure = 1.0
[[light]]
name = "cone"
type = "spot"
position = [-1.0, 0.5, 4.0]
direction = [0.2, 0.0, -1.0]
intensity = 20.0
cone_angle = 60.0
blend = 0.4
[[light]]
name = "old"
type = "point"
position = [0.0, -2.0, 2.0]
intensity = 2.0
attenuation = [1.0, 0.1, 0.01]
[[light]]
name = "dome"
type = "sky"
up = [0.0, 1.0, 0.0]
sky_color = [0.2, 0.4, 1.0]
ground_color = [0.1, 0.05, 0.0]
[[light]]
name = "rim"
type = "bounce"
direction = [1.0, 0.0, 0.0]
irradiance = 0.5
[[shader]]
use = "default_lit"
)";

/// What arrives at p from the direct lights of kLights: direction to the light and irradiance at normal incidence.
struct Arriving {
    V l, irradiance;
};

std::vector<Arriving> arriving(const V& p) {
    std::vector<Arriving> out;
    out.push_back({unit({0.3, 0.4, 1.0}), {3, 2, 1}});
    {
        const V d = sub({1, 2, 3}, p);
        const double e = 100 / (4 * kPi) * 2 / dot(d, d);
        out.push_back({unit(d), {0.5 * e, e, 0.8 * e}});
    }
    {
        const V d = sub({-1, 0.5, 4}, p), l = unit(d), axis = unit({0.2, 0, -1});
        const double cosine = -dot(l, axis), outer = std::cos(30 * kPi / 180);
        const double t = std::clamp((cosine - outer) / ((1 - outer) * 0.4), 0., 1.);
        const double e = 20 * t * t * (3 - 2 * t) / dot(d, d);
        out.push_back({l, {e, e, e}});
    }
    {
        const V d = sub({0, -2, 2}, p);
        const double r = std::sqrt(dot(d, d)), e = 2 / (1 + 0.1 * r + 0.01 * r * r);
        out.push_back({unit(d), {e, e, e}});
    }
    return out;
}

/// Reflected radiance of pixel i by default_lit in double, and the part of it that is diffuse.
void reference(const MemoryFrame& frame, std::size_t i, V& total, V& diffuse) {
    const auto at = [&](const char* name, std::size_t k) { return static_cast<double>(frame.channels.at(name)[k][i]); };
    const V n = unit({at("normal", 0), at("normal", 1), at("normal", 2)});
    const V p{at("position", 0), at("position", 1), at("position", 2)};
    const V v = unit(sub({0, 0, 5}, p));
    total = diffuse = {0, 0, 0};

    const ShaderInfo& shader = require_shader("default_lit");
    std::vector<double> params = default_params(shader);
    for (const Parameter& parameter : shader.parameters)
        if (const auto channel = frame.channels.find(std::string(parameter.name)); channel != frame.channels.end())
            for (int k = 0; k < parameter.components(); ++k)
                params[static_cast<std::size_t>(parameter.slot + k)] = channel->second[static_cast<std::size_t>(k)][i];
    std::vector<const double*> slots;
    for (const double& x : params) slots.push_back(&x);
    for (const Arriving& light : arriving(p)) {
        ShaderEvaluation<double> e{};
        V d{}, s{}, t{};
        e.count = 1;
        e.params = slots.data();
        for (std::size_t k = 0; k < 3; ++k) {
            e.n[k] = &n[k], e.v[k] = &v[k], e.l[k] = &light.l[k];
            e.diffuse[k] = &d[k], e.specular[k] = &s[k], e.transmission[k] = &t[k];
        }
        evaluate_shader(shader, e);
        for (std::size_t k = 0; k < 3; ++k) {
            diffuse[k] += d[k] * light.irradiance[k];
            total[k] += (d[k] + s[k] + t[k]) * light.irradiance[k];
        }
    }
    // Sky and bounce: cd/π · E · weight.
    const double up = 0.5 + 0.5 * n[1], rim = 0.5 - 0.5 * n[0];
    const V sky{0.2, 0.4, 1.0}, ground{0.1, 0.05, 0.0};
    for (std::size_t k = 0; k < 3; ++k) {
        const double cd = at("base_color", k) * (1 - at("metallic", 0));
        const double e = ground[k] + (sky[k] - ground[k]) * up + 0.5 * rim;
        diffuse[k] += cd / kPi * e;
        total[k] += cd / kPi * e + at("emission", k);
    }
}

class EveryIsa : public testing::TestWithParam<std::string_view> {
protected:
    void SetUp() override {
        before_ = active_isa();
        use_isa(GetParam());
    }
    void TearDown() override { use_isa(before_); }

private:
    std::string_view before_;
};

INSTANTIATE_TEST_SUITE_P(Isas, EveryIsa, testing::ValuesIn(available_isas()), [](const auto& tested) {
    std::string name(tested.param);
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
});

TEST_P(EveryIsa, AllLightsAgainstTheDoubleEvaluation) {
    const MemoryFrame frame(67, 9);
    const GBuffer gbuffer = frame.gbuffer();
    Rig rig = Rig::loads(kLights);
    rig.set("output.aovs", "[\"diffuse\", \"specular\"]");
    const Pictures got = relit(gbuffer, rig);
    for (std::size_t i = 0; i < frame.pixels(); ++i) {
        V total, diffuse;
        reference(frame, i, total, diffuse);
        for (std::size_t k = 0; k < 3; ++k) {
            // float32 through about 40 operations a light; the narrow highlights of roughness 0.1 amplify the rounding
            // of h.
            ASSERT_NEAR(got("beauty", k)[i], total[k], 2e-4 * (0.1 + total[k])) << "pixel " << i;
            ASSERT_NEAR(got("diffuse", k)[i], diffuse[k], 2e-5 * (0.1 + diffuse[k])) << "pixel " << i;
            ASSERT_NEAR(got("diffuse", k)[i] + got("specular", k)[i] + frame.channels.at("emission")[k][i],
                        got("beauty", k)[i], 1e-6 * (1 + total[k]));
        }
    }
    EXPECT_EQ(got.report.pixels, static_cast<std::int64_t>(frame.pixels()));
    EXPECT_EQ(got.report.shaded, got.report.pixels);
    EXPECT_TRUE(got.report.nonfinite.empty());
}

TEST_P(EveryIsa, LightAovsAddUpToTheBeauty) {
    const MemoryFrame frame(45, 4);
    const GBuffer gbuffer = frame.gbuffer();
    Rig rig = Rig::loads(kLights);
    rig.set("output.aovs", R"(["light:key", "light:lamp", "light:cone", "light:old", "light:dome", "light:rim"])");
    const Pictures got = relit(gbuffer, rig);
    // One at a time as well: the AOV of a light is the beauty of a rig that has that light alone.
    Rig key_only = Rig::loads(kLights);
    for (Light& light : key_only.lights)
        if (light.name != "key") key_only.set("light." + light.name + ".enabled", "false");
    const Pictures key = relit(gbuffer, key_only);
    for (std::size_t i = 0; i < frame.pixels(); ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            double sum = frame.channels.at("emission")[k][i];
            for (const auto& [name, planes] : got.planes)
                if (name.starts_with("light:")) sum += planes[k][i];
            ASSERT_NEAR(got("beauty", k)[i], sum, 2e-6 * (1 + sum));
            ASSERT_NEAR(got("light:key", k)[i] + frame.channels.at("emission")[k][i], key("beauty", k)[i],
                        1e-6 * (1 + sum));
        }
}

TEST_P(EveryIsa, ThreadsAndCropsGiveTheSameBits) {
    const MemoryFrame frame(2100, 11);
    const Rig rig = Rig::loads(kLights);
    const Pictures whole = relit(frame.gbuffer(), rig, 1);
    EXPECT_EQ(whole.planes, relit(frame.gbuffer(), rig, 3).planes);
    for (const auto& [x, y, w, h] : {std::array{5, 2, 37, 3}, std::array{1023, 0, 2, 11}, std::array{2099, 10, 1, 1}}) {
        GBuffer crop = frame.gbuffer(x, y, w, h);
        const Pictures part = relit(crop, rig);
        for (std::size_t k = 0; k < 4; ++k)
            for (int j = 0; j < h; ++j)
                for (int i = 0; i < w; ++i)
                    ASSERT_EQ(part("beauty", k)[static_cast<std::size_t>(j * w + i)],
                              whole("beauty", k)[static_cast<std::size_t>((y + j) * frame.width + x + i)]);
    }
}

TEST_P(EveryIsa, BackgroundPassesTheBeautyThrough) {
    MemoryFrame frame(19, 3);
    for (std::size_t i = 0; i < frame.pixels(); i += 3)
        for (auto& plane : frame.channels["normal"]) plane[i] = 0;
    Rig rig = Rig::loads(kLights);
    rig.set("output.aovs", "[\"diffuse\", \"light:key\"]");
    const Pictures got = relit(frame.gbuffer(), rig);
    for (std::size_t i = 0; i < frame.pixels(); i += 3)
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_EQ(got("beauty", k)[i], frame.channels.at("beauty")[k][i]);
            EXPECT_EQ(got("diffuse", k)[i], 0);
            EXPECT_EQ(got("light:key", k)[i], 0);
            EXPECT_EQ(got("beauty", 3)[i], 1);
        }
    EXPECT_EQ(got.report.background, 19);
}

TEST_P(EveryIsa, CoverageWeighsTheSurfaceAgainstWhatIsBeside) {
    MemoryFrame frame(33, 2);
    frame.channels["coverage"].assign(1, std::vector<float>(frame.pixels(), 0.25f));
    const Rig rig = Rig::loads(kLights);
    const Pictures full = relit(MemoryFrame(33, 2).gbuffer(), rig);
    // Opaque film: the beauty stands for what is beside.
    const Pictures opaque = relit(frame.gbuffer(), rig);
    // Transparent film: alpha is the coverage and nothing is beside.
    frame.channels["alpha"].assign(1, std::vector<float>(frame.pixels(), 0.25f));
    const Pictures transparent = relit(frame.gbuffer(), rig);
    Rig add = rig;
    add.set("output.mode", "add");
    const Pictures added = relit(frame.gbuffer(), add);
    for (std::size_t i = 0; i < frame.pixels(); ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            const double light = full("beauty", k)[i], beauty = frame.channels.at("beauty")[k][i];
            ASSERT_NEAR(opaque("beauty", k)[i], 0.25 * light + 0.75 * beauty, 1e-6 * (1 + light));
            ASSERT_NEAR(transparent("beauty", k)[i], 0.25 * light, 1e-6 * (1 + light));
            ASSERT_NEAR(added("beauty", k)[i], 0.25 * light + beauty, 1e-6 * (1 + light));
            ASSERT_EQ(transparent("beauty", 3)[i], 0.25f);
        }
}

TEST_P(EveryIsa, NonFiniteInputsAreBlackCountedAndNamed) {
    MemoryFrame frame(40, 2);
    const Pictures clean = relit(frame.gbuffer(), Rig::loads(kLights));
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    frame.channels["normal"][1][3] = nan;
    frame.channels["position"][0][17] = inf;
    frame.channels["roughness"][0][18] = nan;
    frame.channels["base_color"][2][39] = -inf;
    frame.channels["base_color"][2][79] = nan;
    frame.channels["beauty"][0][5] = nan;
    const Pictures got = relit(frame.gbuffer(), Rig::loads(kLights));
    for (std::size_t i = 0; i < frame.pixels(); ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            const bool bad = i == 3 || i == 17 || i == 18 || i == 39 || i == 79;
            ASSERT_EQ(got("beauty", k)[i], bad ? 0.f : clean("beauty", k)[i]) << "pixel " << i;
        }
    const std::map<std::string, std::int64_t> expected{
        {"normal", 1}, {"position", 1}, {"roughness", 1}, {"base_color", 2}, {"beauty", 1}};
    EXPECT_EQ(got.report.nonfinite, expected);
}

TEST_P(EveryIsa, EachPixelGetsTheShaderThatItsIdNames) {
    MemoryFrame frame(50, 3);
    auto& ids = frame.channels["object_id"];
    ids.assign(1, std::vector<float>(frame.pixels()));
    for (std::size_t i = 0; i < frame.pixels(); ++i) ids[0][i] = static_cast<float>(i % 7);
    const auto with = [](const std::string& shaders) {
        const std::string lights = kLights;
        return Rig::loads(lights.substr(0, lights.find("[[shader]]")) + shaders);
    };
    const Rig mixed = with(
        "[[shader]]\nobject_id = [1, 4]\nuse = \"lambert\"\nbase_color = [0.1, 0.2, 0.3]\n[[shader]]\nobject_id = [4, 5]\nuse = \"ggx\"\n"
        "[[shader]]\nuse = \"default_lit\"\n");
    const GBuffer gbuffer = frame.gbuffer();
    const Pictures got = relit(gbuffer, mixed);
    const Pictures lambert = relit(gbuffer, with("[[shader]]\nuse = \"lambert\"\nbase_color = [0.1, 0.2, 0.3]\n"));
    const Pictures ggx = relit(gbuffer, with("[[shader]]\nuse = \"ggx\"\n"));
    const Pictures rest = relit(gbuffer, with("[[shader]]\nuse = \"default_lit\"\n"));
    for (std::size_t i = 0; i < frame.pixels(); ++i) {
        const std::size_t id = i % 7;
        const Pictures& one = id == 1 || id == 4 ? lambert : id == 5 ? ggx : rest;
        for (std::size_t k = 0; k < 3; ++k) ASSERT_EQ(got("beauty", k)[i], one("beauty", k)[i]) << "pixel " << i;
    }
}

TEST(Relight, HalfAndInterleavedOutputsHoldTheSameNumbers) {
    const MemoryFrame frame(37, 5);
    const GBuffer gbuffer = frame.gbuffer();
    const Rig rig = Rig::loads(kLights);
    const Pictures planar = relit(gbuffer, rig);
    std::vector<float> interleaved(frame.pixels() * 4 + 4, -1.f);
    std::vector<Plane> planes;
    for (std::size_t k = 0; k < 4; ++k)
        planes.push_back({reinterpret_cast<std::byte*>(interleaved.data() + k), PixelType::float32, 16, 37 * 16});
    relight(gbuffer, rig, {{"beauty", planes}});
    for (std::size_t i = 0; i < frame.pixels(); ++i)
        for (std::size_t k = 0; k < 4; ++k) ASSERT_EQ(interleaved[4 * i + k], planar("beauty", k)[i]);
    EXPECT_EQ(interleaved[4 * frame.pixels()], -1.f);
}

TEST(Relight, SaysWhatIsWrong) {
    const MemoryFrame frame(4, 4);
    const GBuffer gbuffer = frame.gbuffer();
    const auto message = [&](const Rig& rig, const GBuffer& g) -> std::string {
        try {
            relit(g, rig);
        } catch (const Error& error) {
            return error.what();
        }
        return "no error";
    };
    EXPECT_NE(message(Rig::loads("version = 1\n"), gbuffer).find("no lights"), std::string::npos);
    Rig rig = Rig::loads(kLights);
    rig.set("output.aovs", "[\"light:kye\"]");
    EXPECT_NE(message(rig, gbuffer).find("did you mean 'light:key'"), std::string::npos);

    rig = Rig::loads(kLights);
    rig.set("light.key.exposure", "200");
    EXPECT_EQ(message(rig, gbuffer), "light 'key': is brighter than single precision holds; lower its exposure");

    MemoryFrame no_normal(4, 4);
    no_normal.channels.erase("normal");
    EXPECT_THROW(no_normal.gbuffer(), Error);
    MemoryFrame no_position(4, 4);
    no_position.channels.erase("position");
    EXPECT_NE(
        message(Rig::loads(kLights), no_position.gbuffer()).find("light 'lamp' is a point light and needs positions"),
        std::string::npos);

    std::atomic<bool> cancel{true};
    RelightOptions options;
    options.cancel = &cancel;
    EXPECT_THROW(relight(gbuffer, Rig::loads(kLights), {}, options), Error);
}

}  // namespace
}  // namespace relume
