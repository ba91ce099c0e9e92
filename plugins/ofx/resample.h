// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "clip_image.h"
#include "file_frames.h"

namespace relume::ofx {

/// How a file's pixels lie under the node's: x of the node is x of the file's display window times `step` plus
/// `offset`; y, up in the node and down in the file, likewise from the display window's lower edge.
struct Placement {
    double step_x = 1, offset_x = 0;
    double step_y = 1, offset_y = 0;
    bool is_identity() const;
};

/// Where the file's frame lies in the node: its display window's lower left corner on the project's.
Placement placement(const FileFrame& frame, double scale_x, double scale_y, double aspect, double origin_x,
                    double origin_y);

/// The node's pixels of `rect`, R, G, B, A, row 0 at the top: the file's own where the placement is the identity, else
/// the mean of what each pixel covers. Outside of the file's data window is 0. What a pixel gets does not depend on
/// `rect`.
std::vector<float> resample(const FileFrame& frame, const Placement& placement, const OfxRectI& rect);

/// The same, of a placement that is the identity, into rows of floats: the top one at `to`, each next one `row_bytes`
/// before it.
void copy_rows(const FileFrame& frame, const Placement& placement, const OfxRectI& rect, std::byte* to,
               std::ptrdiff_t row_bytes);

}  // namespace relume::ofx
