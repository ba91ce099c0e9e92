// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "relume/gbuffer.h"

namespace relume::gbuffer {

/// Gives back what reading the files keeps for the next read: a few chunks, packed and unpacked, for each thread that
/// has read, which is some 10 MB of a 4K frame and thread. For G-buffers that are kept in case they come again; reading
/// goes on whenever it likes. The number of decoders that had some.
int release_buffers(const GBuffer& gbuffer);

}  // namespace relume::gbuffer
