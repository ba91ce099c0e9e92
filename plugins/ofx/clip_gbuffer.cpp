// SPDX-License-Identifier: Apache-2.0
#include "clip_gbuffer.h"

#include <algorithm>
#include <cmath>

#include "relume/error.h"

namespace relume::ofx {

namespace {

constexpr double kInfinite = 1e7;  ///< a canonical coordinate beyond this has no end

constexpr std::int64_t kMostPixels = std::int64_t{1} << 30;  ///< as of a file

/// Canonical to pixels, outwards, but for what rounding adds.
OfxRectI pixels_of(const OfxRectD& rect, const PixelGrid& grid) {
    constexpr double kSlack = 1e-4;
    const double sx = grid.scale_x / grid.aspect, sy = grid.scale_y;
    const auto whole = [](double v) { return static_cast<int>(std::clamp(v, -1e9, 1e9)); };
    return {whole(std::floor(rect.x1 * sx + kSlack)), whole(std::floor(rect.y1 * sy + kSlack)),
            whole(std::ceil(rect.x2 * sx - kSlack)), whole(std::ceil(rect.y2 * sy - kSlack))};
}

double positive(double value, double fallback) { return value > 0 && std::isfinite(value) ? value : fallback; }

constexpr const char* kNormalClip = "Normal";
constexpr const char* kNoNormal =
    "clip 'Normal' is not connected, or has no image here: connect the render's normals to it, or name the EXR that "
    "holds them in 'G-buffer file'";

}  // namespace

bool has_normal_clip(const Instance& instance) {
    if (instance.clip(kNormalClip) == nullptr) return false;
    return instance.clip_properties(kNormalClip).integer(name::kPropConnected, 1) != 0;
}

std::optional<OfxRectD> project_format(const Instance& instance) {
    const Properties p = effect_properties(instance.effect());
    std::array<double, 2> size{}, offset{};
    if (!p.get(name::kPropProjectSize, size) || !(size[0] > 0) || !(size[1] > 0)) return std::nullopt;
    if (size[0] > kInfinite || size[1] > kInfinite) return std::nullopt;
    const auto placed = [](double v) { return std::abs(v) < kInfinite; };
    if (!p.get(name::kPropProjectOffset, offset) || !placed(offset[0]) || !placed(offset[1])) offset = {};
    return OfxRectD{offset[0], offset[1], offset[0] + size[0], offset[1] + size[1]};
}

std::optional<OfxRectD> defined_region(const Instance& instance, const char* clip, double time) {
    const OfxImageClipHandle handle = instance.clip(clip);
    if (handle == nullptr || host().effect->clipGetRegionOfDefinition == nullptr) return std::nullopt;
    if (instance.clip_properties(clip).integer(name::kPropConnected, 1) == 0) return std::nullopt;
    OfxRectD rect{};
    if (host().effect->clipGetRegionOfDefinition(handle, time, &rect) != kOk) return std::nullopt;
    const bool infinite = !(rect.x1 > -kInfinite && rect.y1 > -kInfinite && rect.x2 < kInfinite && rect.y2 < kInfinite);
    if (infinite) return project_format(instance);
    if (!(rect.x1 < rect.x2 && rect.y1 < rect.y2)) return std::nullopt;
    return rect;
}

ClipGBuffer::ClipGBuffer(const Instance& instance, double time, double scale_x, double scale_y, GBufferOptions options)
    : options_(std::move(options)) {
    set_grid(instance, time, scale_x, scale_y);
    const bool known = grid_.canonical.x1 < grid_.canonical.x2;
    const auto fetch = [&](const char* clip) -> std::optional<ClipImage> {
        const OfxImageClipHandle handle = instance.clip(clip);
        if (handle == nullptr || instance.clip_properties(clip).integer(name::kPropConnected, 1) == 0)
            return std::nullopt;
        return ClipImage::fetch(handle, time, known ? &grid_.canonical : nullptr);
    };
    bool normal = false;
    if (std::optional<ClipImage> source = fetch(name::kClipSource)) {
        if (!options_.alpha && source->properties().text(name::kPropPremultiplication) == name::kUnpremultiplied)
            options_.alpha = AlphaMode::straight;
        inputs_.push_back({nullptr, std::move(*source)});
    }
    for (const DataClip& clip : kDataClips) {
        std::optional<ClipImage> image = fetch(clip.name);
        if (!image) continue;
        normal = normal || std::string_view(clip.name) == kNormalClip;
        if (clip.components == 3 && image->components() < 3) {
            throw Error(ErrorKind::channel, "clip '" + std::string(clip.name) + "' has " +
                                                std::to_string(image->components()) +
                                                " component; it needs R, G and B");
        }
        inputs_.push_back({&clip, std::move(*image)});
    }
    if (!normal) throw Error(ErrorKind::channel, kNoNormal);
    // A host that says no region gives images of the whole.
    if (!known) grid_.frame = inputs_.front().image.bounds();
    if (is_empty(grid_.frame)) throw Error(ErrorKind::value, "clip 'Source' defines no pixels");
    const std::int64_t area = std::int64_t{grid_.frame.x2 - grid_.frame.x1} * (grid_.frame.y2 - grid_.frame.y1);
    if (area > kMostPixels)
        throw Error(ErrorKind::value, "clip 'Source' defines " + std::to_string(area) + " pixels; crop it first");
    const std::optional<OfxRectD> format = project_format(instance);
    grid_.display = format ? pixels_of(*format, grid_) : grid_.frame;
}

void ClipGBuffer::set_grid(const Instance& instance, double time, double scale_x, double scale_y) {
    grid_.scale_x = positive(scale_x, 1);
    grid_.scale_y = positive(scale_y, 1);
    const auto aspect_of = [&](const char* clip) {
        return positive(instance.clip_properties(clip).number(name::kPropImageAspect, 0), 0);
    };
    const double project = positive(effect_properties(instance.effect()).number(name::kPropProjectAspect, 1), 1);
    grid_.aspect = positive(aspect_of(name::kClipSource), positive(aspect_of(name::kClipOutput), project));
    std::optional<OfxRectD> region = defined_region(instance, name::kClipSource, time);
    if (!region) region = defined_region(instance, kNormalClip, time);
    if (!region) return;
    grid_.canonical = *region;
    grid_.frame = pixels_of(*region, grid_);
}

GBuffer ClipGBuffer::understand(const OfxRectI& part, const std::atomic<bool>& cancel) {
    std::map<std::string, MemoryChannel> channels;
    std::map<std::string, FramePlanes*, std::less<>> planes_of;
    planes_.clear();
    planes_.reserve(inputs_.size());  // they stay where they are: the channels point into them
    for (const Input& input : inputs_) {
        if (input.clip == nullptr) {
            if (input.image.components() < 3) continue;
            FramePlanes& planes = planes_.emplace_back(input.image, grid_.frame, 4, Numbers::values);
            for (int k = 0; k < planes.count(); ++k) channels["beauty"].planes.push_back(planes[k]);
            planes_of["beauty"] = &planes;
            continue;
        }
        const DataClip& clip = *input.clip;
        const bool ids = !clip.semantics[1].empty();
        const Numbers numbers = !ids ? Numbers::values : grid_.is_proxy() ? Numbers::blurred_ids : Numbers::ids;
        FramePlanes& planes = planes_.emplace_back(input.image, grid_.frame, ids ? 3 : clip.components, numbers);
        int component = 0;
        for (const std::string_view semantic : clip.semantics) {
            if (semantic.empty() || component + clip.components > planes.count()) continue;
            MemoryChannel& channel = channels[std::string(semantic)];
            for (int k = 0; k < clip.components; ++k) channel.planes.push_back(planes[component++]);
            planes_of[std::string(semantic)] = &planes;
        }
    }
    MemoryFrame frame;
    frame.data_window = grid_.window(grid_.frame);
    frame.display_window = grid_.window(grid_.display);
    // A proxy may be scaled otherwise across than down.
    frame.pixel_aspect = static_cast<float>(grid_.aspect * grid_.scale_y / grid_.scale_x);
    frame.resampled = grid_.is_proxy();
    frame.fill_row = [&](std::string_view channel, int y) {
        if (const auto at = planes_of.find(channel); at != planes_of.end())
            at->second->fill_row(grid_.display.y2 - 1 - y);
    };
    GBuffer gbuffer = GBuffer::from_memory(frame, channels, options_, understood_frames());
    constexpr int kReach = MemoryFrame::kReach;
    for (FramePlanes& planes : planes_)
        planes.fill({part.x1 - kReach, part.y1 - 1, part.x2 + kReach, part.y2 + 1}, cancel);
    return gbuffer;
}

UnderstoodFrames& understood_frames() {
    static UnderstoodFrames all;
    return all;
}

}  // namespace relume::ofx
