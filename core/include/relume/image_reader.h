// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "relume/export.h"

namespace relume {

/// An image that is not an EXR, as its file stores it.
struct StoredImage {
    int width = 0;
    int height = 0;
    std::vector<std::string> channels;  ///< "R", "G", "B", "A"; "Y" for grey
    std::vector<float> pixels;          ///< channels interleaved, row 0 at the top; integers as 0..1, undecoded
    int integer_bits = 0;               ///< 8 or 16; 0 for floating point
};

/// Reads one file. Errors: file, format.
using ImageReader = std::function<StoredImage(const std::filesystem::path&)>;

/// Makes GBuffer::read take PNG, JPEG, TIFF and their like, one file per channel: librelume reads EXR alone, so whoever
/// has a reader hands it in (the Python package brings the `openimageio` wheel's). Of such images colours of 8 bits are
/// decoded from sRGB, and directions of 8 or 16 bits from 0..1. An empty function takes it back. Thread-safe.
RELUME_API void set_image_reader(ImageReader reader);

}  // namespace relume
