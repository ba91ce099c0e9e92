// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "io/exr.h"
#include "oiio/block_cache.h"
#include "relume/gbuffer.h"
#include "relume/relight.h"
#include "relume/rig.h"

namespace relume::oiio {

/// Rows of a strip, and the width of a tile: what is rendered at once at the least.
inline constexpr int kTile = 64;

/// One picture of a frame.
struct Picture {
    std::string name;  ///< as the layer or part that `relume relight` writes
    int components = 3;
};

/// One frame's relight, rendered by strips where somebody asks for pixels. Thread-safe: what several threads ask for is
/// rendered once, by the one that came first. A file's scanlines come in whole rows, so that a tile costs its row of
/// tiles; the others of that row are then there.
class RelitFrame {
public:
    /// Understands the G-buffer. Errors: those of GBuffer::read, and a rig that fits no frame.
    RelitFrame(Rig rig, std::string key);

    /// The frame of this rig: the one that is in memory, unless one of its files has changed since.
    static std::shared_ptr<RelitFrame> get(Rig rig);

    const std::vector<Picture>& pictures() const { return pictures_; }
    PixelType type() const { return type_; }
    const Window& window() const { return gbuffer_.data_window(); }
    /// The header that `relume relight` would write, its first part: windows and metadata.
    const io::Part& header() const { return header_; }
    std::string_view working_space() const { return gbuffer_.working_space(); }

    /// Pixels of [x, x_end) × [y, y_end) (of the data window, in its coordinates) of one picture, components
    /// interleaved, into rows `stride` bytes apart. `ahead`: rows below them that will be asked for next, rendered
    /// along with them where these are not there. Errors: those of relight(), and where all rows have been rendered
    /// that of a frame of NaN.
    void read(int picture, int x, int x_end, int y, int y_end, std::byte* out, std::ptrdiff_t stride, int ahead = 0);

    const std::string& key() const { return key_; }
    /// Rows that were rendered so far, those that were thrown away and rendered again counted again.
    std::int64_t rendered_rows() const { return rendered_rows_; }

private:
    struct Render {
        std::shared_ptr<const Block> block;
        RelightReport report;
    };
    Render render(int first_strip, int strips);
    void take_note(int first_strip, int strips, const RelightReport& report);
    std::size_t strip_bytes() const;

    const std::string key_;
    const Rig rig_;
    const GBuffer gbuffer_;
    io::Part header_;
    std::vector<Picture> pictures_;
    PixelType type_ = PixelType::half;

    std::mutex mutex_;
    std::condition_variable rendered_;
    std::vector<std::weak_ptr<const Block>> strips_;  ///< held by the cache of blocks
    std::vector<bool> busy_;                          ///< being rendered by some thread
    std::vector<bool> seen_;                          ///< rendered at least once
    std::int64_t surfaces_ = 0;                       ///< pixels that hold one, of the strips that were seen
    std::map<std::string, std::int64_t> nonfinite_;   ///< channels that were finite in none of them
    std::atomic<std::int64_t> rendered_rows_{0};
};

}  // namespace relume::oiio
