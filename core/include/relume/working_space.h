// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string_view>

#include "relume/export.h"

namespace relume {

/// CIE x, y of red, green, blue and white, as in an EXR's attribute `chromaticities`.
using Chromaticities = std::array<double, 8>;
/// Row-major, for column vectors.
using ColorMatrix = std::array<double, 9>;

/// A scene-linear RGB space that colours may be in. Colours of lights are in the working space of the G-buffer.
struct WorkingSpace {
    std::string_view name;   ///< "lin_rec709": the ASWF Color Interop Forum's name without "_scene"
    std::string_view label;  ///< "Rec.709"
    Chromaticities chromaticities;
    std::string_view aliases;  ///< '|'-separated: what OpenColorIO configs and programs call it
};

/// lin_rec709, lin_rec2020, lin_p3d65, lin_ap0, lin_ap1, lin_adobergb, lin_ciexyzd65.
RELUME_API std::span<const WorkingSpace> working_spaces();

/// By name or alias; case, blanks, '_' and '-' do not count, nor does an ending "_scene" or "_display" ("ACEScg",
/// "lin_ap1_scene", "Linear Rec.709 (sRGB)"). nullptr when relume does not know it (an OpenColorIO config still may).
RELUME_API const WorkingSpace* find_working_space(std::string_view name);

/// The space with these chromaticities, each within `tolerance`, or nullptr.
RELUME_API const WorkingSpace* find_working_space(const Chromaticities& chromaticities, double tolerance = 2e-3);

/// Linear RGB to CIE XYZ, white having Y = 1 (SMPTE RP 177-1993, section 3.3). Exact up to rounding in double.
RELUME_API ColorMatrix rgb_to_xyz(const Chromaticities& chromaticities);
/// Its inverse.
RELUME_API ColorMatrix xyz_to_rgb(const Chromaticities& chromaticities);

/// Takes XYZ as seen under one white to what looks the same under another (linear Bradford, Lam 1985). Whites as x, y.
RELUME_API ColorMatrix bradford(std::array<double, 2> from_white, std::array<double, 2> to_white);

/// Linear RGB of one space to that of another; whites that differ by more than rounding (1e-6) are adapted by Bradford.
/// White (1, 1, 1) stays white.
RELUME_API ColorMatrix rgb_to_rgb(const Chromaticities& from, const Chromaticities& to);

/// The matrix that does b, then a.
RELUME_API ColorMatrix concatenated(const ColorMatrix& a, const ColorMatrix& b);
RELUME_API std::array<double, 3> transformed(const ColorMatrix& m, std::array<double, 3> v);
/// Errors: value (a matrix that has no inverse).
RELUME_API ColorMatrix inverse(const ColorMatrix& m);

}  // namespace relume
