// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gbuffer/channel_rules.h"
#include "gbuffer/kept_channels.h"
#include "gbuffer/layers.h"
#include "gbuffer/row_hash.h"
#include "io/exr.h"
#include "relume/gbuffer.h"

namespace relume {

namespace gbuffer {

/// Pixels of an open file. ExrReader in production; tests bring their own.
class PixelSource {
public:
    virtual ~PixelSource() = default;
    virtual void read(const Window& region, std::span<const io::ReadTarget> targets) const = 0;
    virtual int release_buffers() const { return 0; }
};

struct SourceFile {
    std::filesystem::path path;
    io::Header header;
    std::shared_ptr<const PixelSource> pixels;
    std::vector<Layer> layers;
    Detected producer;
    int integer_bits = 0;  ///< of a file that is no EXR: 8 or 16, 0 for floating point
    bool decoded = false;  ///< its sRGB curve has been taken off
};

/// One plane of numbers as the producer wrote them.
struct RawPlane {
    std::string name;                     ///< the channel's full name
    PixelType type = PixelType::float32;  ///< as stored
    Address address;                      ///< of a file's plane
    ConstPlane memory;                    ///< of a plane in memory: data is not null
};

/// A semantic channel and how its raw numbers become canonical ones.
struct Semantic {
    ChannelInfo info;
    std::string layer_name;  ///< how its layer is called, as a parameter's name: "specular_ior_level"
    Quantity quantity = Quantity::scalar;
    std::vector<int> raws;    ///< one index into Impl::raws per component
    std::vector<int> glossy;  ///< base colour from a diffuse pass: add metallic times these
    Encoding encoding = Encoding::as_is;
    Space space = Space::world;
    std::array<float, 3> sign{1, 1, 1};
    DepthKind kind = DepthKind::planar;
    std::optional<double> near;  ///< normalised depth, or the near plane that ray distances start from
    std::optional<double> far;
    bool invert = false;
    bool averaged = false;         ///< premultiplied by coverage
    bool two_sided = false;        ///< normals: may look away from the viewer
    bool unit = false;             ///< directions: known to be unit (or 0) already
    bool repair = false;           ///< points and depths: one sample a pixel, so edges may hold the background
    bool detect_encoding = false;  ///< to be settled by a sample of the pixels
    bool detect_space = false;
    bool detect_kind = false;
    bool near_assumed = false;  ///< `near` is the producer's default: the positions may know better
};

/// Share of a pixel that the surface covers: Σ of the planes, or 1 where there is none.
struct Coverage {
    std::vector<int> raws;
    std::string reason;
};

/// Whether the normals' lengths widen highlights.
struct Variance {
    bool on = false;
    float dead_zone = 0;       ///< how much shorter than 1 the storage alone may leave a unit normal
    float edge_dead_zone = 0;  ///< the same for what was divided by a coverage below 1
    std::string reason;
};

struct CryptoLayer {
    std::string name;                        ///< "ViewLayer.CryptoObject"
    std::vector<std::pair<int, int>> ranks;  ///< raw planes of ID and coverage, best covered first
    std::map<std::string, std::uint32_t> manifest;
};

/// A look that detection takes at pixels: at which, and a hash of what it saw.
struct Look {
    std::vector<int> raws;
    bool dense = false;
    Hash seen{};
};

/// Where view directions come from.
enum class ViewSource : std::uint8_t {
    camera,  ///< Impl::view_camera
    normal,  ///< nothing is known: every surface is seen head-on
};

}  // namespace gbuffer

struct GBuffer::Impl {
    std::vector<gbuffer::SourceFile> files;  ///< empty for a G-buffer in memory
    std::vector<gbuffer::RawPlane> raws;
    std::vector<gbuffer::Semantic> semantics;
    std::vector<ChannelInfo> infos;  ///< of the semantics and of what is derived from them
    gbuffer::Coverage coverage;
    gbuffer::Variance normal_variance;
    std::vector<gbuffer::CryptoLayer> crypto_layers;
    std::map<std::string, std::vector<std::string>> crypto_names;

    Window data_window;
    Window display_window;
    float pixel_aspect = 1;
    std::string producer = "unknown";
    std::string producer_reason;
    std::string working_space = "lin_rec709";
    std::string working_space_reason;
    std::string group;  ///< Blender's view layer, or what else stands before the chosen channels' names
    std::string view;   ///< of a stereo file
    bool straight_alpha = false;
    bool resampled = false;  ///< in memory: pixels that a filter made

    std::optional<Camera> camera;
    std::string camera_reason;
    double camera_error = 0;
    gbuffer::ViewSource view_source = gbuffer::ViewSource::normal;
    Camera view_camera;  ///< `camera`, or what is assumed when there is none
    /// Camera-space directions and points to world: row-major 3×4, applied to columns. Identity when the camera is
    /// unknown.
    std::array<double, 12> to_world{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

    std::vector<std::string> notes;

    std::shared_ptr<gbuffer::KeptChannels> kept;  ///< of files, where channels are kept

    // While a frame in memory is being understood.
    std::function<void(std::string_view, int)> fill_row;  ///< as in MemoryFrame
    std::vector<gbuffer::Look>* looks = nullptr;          ///< where they are noted

    bool in_memory() const { return files.empty(); }
    /// By its semantic name, else by the name of its layer, in any spelling.
    const gbuffer::Semantic* find(std::string_view name) const;
    gbuffer::Semantic* find(std::string_view name);
    /// Index of the plane at this address, added when it is new.
    int raw_of(const gbuffer::Component& component);
};

namespace gbuffer {

/// Finds a layer or channel by the name that a user gives: full names first, then names within the chosen group, then
/// tolerant spellings. Empty when there is none.
std::vector<const Component*> find_by_name(const SourceFile& file, std::string_view name, std::string_view group,
                                           std::string_view view, Quantity quantity);

/// The components of `layer` that make up one quantity; empty when it lacks them. `letters` as in ChannelRow.
std::vector<const Component*> components_for(const Layer& layer, Quantity quantity, std::string_view letters);

/// The sentence that describes how a channel is taken: "world space, -1..1, divided by coverage".
std::string interpretation(const Semantic& semantic);

/// Understands an open file: its header, and a sparse sample of its pixels where that does not tell.
std::unique_ptr<GBuffer::Impl> understand(SourceFile main, const GBufferOptions& options, int threads);

/// Opens an EXR, or by set_image_reader() another kind of image. `color` says what it is wanted for.
/// Errors: file, format.
SourceFile open_file(const std::filesystem::path& path, const io::ReadLimits& limits, bool color = false);

/// What the options allow of a file.
io::ReadLimits read_limits(const GBufferOptions& options);

/// Lets a rule that the user gave override what the table says.
void apply_rule(Semantic& semantic, const ChannelRule& rule);

/// Settles what only pixels tell (encoding, transparency, the camera), then fills infos and notes. The last step of
/// both read() and from_memory().
void finish(GBuffer::Impl& impl, const GBufferOptions& options, int threads);

struct CameraSample;
/// Impl::camera and what hangs on it, from the options, the headers or the positions.
void set_up_camera(GBuffer::Impl& impl, const GBufferOptions& options, const CameraSample& sample, int threads);

/// The working space that the header states, by interop ID or chromaticities, and the reason; nothing when it states
/// none.
std::optional<std::pair<std::string, std::string>> stated_working_space(const io::Header& header, int beauty_part);
/// "lin_rec709" for "lin_rec709_scene" and its other names.
std::string canonical_space(std::string_view name);

}  // namespace gbuffer
}  // namespace relume
