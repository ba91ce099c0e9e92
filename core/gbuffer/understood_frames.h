// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <string>

#include "gbuffer/gbuffer_impl.h"
#include "relume/gbuffer.h"

namespace relume::gbuffer {

/// The understanding of a frame in memory that is set up but for finish(): one that `known` remembers, if every look
/// at pixels that led to it would see the same again, else a new one.
std::unique_ptr<GBuffer::Impl> understand_once(std::unique_ptr<GBuffer::Impl> fresh,
                                               const std::map<std::string, MemoryChannel>& channels,
                                               const GBufferOptions& options, UnderstoodFrames::Impl& known);

}  // namespace relume::gbuffer
