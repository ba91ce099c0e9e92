// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "relume/export.h"
#include "relume/gbuffer.h"
#include "relume/image.h"
#include "relume/rig.h"

namespace relume {

struct RelightOptions {
    int threads = 0;                            ///< 0: as many as the process may use
    const std::atomic<bool>* cancel = nullptr;  ///< polled every few rows; relight then throws Error(cancelled)
    std::function<void(double)> progress;       ///< share done, 0…1, from any thread
    /// relight() alone: the part of the data window that is wanted, in its coordinates. The planes are of this size,
    /// and pixels get the same bits as in the whole.
    std::optional<Window> region;
    /// relight() alone: every `step`-th pixel of every `step`-th row, from the first on. The planes have as many (the
    /// last ones count), and pixels get the same bits as in the whole.
    int step = 1;
};

/// What happened to the pixels.
struct RelightReport {
    std::int64_t pixels = 0;
    std::int64_t shaded = 0;
    std::int64_t background = 0;                    ///< passed through
    std::map<std::string, std::int64_t> nonfinite;  ///< pixels with NaN or infinity, by channel; they are left black
    std::vector<std::string> warnings;
    std::vector<std::string> notes;  ///< what was decided where the rig left it open, one sentence each
    double seconds = 0;
};

/// One picture of the result: the beauty (R, G, B, A) or an AOV (R, G, B).
struct AovInfo {
    std::string name;  ///< "beauty", "diffuse", "specular", "transmission", "light:key", …
    int components = 3;
};

/// The pictures that a rig makes, beauty first. Errors: rig (an AOV that names no light, with the nearest name).
RELUME_API std::vector<AovInfo> aovs(const Rig& rig);

/// Relights into the caller's memory: for each AOV of aovs(rig) that `out` names, one plane per component over the
/// data window (or the region), row 0 at the top, half or float32. Zero lights is an error (rig), a region that leaves
/// the data window one of value, and so is (format) a channel that is NaN or infinite in every pixel that holds a
/// surface, where the whole frame is asked for.
RELUME_API RelightReport relight(const GBuffer& gbuffer, const Rig& rig,
                                 const std::map<std::string, std::vector<Plane>>& out,
                                 const RelightOptions& options = {});

/// Relights into an EXR, in bands: the whole frame is never in memory. Written to a temporary name, then renamed.
RELUME_API RelightReport relight_to_file(const GBuffer& gbuffer, const Rig& rig, const std::filesystem::path& path,
                                         const RelightOptions& options = {});

}  // namespace relume
