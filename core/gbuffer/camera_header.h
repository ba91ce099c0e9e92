// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gbuffer/channel_rules.h"
#include "io/exr.h"
#include "relume/camera.h"

namespace relume::gbuffer {

/// One reading of what a header says of the camera. Headers leave conventions open, so there are several: the positions
/// tell which is meant, else the most plausible one is taken.
struct HeaderCamera {
    Camera camera;
    bool has_lens = false;   ///< the numbers of the lens are in the header too
    double implausible = 0;  ///< smaller is better
    std::string reason;      ///< "worldToNDC read as -1..1 with y up"
};

/// All readings, the most plausible first. Empty when the header has no camera.
std::vector<HeaderCamera> header_cameras(const io::Header& header, Producer producer, const Window& display,
                                         double pixel_aspect);

/// Half the width of the picture at distance 1, where the header states a field of view or a focal length.
struct HeaderLens {
    double half_width = 0;
    std::string reason;
};
std::optional<HeaderLens> header_lens(const io::Header& header);

/// Lens numbers of a camera that shows ±half_width (at distance 1, or of the world when orthographic) across the
/// display window, centred.
void set_lens(Camera& camera, const Window& display, double pixel_aspect, double half_width);

}  // namespace relume::gbuffer
