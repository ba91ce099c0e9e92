// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "gbuffer/gbuffer_impl.h"

namespace relume::gbuffer {

/// One whole row of some raw planes, as float; planes[k][i] is column i of the k-th plane asked for.
struct SampledRow {
    int y = 0;
    std::vector<std::vector<float>> planes;
};

/// Rows spread over the data window, read for the sake of detection: few chunks of the file, whatever its size.
/// `dense` takes every chunk. The order is from top to bottom and depends on nothing but the windows. `threads` 0: all.
std::vector<SampledRow> sample_rows(const GBuffer::Impl& impl, std::span<const int> raws, int threads,
                                    bool dense = false);

/// A hash of the memory that sample_rows takes its numbers from, of a frame in memory.
Hash hash_of_rows(const GBuffer::Impl& impl, std::span<const int> raws, int threads, bool dense);

/// Sampled rows and where in them the first plane of a channel stands; negative when there is no such channel.
struct CameraSample {
    std::span<const SampledRow> rows;
    int position = -1;
    int depth = -1;
    int normal = -1;
};

/// What the normals look like.
struct DirectionStatistics {
    std::int64_t samples = 0;  ///< finite and not background
    double negative = 0;       ///< share with a component below -0.01
    double unit = 0;           ///< share of unit length, within 5 %
    double unit_decoded = 0;   ///< share of unit length after 2v - 1, within 5 %
    double near_unit = 0;      ///< share of unit length within 0.2 % or exactly 0
};
DirectionStatistics direction_statistics(std::span<const SampledRow> rows, std::size_t first_plane);

/// Smallest and largest finite value of a plane, and whether any value is below `threshold`.
struct Range {
    double min = 0;
    double max = 0;
    bool any = false;
};
Range value_range(std::span<const SampledRow> rows, std::size_t plane);

}  // namespace relume::gbuffer
