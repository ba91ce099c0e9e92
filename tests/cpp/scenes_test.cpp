// SPDX-License-Identifier: Apache-2.0
// The G-buffers of the built-in scenes against closed forms in double precision. Light paths: scenes_room_test.cpp.
#include "relume/scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <set>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "io/exr.h"
#include "relume/error.h"
#include "scenes/cornell_scene.h"
#include "scenes/name_id.h"
#include "scenes/sdf_scene.h"

namespace relume {
namespace {

using glm::dvec2;
using glm::dvec3;
using scene::CornellScene;
using scene::SdfScene;
using scene::Surface;

float at(const SceneImage& image, std::string_view channel, int i, int j) {
    const SceneChannel* found = image.find("ViewLayer." + std::string(channel));
    if (!found) throw std::runtime_error("no channel " + std::string(channel));
    return found->pixels[static_cast<std::size_t>(j) * static_cast<std::size_t>(image.window.width) +
                         static_cast<std::size_t>(i)];
}

dvec3 triple(const SceneImage& image, const std::string& layer, const char* components, int i, int j) {
    dvec3 value;
    for (int k = 0; k < 3; ++k) value[k] = at(image, layer + "." + components[k], i, j);
    return value;
}

SceneImage small(std::string_view name, int samples, int paths = 0, int threads = 1) {
    SceneOptions options;
    options.width = 64;
    options.height = 36;
    options.samples = samples;
    options.paths = paths;
    options.threads = threads;
    return render_scene(name, options);
}

TEST(ScenesTest, NameIdsAreCryptomattes) {
    EXPECT_EQ(scene::name_id_hex(scene::name_id("torus")), "f19c73fd");
    EXPECT_EQ(scene::name_id_hex(scene::name_id("равнина")), "9623511e");
    EXPECT_EQ(scene::name_id_hex(scene::name_id("ViewLayer.CryptoObject")).substr(0, 7), "542cafa");
    EXPECT_EQ(scene::name_id_hex(scene::name_id("Suzanne_plastic")), "010bace9");  // bit 23 flipped: a denormal else
}

TEST(ScenesTest, UnknownNamesAndBadOptionsAreErrors) {
    try {
        render_scene("cornel");
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::parameter);
        EXPECT_STREQ(error.what(), "there is no scene 'cornel'; the scenes are sdf and cornell");
    }
    const auto refused = [](auto change) {
        SceneOptions options;
        options.width = options.height = 2;
        change(options);
        try {
            render_scene("sdf", options);
            return false;
        } catch (const Error& error) {
            return error.kind() == ErrorKind::value;
        }
    };
    EXPECT_TRUE(refused([](SceneOptions& o) { o.width = -1; }));
    EXPECT_TRUE(refused([](SceneOptions& o) { o.height = 40000; }));
    EXPECT_TRUE(refused([](SceneOptions& o) { o.samples = -4; }));
    EXPECT_TRUE(refused([](SceneOptions& o) { o.paths = -2; }));
    EXPECT_TRUE(refused([](SceneOptions& o) { o.bounces = 65; }));
    EXPECT_TRUE(refused([](SceneOptions& o) { o.threads = -1; }));
    EXPECT_TRUE(refused([](SceneOptions& o) { o.time = std::numeric_limits<double>::infinity(); }));
    EXPECT_FALSE(refused([](SceneOptions&) {}));
}

TEST(ScenesTest, OnePixelIsEnough) {
    for (const SceneInfo& info : scenes()) {
        SceneOptions options;
        options.width = options.height = 1;
        const SceneImage image = render_scene(info.name, options);
        for (const SceneChannel& channel : image.channels) {
            ASSERT_EQ(channel.pixels.size(), 1u);
            EXPECT_TRUE(std::isfinite(channel.pixels[0])) << channel.name;
        }
    }
}

TEST(ScenesTest, PixelsDoNotDependOnThreads) {
    for (const SceneInfo& info : scenes()) {
        const SceneImage one = small(info.name, 3, 2, 1);
        for (const int threads : {2, 5}) {
            const SceneImage many = small(info.name, 3, 2, threads);
            ASSERT_EQ(one.channels.size(), many.channels.size());
            for (std::size_t c = 0; c < one.channels.size(); ++c) {
                EXPECT_EQ(one.channels[c].pixels, many.channels[c].pixels) << one.channels[c].name;
            }
        }
    }
}

TEST(ScenesTest, TheSeedReachesTheBeautyAlone) {
    SceneOptions options;
    options.width = options.height = 16;
    options.samples = 2;
    options.paths = 1;
    const SceneImage a = render_scene("cornell", options);
    options.seed = 1;
    const SceneImage b = render_scene("cornell", options);
    for (const SceneChannel& channel : a.channels) {
        const bool beauty = channel.name.starts_with("ViewLayer.Combined") && !channel.name.ends_with(".A");
        EXPECT_EQ(channel.pixels != b.find(channel.name)->pixels, beauty) << channel.name;
    }
}

TEST(ScenesTest, TheCameraTurnsDepthIntoPosition) {
    for (const SceneInfo& info : scenes()) {
        const SceneImage image = small(info.name, 1);
        const Camera& c = image.camera;
        int surfaces = 0;
        for (int j = 0; j < image.window.height; ++j) {
            for (int i = 0; i < image.window.width; ++i) {
                const double depth = at(image, "Depth.Z", i, j);
                if (at(image, "IndexOB.X", i, j) == 0) {
                    EXPECT_EQ(depth, 1e10f);
                    continue;
                }
                ++surfaces;
                const dvec3 in_camera{depth * ((i + 0.5) * c.x_scale + c.x_offset),
                                      depth * ((j + 0.5) * c.y_scale + c.y_offset), -depth};
                const dvec3 position = triple(image, "Position", "XYZ", i, j);
                for (int row = 0; row < 3; ++row) {
                    double expected = c.camera_to_world[4 * row + 3];
                    for (int k = 0; k < 3; ++k) expected += c.camera_to_world[4 * row + k] * in_camera[k];
                    EXPECT_NEAR(position[row], expected, 1e-6 * depth) << info.name << " " << i << " " << j;
                }
            }
        }
        EXPECT_GT(surfaces, 1000);
    }
}

TEST(ScenesTest, EdgesArePremultipliedAndTheCentreDecidesTheRest) {
    for (const SceneInfo& info : scenes()) {
        const SceneImage centre = small(info.name, 1);
        const SceneImage image = small(info.name, 16, 1);
        int edges = 0;
        for (int j = 0; j < image.window.height; ++j) {
            for (int i = 0; i < image.window.width; ++i) {
                for (const char* name : {"Depth.Z", "Position.X", "Position.Y", "Position.Z", "IndexOB.X", "IndexMA.X"}) {
                    EXPECT_EQ(at(image, name, i, j), at(centre, name, i, j));
                }
                const double coverage = at(image, "albedo.A", i, j);
                EXPECT_EQ(at(image, "Combined.A", i, j), coverage);
                const double length = glm::length(triple(image, "Normal", "XYZ", i, j));
                EXPECT_LE(length, coverage + 1e-6);
                double matte = 0;
                int objects = 0;
                for (const char* rank : {"CryptoObject00.g", "CryptoObject00.a", "CryptoObject01.g", "CryptoObject01.a"}) {
                    matte += at(image, rank, i, j);
                    objects += at(image, rank, i, j) > 0;
                }
                EXPECT_NEAR(matte, coverage, 1e-6);
                if (coverage == 0 || coverage == 1) continue;
                ++edges;
                // The ground's horizon and the box's rim: one flat surface and the background.
                if (objects == 1) {
                    EXPECT_NEAR(length, coverage, 1e-6);
                }
            }
        }
        EXPECT_GT(edges, 30) << info.name;
    }
}

TEST(ScenesTest, ManifestsNameTheMattes) {
    for (const SceneInfo& info : scenes()) {
        SceneOptions options;
        options.width = options.height = 64;
        options.samples = 1;
        options.paths = 0;
        const SceneImage image = render_scene(info.name, options);
        const std::string& manifest = image.attributes.at("cryptomatte/542cafa/manifest");
        std::set<float> indices;
        for (int j = 0; j < image.window.height; ++j) {
            for (int i = 0; i < image.window.width; ++i) {
                const float index = at(image, "IndexOB.X", i, j);
                const float id = at(image, "CryptoObject00.r", i, j);
                EXPECT_EQ(index == 0, id == 0);
                if (index != 0 && indices.insert(index).second) {
                    const std::string hex = scene::name_id_hex(std::bit_cast<std::uint32_t>(id));
                    EXPECT_NE(manifest.find("\":\"" + hex + "\""), std::string::npos) << manifest << hex;
                }
            }
        }
        EXPECT_EQ(indices.size(), info.name == "sdf" ? 2u : 14u);
    }
    const std::string manifest = small("sdf", 1).attributes.at("cryptomatte/542cafa/manifest");
    EXPECT_EQ(manifest, R"({"sphere":"591e9a8d","ground":"c5b51ede"})");
}

TEST(ScenesTest, AnOpaqueFilmHasTheSkyBehindIt) {
    SceneOptions options;
    options.width = 64;
    options.height = 36;
    options.samples = 8;
    const SceneImage clear = render_scene("sdf", options);
    options.opaque = true;
    const SceneImage opaque = render_scene("sdf", options);
    for (int i = 0; i < 64; ++i) {
        EXPECT_EQ(at(clear, "Combined.A", i, 0), 0);
        EXPECT_EQ(at(clear, "Combined.B", i, 0), 0);
        EXPECT_EQ(at(opaque, "Combined.A", i, 0), 1);
        // Away from the sun and near the horizon: half-way between the gradient's ends, and a little below.
        EXPECT_NEAR(at(opaque, "Combined.R", i, 0), 0.65, 0.02);
        EXPECT_NEAR(at(opaque, "Combined.B", i, 0), 0.95, 0.02);
        EXPECT_EQ(at(clear, "Combined.R", i, 35), at(opaque, "Combined.R", i, 35));
    }
}

TEST(ScenesTest, FilesHoldWhatWasRendered) {
    const std::filesystem::path folder = testing::TempDir() + "relume_scenes";
    std::filesystem::create_directories(folder);
    for (const SceneInfo& info : scenes()) {
        SceneOptions options;
        options.width = 50;
        options.height = 37;
        options.samples = 2;
        options.paths = 1;
        const std::filesystem::path path = folder / (std::string(info.name) + ".exr");
        write_scene(info.name, path, options);
        const SceneImage image = render_scene(info.name, options);

        const io::ExrReader reader(path);
        ASSERT_EQ(reader.header().parts.size(), 1u);
        const io::Part& part = reader.header().parts[0];
        EXPECT_EQ(part.data_window, image.window);
        EXPECT_EQ(part.display_window, image.window);
        ASSERT_EQ(part.channels.size(), image.channels.size());
        for (std::size_t c = 0; c < part.channels.size(); ++c) {
            EXPECT_EQ(part.channels[c].name, image.channels[c].name);
            EXPECT_EQ(part.channels[c].type, PixelType::float32);
            std::vector<float> pixels(image.channels[c].pixels.size());
            const Plane plane{reinterpret_cast<std::byte*>(pixels.data()), PixelType::float32, 4, 4 * 50};
            const io::ReadTarget target{0, static_cast<int>(c), plane};
            reader.read(image.window, {&target, 1});
            EXPECT_EQ(pixels, image.channels[c].pixels) << image.channels[c].name;
        }
        for (const auto& entry : image.attributes) {
            const auto same = [&](const io::Attribute& a) {
                return a.name == entry.first && std::get<std::string>(a.value) == entry.second;
            };
            EXPECT_EQ(std::ranges::count_if(part.attributes, same), 1) << entry.first;
        }
    }
    EXPECT_THROW(write_scene("sdf", folder / "none" / "sdf.exr", {.width = 4, .height = 4}), Error);
    std::filesystem::remove_all(folder);
}

/// The eye and the ray through a point of the film, from the definition: eye on a circle, looking at the origin, focal
/// length 1.5 half-heights.
struct Ray {
    dvec3 origin;
    dvec3 direction;
};
Ray sdf_ray(int width, int height, double time, dvec2 film) {
    const double phi = 0.3 * time;
    const dvec3 eye(3 * std::cos(phi), 1.5, 3 * std::sin(phi));
    const dvec3 back = eye / glm::length(eye);
    const dvec3 right = glm::normalize(dvec3(back.z, 0, -back.x));
    const dvec3 up = glm::cross(back, right);
    const double half = 0.5 * height;
    return {eye, glm::normalize(right * ((film.x - 0.5 * width) / half) + up * ((0.5 * height - film.y) / half) - back * 1.5)};
}

TEST(SdfSceneTest, HitsLieOnTheSphereAndTheGround) {
    for (const double time : {0.0, 1.7, 12.0}) {
        const SdfScene scene(160, 90, time);
        int checked = 0;
        for (int j = 0; j < 90; ++j) {
            for (int i = 0; i < 160; ++i) {
                const Ray ray = sdf_ray(160, 90, time, {i + 0.5, j + 0.5});
                const Surface s = scene.trace({i + 0.5, j + 0.5});
                EXPECT_NEAR(glm::length(s.direction - ray.direction), 0, 1e-12);

                const double b = glm::dot(ray.origin, ray.direction);
                const double root = b * b - glm::dot(ray.origin, ray.origin) + 1;
                const double miss = std::sqrt(std::max(0.0, 1 - root)) - 1;  // gap between ray and sphere
                if (miss > -0.01 && miss < 0.01) continue;                 // silhouettes belong to either
                const double ground = ray.direction.y < 0 ? -(ray.origin.y + 1) / ray.direction.y : 1e9;
                if (root > 0) {
                    const double t = -b - std::sqrt(root);
                    const dvec3 normal = ray.origin + ray.direction * t;
                    ASSERT_EQ(s.object, 1);
                    const double slack = 0.001 / -glm::dot(normal, ray.direction);
                    const double found = glm::dot(s.position - ray.origin, ray.direction);
                    EXPECT_LE(found, t + 1e-12);
                    EXPECT_GE(found, t - slack - 1e-9);
                    EXPECT_NEAR(glm::length(s.normal - glm::normalize(s.position)), 0, 1e-6);
                    EXPECT_EQ(s.base_color, dvec3(0.8, 0.2, 0.2));
                    EXPECT_EQ(s.roughness, 0.35);
                } else if (ground < 40) {
                    ASSERT_EQ(s.object, 2);
                    const double found = glm::dot(s.position - ray.origin, ray.direction);
                    EXPECT_LE(found, ground + 1e-9);
                    EXPECT_GE(found, ground - 0.001 / -ray.direction.y - 1e-9);
                    if (s.position.y + 1 < glm::length(s.position) - 1 - 0.01) {
                        EXPECT_NEAR(glm::length(s.normal - dvec3(0, 1, 0)), 0, 1e-9);
                    }
                    const int tile = static_cast<int>(std::floor(s.position.x)) + static_cast<int>(std::floor(s.position.z));
                    EXPECT_EQ(s.base_color, dvec3(tile % 2 == 0 ? 0.3 : 0.6));
                    EXPECT_EQ(s.roughness, 0.8);
                } else if (ground > 52) {
                    EXPECT_EQ(s.object, 0);
                }
                ++checked;
            }
        }
        EXPECT_GT(checked, 12000);
    }
}

TEST(SdfSceneTest, SilhouettesHaveNoHoles) {
    const SdfScene scene(480, 270, 0);
    int off = 0;
    for (int j = 100; j < 200; ++j) {
        for (int i = 0; i < 480; ++i) {
            const Surface s = scene.trace({i + 0.5, j + 0.5});
            ASSERT_NE(s.object, 0) << i << " " << j;
            // Out of steps, most rays stand within a hair of the sphere; a few had just begun to leave it.
            off += scene::sdf_distance(s.position) > 0.0025;
            EXPECT_LT(scene::sdf_distance(s.position), 0.25);
        }
    }
    EXPECT_LE(off, 12);
}

TEST(SdfSceneTest, AmbientOcclusion) {
    // In the open the distance along the normal is the tap itself: nothing is missing.
    EXPECT_NEAR(scene::sdf_ambient_occlusion({0, 1, 0}, {0, 1, 0}), 1, 1e-12);
    EXPECT_NEAR(scene::sdf_ambient_occlusion({9, -1, 4}, {0, 1, 0}), 1, 1e-12);
    // Where sphere and ground meet the taps go into the sphere.
    EXPECT_EQ(scene::sdf_ambient_occlusion({0, -1, 0}, {0, 1, 0}), 0);
    // Beside the sphere, written out: the distance to it where that is less than the height.
    const std::array taps{0.01, 0.04, 0.07, 0.10, 0.13};
    const std::array weights{1.0, 0.95, 0.9025, 0.857375, 0.81450625};
    for (const double x : {0.1, 0.3, 0.42, 0.6}) {
        double missing = 0;
        for (std::size_t i = 0; i < 5; ++i) {
            const double to_sphere = std::hypot(x, taps[i] - 1) - 1;
            missing += weights[i] * (taps[i] - std::min(taps[i], to_sphere));
        }
        const double expected = std::max(0.0, 1 - 3 * missing);
        EXPECT_NEAR(scene::sdf_ambient_occlusion({x, -1, 0}, {0, 1, 0}), expected, 1e-12) << x;
        EXPECT_LT(expected, 1.0000001);
    }
}

TEST(SdfSceneTest, Shadow) {
    const dvec3 sun = scene::sdf_lights().to_sun;
    EXPECT_NEAR(glm::length(sun - dvec3(0.6, 0.8, -0.5) / std::sqrt(1.25)), 0, 1e-12);
    // The axis of the shadow on the ground, open ground, and the sphere's lit side.
    const dvec3 axis = sun * (-1 / sun.y);
    EXPECT_EQ(scene::sdf_shadow(axis, sun), 0);
    EXPECT_EQ(scene::sdf_shadow({3, -1, -3}, sun), 1);
    EXPECT_EQ(scene::sdf_shadow(sun * 1.001, sun), 1);
    // Across the penumbra: never below the least of 8·distance/t on the whole way, which the steps sample, and near it.
    const dvec3 across = glm::normalize(glm::cross(sun, dvec3(0, 1, 0)));
    double previous = 0;
    int partial = 0;
    for (double offset = 0.8; offset < 2.2; offset += 0.01) {
        const dvec3 p = axis + across * offset;
        double least = 1;
        for (double t = 0.02; t < 4.8; t += 1e-4) {
            const double gap = std::min(glm::length(p + sun * t) - 1, sun.y * t);
            least = std::min(least, std::clamp(8 * gap / t, 0.0, 1.0));
        }
        const double light = scene::sdf_shadow(p, sun);
        EXPECT_GE(light, least - 1e-3) << offset;
        EXPECT_LE(light, least + 0.03) << offset;
        EXPECT_GE(light, previous - 0.02) << offset;
        previous = light;
        partial += light > 0.01 && light < 0.99;
    }
    EXPECT_GT(partial, 5);
}

TEST(SdfSceneTest, BeautyFromTheTextbook) {
    SceneOptions options;
    options.width = 64;
    options.height = 36;
    options.samples = 1;
    const SceneImage image = render_scene("sdf", options);
    const dvec3 sun = dvec3(0.6, 0.8, -0.5) / std::sqrt(1.25);
    const dvec3 back = dvec3(-0.6, 0, 0.5) / std::sqrt(0.61);
    constexpr double pi = std::numbers::pi;
    int lit = 0;
    for (int j = 0; j < 36; ++j) {
        for (int i = 0; i < 64; ++i) {
            if (at(image, "IndexOB.X", i, j) == 0) continue;
            const dvec3 n = triple(image, "Normal", "XYZ", i, j);
            const dvec3 v = -sdf_ray(64, 36, 0, {i + 0.5, j + 0.5}).direction;
            const dvec3 c = triple(image, "albedo", "RGB", i, j);
            const double ao = at(image, "AO.R", i, j);
            const double alpha = std::pow(at(image, "roughness.X", i, j), 2);
            const double n_l = glm::dot(n, sun);
            const double n_v = glm::dot(n, v);
            dvec3 expected = c * ((0.5 + 0.5 * n.y) * dvec3(0.08, 0.2, 0.4) + (0.5 + 0.5 * glm::dot(n, back)) * dvec3(0.15, 0.1, 0.08)) * ao;
            if (n_l > 0 && n_v > 0) {
                const dvec3 h = (v + sun) / glm::length(v + sun);
                const double cos2 = std::pow(glm::dot(n, h), 2);
                const double tan2 = 1 / cos2 - 1;
                const double d = 1 / (pi * alpha * alpha * cos2 * cos2 * std::pow(1 + tan2 / (alpha * alpha), 2));
                const auto lambda = [&](double x) { return (std::sqrt(1 + alpha * alpha * (1 / (x * x) - 1)) - 1) / 2; };
                const double g = 1 / (1 + lambda(n_l) + lambda(n_v));
                const double f = 0.04 + 0.96 * std::pow(1 - glm::dot(v, h), 5);
                const dvec3 reflected = (1 - f) * c / pi * n_l + dvec3(d * g * f / (4 * n_v));
                expected += reflected * dvec3(2, 1.9, 1.7) * double(at(image, "Shadow.R", i, j));
                ++lit;
            }
            const dvec3 found = triple(image, "Combined", "RGB", i, j);
            for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[k], expected[k], 3e-5 * expected[k] + 1e-6) << i << " " << j;
        }
    }
    EXPECT_GT(lit, 1000);
}

TEST(CornellSceneTest, RaysMeetTheWallsAndSpheresWhereAlgebraSays) {
    struct Ball { long double x, y, z, r; };
    std::vector<Ball> balls{{-9, -9.3L, 20, 3}, {0, -9.3L, 20, 3}, {9, -9.3L, 20, 3}};
    for (int i = 0; i < 5; ++i) balls.push_back({-10.0L + 5 * i, 0, 23, 1.75L});
    const CornellScene scene(96, 72, 8);
    std::array<int, 15> seen{};
    for (int j = 0; j < 72; ++j) {
        for (int i = 0; i < 96; ++i) {
            const Surface s = scene.trace({i + 0.5, j + 0.5});
            // From the origin along (x, y, 1): half the width is the tangent of 45°, rows have the columns' size.
            const long double x = (i + 0.5L - 48) / 48;
            const long double y = (36 - j - 0.5L) / 48;
            long double depth = 1e30L;
            int object = 0;
            const auto meet = [&](long double z, int what, bool inside) {
                if (inside && z > 0 && z < depth) {
                    depth = z;
                    object = what;
                }
            };
            const auto within = [](long double value, long double low, long double high) { return value >= low && value <= high; };
            meet(25, 1, within(25 * x, -12.6L, 12.6L) && within(25 * y, -12.6L, 12.6L));
            for (const auto& [height, what, near, far, half] : {std::tuple{-12.45L, 2, 15.0L, 25.0L, 12.6L},
                                                                {12.5L, 3, 15.0L, 25.0L, 12.6L},
                                                                {12.4L, 6, 17.5L, 22.5L, 5.0L}}) {
                const long double z = height / y;
                meet(z, what, within(z, near, far) && within(z * x, -half, half));
            }
            for (const auto& [side, what] : {std::pair{-12.5L, 4}, {12.5L, 5}}) {
                const long double z = side / x;
                meet(z, what, within(z, 15, 25) && within(z * y, -12.6L, 12.6L));
            }
            for (std::size_t k = 0; k < balls.size(); ++k) {
                const Ball& ball = balls[k];
                const long double a = x * x + y * y + 1;
                const long double b = x * ball.x + y * ball.y + ball.z;
                const long double c = ball.x * ball.x + ball.y * ball.y + ball.z * ball.z - ball.r * ball.r;
                if (b * b - a * c >= 0) meet(c / (b + std::sqrt(b * b - a * c)), static_cast<int>(7 + k), true);
            }
            ASSERT_EQ(s.object, object) << i << " " << j;
            ++seen[static_cast<std::size_t>(object)];
            if (object == 0) continue;
            EXPECT_NEAR(s.depth, static_cast<double>(depth), 1e-11);
            EXPECT_NEAR(glm::length(s.position - dvec3(double(x), double(y), 1) * s.depth), 0, 1e-11);
            EXPECT_LT(glm::dot(s.normal, s.direction), 0);
            dvec3 normal(0);
            if (object == 1) normal = {0, 0, -1};
            if (object == 2) normal = {0, 1, 0};
            if (object == 3 || object == 6) normal = {0, -1, 0};
            if (object == 4) normal = {1, 0, 0};
            if (object == 5) normal = {-1, 0, 0};
            if (object >= 7) {
                const Ball& ball = balls[static_cast<std::size_t>(object - 7)];
                normal = (s.position - dvec3(double(ball.x), double(ball.y), double(ball.z))) / double(ball.r);
            }
            EXPECT_NEAR(glm::length(s.normal - normal), 0, 1e-11);
        }
    }
    // The frame is too wide for the height of 72 rows: floor, ceiling and sides, but little background.
    for (int object = 1; object <= 14; ++object) EXPECT_GT(seen[static_cast<std::size_t>(object)], 10) << object;
}

TEST(CornellSceneTest, MaterialsReachTheirChannels) {
    SceneOptions options;
    options.width = options.height = 64;
    options.samples = 1;
    options.paths = 0;
    const SceneImage image = render_scene("cornell", options);
    EXPECT_EQ(image.find("ViewLayer.Combined.R"), nullptr);
    int light = 0;
    std::set<float> shiny;
    for (int j = 0; j < 64; ++j) {
        for (int i = 0; i < 64; ++i) {
            const int object = static_cast<int>(at(image, "IndexOB.X", i, j));
            const dvec3 emission = triple(image, "Emit", "RGB", i, j);
            const dvec3 specular_color = triple(image, "specular_color", "RGB", i, j);
            const double p = at(image, "percent_specular.X", i, j);
            const double roughness = at(image, "roughness.X", i, j);
            if (object == 6) {
                ++light;
                EXPECT_LT(glm::length(emission - dvec3(20, 18, 14)), 1e-6);
                continue;
            }
            EXPECT_EQ(emission, dvec3(0));
            if (object >= 1 && object <= 5) {
                EXPECT_EQ(p, 0);
            }
            if (object == 4) {
                EXPECT_LT(glm::length(triple(image, "albedo", "RGB", i, j) - dvec3(0.7, 0.1, 0.1)), 1e-6);
            }
            if (object == 9) {
                EXPECT_EQ(p, 0.5);
                EXPECT_EQ(specular_color, dvec3(1, 0, 0));
                EXPECT_NEAR(roughness, 0.4, 1e-7);
            }
            if (object >= 10) {
                EXPECT_EQ(p, 1);
                EXPECT_EQ(roughness, 0.25 * (object - 10));
                EXPECT_LT(glm::length(specular_color - dvec3(0.3, 1, 0.3)), 1e-6);
                shiny.insert(static_cast<float>(roughness));
            }
        }
    }
    EXPECT_GT(light, 20);
    EXPECT_EQ(shiny.size(), 5u);
}

}  // namespace
}  // namespace relume
