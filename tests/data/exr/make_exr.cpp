// SPDX-License-Identifier: Apache-2.0
// Writes the EXR files of this folder with OpenEXR's C++ library (Debian's 3.1.5), whose reader, writer and compressors
// are not those that relume uses:
//     g++ -std=c++17 -I../../cpp make_exr.cpp $(pkg-config --cflags --libs OpenEXR) -o /tmp/make_exr && /tmp/make_exr .
// For each lossy compression there is a second file, *.decoded.exr, with the pixels that this library decodes.
// make_exr_new.py adds the compressions that are newer than it.
#include <ImfArray.h>
#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputPart.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfTiledOutputFile.h>
#include <ImfTiledOutputPart.h>
#include <half.h>

#include <map>
#include <string>
#include <vector>

#include "exr_pattern.h"

using namespace OPENEXR_IMF_NAMESPACE;
using IMATH_NAMESPACE::Box2i;
using IMATH_NAMESPACE::V2i;

namespace {

std::string folder;

struct Spec {
    std::string name;
    PixelType type;
    int sampling = 1;
};

// Pixels of one level, in the channels' own types, and the frame buffer that points at them.
class Pixels {
public:
    Pixels(const std::vector<Spec>& specs, const Box2i& window, int level = 0) {
        for (std::size_t c = 0; c < specs.size(); ++c) {
            const Spec& spec = specs[c];
            const int s = spec.sampling;
            const int width = (window.max.x - window.min.x) / s + 1;
            const int height = (window.max.y - window.min.y) / s + 1;
            const std::size_t size = spec.type == HALF ? 2 : 4;
            std::vector<char>& bytes = memory_[spec.name];
            bytes.resize(width * height * size);
            for (int j = 0; j < height; ++j) {
                for (int i = 0; i < width; ++i) {
                    const int x = window.min.x + i * s;
                    const int y = window.min.y + j * s;
                    char* at = bytes.data() + (j * width + i) * size;
                    // Levels other than the first hold something else, so that reading the wrong one shows.
                    const float value = pattern_value(static_cast<int>(c), x, y) + 100.0f * level;
                    if (spec.type == HALF) {
                        *reinterpret_cast<half*>(at) = half(value);
                    } else if (spec.type == FLOAT) {
                        *reinterpret_cast<float*>(at) = value;
                    } else {
                        *reinterpret_cast<unsigned*>(at) = pattern_uint(static_cast<int>(c), x, y) + level;
                    }
                }
            }
            char* base = bytes.data() - ((window.min.y / s) * width + window.min.x / s) * static_cast<long>(size);
            buffer.insert(spec.name, Slice(spec.type, base, size, size * width, s, s));
        }
    }
    FrameBuffer buffer;

private:
    std::map<std::string, std::vector<char>> memory_;
};

Header make_header(const Box2i& display, const Box2i& data, const std::vector<Spec>& specs, Compression compression) {
    Header header(display, data);
    header.compression() = compression;
    for (const Spec& spec : specs) {
        header.channels().insert(spec.name, Channel(spec.type, spec.sampling, spec.sampling));
    }
    return header;
}

const std::vector<Spec> kMixed{{"B", HALF}, {"G", HALF}, {"ID", UINT}, {"R", HALF}, {"Z", FLOAT}};
const Box2i kDisplay(V2i(0, 0), V2i(31, 23));
const Box2i kData(V2i(-5, -3), V2i(20, 33));

void scanline(const std::string& name, const std::vector<Spec>& specs, const Box2i& data, Compression compression,
              LineOrder order = INCREASING_Y) {
    Header header = make_header(kDisplay, data, specs, compression);
    header.lineOrder() = order;
    Pixels pixels(specs, data);
    OutputFile file((folder + name + ".exr").c_str(), header);
    file.setFrameBuffer(pixels.buffer);
    file.writePixels(data.max.y - data.min.y + 1);
}

// What this library makes of its own lossy file, without loss.
void decoded_copy(const std::string& name) {
    InputFile input((folder + name + ".exr").c_str());
    const Box2i data = input.header().dataWindow();
    std::vector<Spec> specs;
    for (auto c = input.header().channels().begin(); c != input.header().channels().end(); ++c) {
        specs.push_back({c.name(), c.channel().type});
    }
    Pixels pixels(specs, data);
    input.setFrameBuffer(pixels.buffer);
    input.readPixels(data.min.y, data.max.y);
    OutputFile output((folder + name + ".decoded.exr").c_str(), make_header(kDisplay, data, specs, ZIP_COMPRESSION));
    output.setFrameBuffer(pixels.buffer);
    output.writePixels(data.max.y - data.min.y + 1);
}

void tiled(const std::string& name, Compression compression, LevelMode mode, LineOrder order = INCREASING_Y) {
    Header header = make_header(kDisplay, kData, kMixed, compression);
    header.lineOrder() = order;
    header.setTileDescription(TileDescription(16, 12, mode));
    TiledOutputFile file((folder + name + ".exr").c_str(), header);
    for (int ly = 0; ly < file.numYLevels(); ++ly) {
        for (int lx = 0; lx < file.numXLevels(); ++lx) {
            if (!file.isValidLevel(lx, ly)) {
                continue;
            }
            Pixels pixels(kMixed, file.dataWindowForLevel(lx, ly), lx + ly);
            file.setFrameBuffer(pixels.buffer);
            file.writeTiles(0, file.numXTiles(lx) - 1, 0, file.numYTiles(ly) - 1, lx, ly);
        }
    }
}

// A tiled part, a deep part and two views, in one file.
void multi_part() {
    std::vector<Header> headers;
    headers.push_back(make_header(kDisplay, kData, kMixed, ZIP_COMPRESSION));
    headers.back().setName("tiles");
    headers.back().setType(TILEDIMAGE);
    headers.back().setTileDescription(TileDescription(16, 12, ONE_LEVEL));
    const std::vector<Spec> one{{"Z", FLOAT}};
    headers.push_back(make_header(kDisplay, Box2i(V2i(0, 0), V2i(3, 3)), one, ZIPS_COMPRESSION));
    headers.back().setName("deep");
    headers.back().setType(DEEPSCANLINE);
    const std::vector<Spec> rgb{{"B", HALF}, {"G", HALF}, {"R", HALF}};
    for (const char* view : {"left", "right"}) {
        headers.push_back(make_header(kDisplay, kDisplay, rgb, PIZ_COMPRESSION));
        headers.back().setName(std::string("beauty.") + view);
        headers.back().setType(SCANLINEIMAGE);
        headers.back().setView(view);
    }
    MultiPartOutputFile file((folder + "multipart.exr").c_str(), headers.data(), static_cast<int>(headers.size()));

    Pixels mixed(kMixed, kData);
    TiledOutputPart tiles(file, 0);
    tiles.setFrameBuffer(mixed.buffer);
    tiles.writeTiles(0, tiles.numXTiles() - 1, 0, tiles.numYTiles() - 1);

    std::vector<unsigned> counts(16, 1);
    std::vector<float> samples(16, 1.5f);
    std::vector<float*> pointers;
    for (float& sample : samples) {
        pointers.push_back(&sample);
    }
    DeepFrameBuffer deep;
    deep.insertSampleCountSlice(Slice(UINT, reinterpret_cast<char*>(counts.data()), 4, 16));
    deep.insert("Z", DeepSlice(FLOAT, reinterpret_cast<char*>(pointers.data()), sizeof(float*), 4 * sizeof(float*), 4));
    DeepScanLineOutputPart deep_part(file, 1);
    deep_part.setFrameBuffer(deep);
    deep_part.writePixels(4);

    Pixels beauty(rgb, kDisplay);
    for (int part : {2, 3}) {
        OutputPart output(file, part);
        output.setFrameBuffer(beauty.buffer);
        output.writePixels(kDisplay.max.y + 1);
    }
}

}  // namespace

int main(int argc, char** argv) {
    folder = std::string(argc > 1 ? argv[1] : ".") + "/";
    const std::map<std::string, Compression> all{
        {"none", NO_COMPRESSION},   {"rle", RLE_COMPRESSION},   {"zips", ZIPS_COMPRESSION},
        {"zip", ZIP_COMPRESSION},   {"piz", PIZ_COMPRESSION},   {"pxr24", PXR24_COMPRESSION},
        {"b44", B44_COMPRESSION},   {"b44a", B44A_COMPRESSION}, {"dwaa", DWAA_COMPRESSION},
        {"dwab", DWAB_COMPRESSION},
    };
    for (const auto& [name, compression] : all) {
        scanline("scanline_" + name, kMixed, kData, compression);
        tiled("tiled_" + name, compression, ONE_LEVEL);
        if (name == "b44" || name == "b44a" || name == "dwaa" || name == "dwab" || name == "pxr24") {
            decoded_copy("scanline_" + name);
            decoded_copy("tiled_" + name);
        }
    }
    scanline("decreasing", kMixed, kData, ZIP_COMPRESSION, DECREASING_Y);
    tiled("mipmap", ZIP_COMPRESSION, MIPMAP_LEVELS);
    tiled("ripmap", ZIP_COMPRESSION, RIPMAP_LEVELS);
    tiled("random_order", ZIPS_COMPRESSION, ONE_LEVEL, RANDOM_Y);
    const std::vector<Spec> luminance{{"BY", HALF, 2}, {"RY", HALF, 2}, {"Y", HALF}};
    const Box2i even(V2i(-4, -6), V2i(17, 33));
    for (const char* name : {"none", "zips", "zip", "piz", "rle"}) {
        scanline(std::string("subsampled_") + name, luminance, even, all.at(name));
    }
    multi_part();
    return 0;
}
