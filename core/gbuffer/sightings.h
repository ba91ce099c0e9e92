// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "gbuffer/camera_fit.h"
#include "gbuffer/gbuffer_impl.h"
#include "gbuffer/sampling.h"

namespace relume::gbuffer {

/// Positions that can be trusted, and the pixels that see them, spread over the rows: those whose two neighbours on
/// either side are surface too, where it goes on evenly. `first` is the position's first plane in the rows, `depth`
/// that of the depth channel or negative.
std::vector<Sighting> sightings(const GBuffer::Impl& impl, std::span<const SampledRow> rows, int first, int depth);

}  // namespace relume::gbuffer
