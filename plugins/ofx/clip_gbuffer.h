// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <optional>
#include <vector>

#include "clip_image.h"
#include "describe.h"
#include "frame_planes.h"
#include "node_rig.h"
#include "relume/gbuffer.h"

namespace relume::ofx {

/// Where pixels of the node stand at one render scale.
struct PixelGrid {
    double scale_x = 1, scale_y = 1;
    double aspect = 1;     ///< width of a pixel by its height, at full scale
    OfxRectI frame{};      ///< what the source defines, in pixels, y up
    OfxRectD canonical{};  ///< the same, canonical
    OfxRectI display{};    ///< the project's format, in pixels

    bool is_proxy() const { return scale_x != 1 || scale_y != 1; }
    /// Pixels, y up, to the G-buffer's absolute coordinates: (0, 0) the display's top left pixel, y down.
    Window window(const OfxRectI& rect) const {
        return {rect.x1 - display.x1, display.y2 - rect.y2, rect.x2 - rect.x1, rect.y2 - rect.y1};
    }
};

/// The clips' images of one frame as a G-buffer: always the whole of what the source defines, so that what is decided
/// from pixels (encodings, the camera) is the same for every tile; it is decided once. Holds the images.
class ClipGBuffer {
public:
    /// Fetches the images, which asks the host. Errors: channel (no normal: names the clip).
    ClipGBuffer(const Instance& instance, double time, double scale_x, double scale_y, GBufferOptions options);

    const PixelGrid& grid() const { return grid_; }
    /// Brings them to arrays and understands those, which asks nobody and takes time, unless the frame is understood
    /// already. The G-buffer points into this, and may be read in `part` (pixels, y up).
    GBuffer understand(const OfxRectI& part, const std::atomic<bool>& cancel);

private:
    struct Input {
        const DataClip* clip;  ///< null: the source
        ClipImage image;
    };
    void set_grid(const Instance& instance, double time, double scale_x, double scale_y);

    PixelGrid grid_;
    GBufferOptions options_;
    std::vector<Input> inputs_;
    std::vector<FramePlanes> planes_;
};

/// The frames of clips that this process has understood. By their pixels alone: hosts give images the same name, or no
/// name, or another name each time.
UnderstoodFrames& understood_frames();

/// Whether the Normal clip is there and has an image: then clips are what a node without a file is about.
bool has_normal_clip(const Instance& instance);

/// The region that a clip defines, clipped to what is finite: a constant's is not.
std::optional<OfxRectD> defined_region(const Instance& instance, const char* clip, double time);
/// The project's format, canonical; nothing where the host does not say.
std::optional<OfxRectD> project_format(const Instance& instance);

}  // namespace relume::ofx
