// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "gbuffer/gbuffer_impl.h"
#include "relume/working_space.h"

namespace relume::gbuffer {

/// Whether a file is one of those that are not EXR, by its name.
bool is_other_image(const std::filesystem::path& path);

/// Such a file as a source of one part, by the reader that set_image_reader() was given. `decode` takes the colours of
/// 8-bit files through the sRGB curve. Errors: format when there is no reader, and the reader's own.
SourceFile open_other_image(const std::filesystem::path& path, bool decode);

/// Takes the R, G, B of such a file through a matrix. Grey, which looks the same in every space, stays as it is.
void convert_colors(SourceFile& file, const ColorMatrix& matrix);

}  // namespace relume::gbuffer
