// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gbuffer/dense.h"
#include "relume/camera.h"
#include "relume/image.h"

namespace relume::gbuffer {

/// A surface point and the pixel coordinates (absolute, centres at ½) that see it.
struct Sighting {
    double u = 0;
    double v = 0;
    Vector3 point{};
    double depth = 0;  ///< as the depth channel has it; 0 when there is none
};

struct CameraFit {
    Camera camera;
    double median_error = 0;  ///< pixels
    bool planar = false;      ///< all points on a plane: a centred lens had to be assumed
    bool centred = false;     ///< square pixels and a centred lens explain the points as well as a free lens does
    bool mirrored = false;    ///< the world is left-handed
};

/// Recovers the camera from points and the pixels that see them: a direct linear transform (Hartley, Zisserman 2004,
/// algorithm 7.1) in normalised coordinates, refined by Levenberg–Marquardt on the reprojection error without skew,
/// with the farthest outliers left out; an orthographic camera where parallel rays explain the points as well. Nothing
/// when the points do not determine a camera; `why` then says why not.
std::optional<CameraFit> fit_camera(std::span<const Sighting> sightings, const Window& display, double pixel_aspect,
                                    std::string& why);

/// A 3×4 projection (rows give u·w, v·w and w of pixel coordinates) as a camera. Nothing when it is singular.
std::optional<Camera> camera_from_projection(const std::array<double, 12>& projection);
/// The same for parallel rays: w is constant.
std::optional<Camera> camera_from_affine(const std::array<double, 12>& projection);

/// Depth of a point along the view axis.
double planar_depth(const Camera& camera, const Vector3& point);

/// Pixel coordinates that see `point`; infinite when it is behind the camera.
std::array<double, 2> project(const Camera& camera, const Vector3& point);

/// Median distance in pixels between where the camera sees the points and where they were seen; infinite without any.
double median_reprojection_error(const Camera& camera, std::span<const Sighting> sightings);

}  // namespace relume::gbuffer
