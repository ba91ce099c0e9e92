// SPDX-License-Identifier: Apache-2.0
// The tables of the lights. A new light is a row group here, its constants in bake.cpp and its direction and falloff in
// relume/shading/kernel.h.
#include <algorithm>
#include <array>

#include "relume/light.h"

namespace relume {

namespace {

constexpr Parameter color_row(std::string_view name, std::string_view label, std::string_view unit,
                              std::string_view help) {
    return {.name = name,
            .type = ParameterType::color,
            .value = {1, 1, 1},
            .min = 0,
            .soft_max = 10,
            .unit = unit,
            .label = label,
            .help = help};
}

constexpr Parameter vector_row(std::string_view name, std::string_view label, std::array<double, 3> value,
                               std::string_view unit, std::string_view help, bool has_default = true) {
    return {.name = name,
            .type = ParameterType::vector,
            .value = value,
            .soft_min = -10,
            .soft_max = 10,
            .unit = unit,
            .label = label,
            .help = help,
            .has_default = has_default};
}

constexpr Parameter kCommon[] = {
    color_row("color", "Color", "",
              "Tint, scene-linear in the working space; multiplies irradiance, intensity or power."),
    {.name = "exposure",
     .value = {0},
     .soft_min = -10,
     .soft_max = 10,
     .unit = "stops",
     .label = "Exposure",
     .help = "Brightness in stops: each doubles the light."},
    {.name = "enabled",
     .type = ParameterType::boolean,
     .value = {1},
     .min = 0,
     .max = 1,
     .label = "Enabled",
     .help = "Off: as if the light were not in the rig."},
    {.name = "space",
     .type = ParameterType::choice,
     .label = "Space",
     .help =
         "Space of the light's positions and directions: the world, or the camera (+X right, +Y up, looking down −Z).",
     .choices = "world|camera"},
    {.name = "diffuse",
     .value = {1},
     .min = 0,
     .soft_max = 2,
     .label = "Diffuse",
     .help = "Multiplies the light's share in the diffuse lobe."},
    {.name = "specular",
     .value = {1},
     .min = 0,
     .soft_max = 2,
     .label = "Specular",
     .help = "Multiplies the light's share in the specular lobe."},
    {.name = "transmission",
     .value = {1},
     .min = 0,
     .soft_max = 2,
     .label = "Transmission",
     .help = "Multiplies the light's share in what comes through the surface."},
    {.name = "include",
     .type = ParameterType::text_list,
     .label = "Include",
     .help =
         "Light linking: Cryptomatte name patterns of what the light reaches (\"object:NAME\": objects alone); empty is everything."},
    {.name = "exclude",
     .type = ParameterType::text_list,
     .label = "Exclude",
     .help = "Light linking: Cryptomatte name patterns of what the light does not reach."},
};

constexpr Parameter kSun[] = {
    vector_row("direction", "Direction", {0, 0, -1}, "",
               "Where the light travels: a noon sun in a Z-up world is [0, 0, −1]. Any length but 0."),
    color_row("irradiance", "Irradiance", "W/m²", "Irradiance of a surface that faces the sun; a number or RGB."),
    {.name = "angle",
     .value = {0},
     .min = 0,
     .max = 180,
     .soft_max = 10,
     .unit = "degrees",
     .label = "Angle",
     .help = "Angular diameter. Shading treats the sun as a point at infinity; a value above 0 is reported."},
};

constexpr Parameter kPosition =
    vector_row("position", "Position", {0, 0, 0}, "scene units", "Where the light is.", false);
constexpr Parameter kIntensity =
    color_row("intensity", "Intensity", "W/sr",
              "Radiant intensity; irradiance at distance d is intensity/d². A number or RGB. Give this or power.");
constexpr Parameter kPower = {
    .name = "power",
    .min = 0,
    .soft_max = 1000,
    .unit = "W",
    .label = "Power",
    .help = "Radiant flux, as Blender's lamps have it: intensity = power/4π. Give this or intensity.",
    .has_default = false};
constexpr Parameter kRadius = {
    .name = "radius",
    .min = 0,
    .soft_max = 1,
    .unit = "scene units",
    .label = "Radius",
    .help = "Radius of the lamp. Shading treats it as a point; a value above 0 is reported."};
constexpr Parameter kAttenuation = {.name = "attenuation",
                                    .type = ParameterType::number_list,
                                    .min = 0,
                                    .label = "Attenuation",
                                    .help = "[a, b, c]: falls off as 1/(a + b·d + c·d²) instead of 1/d².",
                                    .count = 3,
                                    .has_default = false};

constexpr Parameter kPoint[] = {kPosition, kIntensity, kPower, kRadius, kAttenuation};

constexpr Parameter kSpot[] = {
    kPosition,
    kIntensity,
    kPower,
    kRadius,
    kAttenuation,
    vector_row("direction", "Direction", {0, 0, -1}, "", "Where the cone points. Any length but 0."),
    {.name = "cone_angle",
     .value = {45},
     .min = 0,
     .max = 180,
     .soft_max = 180,
     .unit = "degrees",
     .label = "Cone angle",
     .help = "Full angle of the cone."},
    {.name = "blend",
     .value = {0.15},
     .min = 0,
     .max = 1,
     .label = "Blend",
     .help = "Softness of the cone's edge: 0 is hard, 1 fades from the axis."},
    {.name = "falloff",
     .type = ParameterType::choice,
     .label = "Falloff",
     .help =
         "Across the soft edge: smoothstep in the cosine (Blender 4 and later); blender3, the same times the cosine; linear in "
         "the angle (Mitsuba); step, a hard edge whatever the blend.",
     .choices = "smoothstep|blender3|linear|step"},
};

constexpr Parameter kSky[] = {
    vector_row("up", "Up", {0, 0, 1}, "", "Towards the zenith. Any length but 0."),
    color_row("sky_color", "Sky color", "W/m²", "Irradiance of a surface that faces up."),
    {.name = "ground_color",
     .type = ParameterType::color,
     .value = {0, 0, 0},
     .min = 0,
     .unit = "W/m²",
     .label = "Ground color",
     .help = "Irradiance of a surface that faces down; between, a blend by ½ + ½·n·up."},
};

constexpr Parameter kBounce[] = {
    vector_row("direction", "Direction", {0, 0, 1}, "", "Where the light travels. Any length but 0."),
    color_row("irradiance", "Irradiance", "W/m²",
              "Irradiance of a surface that faces the light; it fades as ½ + ½·cos around the surface."),
    {.name = "clamp",
     .type = ParameterType::boolean,
     .min = 0,
     .max = 1,
     .label = "Clamp",
     .help = "Fade as max(0, cos) instead: no light from behind."},
};

constexpr Parameter kAmbient[] = {
    color_row("irradiance", "Irradiance", "W/m²", "The same irradiance on every surface."),
};

template <std::size_t N> constexpr auto with_common(const Parameter (&own)[N]) {
    std::array<Parameter, N + std::size(kCommon)> all{};
    std::copy(std::begin(kCommon), std::end(kCommon), all.begin());
    std::copy(std::begin(own), std::end(own), all.begin() + std::size(kCommon));
    return all;
}

constexpr auto kSunAll = with_common(kSun);
constexpr auto kPointAll = with_common(kPoint);
constexpr auto kSpotAll = with_common(kSpot);
constexpr auto kSkyAll = with_common(kSky);
constexpr auto kBounceAll = with_common(kBounce);
constexpr auto kAmbientAll = with_common(kAmbient);

constexpr LightType kTypes[] = {
    {"sun", "Sun", "Parallel light from far away.", kSunAll},
    {"point", "Point", "Light in all directions from one point, by default falling with the square of the distance.",
     kPointAll},
    {"spot", "Spot", "A point light within a cone.", kSpotAll},
    {"sky", "Sky", "A hemisphere above and one below; reaches the diffuse part alone, times ambient occlusion.",
     kSkyAll},
    {"bounce", "Bounce",
     "Soft light from one side (back, rim or bounce light); diffuse part alone, times ambient occlusion.", kBounceAll},
    {"ambient", "Ambient", "Constant light; diffuse part alone, times ambient occlusion.", kAmbientAll},
};

}  // namespace

std::span<const LightType> light_types() { return kTypes; }

const LightType* find_light_type(std::string_view name) {
    const auto found =
        std::find_if(std::begin(kTypes), std::end(kTypes), [&](const LightType& t) { return t.name == name; });
    return found == std::end(kTypes) ? nullptr : found;
}

}  // namespace relume
