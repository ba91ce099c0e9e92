// SPDX-License-Identifier: Apache-2.0
// Normals that are means over a pixel: how short they are, how much wider that makes a highlight, and when it does not.
#include <gtest/gtest.h>

#include <memory>
#include <numbers>

#include "io/pixel_convert.h"
#include "made_scene.h"
#include "relight/memory_frame.h"

namespace relume {
namespace {

using test::MadePart;
using test::Vector3;

constexpr double kDegree = std::numbers::pi / 180;
constexpr int kWidth = 48, kHeight = 32;

/// A unit normal that leans `degrees` to the right.
Vector3 leaning(double degrees) { return {std::sin(degrees * kDegree), 0, std::cos(degrees * kDegree)}; }

Vector3 mean(const Vector3& a, const Vector3& b, double share_of_b) {
    return gbuffer::plus(gbuffer::scaled(a, 1 - share_of_b), gbuffer::scaled(b, share_of_b));
}

/// A box seen across its edge: a face to the left, one to the right that leans by 60°, and column 24 a mean of both.
Vector3 crease(int x, int, double share = 0.5) {
    return x < 24 ? leaning(-30) : x > 24 ? leaning(30) : mean(leaning(-30), leaning(30), share);
}

/// As a mesh shows it that is shaded between its vertices, 12 pixels apart and 15° from each other, and never made
/// unit.
Vector3 interpolated(int x, int) {
    const int vertex = x / 12;
    return mean(leaning(15 * vertex - 30), leaning(15 * vertex - 15), x % 12 / 12.0);
}

double half(double value) {
    return static_cast<double>(io::half_to_float(io::float_to_half(static_cast<float>(value))));
}

using Planes = std::map<std::string, std::vector<std::vector<float>>>;

/// A G-buffer together with the arrays that it reads.
class Kept : public GBuffer {
public:
    Kept(std::shared_ptr<const Planes> planes, GBuffer gbuffer)
        : GBuffer(std::move(gbuffer)), planes_(std::move(planes)) {}

private:
    std::shared_ptr<const Planes> planes_;
};

/// Normals in memory, and with them whatever a test adds.
class Frame {
public:
    explicit Frame(const test::VectorFunction& normal) {
        std::vector<std::vector<float>>& planes = (*planes_)["normal"];
        planes.assign(3, {});
        for (int y = 0; y < kHeight; ++y) {
            for (int x = 0; x < kWidth; ++x) {
                for (std::size_t k = 0; k < 3; ++k) planes[k].push_back(static_cast<float>(normal(x, y)[k]));
            }
        }
    }
    Frame& add(const std::string& name, const std::function<double(int, int)>& value, std::size_t components = 1) {
        std::vector<float> plane;
        for (int y = 0; y < kHeight; ++y) {
            for (int x = 0; x < kWidth; ++x) plane.push_back(static_cast<float>(value(x, y)));
        }
        (*planes_)[name].assign(components, plane);
        return *this;
    }
    Kept gbuffer(const GBufferOptions& options = test::MemoryFrame::camera()) const {
        std::map<std::string, MemoryChannel> channels;
        for (const auto& [name, planes] : *planes_) {
            for (const std::vector<float>& plane : planes)
                channels[name].planes.push_back(
                    {reinterpret_cast<const std::byte*>(plane.data()), PixelType::float32, 4, kWidth * 4});
        }
        return {planes_, GBuffer::from_memory(kWidth, kHeight, channels, options)};
    }
    Kept gbuffer(NormalVariance variance) const {
        GBufferOptions options = test::MemoryFrame::camera();
        options.normal_variance = variance;
        return gbuffer(options);
    }

private:
    std::shared_ptr<Planes> planes_ = std::make_shared<Planes>();
};

ChannelRequest constant(double value, LobeWidth widen) {
    ChannelRequest request;
    request.kind = ChannelRequest::Kind::constant;
    request.name = "constant";
    request.offset = value;
    request.widen = widen;
    return request;
}

double at(const test::Answer& answer, int x, int y = 16) {
    return static_cast<double>(answer[0][static_cast<std::size_t>(y)][static_cast<std::size_t>(x)]);
}

/// What alpha² grows by where the mean normal has this length.
double growth(double length, double dead_zone) {
    const double seen = std::min(length + dead_zone, 1.0);
    return 2 * (1 - seen) / seen;
}

bool reads(const GBuffer& gbuffer, std::string_view name, std::string_view words) {
    const ChannelInfo* info = gbuffer.find(name);
    return info && (info->reason + info->interpretation).find(words) != std::string::npos;
}

/// The same mean of two faces at an angle of `degrees` in every pixel: no face stands in anywhere.
Kept mixed(double degrees, double share) {
    return Frame([=](int, int) { return mean(leaning(-degrees / 2), leaning(degrees / 2), share); })
        .gbuffer(NormalVariance::on);
}

TEST(NormalVariance, OfTwoFacesIsThatOfTheirMean) {
    for (const double share : {0.5, 0.25, 0.0625}) {
        const test::Answer variance = test::ask(mixed(40, share), test::semantic("normal_variance"));
        // |f·a + (1−f)·b|² = 1 − 2f(1−f)(1 − cos φ)
        const double length = std::sqrt(1 - 2 * share * (1 - share) * (1 - std::cos(40 * kDegree)));
        EXPECT_NEAR(at(variance, 24), growth(length, 1e-5), 1e-6);
    }
}

TEST(NormalVariance, WidensByTheVarianceOfTheFacesSlopes) {
    // Two equal lobes of slope variance alpha²/2 along each axis, a slope of ±t apart along one of them: together their
    // variance along it is alpha²/2 + t², so alpha²/2 + t²/2 in the mean over both axes.
    for (const double degrees : {4.0, 10.0, 20.0}) {
        const double alpha = 0.04, t = std::tan(degrees / 2 * kDegree);
        const test::Answer wide = test::ask(mixed(degrees, 0.5), constant(alpha, LobeWidth::alpha));
        const double both = alpha * alpha / 2 + t * t / 2;
        EXPECT_NEAR(at(wide, 24) * at(wide, 24) / 2, both, 0.012 * both + 1e-5) << degrees;
    }
}

TEST(NormalVariance, EveryWidthGrowsAlike) {
    const Kept gbuffer = mixed(40, 0.1);
    const double v = growth(std::sqrt(1 - 2 * 0.1 * 0.9 * (1 - std::cos(40 * kDegree))), 1e-5);
    const auto widened = [&](double value, LobeWidth width) {
        return at(test::ask(gbuffer, constant(value, width)), 24);
    };
    for (const double r : {0.0, 0.02, 0.3, 0.8, 1.0}) {
        const double expected = std::pow(std::min(std::pow(r, 4) + v, 1.0), 0.25);
        EXPECT_NEAR(widened(r, LobeWidth::roughness), r == 0 ? 0 : expected, 1e-6) << r;
        EXPECT_NEAR(widened(r, LobeWidth::alpha), std::sqrt(std::min(r * r + v, 1.0)), 1e-6) << r;
    }
    for (const double e : {0.0, 1.0, 32.0, 5000.0}) {
        // Through alpha and back: e = 2/alpha² − 2, a quarter of it about the mirrored view.
        const double of_half = 2 / std::min(2 / (e + 2) + v, 1.0) - 2;
        EXPECT_NEAR(widened(e, LobeWidth::half_exponent), of_half, 1e-5 * (of_half + 1)) << e;
        const double of_mirror = (2 / std::min(2 / (4 * e + 2) + v, 1.0) - 2) / 4;
        EXPECT_NEAR(widened(e, LobeWidth::mirror_exponent), of_mirror, 1e-5 * (of_mirror + 1)) << e;
    }
    for (const double g : {0.0, 0.5, 1.0}) {
        const double alpha = std::sqrt(std::pow(0.1 * (1 - g) + 0.001 * g, 2) + v);
        EXPECT_NEAR(widened(g, LobeWidth::gloss), std::max(0.0, (0.1 - alpha) / 0.099), 1e-5) << g;
    }
    EXPECT_EQ(widened(0.3, LobeWidth::none), static_cast<double>(0.3f));
    EXPECT_TRUE(std::isnan(widened(std::nan(""), LobeWidth::roughness)));
    EXPECT_EQ(widened(-0.5, LobeWidth::roughness), 0);
    // Nothing is widened where the pixel shows one normal.
    const Kept unit = Frame([](int, int) { return leaning(7); }).gbuffer(NormalVariance::on);
    for (const double value : {-0.5, 0.0, 0.3, 2.0}) {
        for (const LobeWidth width : {LobeWidth::roughness, LobeWidth::alpha, LobeWidth::gloss})
            EXPECT_EQ(at(test::ask(unit, constant(value, width)), 24), static_cast<double>(static_cast<float>(value)));
    }
}

TEST(NormalVariance, AtACreaseTheNearerFaceStandsIn) {
    for (const bool lying : {false, true}) {
        for (const double share : {0.25, 0.75}) {
            const Kept gbuffer =
                Frame([&](int x, int y) { return lying ? crease(y + 8, 0, share) : crease(x, y, share); }).gbuffer();
            ASSERT_TRUE(gbuffer.normal_variance());
            EXPECT_TRUE(reads(gbuffer, "normal_variance", "means over the pixel"));
            const test::Answer normal = test::ask(gbuffer, test::semantic("normal", 3)),
                               variance = test::ask(gbuffer, test::semantic("normal_variance"));
            for (int k = 0; k < kHeight; ++k) {
                const Vector3 face = leaning(k < 16 || (k == 16 && share < 0.5) ? -30 : 30);
                const std::size_t column = lying ? 5 : static_cast<std::size_t>(k + 8);
                const std::size_t row = lying ? static_cast<std::size_t>(k) : 5;
                for (std::size_t c = 0; c < 3; ++c)
                    EXPECT_NEAR(static_cast<double>(normal[c][row][column]), face[c], 1e-6) << k;
                EXPECT_EQ(variance[0][row][column], 0.0f) << k;
            }
        }
    }
}

TEST(NormalVariance, OfABendKeepsItsMean) {
    // 30° are too little for a crease: the surface between is there, and lit.
    const auto bend = [](int x, int) {
        return x < 24 ? leaning(-15) : x > 24 ? leaning(15) : mean(leaning(-15), leaning(15), 0.5);
    };
    const Kept gbuffer = Frame(bend).gbuffer();
    ASSERT_TRUE(gbuffer.normal_variance());
    EXPECT_NEAR(at(test::ask(gbuffer, test::semantic("normal", 3)), 24), 0, 1e-6);
    EXPECT_NEAR(at(test::ask(gbuffer, test::semantic("normal_variance")), 24), growth(std::cos(15 * kDegree), 1e-5),
                1e-6);
}

TEST(NormalVariance, BeginsWithoutAStep) {
    // Columns of ever shorter normals about the end of the dead zone.
    const auto by = [](int x) { return 2e-6 * x; };
    const Kept gbuffer =
        Frame([&](int x, int) { return gbuffer::scaled(leaning(0), 1 - by(x)); }).gbuffer(NormalVariance::on);
    const test::Answer variance = test::ask(gbuffer, test::semantic("normal_variance"));
    for (int x = 0; x < kWidth; ++x) EXPECT_NEAR(at(variance, x), growth(1 - by(x), 1e-5), 4e-7) << x;
    EXPECT_EQ(at(variance, 4), 0);
    EXPECT_GT(at(variance, 6), 0);
}

TEST(NormalVariance, IsNotTakenFromNormalsThatWereNeverUnit) {
    struct Case {
        const char* what;
        test::VectorFunction normal;
        const char* note;
    };
    const auto wavy = [](int x, int y) { return leaning(20 * std::sin(0.02 * x + 0.01 * y)); };
    for (const Case& c : {Case{"interpolated", interpolated, "only"},
                          Case{"too short", [&](int x, int y) { return gbuffer::scaled(wavy(x, y), 0.9); }, "only"},
                          Case{"nearly", [&](int x, int y) { return gbuffer::scaled(wavy(x, y), 0.9997); }, "only"},
                          Case{"too long", [&](int x, int y) { return gbuffer::scaled(wavy(x, y), 1.1); }, "longer"}}) {
        const Kept gbuffer = Frame(c.normal).gbuffer();
        EXPECT_FALSE(gbuffer.normal_variance()) << c.what;
        EXPECT_EQ(gbuffer.find("normal_variance"), nullptr);
        EXPECT_TRUE(test::mentions(gbuffer.notes(), "normal_variance")) << c.what;
        EXPECT_TRUE(test::mentions(gbuffer.notes(), c.note)) << c.what;
        EXPECT_EQ(at(test::ask(gbuffer, constant(0.25, LobeWidth::roughness)), 30), 0.25) << c.what;
    }
    const Kept unit = Frame(wavy).gbuffer();
    EXPECT_FALSE(unit.normal_variance());
    EXPECT_FALSE(test::mentions(unit.notes(), "normal_variance"));
}

TEST(NormalVariance, TheRigHasTheLastWord) {
    EXPECT_FALSE(Frame([](int x, int y) { return crease(x, y); }).gbuffer(NormalVariance::off).normal_variance());
    const Kept forced = Frame(interpolated).gbuffer(NormalVariance::on);
    EXPECT_TRUE(forced.normal_variance());
    EXPECT_GT(at(test::ask(forced, test::semantic("normal_variance")), 6), 0.01);
}

TEST(NormalVariance, TheDeadZoneFollowsThePrecision) {
    // As float, but rounded to half somewhere on the way.
    const auto rounded = [](const Vector3& n) { return Vector3{half(n[0]), half(n[1]), half(n[2])}; };
    const Kept gbuffer =
        Frame([&](int x, int y) {
            return rounded(x == 24 ? mean(leaning(-20), leaning(20), 0.5) : leaning((x < 24 ? -20 : 20) + 0.1 * y));
        }).gbuffer();
    ASSERT_TRUE(gbuffer.normal_variance());
    EXPECT_TRUE(reads(gbuffer, "normal_variance", "0.001"));
    const test::Answer variance = test::ask(gbuffer, test::semantic("normal_variance"));
    for (int y = 0; y < kHeight; ++y) {
        for (const int x : {3, 23, 25, 40}) EXPECT_EQ(at(variance, x, y), 0);
    }
}

/// Files: a crease whose left end is a silhouette, as a renderer averages it.
class VarianceOfFiles : public testing::Test {
protected:
    static double coverage(int x, int) { return x < 8 ? 0 : x == 8 ? 0.375 : 1; }

    GBuffer read(const test::VectorFunction& normal, PixelType type, bool alpha = true,
                 const GBufferOptions& options = {}) {
        MadePart part;
        part.attributes = {test::text("BlenderMultiChannel", "Blender V2.55.1 and newer")};
        test::add_vector(
            part, "V.Normal", [&](int x, int y) { return gbuffer::scaled(normal(x, y), coverage(x, y)); }, "XYZ", type);
        test::add_vector(part, "V.Combined", test::constant(1, 1, 1), "RGB");
        if (alpha)
            part.channels.push_back({"V.Combined.A", [](int x, int y) { return coverage(x, y); }, PixelType::float32});
        part.channels.push_back(
            {"V.roughness.X", [](int x, int y) { return 0.25 * coverage(x, y); }, PixelType::float32});
        test::write_exr(folder / "a.exr", {part});
        return GBuffer::read(folder / "a.exr", options);
    }

    io::TemporaryFolder folder;
};

TEST_F(VarianceOfFiles, SilhouettesAreNotTakenForCreases) {
    // A crease, and to the right of it pixels that all show both faces.
    const auto both = [](int x, int y) { return x < 30 ? crease(x, y) : crease(24, y); };
    GBufferOptions on;
    on.normal_variance = NormalVariance::on;
    const GBuffer gbuffer = read(both, PixelType::float32, true, on);
    ChannelRequest roughness = test::semantic("roughness");
    roughness.widen = LobeWidth::roughness;
    const test::Answer wide = test::ask(gbuffer, roughness), normal = test::ask(gbuffer, test::semantic("normal", 3));
    EXPECT_EQ(at(wide, 4), 0);
    for (const int x : {8, 9, 23, 24, 25, 30}) EXPECT_NEAR(at(wide, x), 0.25, 1e-7) << x;
    EXPECT_NEAR(at(normal, 8), leaning(-30)[0], 1e-6);
    const double v = growth(std::cos(30 * kDegree), 1e-5);
    for (int y = 0; y < kHeight; ++y) EXPECT_NEAR(at(wide, 40, y), std::pow(std::pow(0.25, 4) + v, 0.25), 1e-6);
    // By its own name, scaled, it is as wide.
    roughness.kind = ChannelRequest::Kind::raw;
    roughness.scale = 2;
    EXPECT_NEAR(at(test::ask(gbuffer, roughness), 40), std::pow(std::pow(0.5, 4) + v, 0.25), 1e-6);
}

TEST_F(VarianceOfFiles, BandsAndRunsDoNotMatter) {
    // A crease that crosses the rows, so that every pixel's neighbours matter, beyond the loaded rows too.
    const auto slanted = [](int x, int y) { return crease(x - y + 16, y, 0.25 + 0.5 * (x % 2)); };
    const GBuffer gbuffer = read(slanted, PixelType::float32);
    ASSERT_TRUE(gbuffer.normal_variance());
    ChannelRequest roughness = test::semantic("roughness");
    roughness.widen = LobeWidth::roughness;
    for (const ChannelRequest& request : {roughness, test::semantic("normal", 3)}) {
        const test::Answer whole = test::ask(gbuffer, request);
        for (const auto& [rows, step] : {std::pair(1, 5), std::pair(3, 0), std::pair(32, 7)})
            EXPECT_EQ(test::ask(gbuffer, request, rows, step), whole) << rows << ' ' << step;
    }
}

TEST_F(VarianceOfFiles, WithoutCoverageNothingTellsThem) {
    const GBuffer gbuffer = read([](int x, int y) { return crease(x, y); }, PixelType::float32, false);
    EXPECT_FALSE(gbuffer.normal_variance());
    EXPECT_TRUE(test::mentions(gbuffer.notes(), "no coverage"));
    GBufferOptions on;
    on.normal_variance = NormalVariance::on;
    EXPECT_TRUE(read([](int x, int y) { return crease(x, y); }, PixelType::float32, false, on).normal_variance());
}

TEST_F(VarianceOfFiles, HalfNormalsAreUnit) {
    const auto faces = [](int x, int y) { return leaning((x < 24 ? -20 : 20) + 0.3 * y + 0.01 * x); };
    EXPECT_FALSE(read(faces, PixelType::half).normal_variance());
    const GBuffer gbuffer = read(
        [&](int x, int y) { return x == 24 ? mean(faces(23, y), faces(25, y), 0.5) : faces(x, y); }, PixelType::half);
    ASSERT_TRUE(gbuffer.normal_variance());
    EXPECT_TRUE(reads(gbuffer, "normal_variance", "0.001"));
    const test::Answer variance = test::ask(gbuffer, test::semantic("normal_variance"));
    for (int y = 0; y < kHeight; ++y) {
        for (const int x : {8, 12, 23, 25, 47}) EXPECT_EQ(at(variance, x, y), 0) << x;
    }
}

TEST(NormalVariance, OfEightBitsHasAWideDeadZone) {
    const auto coded = [](const Vector3& n) {
        Vector3 code{};
        for (std::size_t k = 0; k < 3; ++k) code[k] = std::round((n[k] + 1) / 2 * 255) / 255;
        return code;
    };
    const auto faces = [](int x, int y) { return leaning((x < 24 ? -20 : 20) + 0.3 * y + 0.01 * x); };
    GBufferOptions options = test::MemoryFrame::camera();
    options.channels["normal"].encoding = Encoding::zero_to_one;
    EXPECT_FALSE(Frame([&](int x, int y) { return coded(faces(x, y)); }).gbuffer(options).normal_variance());
    const Kept gbuffer = Frame([&](int x, int y) {
                             return coded(x == 24 ? mean(faces(23, y), faces(25, y), 0.5) : faces(x, y));
                         }).gbuffer(options);
    ASSERT_TRUE(gbuffer.normal_variance());
    EXPECT_TRUE(reads(gbuffer, "normal_variance", "0.01"));
    const test::Answer variance = test::ask(gbuffer, test::semantic("normal_variance"));
    for (int y = 0; y < kHeight; ++y) {
        for (const int x : {3, 23, 25, 40}) EXPECT_EQ(at(variance, x, y), 0) << x;
    }
}

TEST(NormalVariance, ShadesAsIfTheRoughnessWereWider) {
    // One frame has mixed pixels and narrow highlights; the other unit normals, and what the widths should be. The
    // outer two of three mixed columns are next to a face.
    const auto face = [](int x, int y) { return leaning((x / 6 % 2 == 0 ? -26 : 34) + y + 0.01 * x); };
    const auto normal = [&](int x, int y) {
        return x % 6 < 3 ? face(x, y) : mean(leaning(-26 + y), leaning(34 + y), 0.3);
    };
    const auto stands_in = [](int x) { return x % 6 == 3 ? x - 1 : x % 6 == 5 && x + 1 < kWidth ? x + 1 : x; };
    const auto unit = [&](int x, int y) {
        const Vector3 n = normal(stands_in(x), y);
        return gbuffer::scaled(n, 1 / gbuffer::length(n));
    };
    const auto alpha2 = [&](int x, int y, double narrow) {
        return std::min(narrow + growth(gbuffer::length(normal(stands_in(x), y)), 1e-5), 1.0);
    };
    struct Case {
        const char *shader, *parameter;
        double value;
        std::function<double(double)> alpha2_of, from_alpha2;
    };
    const auto of_roughness = [](double r) { return std::pow(r, 4); };
    const auto to_roughness = [](double a2) { return std::pow(a2, 0.25); };
    for (const Case& c :
         {Case{"ggx", "roughness", 0.3, of_roughness, to_roughness},
          Case{"blender_principled", "roughness", 0.3, of_roughness, to_roughness},
          Case{"beckmann", "width", 0.1, [](double w) { return w * w; }, [](double a2) { return std::sqrt(a2); }},
          Case{"blinn_phong", "exponent", 200, [](double e) { return 2 / (e + 2); },
               [](double a2) { return 2 / a2 - 2; }}}) {
        const auto wide = [&](int x, int y) { return c.from_alpha2(alpha2(x, y, c.alpha2_of(c.value))); };
        const auto grey = [](int, int) { return 0.5; };
        Frame creased(normal), widened(unit);
        creased.add("base_color", grey, 3);
        widened.add("base_color", grey, 3).add(c.parameter, wide);
        const std::string lit = "[[light]]\ntype = \"sun\"\ndirection = [-0.3, -0.2, -1]\n";
        const std::string use = "[[shader]]\nuse = \"" + std::string(c.shader) + "\"\n";
        const Rig by_constant = Rig::loads(lit + use + c.parameter + " = " + std::to_string(c.value) + "\n");
        const Rig by_channel = Rig::loads(lit + use);
        const Kept in = creased.gbuffer(NormalVariance::on), reference = widened.gbuffer(),
                   off = creased.gbuffer(NormalVariance::off);
        ASSERT_TRUE(in.normal_variance());
        ASSERT_FALSE(reference.normal_variance());
        const test::Pictures seen = test::relit(in, by_constant), expected = test::relit(reference, by_channel),
                             narrow = test::relit(off, by_constant);
        double changed = 0;
        for (std::size_t i = 0; i < seen("beauty", 0).size(); ++i) {
            const float e = expected("beauty", 0)[i];
            ASSERT_NEAR(seen("beauty", 0)[i], e, 2e-5f * (1 + e)) << c.shader << ' ' << i;
            changed = std::max(changed, static_cast<double>(std::abs(narrow("beauty", 0)[i] - e)));
        }
        EXPECT_GT(changed, 0.05) << c.shader;
    }
}

}  // namespace
}  // namespace relume
