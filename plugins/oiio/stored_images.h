// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace relume::oiio {

/// Lets G-buffers hold files that are not EXR (PNG, JPEG, TIFF), read by the host's own OpenImageIO. Once is enough.
void install_reader();

}  // namespace relume::oiio
