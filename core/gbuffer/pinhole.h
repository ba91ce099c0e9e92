// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "gbuffer/camera_fit.h"
#include "gbuffer/dense.h"

namespace relume::gbuffer {

/// A pinhole whose own axes run right, down and forward, in the normalised coordinates of the fit.
struct Pinhole {
    double fx = 1, fy = 1, cx = 0, cy = 0;
    Matrix<3> rotation{};
    Vector3 translation{};
};

/// What the fit works on: centred and scaled points and pixels, so that the normal equations are well conditioned.
struct Normalised {
    std::vector<Sighting> sightings;
    double u0 = 0, v0 = 0, pixel_scale = 1;  ///< u' = (u − u0)·pixel_scale
    Vector3 centre{};
    double point_scale = 1;  ///< p' = (p − centre)·point_scale, z negated when mirrored
    bool mirrored = false;
};

Normalised normalise(std::span<const Sighting> sightings);

/// Splits a projection (rows m, last column t) into lens and pose. Nothing when it is singular.
std::optional<Pinhole> decompose(std::array<Vector3, 3> m, Vector3 t);

/// Minimises the squared reprojection error of the kept sightings. `free_lens` lets all four numbers of the lens move,
/// else the focal length alone with fy = fx·aspect.
void refine(Pinhole& pinhole, std::span<const Sighting> sightings, std::span<const std::uint8_t> kept, bool free_lens,
            double aspect);

/// Pixel error of one sighting, in normalised coordinates; infinite behind the camera.
Vector<2> residual(const Pinhole& pinhole, const Sighting& sighting);

/// Points on one plane: `axes` are two directions in it and its normal. By the depths that the sightings hold, else by
/// a centred lens.
std::optional<Pinhole> planar_fit(const Normalised& points, const Matrix<3>& axes, const Window& display,
                                  double aspect);

/// Back to pixels and world.
Camera to_camera(const Pinhole& pinhole, const Normalised& points);

/// An orthographic camera whose u grows along `across` and v along `down` (pixels per world unit), and that sees
/// `through` at (u, v).
std::optional<Camera> orthographic(Vector3 across, Vector3 down, const Vector3& through, double u, double v);

}  // namespace relume::gbuffer
