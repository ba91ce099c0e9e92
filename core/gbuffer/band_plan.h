// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "gbuffer/gbuffer_impl.h"
#include "gbuffer/pixel_steps.h"

namespace relume::gbuffer {

/// Rows that are read together where a chunk of a file has this many.
constexpr int rows_of_band(int rows_per_chunk) {
    constexpr int kLeast = 16;
    const int rows = rows_per_chunk > 0 ? rows_per_chunk : 1;
    return (kLeast + rows - 1) / rows * rows;
}

struct PlannedRaw {
    RawPlane plane;
    bool integer = false;  ///< read as unsigned integers
};

/// What must be read and computed to answer requests: registers [0, raws.size()) hold raw planes, the others results.
struct BandPlan {
    /// Throws Error(channel) that names a request nothing can answer.
    BandPlan(const GBuffer::Impl& source, std::span<const ChannelRequest> requests);

    std::vector<PlannedRaw> raws;
    std::vector<Step> steps;
    std::vector<int> outputs;  ///< registers, in the requests' order
    std::size_t registers = 0;
    std::vector<int> neighbours;  ///< raw registers that repairs look at beside the run
    int chunk_rows = 0;           ///< of the part whose samples are repaired, and the row that its chunks count from
    int chunk_top = 0;
};

}  // namespace relume::gbuffer
