// SPDX-License-Identifier: Apache-2.0
#include "lights/bake.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "relume/error.h"
#include "relume/light.h"

namespace relume {

namespace {

using Triple = std::array<double, 3>;

class Baker {
public:
    Baker(const Light& light, const LightType& type, const std::optional<Camera>& camera)
        : light_(light), table_(type.parameters) {
        if (camera && choice("space") == 1) camera_to_world_ = &camera->camera_to_world;
    }

    double number(std::string_view name) const { return light_.values.number(table_, name); }
    Triple triple(std::string_view name) const { return light_.values.triple(table_, name); }
    int choice(std::string_view name) const { return light_.values.choice(table_, name); }
    bool boolean(std::string_view name) const { return light_.values.boolean(table_, name); }
    bool given(std::string_view name) const { return light_.values.given(name); }
    std::vector<double> numbers(std::string_view name) const { return light_.values.numbers(table_, name); }
    std::vector<std::string> texts(std::string_view name) const { return light_.values.texts(table_, name); }

    [[noreturn]] void fail(const std::string& what) const {
        throw Error(ErrorKind::parameter, "light '" + light_.name + "': " + what);
    }

    Triple position() const {
        if (!given("position")) fail("a " + light_.type + " light needs a position = [x, y, z]");
        return transformed(triple("position"), 1);
    }

    /// Unit, in world space.
    Triple direction(std::string_view name) const {
        const Triple d = transformed(triple(name), 0);
        const double length = std::hypot(d[0], d[1], d[2]);
        if (!(length > 1e-12) || !std::isfinite(length)) fail(std::string(name) + " must not be the zero vector");
        return {d[0] / length, d[1] / length, d[2] / length};
    }

    /// Colour times exposure.
    Triple tint() const {
        const Triple c = triple("color");
        const double gain = std::exp2(number("exposure"));
        return {c[0] * gain, c[1] * gain, c[2] * gain};
    }

    /// Radiant intensity of a point or spot, W/sr, without the tint.
    Triple intensity() const {
        if (!given("power")) return triple("intensity");
        if (given("intensity")) fail("give intensity (W/sr) or power (W), not both");
        const double i = number("power") / (4 * std::numbers::pi);
        return {i, i, i};
    }

private:
    Triple transformed(const Triple& v, double w) const {
        if (camera_to_world_ == nullptr) return v;
        const auto& m = *camera_to_world_;
        Triple out{};
        for (std::size_t row = 0; row < 3; ++row)
            out[row] = m[4 * row] * v[0] + m[4 * row + 1] * v[1] + m[4 * row + 2] * v[2] + m[4 * row + 3] * w;
        return out;
    }

    const Light& light_;
    std::span<const Parameter> table_;
    const std::array<double, 16>* camera_to_world_ = nullptr;
};

/// A light's colour in single precision.
void store_color(const Baker& b, float (&to)[3], const Triple& from, double factor) {
    for (std::size_t k = 0; k < 3; ++k) {
        to[k] = static_cast<float>(factor * from[k]);
        if (!std::isfinite(to[k])) b.fail("is brighter than single precision holds; lower its exposure");
    }
}

void store(float (&to)[3], const Triple& from, double sign = 1) {
    for (std::size_t k = 0; k < 3; ++k) to[k] = static_cast<float>(sign * from[k]);
}

Triple product(const Triple& a, const Triple& b) { return {a[0] * b[0], a[1] * b[1], a[2] * b[2]}; }

DirectLight bake_direct(const Baker& b, LightKind kind) {
    DirectLight out{};
    out.kind = kind;
    out.inverse_square = 1;
    const Triple color = product(b.tint(), kind == LightKind::sun ? b.triple("irradiance") : b.intensity());
    const double lobes[3] = {b.number("diffuse"), b.number("specular"), b.number("transmission")};
    for (std::size_t k = 0; k < 3; ++k) store_color(b, out.color[k], color, lobes[k]);
    if (kind != LightKind::point) store(out.to_light, b.direction("direction"), -1);
    if (kind == LightKind::sun) return out;

    store(out.position, b.position());
    if (b.given("attenuation")) {
        const auto a = b.numbers("attenuation");
        if (a[0] + a[1] + a[2] <= 0) b.fail("attenuation must not be all 0");
        out.inverse_square = 0;
        store(out.attenuation, {a[0], a[1], a[2]});
    }
    if (kind == LightKind::spot) {
        out.falloff = static_cast<SpotFalloff>(b.choice("falloff"));
        const double half = b.number("cone_angle") * std::numbers::pi / 360;
        const double blend = b.number("blend");
        // A blend of 0 is a hard edge: a ramp too steep for any pixel to see.
        const double width = out.falloff == SpotFalloff::linear ? half * blend : (1 - std::cos(half)) * blend;
        out.cone[0] = static_cast<float>(std::cos(half));
        out.cone[1] = static_cast<float>(1 / std::max(width, 1e-7));
        out.cone[2] = static_cast<float>(half);
        out.cone[3] = static_cast<float>(blend);
    }
    return out;
}

AmbientLight bake_ambient(const Baker& b, std::string_view type) {
    AmbientLight out{};
    const Triple tint = b.tint();
    const double diffuse = b.number("diffuse");
    if (type == "sky") {
        store(out.axis, b.direction("up"));
        store_color(b, out.low, product(tint, b.triple("ground_color")), diffuse);
        store_color(b, out.high, product(tint, b.triple("sky_color")), diffuse);
    } else {
        const Triple irradiance = product(tint, b.triple("irradiance"));
        store_color(b, out.high, irradiance, diffuse);
        if (type == "bounce") {
            store(out.axis, b.direction("direction"), -1);
            out.clamp = b.boolean("clamp");
        } else {
            store_color(b, out.low, irradiance, diffuse);
        }
    }
    return out;
}

}  // namespace

BakedLight bake_light(const Light& light, const std::optional<Camera>& camera, std::vector<std::string>& warnings) {
    const LightType* type = find_light_type(light.type);
    if (type == nullptr)
        throw Error(ErrorKind::parameter, "light '" + light.name + "': unknown type '" + light.type + "'");
    const Baker b(light, *type, camera);
    if (!camera && b.choice("space") == 1)
        warnings.push_back(
            "light '" + light.name +
            "' is in camera space and no camera is known: world and camera space are taken to be the same");
    for (const std::string_view size : {"angle", "radius"})
        if (b.given(size) && b.number(size) > 0)
            warnings.push_back("light '" + light.name + "': " + std::string(size) +
                               " is left out, the light is shaded as a point");

    BakedLight out;
    out.name = light.name;
    out.include = b.texts("include");
    out.exclude = b.texts("exclude");
    if (light.type == "sun") out.direct = bake_direct(b, LightKind::sun);
    else if (light.type == "point") out.direct = bake_direct(b, LightKind::point);
    else if (light.type == "spot") out.direct = bake_direct(b, LightKind::spot);
    else out.ambient = bake_ambient(b, light.type);
    return out;
}

}  // namespace relume
