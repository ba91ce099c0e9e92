// SPDX-License-Identifier: Apache-2.0
#include "oiio/stored_images.h"

#include <OpenImageIO/imageio.h>

#include <mutex>

#include "relume/error.h"
#include "relume/image_reader.h"

namespace relume::oiio {

namespace {

StoredImage read_stored(const std::filesystem::path& path) {
    std::error_code error;
    if (!std::filesystem::exists(path, error)) throw Error(ErrorKind::file, path.string() + ": no such file");
    const auto input = OIIO::ImageInput::open(path.string());
    if (!input) throw Error(ErrorKind::format, path.string() + ": cannot be read: " + OIIO::geterror());
    const OIIO::ImageSpec& spec = input->spec();
    StoredImage image;
    image.width = spec.width;
    image.height = spec.height;
    image.channels = spec.channelnames;
    if (image.channels.size() == 1) image.channels = {"Y"};
    if (OIIO::TypeDesc(spec.format).is_floating_point()) image.integer_bits = 0;
    else {
        const int bits = spec.get_int_attribute("oiio:BitsPerSample", 8 * static_cast<int>(spec.format.basesize()));
        // 1, 2 and 4 bits a pixel are as coarse as 8, and coded like them.
        image.integer_bits = bits < 8 ? 8 : bits;
    }
    image.pixels.resize(static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height) *
                        static_cast<std::size_t>(spec.nchannels));
    if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, image.pixels.data()))
        throw Error(ErrorKind::format, path.string() + ": cannot be read: " + input->geterror());
    return image;
}

}  // namespace

void install_reader() {
    static std::once_flag once;
    std::call_once(once, [] { set_image_reader(&read_stored); });
}

}  // namespace relume::oiio
