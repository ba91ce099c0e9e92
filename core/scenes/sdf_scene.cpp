// SPDX-License-Identifier: Apache-2.0
#include "scenes/sdf_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace relume::scene {
namespace {

using glm::dvec3;

constexpr double kPi = std::numbers::pi;
constexpr double kFocal = 1.5;  // in half-heights of the picture
constexpr int kTraceSteps = 128;
constexpr double kHit = 0.001;
constexpr double kFar = 50;
constexpr double kNormalStep = 0.001;

constexpr std::array<std::string_view, 2> kObjects{"sphere", "ground"};

constexpr std::array<ChannelSpec, 22> kChannels{{
    {"Depth.Z", [](const Surface& s) { return s.object ? s.depth : 1e10; }, true},
    {"Position.X", [](const Surface& s) { return s.position.x; }, true},
    {"Position.Y", [](const Surface& s) { return s.position.y; }, true},
    {"Position.Z", [](const Surface& s) { return s.position.z; }, true},
    {"IndexOB.X", [](const Surface& s) { return double(s.object); }, true},
    {"IndexMA.X", [](const Surface& s) { return double(s.material); }, true},
    {"Normal.X", [](const Surface& s) { return s.normal.x; }},
    {"Normal.Y", [](const Surface& s) { return s.normal.y; }},
    {"Normal.Z", [](const Surface& s) { return s.normal.z; }},
    {"albedo.R", [](const Surface& s) { return s.base_color.x; }},
    {"albedo.G", [](const Surface& s) { return s.base_color.y; }},
    {"albedo.B", [](const Surface& s) { return s.base_color.z; }},
    {"albedo.A", [](const Surface& s) { return s.object ? 1.0 : 0.0; }},
    {"roughness.X", [](const Surface& s) { return s.roughness; }},
    {"metallic.X", [](const Surface& s) { return s.metallic; }},
    {"specular.X", [](const Surface& s) { return s.specular; }},
    {"AO.R", [](const Surface& s) { return s.ambient_occlusion; }},
    {"AO.G", [](const Surface& s) { return s.ambient_occlusion; }},
    {"AO.B", [](const Surface& s) { return s.ambient_occlusion; }},
    {"Shadow.R", [](const Surface& s) { return s.sun_shadow; }},
    {"Shadow.G", [](const Surface& s) { return s.sun_shadow; }},
    {"Shadow.B", [](const Surface& s) { return s.sun_shadow; }},
}};

double clamp01(double x) { return std::clamp(x, 0.0, 1.0); }

/// GGX with the height-correlated Smith term (Walter 2007 eq. 33, Heitz 2014) and Schlick's Fresnel over Lambert, which
/// gets what the microfacets do not reflect: f·n·l.
dvec3 reflect_sun(const Surface& s, const dvec3& v, const dvec3& l) {
    const double n_l = glm::dot(s.normal, l);
    const double n_v = glm::dot(s.normal, v);
    if (n_l <= 0 || n_v <= 0) return dvec3(0);
    const dvec3 h = glm::normalize(v + l);
    const double v_h = clamp01(glm::dot(v, h));
    const double a2 = std::pow(s.roughness, 4);
    const dvec3 n_cross_h = glm::cross(s.normal, h);
    const double n_h = glm::dot(s.normal, h);
    const double q = glm::dot(n_cross_h, n_cross_h) + a2 * n_h * n_h;
    const double distribution = a2 / (kPi * q * q);
    const double visibility =
        0.5 / (n_l * std::sqrt(n_v * n_v * (1 - a2) + a2) + n_v * std::sqrt(n_l * n_l * (1 - a2) + a2));
    const dvec3 f0 = glm::mix(dvec3(0.08 * s.specular), s.base_color, s.metallic);
    const dvec3 fresnel = f0 + (dvec3(1) - f0) * std::pow(1 - v_h, 5);
    return ((dvec3(1) - fresnel) * (1 - s.metallic) * s.base_color / kPi + distribution * visibility * fresnel) * n_l;
}

}  // namespace

SdfLights sdf_lights() {
    const dvec3 to_sun = glm::normalize(dvec3(0.6, 0.8, -0.5));
    return {to_sun, dvec3(1, 0.95, 0.85) * 2.0, dvec3(0.2, 0.5, 1) * 0.4,
            glm::normalize(dvec3(-to_sun.x, 0, -to_sun.z)), dvec3(0.15, 0.1, 0.08)};
}

double sdf_distance(const dvec3& p) { return std::min(glm::length(p) - 1, p.y + 1); }

double sdf_ambient_occlusion(const dvec3& p, const dvec3& n) {
    double missing = 0;
    double weight = 1;
    for (int i = 0; i < 5; ++i) {
        const double h = 0.01 + 0.12 * i / 4;
        missing += weight * (h - sdf_distance(p + n * h));
        weight *= 0.95;
    }
    return clamp01(1 - 3 * missing);
}

double sdf_shadow(const dvec3& p, const dvec3& l) {
    double light = 1;
    double t = 0.02;
    for (int i = 0; i < 24 && t <= 5; ++i) {
        const double gap = sdf_distance(p + l * t);
        light = std::min(light, clamp01(8 * gap / t));
        if (light < 0.001) break;
        t += std::clamp(gap, 0.02, 0.2);
    }
    return light;
}

SdfScene::SdfScene(int width, int height, double time) : width_(width), height_(height) {
    const double angle = 0.3 * time;
    eye_ = dvec3(3 * std::cos(angle), 1.5, 3 * std::sin(angle));
    forward_ = glm::normalize(-eye_);
    right_ = glm::normalize(glm::cross(forward_, dvec3(0, 1, 0)));
    up_ = glm::cross(right_, forward_);
}

Camera SdfScene::camera() const {
    const double step = 2.0 / (height_ * kFocal);
    Camera camera;
    for (int row = 0; row < 3; ++row) {
        camera.camera_to_world[4 * row] = right_[row];
        camera.camera_to_world[4 * row + 1] = up_[row];
        camera.camera_to_world[4 * row + 2] = -forward_[row];
        camera.camera_to_world[4 * row + 3] = eye_[row];
    }
    camera.x_scale = step;
    camera.x_offset = -0.5 * width_ * step;
    camera.y_scale = -step;
    camera.y_offset = 0.5 * height_ * step;
    return camera;
}

Surface SdfScene::trace(glm::dvec2 film) const {
    const double x = (2 * film.x - width_) / height_;
    const double y = (height_ - 2 * film.y) / height_;
    Surface s;
    s.direction = glm::normalize(right_ * x + up_ * y + forward_ * kFocal);

    // A ray that grazes the sphere may run out of steps beside it: it counts as a hit where it stands, or the
    // silhouette would have holes.
    double t = 0;
    for (int i = 0; i < kTraceSteps && t <= kFar; ++i) {
        const double gap = sdf_distance(eye_ + s.direction * t);
        if (gap < kHit) break;
        t += gap;
    }
    if (t > kFar) return s;

    s.position = eye_ + s.direction * t;
    s.depth = t * glm::dot(s.direction, forward_);
    for (int axis = 0; axis < 3; ++axis) {
        dvec3 step(0);
        step[axis] = kNormalStep;
        s.normal[axis] = sdf_distance(s.position + step) - sdf_distance(s.position - step);
    }
    s.normal = glm::normalize(s.normal);
    const bool sphere = glm::length(s.position) - 1 < s.position.y + 1;
    s.object = s.material = sphere ? 1 : 2;
    const double tile = std::floor(s.position.x) + std::floor(s.position.z);
    s.base_color = sphere ? dvec3(0.8, 0.2, 0.2) : dvec3(tile - 2 * std::floor(tile / 2) < 0.5 ? 0.3 : 0.6);
    s.roughness = sphere ? 0.35 : 0.8;
    s.specular = 0.5;
    s.ambient_occlusion = sdf_ambient_occlusion(s.position, s.normal);
    s.sun_shadow = sdf_shadow(s.position, sdf_lights().to_sun);
    return s;
}

dvec3 SdfScene::radiance(const Surface& s, const PathRandom&) const {
    if (!s.object) return dvec3(0);
    const SdfLights lights = sdf_lights();
    const dvec3 diffuse = s.base_color * (1 - s.metallic);
    const dvec3 sun = reflect_sun(s, -s.direction, lights.to_sun) * lights.sun * s.sun_shadow;
    const dvec3 sky = diffuse * lights.sky * (0.5 + 0.5 * s.normal.y);
    const dvec3 back = diffuse * lights.back * (0.5 + 0.5 * glm::dot(s.normal, lights.to_back));
    return sun + (sky + back) * s.ambient_occlusion;
}

dvec3 SdfScene::background(const dvec3& direction) const {
    const SdfLights lights = sdf_lights();
    const double s = std::max(0.0, glm::dot(direction, lights.to_sun));
    return glm::mix(dvec3(0.8, 0.85, 0.9), dvec3(0.5, 0.7, 1), clamp01(0.5 * direction.y + 0.5)) +
           lights.sun * (0.3 * std::pow(s, 8) + std::pow(s, 256));
}

std::span<const ChannelSpec> SdfScene::channels() const { return kChannels; }
std::span<const std::string_view> SdfScene::objects() const { return kObjects; }

}  // namespace relume::scene
