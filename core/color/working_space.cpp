// SPDX-License-Identifier: Apache-2.0
#include "relume/working_space.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "relume/error.h"

namespace relume {

namespace {

// Whites: D65 (0.3127, 0.3290) as Rec.709 has it, ACES' own near D60 (SMPTE ST 2065-1).
constexpr WorkingSpace kSpaces[] = {
    {"lin_rec709",
     "Rec.709",
     {0.640, 0.330, 0.300, 0.600, 0.150, 0.060, 0.3127, 0.3290},
     "Linear Rec.709|Linear Rec.709 (sRGB)|Linear sRGB|lin_srgb|scene-linear Rec.709-sRGB|Utility - Linear - sRGB|Utility - Linear - Rec.709|Linear BT.709"},
    {"lin_rec2020",
     "Rec.2020",
     {0.708, 0.292, 0.170, 0.797, 0.131, 0.046, 0.3127, 0.3290},
     "Linear Rec.2020|Linear BT.2020|scene-linear Rec.2020|Utility - Linear - Rec.2020"},
    {"lin_p3d65",
     "P3-D65",
     {0.680, 0.320, 0.265, 0.690, 0.150, 0.060, 0.3127, 0.3290},
     "Linear P3-D65|Linear DCI-P3 D65|Linear Display P3|scene-linear P3-D65|Utility - Linear - P3-D65"},
    {"lin_ap0",
     "ACES AP0",
     {0.7347, 0.2653, 0.0000, 1.0000, 0.0001, -0.0770, 0.32168, 0.33767},
     "ACES2065-1|ACES - ACES2065-1|aces|scene-linear AP0|Linear AP0"},
    {"lin_ap1",
     "ACES AP1",
     {0.713, 0.293, 0.165, 0.830, 0.128, 0.044, 0.32168, 0.33767},
     "ACEScg|ACES - ACEScg|scene-linear AP1|Linear AP1"},
    {"lin_adobergb",
     "Adobe RGB",
     {0.640, 0.330, 0.210, 0.710, 0.150, 0.060, 0.3127, 0.3290},
     "Linear AdobeRGB|scene-linear AdobeRGB|Utility - Linear - Adobe RGB"},
    {"lin_ciexyzd65",
     "CIE XYZ, white D65",
     {1, 0, 0, 1, 0, 0, 0.3127, 0.3290},
     "CIE-XYZ-D65|Linear CIE-XYZ D65|CIE XYZ-D65|scene-linear CIE-XYZ-D65"},
};

std::string folded(std::string_view name) {
    std::string out;
    for (const char c : name)
        if (c != ' ' && c != '_' && c != '-') out += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    for (const std::string_view ending : {"scene", "display"})
        if (out.starts_with("lin") && out.ends_with(ending)) out.resize(out.size() - ending.size());
    return out;
}

bool goes_by(const WorkingSpace& space, std::string_view wanted) {
    if (folded(space.name) == wanted) return true;
    for (std::string_view rest = space.aliases; !rest.empty();) {
        const std::size_t bar = rest.find('|');
        if (folded(rest.substr(0, bar)) == wanted) return true;
        rest = bar == std::string_view::npos ? std::string_view{} : rest.substr(bar + 1);
    }
    return false;
}

/// XYZ of a colour of these x, y whose X + Y + Z is 1; primaries may have y = 0.
std::array<double, 3> direction(double x, double y) { return {x, y, 1 - x - y}; }

std::array<double, 3> white_xyz(double x, double y) { return {x / y, 1, (1 - x - y) / y}; }

}  // namespace

std::span<const WorkingSpace> working_spaces() { return kSpaces; }

const WorkingSpace* find_working_space(std::string_view name) {
    const std::string wanted = folded(name);
    const auto found =
        std::find_if(std::begin(kSpaces), std::end(kSpaces), [&](const WorkingSpace& s) { return goes_by(s, wanted); });
    return found == std::end(kSpaces) ? nullptr : found;
}

const WorkingSpace* find_working_space(const Chromaticities& chromaticities, double tolerance) {
    const auto found = std::find_if(std::begin(kSpaces), std::end(kSpaces), [&](const WorkingSpace& s) {
        for (std::size_t k = 0; k < chromaticities.size(); ++k)
            if (!(std::abs(s.chromaticities[k] - chromaticities[k]) < tolerance)) return false;
        return true;
    });
    return found == std::end(kSpaces) ? nullptr : found;
}

ColorMatrix concatenated(const ColorMatrix& a, const ColorMatrix& b) {
    ColorMatrix out{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            for (std::size_t k = 0; k < 3; ++k) out[3 * i + j] += a[3 * i + k] * b[3 * k + j];
    return out;
}

std::array<double, 3> transformed(const ColorMatrix& m, std::array<double, 3> v) {
    std::array<double, 3> out{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k) out[i] += m[3 * i + k] * v[k];
    return out;
}

ColorMatrix inverse(const ColorMatrix& m) {
    const auto cofactor = [&](std::size_t row, std::size_t column) {
        const std::size_t r0 = (row + 1) % 3, r1 = (row + 2) % 3, c0 = (column + 1) % 3, c1 = (column + 2) % 3;
        return m[3 * r0 + c0] * m[3 * r1 + c1] - m[3 * r0 + c1] * m[3 * r1 + c0];
    };
    const double determinant = m[0] * cofactor(0, 0) + m[1] * cofactor(0, 1) + m[2] * cofactor(0, 2);
    if (!(std::abs(determinant) > 1e-12) || !std::isfinite(determinant))
        throw Error(ErrorKind::value, "the primaries of a colour space lie on one line: its matrix has no inverse");
    ColorMatrix out{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) out[3 * i + j] = cofactor(j, i) / determinant;
    return out;
}

ColorMatrix rgb_to_xyz(const Chromaticities& c) {
    // The primaries as columns, each scaled so that their sum is the white (SMPTE RP 177-1993).
    ColorMatrix primaries{};
    for (std::size_t k = 0; k < 3; ++k) {
        const auto column = direction(c[2 * k], c[2 * k + 1]);
        for (std::size_t row = 0; row < 3; ++row) primaries[3 * row + k] = column[row];
    }
    const auto scale = transformed(inverse(primaries), white_xyz(c[6], c[7]));
    for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t k = 0; k < 3; ++k) primaries[3 * row + k] *= scale[k];
    return primaries;
}

ColorMatrix xyz_to_rgb(const Chromaticities& c) { return inverse(rgb_to_xyz(c)); }

ColorMatrix bradford(std::array<double, 2> from_white, std::array<double, 2> to_white) {
    // Sharpened cone responses (Lam 1985, as in ICC.1:2010 annex E).
    constexpr ColorMatrix kCones{0.8951, 0.2664, -0.1614, -0.7502, 1.7135, 0.0367, 0.0389, -0.0685, 1.0296};
    const auto from = transformed(kCones, white_xyz(from_white[0], from_white[1]));
    const auto to = transformed(kCones, white_xyz(to_white[0], to_white[1]));
    ColorMatrix scaled = kCones;
    for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t k = 0; k < 3; ++k) scaled[3 * row + k] *= to[row] / from[row];
    return concatenated(inverse(kCones), scaled);
}

ColorMatrix rgb_to_rgb(const Chromaticities& from, const Chromaticities& to) {
    const bool same_white = std::abs(from[6] - to[6]) < 1e-6 && std::abs(from[7] - to[7]) < 1e-6;
    const ColorMatrix xyz = rgb_to_xyz(from);
    return concatenated(xyz_to_rgb(to),
                        same_white ? xyz : concatenated(bradford({from[6], from[7]}, {to[6], to[7]}), xyz));
}

}  // namespace relume
