// SPDX-License-Identifier: Apache-2.0
#include "gbuffer/stored_image.h"

#include <algorithm>
#include <array>
#include <mutex>

#include "gbuffer/names.h"
#include "gbuffer/planes.h"
#include "relume/display.h"
#include "relume/error.h"
#include "relume/image_reader.h"

namespace relume {

namespace {

std::mutex reader_mutex;
ImageReader reader;

}  // namespace

void set_image_reader(ImageReader read) {
    const std::lock_guard lock(reader_mutex);
    reader = std::move(read);
}

namespace gbuffer {

namespace {

class StoredPixels final : public PixelSource {
public:
    explicit StoredPixels(StoredImage image) : image_(std::move(image)) {}

    const StoredImage& image() const { return image_; }

    void read(const Window& region, std::span<const io::ReadTarget> targets) const override {
        const std::ptrdiff_t components = std::ssize(image_.channels);
        std::vector<float> row(static_cast<std::size_t>(std::max(region.width, 0)));
        for (const io::ReadTarget& target : targets) {
            for (int j = 0; j < region.height; ++j) {
                // What lies outside the image is 0, as outside an EXR's data window.
                std::fill(row.begin(), row.end(), 0.0f);
                const int y = region.y + j;
                const int first = std::max(region.x, 0), last = std::min(region.x_end(), image_.width);
                for (int x = first; y >= 0 && y < image_.height && x < last; ++x) {
                    const std::ptrdiff_t pixel = static_cast<std::ptrdiff_t>(y) * image_.width + x;
                    row[static_cast<std::size_t>(x - region.x)] =
                        image_.pixels[static_cast<std::size_t>(pixel * components + target.channel)];
                }
                store(row, target.plane, j);
            }
        }
    }

private:
    static void store(const std::vector<float>& row, const Plane& plane, int j) {
        std::byte* at = plane.data + j * plane.y_stride;
        for (const float value : row) {
            if (plane.type == PixelType::float32) {
                std::memcpy(at, &value, sizeof value);
            } else if (plane.type == PixelType::uint32) {
                const std::uint32_t id = to_identifier(value);
                std::memcpy(at, &id, sizeof id);
            } else {
                throw Error(ErrorKind::value, "an image that is not an EXR is read as float");
            }
            at += plane.x_stride;
        }
    }

    StoredImage image_;
};

}  // namespace

bool is_other_image(const std::filesystem::path& path) {
    const std::string extension = fold(path.extension().string());
    const auto known = {".png", ".jpg", ".jpeg", ".tif", ".tiff", ".hdr", ".tga", ".webp", ".bmp"};
    return std::any_of(known.begin(), known.end(), [&](std::string_view other) { return extension == other; });
}

SourceFile open_other_image(const std::filesystem::path& path, bool decode) {
    ImageReader read;
    {
        const std::lock_guard lock(reader_mutex);
        read = reader;
    }
    if (!read) {
        throw Error(ErrorKind::format, path.string() +
                                           ": librelume reads EXR alone; other images come in through OpenImageIO "
                                           "(the Python package, or set_image_reader() in C++)");
    }
    StoredImage image = read(path);
    const std::size_t components = image.channels.size();
    if (image.width < 1 || image.height < 1 || components == 0 ||
        image.pixels.size() !=
            components * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height)) {
        throw Error(ErrorKind::format, path.string() + ": holds no pixels");
    }
    SourceFile file;
    file.path = path;
    file.integer_bits = image.integer_bits;
    file.decoded = decode && image.integer_bits == 8;
    if (file.decoded) {
        for (std::size_t i = 0; i < image.pixels.size(); ++i) {
            if (image.channels[i % components] != "A") image.pixels[i] = srgb_decode(image.pixels[i]);
        }
    }
    io::Part part;
    part.data_window = part.display_window = {0, 0, image.width, image.height};
    part.rows_per_chunk = 16;
    for (const std::string& name : image.channels) {
        io::Channel channel;
        channel.name = name;
        channel.type = PixelType::float32;
        part.channels.push_back(std::move(channel));
    }
    file.header.parts.push_back(std::move(part));
    file.layers = index_layers(file.header, 0, path.stem().string());
    // One file per channel is what estimators write: one value a pixel, nothing averaged with the background.
    file.producer = {Producer::ml, "unknown", "images without a word about who wrote them"};
    file.pixels = std::make_shared<StoredPixels>(std::move(image));
    return file;
}

void convert_colors(SourceFile& file, const ColorMatrix& matrix) {
    StoredImage image = dynamic_cast<const StoredPixels&>(*file.pixels).image();
    std::array<std::size_t, 3> at{};
    for (std::size_t k = 0; k < 3; ++k) {
        const auto found = std::find(image.channels.begin(), image.channels.end(), std::string(1, "RGB"[k]));
        if (found == image.channels.end()) return;
        at[k] = static_cast<std::size_t>(found - image.channels.begin());
    }
    for (std::size_t pixel = 0; pixel < image.pixels.size(); pixel += image.channels.size()) {
        std::array<double, 3> rgb{};
        for (std::size_t k = 0; k < 3; ++k) rgb[k] = image.pixels[pixel + at[k]];
        rgb = transformed(matrix, rgb);
        for (std::size_t k = 0; k < 3; ++k) image.pixels[pixel + at[k]] = static_cast<float>(rgb[k]);
    }
    file.pixels = std::make_shared<StoredPixels>(std::move(image));
}

}  // namespace gbuffer
}  // namespace relume
