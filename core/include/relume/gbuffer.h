// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "relume/camera.h"
#include "relume/export.h"
#include "relume/image.h"
#include "relume/parameter.h"

namespace relume {

enum class Encoding : std::uint8_t { as_is, zero_to_one };  ///< vectors stored as (v + 1)/2 are zero_to_one
enum class Space : std::uint8_t { world, camera };
enum class DepthKind : std::uint8_t { planar, ray };  ///< along the view axis, or along the pixel's ray
enum class AlphaMode : std::uint8_t { premultiplied, straight };
/// Whether normals shorter than 1 are means over the pixel, whose highlights are widened by what they average.
enum class NormalVariance : std::uint8_t { automatic, on, off };

/// How one semantic channel is stored. What is absent is detected, with a reason that `inspect` prints.
struct ChannelRule {
    std::optional<std::string> channel;  ///< channel or layer ("N", "ViewLayer.albedo", "roughness.X"), or a file path
    std::optional<std::string> part;
    std::optional<Encoding> encoding;
    std::optional<Space> space;
    std::optional<std::string> flip;  ///< axes to negate: "x", "y", "xy", …
    std::optional<DepthKind> kind;
    std::optional<double> near;  ///< normalised depth d means near + d·(far − near)
    std::optional<double> far;
    std::optional<bool> invert;  ///< glossiness: roughness = 1 − value
    std::optional<bool>
        premultiplied;  ///< averaged over the pixel together with the background's 0: divide by coverage
    bool operator==(const ChannelRule&) const = default;
};

/// Everything that detection may be told: the rig's [gbuffer] and [camera] sections, Python arguments and flags.
struct GBufferOptions {
    std::optional<std::string> part;  ///< layer or part to take
    std::optional<std::string> view;  ///< "left", …
    std::optional<AlphaMode> alpha;
    std::optional<std::string> working_space;       ///< OCIO or interop name, e.g. "lin_rec709", "lin_ap1"
    std::optional<NormalVariance> normal_variance;  ///< absent: automatic
    std::map<std::string, ChannelRule> channels;    ///< by semantic name

    std::optional<std::array<double, 16>> camera_matrix;  ///< row-major camera-to-world
    std::optional<double> fov;                            ///< degrees, horizontal, of the display window
    std::optional<double> focal_length;                   ///< with horizontal_aperture, same unit
    std::optional<double> horizontal_aperture;
    std::optional<Projection> projection;
    std::optional<double> width;  ///< orthographic: world units across the display window

    // Files that claim more are refused by their header alone.
    std::optional<std::int64_t> max_pixels;    ///< of one part and of the frame; 2^30 when absent
    std::optional<std::int64_t> max_channels;  ///< over all parts; 4096 when absent
    std::optional<std::int64_t> max_parts;     ///< 1024 when absent
    bool operator==(const GBufferOptions&) const = default;
};

/// What was understood of one semantic channel.
struct ChannelInfo {
    std::string name;  ///< semantic: "normal", "base_color", or any shader parameter's name
    int components = 1;
    std::vector<std::string> sources;  ///< the file's channels, e.g. {"ViewLayer.Normal.X", …}
    std::string file;                  ///< the file they stand in
    std::string part;                  ///< its name, where the file has several
    std::string interpretation;        ///< "world space, -1..1, premultiplied by coverage"
    std::string reason;                ///< why: "Blender writes its Normal pass in world space"
};

/// One channel of a G-buffer in memory; `planes` has 1 or 3 entries (4 for a beauty with alpha).
struct MemoryChannel {
    std::vector<ConstPlane> planes;
    ChannelRule rule;
};

/// Where arrays in memory stand in the frame.
struct MemoryFrame {
    Window data_window;      ///< of the arrays
    Window display_window;   ///< what a field of view goes across
    float pixel_aspect = 1;  ///< width of a pixel by its height
    bool resampled = false;  ///< a proxy, whose pixels a filter made: directions are made unit vectors again, and
                             ///< their lengths say nothing about the surface unless options.normal_variance is on
    /// For arrays that are filled as they are needed: called before from_memory looks at row `y` (absolute) of a
    /// channel, by several threads at once for different rows. Whoever relights a region fills that, a row more above
    /// and below, and kReach columns more to both sides. Empty: they are filled.
    std::function<void(std::string_view channel, int y)> fill_row = {};
    static constexpr int kReach = 8;
};

/// Remembers what was understood of the last few frames in memory, for who brings a frame again and again, as hosts
/// bring tiles. Nothing but the pixels decides whether a frame is one that is known: all that from_memory would look
/// at are compared. For any number of threads; a frame that several bring at once is understood once.
class RELUME_API UnderstoodFrames {
public:
    UnderstoodFrames();
    UnderstoodFrames(const UnderstoodFrames&) = delete;
    UnderstoodFrames& operator=(const UnderstoodFrames&) = delete;
    ~UnderstoodFrames();
    std::int64_t understood() const;  ///< how many frames were not known
    void clear();
    struct Impl;

private:
    friend class GBuffer;
    std::unique_ptr<Impl> impl_;
};

/// An attribute of the source's header, kept for the output (type and value as in io::Attribute, opaque here).
struct Metadata;

/// Semantic names that relume knows beyond shader parameters, with their components.
///   beauty 3 (as rendered, premultiplied), alpha 1, coverage 1 (share of the pixel that the surface covers),
///   normal 3 (world, unit, or 0 on background), normal_variance 1 (what alpha² grows by), position 3 (world), view 3
///   (unit, from the surface to the camera), depth 1 (planar), base_color 3, roughness 1, metallic 1, specular 1,
///   emission 3, ambient_occlusion 1, opacity 1, tangent 3 (world), object_id, material_id, shading_model_id 1
///   (std::uint32_t planes).

/// What a shading pass wants of a G-buffer, by name; answered by BandReader in canonical form.
struct ChannelRequest {
    enum class Kind : std::uint8_t {
        semantic,  ///< `name` is a semantic name: decoded, in world and working space, divided by coverage
        raw,    ///< `name` is a channel or layer of the file: value·scale + offset, divided by coverage where averaged
        id,     ///< `name` is an ID's semantic name: std::uint32_t, fractions rounded
        matte,  ///< Σ coverage of the Cryptomatte names that match one of `patterns` (globs, "object:…" for one kind)
        constant,  ///< `offset` in every pixel: of use with `widen`
    };
    Kind kind = Kind::semantic;
    std::string name;
    int components = 1;
    std::vector<std::string> patterns;
    double scale = 1;
    double offset = 0;
    LobeWidth widen = LobeWidth::none;  ///< what the values say; they are widened where GBuffer::normal_variance()
};

/// An understood G-buffer: where each semantic channel lies and how to bring it to one canonical form. Holds no pixels
/// of its own: files are read band by band, arrays stay where they are (and must outlive the object).
class RELUME_API GBuffer {
public:
    /// Reads headers alone (and a sparse sample of pixels where detection needs it). `path` may be a multilayer or
    /// multi-part EXR; further files come through `options.channels`.
    /// Errors: file (missing), format (not an EXR, damaged), channel (no normal; ambiguous layer or view: names them).
    static GBuffer read(const std::filesystem::path& path, const GBufferOptions& options = {}, int threads = 0);

    /// Channels in memory, row 0 at the top. All planes are `width` × `height`.
    static GBuffer from_memory(int width, int height, const std::map<std::string, MemoryChannel>& channels,
                               const GBufferOptions& options = {});
    /// The same for arrays that are a part of a frame, or its proxy; all planes have the size of the data window.
    static GBuffer from_memory(const MemoryFrame& frame, const std::map<std::string, MemoryChannel>& channels,
                               const GBufferOptions& options = {});
    /// The same, where `known` may have understood the frame before.
    static GBuffer from_memory(const MemoryFrame& frame, const std::map<std::string, MemoryChannel>& channels,
                               const GBufferOptions& options, UnderstoodFrames& known);

    /// Files are read once, for who relights a frame again and again: what relights ask for is kept as they take it
    /// (decoded, in world and working space, divided by coverage, mattes summed), up to so many bytes (4 a number), so
    /// that a relight with other lights does nothing but shade; pixels are the same. A relight that asks for more reads
    /// that once. Not while it is being read.
    void keep_channels(std::int64_t bytes);

    GBuffer(GBuffer&&) noexcept;
    GBuffer& operator=(GBuffer&&) noexcept;
    ~GBuffer();

    const Window& data_window() const;
    const Window& display_window() const;
    float pixel_aspect() const;
    std::string_view producer() const;       ///< "Blender 5", "Arnold", …, or "unknown"
    std::string_view working_space() const;  ///< "lin_rec709" when nothing says otherwise
    const std::vector<ChannelInfo>& channels() const;
    const ChannelInfo* find(std::string_view name) const;
    /// Whether the lengths of the normals widen highlights; channels() then lists "normal_variance", and why.
    bool normal_variance() const;

    /// Absent when neither header, positions nor options give one.
    const std::optional<Camera>& camera() const;
    std::string_view camera_reason() const;
    /// Median reprojection error in pixels of a camera recovered from positions, else 0.
    double camera_error() const;

    /// What is missing and what will be assumed instead, one sentence each.
    const std::vector<std::string>& notes() const;
    /// Names in the Cryptomatte manifests, by layer.
    const std::map<std::string, std::vector<std::string>>& cryptomatte() const;

    struct Impl;
    const Impl& impl() const { return *impl_; }

private:
    explicit GBuffer(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

/// Reads channels of the whole data window (or a region of it) in canonical form, all in one pass over the file on
/// `threads` threads (0: as many as the process may use). `out`: a plane for each component of each request, in order,
/// (0, 0) the top left pixel of it, of any type and strides (IDs into float32 and half are rounded). Throws
/// Error(channel) for a request that nothing answers, Error(value) for planes that do not fit, Error(file) and
/// Error(format) from reading.
RELUME_API void read_channels(const GBuffer& gbuffer, std::span<const ChannelRequest> requests,
                              std::span<const Plane> out, int threads = 0, const std::optional<Window>& region = {});

}  // namespace relume
