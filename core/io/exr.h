// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "relume/image.h"

namespace relume::io {

/// EXR's compressions, in the numbering of the file format.
enum class Compression : std::uint8_t {
    none,
    rle,
    zips,
    zip,
    piz,
    pxr24,
    b44,
    b44a,
    dwaa,
    dwab,
    htj2k256,
    htj2k32,
    lj2k,
    zstd
};

std::string_view name_of(Compression compression);                        ///< "zip"
std::optional<Compression> compression_from_name(std::string_view name);  ///< lower case, as name_of gives it
/// Whether the OpenEXR that this was built with reads and writes it (3.1 lacks DWA, HTJ2K and ZSTD).
bool is_supported(Compression compression);

/// An attribute of an EXR header. Types that nobody here interprets are kept as raw bytes so that they survive a copy.
struct Attribute {
    std::string name;
    std::string type;  ///< EXR's type name: "string", "float", "int", "v2f", "v3f", "m44f", "chromaticities", …
    /// Numbers of int, float, double, v*, m*, box*, rational, timecode, keycode and chromaticities come as doubles in
    /// file order.
    std::variant<std::string, std::vector<std::string>, std::vector<double>, std::vector<std::byte>> value;
};

struct Channel {
    std::string name;  ///< full name, made printable: "ViewLayer.Normal.X"
    PixelType type = PixelType::half;
    int x_sampling = 1;
    int y_sampling = 1;
    bool perceptually_linear = false;
};

struct Part {
    std::string name;  ///< "" in single-part files without a name
    std::string view;  ///< of a stereo part, else ""
    Window data_window;
    Window display_window;
    float pixel_aspect = 1;
    Compression compression = Compression::zip;
    bool tiled = false;
    bool deep = false;
    int tile_width = 0;
    int tile_height = 0;
    int rows_per_chunk = 1;             ///< natural band height: scanlines of a chunk, or the tile height
    std::vector<Channel> channels;      ///< in file order (sorted by name)
    std::vector<Attribute> attributes;  ///< all others, in file order
};

struct Header {
    std::vector<Part> parts;
};

/// Hostile files stop here, before anything is allocated.
struct ReadLimits {
    std::int64_t max_pixels = std::int64_t{1} << 30;  ///< of one part's data window
    std::int64_t max_channels = 4096;                 ///< over all parts
    std::int64_t max_parts = 1024;
};

/// Where one channel of a region goes.
struct ReadTarget {
    int part = 0;
    int channel = 0;  ///< index into Part::channels
    Plane plane;      ///< (0, 0) is the region's top left pixel; half, float32 or uint32: converted on the way
};

/// An open EXR. Reading is thread-safe: any number of threads may call read() at once, each decodes what it asks for.
class ExrReader {
public:
    /// Reads the header alone. Throws Error(file) when it can't be opened, Error(format) when it is not an EXR, damaged
    /// or beyond `limits`.
    explicit ExrReader(const std::filesystem::path& path, const ReadLimits& limits = {});
    ~ExrReader();
    ExrReader(ExrReader&&) noexcept;
    ExrReader& operator=(ExrReader&&) noexcept;

    const Header& header() const;
    const std::filesystem::path& path() const;

    /// Decodes the chunks that cover `region` (absolute pixel coordinates) and converts the named channels alone.
    /// Pixels outside a part's data window become 0. Subsampled channels are replicated. Tiled parts give level (0, 0).
    /// Full rows aligned to rows_per_chunk are the fast case. Throws Error(format) naming file, part and chunk,
    /// Error(file) when somebody has written into the file since it was opened.
    void read(const Window& region, std::span<const ReadTarget> targets) const;

    /// Gives back the memory that reads keep for the next one; the number of decoders that had some.
    int release_buffers() const;

    /// Whether every chunk of every part is in the file, without decoding any: false for what a killed writer left.
    bool is_whole() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

struct WriteOptions {
    Compression compression = Compression::zip;
    int zip_level = 4;  ///< 1…9 (libdeflate)
    float dwa_quality = 45;
};

/// Writes scanline EXRs, single- or multi-part, to a temporary name in the destination's folder; commit() renames.
/// Without commit() (an exception, a crash handler) the destination is untouched and the temporary file is removed.
class ExrWriter {
public:
    /// `header`: each part's name, view, windows, pixel aspect, channels and attributes; `compression` and tiling there
    /// are ignored. All parts share the data window. Throws Error(file) when the folder is missing or not writable.
    ExrWriter(const std::filesystem::path& path, const Header& header, const WriteOptions& options = {});
    ~ExrWriter();
    ExrWriter(const ExrWriter&) = delete;
    ExrWriter& operator=(const ExrWriter&) = delete;

    /// Rows that a call to write() must be a multiple of (and start at, counted from the data window's top), except at
    /// the bottom.
    int rows_per_chunk() const;

    /// Compresses the rows [y, y + rows) (absolute) of one part in the calling thread and queues them; they reach the
    /// file in order whatever the order of the calls. `channels` are in the order of the part's channels, (0, 0) of
    /// each plane is the left pixel of row y. Thread-safe. Throws Error(file) on a full disk.
    void write(int part, int y, int rows, std::span<const ConstPlane> channels);

    /// All rows of all parts have been written: flush, check, rename onto the destination.
    void commit();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace relume::io
