// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>

#include "gbuffer/gbuffer_impl.h"
#include "gbuffer/sampling.h"
#include "relume/gbuffer.h"

namespace relume::gbuffer {

/// Of the sampled numbers, to tell whether they are the same.
std::array<std::uint64_t, 2> hash_of(std::span<const SampledRow> rows);

/// The understanding of a frame in memory that is set up but for finish(): one that `known` remembers, if every look
/// at pixels that led to it would see the same again, else a new one.
std::unique_ptr<GBuffer::Impl> understand_once(std::unique_ptr<GBuffer::Impl> fresh,
                                               const std::map<std::string, MemoryChannel>& channels,
                                               const GBufferOptions& options, UnderstoodFrames::Impl& known);

}  // namespace relume::gbuffer
