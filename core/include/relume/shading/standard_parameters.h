// SPDX-License-Identifier: Apache-2.0
#pragma once

// Rows that many models share, so that a channel name means the same in all of them. Each takes the slot and, where
// models differ, the default.

#include "relume/parameter.h"

namespace relume::row {

constexpr Parameter color(std::string_view name, int slot, double r, double g, double b, std::string_view label,
                          std::string_view help, double max = kUnbounded) {
    return {.name = name,
            .type = ParameterType::color,
            .value = {r, g, b},
            .min = 0,
            .max = max,
            .label = label,
            .help = help,
            .slot = slot};
}

constexpr Parameter scalar(std::string_view name, int slot, double value, double min, double max,
                           std::string_view label, std::string_view help, double soft_min = 0, double soft_max = 1,
                           std::string_view unit = {}) {
    return {.name = name,
            .value = {value},
            .min = min,
            .max = max,
            .soft_min = soft_min,
            .soft_max = soft_max,
            .unit = unit,
            .label = label,
            .help = help,
            .slot = slot};
}

constexpr Parameter boolean(std::string_view name, int slot, bool value, std::string_view label,
                            std::string_view help) {
    return {.name = name,
            .type = ParameterType::boolean,
            .value = {value ? 1. : 0.},
            .min = 0,
            .max = 1,
            .label = label,
            .help = help,
            .slot = slot};
}

constexpr Parameter choice(std::string_view name, int slot, int value, std::string_view choices, std::string_view label,
                           std::string_view help) {
    return {.name = name,
            .type = ParameterType::choice,
            .value = {static_cast<double>(value)},
            .label = label,
            .help = help,
            .choices = choices,
            .slot = slot};
}

constexpr Parameter table(std::string_view name, int slot, std::string_view label, std::string_view help) {
    return {.name = name, .type = ParameterType::table, .label = label, .help = help, .slot = slot};
}

constexpr Parameter base_color(int slot, double r = 0.8, double g = 0.8, double b = 0.8) {
    return color("base_color", slot, r, g, b, "Base color",
                 "Reflectance of the surface: the diffuse albedo of a dielectric, F0 of a metal. Scene-linear.");
}
/// A scalar row that says how wide a highlight is.
constexpr Parameter wide(Parameter parameter, LobeWidth lobe_width) {
    parameter.lobe_width = lobe_width;
    return parameter;
}
constexpr Parameter roughness(int slot, double value = 0.5) {
    return wide(scalar("roughness", slot, value, 0, 1, "Roughness", "Perceptual roughness; alpha is its square."),
                LobeWidth::roughness);
}
constexpr Parameter metallic(int slot) {
    return scalar("metallic", slot, 0, 0, 1, "Metallic", "0 is a dielectric, 1 a metal; between, a blend of both.");
}
constexpr Parameter specular(int slot) {
    return scalar("specular", slot, 0.5, 0, kUnbounded, "Specular",
                  "Reflectance of a dielectric at normal incidence in units of 8 %: 0.5 is 4 %.");
}
constexpr Parameter emission(int slot) {
    return color("emission", slot, 0, 0, 0, "Emission",
                 "Radiance that the surface emits, W/(sr·m²); added once, no light changes it.");
}
constexpr Parameter ambient(int slot) {
    return color("ambient", slot, 0, 0, 0, "Ambient", "Constant light: adds base_color · ambient · ambient_occlusion.");
}
constexpr Parameter anisotropy(int slot, std::string_view name = "anisotropy", double min = -1) {
    return scalar(name, slot, 0, min, 1, "Anisotropy", "Stretches the highlight along the tangent; 0 is isotropic.",
                  min);
}
constexpr Parameter specular_tint(int slot) {
    return scalar("specular_tint", slot, 0, 0, 1, "Specular tint",
                  "Colours a dielectric's highlight at normal incidence with the hue of the base color.");
}
constexpr Parameter sheen(int slot) {
    return scalar("sheen", slot, 0, 0, 1, "Sheen", "A soft rim of light at grazing angles, as cloth has.");
}
constexpr Parameter sheen_tint(int slot) {
    return scalar("sheen_tint", slot, 0.5, 0, 1, "Sheen tint",
                  "0: the sheen is white; 1: it has the hue of the base color.");
}
constexpr Parameter clearcoat(int slot) {
    return scalar("clearcoat", slot, 0, 0, 1, "Clearcoat",
                  "Strength of a second, colourless highlight on top, as of lacquer.");
}
constexpr Parameter specular_color(int slot, double value) {
    return color(
        "specular_color", slot, value, value, value, "Specular color",
        "Factor of the highlight. Plausible: 0.02 to 0.05 for dielectrics, grey; 0.5 to 1 for metals. Plain forms need more.");
}
constexpr Parameter exponent(int slot, double value, double max, LobeWidth lobe_width) {
    return wide(scalar("exponent", slot, value, 0, kUnbounded, "Exponent",
                       "Shininess: the higher, the smaller the highlight.", 1, max),
                lobe_width);
}
constexpr Parameter width(int slot) {
    return wide(
        scalar(
            "width", slot, 0.3, 0, 1, "Width",
            "Width of the highlight in the half angle, about radians: the root mean square slope along one direction, times √2.",
            0.01, 1),
        LobeWidth::alpha);
}
constexpr Parameter sss_color(int slot) {
    return color(
        "sss_color", slot, 0, 0, 0, "SSS color",
        "Strength and colour of a cheap stand-in for subsurface scattering, brightest with the light behind the viewer; 0 is off.");
}
constexpr Parameter sss_anisotropy(int slot) {
    return scalar("sss_anisotropy", slot, 0.5, -0.9, 0.9, "SSS anisotropy",
                  "Henyey–Greenstein's g of that scattering: 0 even, towards 1 peaked.", -0.9, 0.9);
}
constexpr Parameter energy_conserving(int slot) {
    return boolean(
        "energy_conserving", slot, true, "Energy conserving",
        "On: normalised, so that the albedo is base_color. Off: the plain textbook form, without 1/π and normalisation.");
}

}  // namespace relume::row
