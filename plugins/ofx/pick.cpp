// SPDX-License-Identifier: Apache-2.0
#include "pick.h"

#include <cmath>
#include <optional>
#include <vector>

#include "clip_gbuffer.h"
#include "file_frames.h"
#include "relume/error.h"
#include "relume/light.h"

namespace relume::ofx {

namespace {

using Triple = std::array<double, 3>;

Triple operator+(const Triple& a, const Triple& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Triple operator-(const Triple& a, const Triple& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Triple operator*(double s, const Triple& a) { return {s * a[0], s * a[1], s * a[2]}; }
double dot(const Triple& a, const Triple& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
double length(const Triple& a) { return std::sqrt(dot(a, a)); }

struct Surface {
    Triple normal{}, view{};
    std::optional<Triple> position;
    std::optional<Camera> camera;
};

Surface surface_at(const GBuffer& gbuffer, int x, int y) {
    const Window& data = gbuffer.data_window();
    if (x < data.x || y < data.y || x >= data.x_end() || y >= data.y_end())
        throw Error(ErrorKind::value, "the picked point lies outside of the G-buffer");
    std::vector<ChannelRequest> requests;
    const auto want = [&](const char* name) {
        ChannelRequest request;
        request.name = name;
        request.components = 3;
        requests.push_back(std::move(request));
    };
    want("normal");
    want("view");
    const bool placed = gbuffer.find("position") != nullptr;
    if (placed) want("position");
    std::array<float, 9> values{};
    std::vector<Plane> planes;
    for (std::size_t k = 0; k < 3 * requests.size(); ++k)
        planes.push_back({reinterpret_cast<std::byte*>(&values[k]), PixelType::float32, 4, 4});
    read_channels(gbuffer, requests, planes, 1, Window{x, y, 1, 1});
    const auto triple = [&](std::size_t first) {
        Triple v{};
        for (std::size_t k = 0; k < 3; ++k) v[k] = static_cast<double>(values[first + k]);
        return v;
    };
    Surface surface{triple(0), triple(3), {}, gbuffer.camera()};
    if (!(dot(surface.normal, surface.normal) > 0.5))
        throw Error(ErrorKind::value, "there is no surface at the picked point");
    if (placed) surface.position = triple(6);
    return surface;
}

/// What is no number lies far outside.
int floor_of(double x) { return static_cast<int>(std::floor(x > -1e9 ? std::min(x, 1e9) : -1e9)); }

Surface picked_surface(const Instance& instance, const std::array<double, 2>& point, double time, double scale_x,
                       double scale_y) {
    const NodeRig node = node_rig(instance, time);
    const std::string file = gbuffer_file(instance, node);
    if (!file.empty()) {
        const auto understood = understand_file(file, node.rig.gbuffer);
        const GBuffer& gbuffer = understood->gbuffer;
        const OfxRectD origin = project_format(instance).value_or(OfxRectD{});
        const Window& display = gbuffer.display_window();
        return surface_at(gbuffer,
                          display.x + floor_of((point[0] - origin.x1) / static_cast<double>(gbuffer.pixel_aspect())),
                          display.y_end() - 1 - floor_of(point[1] - origin.y1));
    }
    ClipGBuffer clips(instance, time, scale_x, scale_y, node.rig.gbuffer);
    const PixelGrid& grid = clips.grid();
    const std::atomic<bool> never{false};
    const int x = floor_of(point[0] * grid.scale_x / grid.aspect), y = floor_of(point[1] * grid.scale_y);
    return surface_at(clips.understand({x, y, x + 1, y + 1}, never), x - grid.display.x1, grid.display.y2 - 1 - y);
}

/// World to camera by the inverse of a rigid motion.
Triple into_camera(const Camera& camera, const Triple& v, bool is_point) {
    const auto& m = camera.camera_to_world;
    const Triple moved = is_point ? v - Triple{m[3], m[7], m[11]} : v;
    Triple out{};
    for (std::size_t k = 0; k < 3; ++k) out[k] = m[k] * moved[0] + m[4 + k] * moved[1] + m[8 + k] * moved[2];
    return out;
}

Triple out_of_camera(const Camera& camera, const Triple& v) {
    const auto& m = camera.camera_to_world;
    Triple out{};
    for (std::size_t k = 0; k < 3; ++k)
        out[k] = m[4 * k] * v[0] + m[4 * k + 1] * v[1] + m[4 * k + 2] * v[2] + m[4 * k + 3];
    return out;
}

void place(const Instance& instance, const LightKnobs& knobs, double time, double scale_x, double scale_y) {
    const LightType* type = find_light_type(instance.light_type(knobs, time));
    if (type == nullptr) return;
    // What the light has, by the names that every table uses.
    std::string direction, position, space;
    const auto index = static_cast<std::size_t>(type - light_types().data());
    for (std::size_t row = 0; row < type->parameters.size(); ++row) {
        const std::string& name = layout().knobs[static_cast<std::size_t>(knobs.of_types[index][row])].name;
        if (type->parameters[row].name == "direction") direction = name;
        if (type->parameters[row].name == "position") position = name;
        if (type->parameters[row].name == "space") space = name;
    }
    if (direction.empty() && position.empty()) return;

    const Surface surface =
        picked_surface(instance, instance.pair(knobs.prefix + own::kPick, time), time, scale_x, scale_y);
    const auto mode = static_cast<PickMode>(instance.integer(knobs.prefix + own::kPickMode, time, 0));
    const bool in_camera = !space.empty() && instance.integer(space, time, 0) == 1 && surface.camera.has_value();
    const auto need_position = [&] {
        if (!surface.position)
            throw Error(ErrorKind::value,
                        "nothing tells where the picked surface is: connect Position, or Depth and give a camera");
        return *surface.position;
    };

    Triple old{};
    if (!position.empty()) {
        old = instance.triple(position, time, {});
        if (in_camera) old = out_of_camera(*surface.camera, old);
    }
    // Unit, from the surface to the light.
    Triple towards = surface.normal;
    if (mode == PickMode::highlight) towards = 2 * dot(surface.normal, surface.view) * surface.normal - surface.view;
    if (mode == PickMode::aim) {
        if (position.empty())
            throw Error(ErrorKind::value,
                        "a " + std::string(type->name) + " light has no place to aim from: choose another pick mode");
        towards = old - need_position();
    }
    const double size = length(towards);
    if (!(size > 0)) throw Error(ErrorKind::value, "the light stands on the picked surface");
    towards = (1 / size) * towards;

    if (!position.empty() && mode != PickMode::aim) {
        const Triple point = need_position();
        double distance = instance.number(knobs.prefix + own::kPickDistance, time, 0);
        if (!(distance > 0)) distance = length(old - point);
        Triple at = point + distance * towards;
        if (in_camera) at = into_camera(*surface.camera, at, true);
        instance.set(position, at);
    }
    if (!direction.empty()) {
        const Triple travel = (-1.0) * towards;
        instance.set(direction, in_camera ? into_camera(*surface.camera, travel, false) : travel);
    }
}

}  // namespace

void pick(const Instance& instance, const std::string& name, double time, double scale_x, double scale_y) {
    for (const LightKnobs& knobs : layout().lights)
        if (name == knobs.prefix + own::kPick) place(instance, knobs, time, scale_x, scale_y);
}

}  // namespace relume::ofx
