// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace relume {

enum class Projection : std::uint8_t { perspective, orthographic };

/// A pinhole or orthographic camera over absolute pixel coordinates, so that crops, overscan, lens shift and pixel
/// aspect need no further words. In camera space +X is right, +Y up, and the camera looks down −Z.
///
/// For the pixel in column i and row j (centre (i + ½, j + ½)), with X = (i + ½)·x_scale + x_offset and
/// Y = (j + ½)·y_scale + y_offset (y_scale < 0: rows run down):
///   perspective:  the ray leaves the origin towards (X, Y, −1); a point at planar depth d is d·(X, Y, −1);
///   orthographic: the ray leaves (X, Y, 0) towards (0, 0, −1).
struct Camera {
    Projection projection = Projection::perspective;
    /// Row-major, for column vectors: world = M · camera. Rigid (rotation and translation) up to rounding.
    std::array<double, 16> camera_to_world{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    double x_scale = 1;
    double x_offset = 0;
    double y_scale = -1;
    double y_offset = 0;

    std::array<double, 3> position() const { return {camera_to_world[3], camera_to_world[7], camera_to_world[11]}; }
    /// Unit vector the camera looks along, in world space.
    std::array<double, 3> forward() const { return {-camera_to_world[2], -camera_to_world[6], -camera_to_world[10]}; }
};

}  // namespace relume
