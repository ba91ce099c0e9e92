// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "relume/gbuffer.h"

namespace relume {

/// Pixels that are read and shaded in one go: inputs and outputs of a tile stay in the L2 cache.
inline constexpr int kTilePixels = 4096;

/// Serves canonical pixels of a G-buffer to the shading pass, a band of rows at a time, with no state shared between
/// threads: each thread brings its own Scratch.
class BandReader {
public:
    /// Resolves the requests against the G-buffer. Throws Error(channel) that names a request nothing can answer.
    /// The G-buffer must outlive the reader.
    BandReader(const GBuffer& gbuffer, std::span<const ChannelRequest> requests);
    ~BandReader();

    class Scratch {
    public:
        Scratch();
        ~Scratch();
        Scratch(Scratch&&) noexcept;
        struct Impl;
        std::unique_ptr<Impl> impl;
    };

    /// Rows that are cheapest to load together (aligned to the top of the data window); ≥ 1.
    int band_rows() const;

    /// Decodes rows [y, y + rows) (absolute) into `scratch`. From memory this costs nothing.
    void load(int y, int rows, Scratch& scratch) const;

    /// Canonical pixels [x, x + count) of row y, which lies in the loaded band: one pointer per component of each
    /// request, in the requests' order, each to `count` contiguous floats (std::uint32_t for IDs). Points straight into
    /// the caller's memory where that is float32, contiguous and needs no change, else into `scratch`; valid until the
    /// next call with the same scratch. What a pixel gets does not depend on x, count or the band.
    std::span<const float* const> segment(int y, int x, int count, Scratch& scratch) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace relume
