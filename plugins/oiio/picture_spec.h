// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imageio.h>

#include "oiio/relit_frame.h"

namespace relume::oiio {

/// What a host is told of one picture: windows, pixel aspect, type, channels, colour space and the metadata of the EXR
/// that `relume relight` writes, by the names that OpenImageIO gives them when it reads an EXR.
OIIO::ImageSpec picture_spec(const RelitFrame& frame, int picture);

}  // namespace relume::oiio
