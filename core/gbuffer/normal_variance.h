// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "gbuffer/sampling.h"

namespace relume::gbuffer {

/// Where the sampled planes that judge the normals' lengths stand; `coverage` is empty when nothing tells it.
struct LengthSample {
    std::span<const SampledRow> rows;
    std::size_t normal = 0;
    std::span<const int> coverage;
};

/// Decides Impl::normal_variance, and says in the notes when normals are short for another reason.
///
/// A mean of unit vectors is shorter than 1 only where they differ, so only where the direction turns from pixel to
/// pixel: of two surfaces that meet at an angle φ it loses at most φ²/8 and turns by φ/2 on one side at least. Normals
/// that were never made unit (scaled, or interpolated between vertices) are short where nothing turns.
void judge_normal_variance(GBuffer::Impl& impl, const GBufferOptions& options, const LengthSample& sample);

}  // namespace relume::gbuffer
