// SPDX-License-Identifier: Apache-2.0
#include "scenes/cornell_scene.h"

#include <array>

#include <glm/geometric.hpp>

namespace relume::scene {
namespace {

using glm::dvec3;

constexpr std::array<std::string_view, 14> kObjects{
    "back_wall",      "floor",           "ceiling",         "left_wall",       "right_wall",
    "light",          "glossy_sphere_1", "glossy_sphere_2", "glossy_sphere_3", "shiny_sphere_1",
    "shiny_sphere_2", "shiny_sphere_3",  "shiny_sphere_4",  "shiny_sphere_5"};

// Index 0 stays black, so that a material's index is its ID in the file.
enum Material : int { none, white, red, green, lamp, yellow, pink, blue, shiny };

constexpr std::array<ChannelSpec, 21> kChannels{{
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
    {"percent_specular.X", [](const Surface& s) { return s.percent_specular; }},
    {"specular_color.R", [](const Surface& s) { return s.specular_color.x; }},
    {"specular_color.G", [](const Surface& s) { return s.specular_color.y; }},
    {"specular_color.B", [](const Surface& s) { return s.specular_color.z; }},
    {"Emit.R", [](const Surface& s) { return s.emission.x; }},
    {"Emit.G", [](const Surface& s) { return s.emission.y; }},
    {"Emit.B", [](const Surface& s) { return s.emission.z; }},
}};

}  // namespace

Room cornell_room() {
    Room room;
    room.materials.resize(shiny);
    room.materials[white].albedo = dvec3(0.7);
    room.materials[red].albedo = dvec3(0.7, 0.1, 0.1);
    room.materials[green].albedo = dvec3(0.1, 0.7, 0.1);
    room.materials[lamp].emission = dvec3(1, 0.9, 0.7) * 20.0;
    room.materials[yellow] = {dvec3(0.9, 0.9, 0.5), dvec3(0.9), dvec3(0), 0.1, 0.2};
    room.materials[pink] = {dvec3(0.9, 0.5, 0.9), dvec3(0.9), dvec3(0), 0.3, 0.2};
    room.materials[blue] = {dvec3(0, 0, 1), dvec3(1, 0, 0), dvec3(0), 0.5, 0.4};

    room.rectangles = {
        {2, {-12.6, -12.6, 25}, {12.6, 12.6, 25}, 1, white}, {1, {-12.6, -12.45, 15}, {12.6, -12.45, 25}, 2, white},
        {1, {-12.6, 12.5, 15}, {12.6, 12.5, 25}, 3, white},  {0, {-12.5, -12.6, 15}, {-12.5, 12.6, 25}, 4, red},
        {0, {12.5, -12.6, 15}, {12.5, 12.6, 25}, 5, green},  {1, {-5, 12.4, 17.5}, {5, 12.4, 22.5}, 6, lamp}};
    room.light = room.rectangles.back();
    room.spheres = {{{-9, -9.3, 20}, 3, 7, yellow}, {{0, -9.3, 20}, 3, 8, pink}, {{9, -9.3, 20}, 3, 9, blue}};
    for (int i = 0; i < 5; ++i) {
        room.spheres.push_back({{-10.0 + 5 * i, 0, 23}, 1.75, 10 + i, shiny + i});
        room.materials.push_back({dvec3(1), dvec3(0.3, 1, 0.3), dvec3(0), 1, 0.25 * i});
    }
    return room;
}

CornellScene::CornellScene(int width, int height, int bounces)
    : width_(width), height_(height), paths_{bounces, true}, room_(cornell_room()) {}

Camera CornellScene::camera() const {
    // The scene's world is left-handed (x right, y up, z ahead), a camera's frame is right-handed: half a turn about y
    // looks along +z, and the columns of the picture run against the camera's x.
    const double step = 2.0 / width_;
    Camera camera;
    camera.camera_to_world = {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1};
    camera.x_scale = -step;
    camera.x_offset = 1;
    camera.y_scale = -step;
    camera.y_offset = 0.5 * height_ * step;
    return camera;
}

Surface CornellScene::trace(glm::dvec2 film) const {
    Surface s;
    s.direction = glm::normalize(dvec3((2 * film.x - width_) / width_, (height_ - 2 * film.y) / width_, 1));
    const std::optional<RoomHit> hit = room_.trace(dvec3(0), s.direction);
    if (!hit) return s;
    const RoomMaterial& m = room_.materials[static_cast<std::size_t>(hit->material)];
    s.object = hit->object;
    s.material = hit->material;
    s.depth = hit->position.z;
    s.position = hit->position;
    s.normal = hit->normal;
    s.base_color = m.albedo;
    s.specular_color = m.specular_color;
    s.emission = m.emission;
    s.roughness = m.roughness;
    s.percent_specular = m.percent_specular;
    return s;
}

dvec3 CornellScene::radiance(const Surface& s, const PathRandom& random) const {
    if (!s.object) return dvec3(0);
    const RoomHit hit{s.depth / s.direction.z, s.object, s.material, s.position, s.normal};
    return room_.radiance(hit, s.direction, random, paths_);
}

std::span<const ChannelSpec> CornellScene::channels() const { return kChannels; }
std::span<const std::string_view> CornellScene::objects() const { return kObjects; }

}  // namespace relume::scene
