// SPDX-License-Identifier: Apache-2.0
#include "render.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "abortable.h"
#include "clip_gbuffer.h"
#include "describe.h"
#include "file_frames.h"
#include "output_image.h"
#include "relight_picture.h"
#include "relume/error.h"
#include "resample.h"
#include "threads/workers.h"

namespace relume::ofx {

namespace {

struct RenderArguments {
    double time = 0;
    double scale_x = 1, scale_y = 1;
    OfxRectI window{};
};

bool is_scale(double value) { return value > 0 && std::isfinite(value); }

RenderArguments arguments(const Properties& in) {
    RenderArguments a;
    a.time = in.number(name::kPropTime, 0);
    a.scale_x = in.number(name::kPropRenderScale, 1, 0);
    a.scale_y = in.number(name::kPropRenderScale, 1, 1);
    if (!is_scale(a.scale_x) || !is_scale(a.scale_y)) a.scale_x = a.scale_y = 1;
    std::array<int, 4> w{};
    if (!in.get(name::kPropRenderWindow, w)) throw Error(ErrorKind::value, "the host gives no render window");
    a.window = {w[0], w[1], w[2], w[3]};
    return a;
}

OutputImage fetch_output(const Instance& instance, const RenderArguments& a) {
    std::optional<ClipImage> image = ClipImage::fetch(instance.clip(name::kClipOutput), a.time, nullptr);
    if (!image) throw Error(ErrorKind::value, "the host gives no image to render into");
    return {std::move(*image), a.window};
}

/// Whether a tile is so small, and each band of it so quick, that the bands are often enough to ask the host.
bool is_short(const OfxRectI& part, const Rig& rig) {
    constexpr std::int64_t kPixels = 1'500'000, kLitPixelsOfABand = 4'000'000, kRowsOfABand = 16;
    const std::int64_t width = part.x2 - part.x1;
    return width * (part.y2 - part.y1) <= kPixels &&
           width * kRowsOfABand * static_cast<std::int64_t>(rig.lights.size() + 1) <= kLitPixelsOfABand;
}

void render_clips(const Instance& instance, const NodeRig& node, const RenderArguments& a) {
    ClipGBuffer clips(instance, a.time, a.scale_x, a.scale_y, node.rig.gbuffer);
    OutputImage output = fetch_output(instance, a);
    const OfxRectI part = intersection(output.window(), clips.grid().frame);
    if (is_empty(part)) {
        output.clear(output.window());
        return;
    }
    const auto work = [&](const std::atomic<bool>& cancel, const std::function<void()>& ask) {
        const GBuffer gbuffer = clips.understand(part, cancel);
        const Rig rig = complete_rig(node, gbuffer);
        const Window region = clips.grid().window(part);
        if (part.x1 != output.window().x1 || part.x2 != output.window().x2 || part.y1 != output.window().y1 ||
            part.y2 != output.window().y2)
            output.clear(output.window());
        if (const std::vector<Plane> planes = output.planes(part); !planes.empty()) {
            relight_picture(gbuffer, rig, node.picture, region, planes, cancel, ask);
            return;
        }
        const auto width = static_cast<std::size_t>(region.width);
        std::vector<float> rgba(4 * width * static_cast<std::size_t>(region.height));
        std::vector<Plane> planes;
        for (std::size_t k = 0; k < 4; ++k)
            planes.push_back({reinterpret_cast<std::byte*>(rgba.data() + k), PixelType::float32, 16,
                              static_cast<std::ptrdiff_t>(16 * width)});
        relight_picture(gbuffer, rig, node.picture, region, planes, cancel, ask);
        output.store(part, rgba);
    };
    if (is_short(part, node.rig)) run_abortable_here(instance.effect(), work);
    else run_abortable(instance.effect(), [&](const std::atomic<bool>& cancel) { work(cancel, {}); });
}

double output_aspect(const Instance& instance) {
    const double project = effect_properties(instance.effect()).number(name::kPropProjectAspect, 1);
    const double clip = instance.clip_properties(name::kClipOutput).number(name::kPropImageAspect, project);
    return is_scale(clip) ? clip : 1;
}

void render_file(const Instance& instance, const NodeRig& node, const std::string& file, const RenderArguments& a) {
    const std::shared_ptr<const FileFrame> frame = relight_file(instance, file, node);
    OutputImage output = fetch_output(instance, a);
    const OfxRectI window = output.window();
    if (is_empty(window)) return;
    const OfxRectD origin = project_format(instance).value_or(OfxRectD{});
    const Placement place = placement(*frame, a.scale_x, a.scale_y, output_aspect(instance), origin.x1, origin.y1);
    constexpr int kBandRows = 64;
    run_abortable(instance.effect(), [&](const std::atomic<bool>& cancel) {
        const int bands = (window.y2 - window.y1 + kBandRows - 1) / kBandRows;
        parallel_for(bands, default_threads(), &cancel, [&](int, int k) {
            const int y = window.y1 + k * kBandRows;
            const OfxRectI band{window.x1, y, window.x2, std::min(window.y2, y + kBandRows)};
            const bool straight = place.is_identity() && output.holds_floats();
            if (straight) copy_rows(*frame, place, band, output.at(band.x1, band.y2 - 1), output.row_bytes());
            else output.store(band, resample(*frame, place, band));
        });
    });
}

/// What the file of the node defines, canonical; nothing where it cannot be read, which the render says.
std::optional<OfxRectD> file_region(const Instance& instance, const NodeRig& node, const std::string& file) {
    try {
        const auto understood = understand_file(file, node.rig.gbuffer);
        const GBuffer& gbuffer = understood->gbuffer;
        const Window &data = gbuffer.data_window(), &display = gbuffer.display_window();
        const double aspect = static_cast<double>(gbuffer.pixel_aspect());
        const OfxRectD origin = project_format(instance).value_or(OfxRectD{});
        return OfxRectD{origin.x1 + (data.x - display.x) * aspect, origin.y1 + display.y_end() - data.y_end(),
                        origin.x1 + (data.x_end() - display.x) * aspect, origin.y1 + display.y_end() - data.y};
    } catch (const Error&) {
        return std::nullopt;
    }
}

void put(const Properties& out, const char* name, const OfxRectD& rect) {
    out.set(name, rect.x1, 0);
    out.set(name, rect.y1, 1);
    out.set(name, rect.x2, 2);
    out.set(name, rect.y2, 3);
}

}  // namespace

OfxStatus render(OfxImageEffectHandle effect, const Properties& in) {
    try {
        const std::shared_ptr<const Instance> instance = instance_of(effect);
        const RenderArguments a = arguments(in);
        const NodeRig node = node_rig(*instance, a.time);
        const std::string file = gbuffer_file(*instance, node);
        if (!file.empty()) {
            render_file(*instance, node, file, a);
        } else if (instance->context() == name::kContextFilter || instance->context() == name::kContextGenerator) {
            throw Error(ErrorKind::file, "'G-buffer file' is empty: name the EXR that holds the normals");
        } else {
            render_clips(*instance, node, a);
        }
        clear_message(effect);
        return kOk;
    } catch (const Error& error) {
        // A stop is no error: the host asked for it, and throws the picture away.
        if (error.kind() == ErrorKind::cancelled) return aborted(effect) ? kOk : kFailed;
        show_error(effect, "Relume: " + std::string(error.what()));
        return kFailed;
    }
}

OfxStatus region_of_definition(OfxImageEffectHandle effect, const Properties& in, const Properties& out) {
    try {
        const std::shared_ptr<const Instance> instance = instance_of(effect);
        const double time = in.number(name::kPropTime, 0);
        const NodeRig node = node_rig(*instance, time);
        const std::string file = gbuffer_file(*instance, node);
        std::optional<OfxRectD> region;
        if (!file.empty()) {
            region = file_region(*instance, node, file);
        } else if (instance->context() == name::kContextGeneral) {
            region = defined_region(*instance, name::kClipSource, time);
            if (!region) region = defined_region(*instance, "Normal", time);
        }
        if (!region) return kReplyDefault;
        put(out, name::kPropRegionOfDefinition, *region);
        return kOk;
    } catch (const Error&) {
        return kReplyDefault;  // the render says what is wrong
    }
}

OfxStatus regions_of_interest(OfxImageEffectHandle effect, const Properties& in, const Properties& out) {
    const std::shared_ptr<const Instance> instance = instance_of(effect);
    if (instance->context() != name::kContextGeneral) return kReplyDefault;
    const double time = in.number(name::kPropTime, 0);
    // Encodings and the camera are found in the whole frame, whichever part of it is rendered.
    std::optional<OfxRectD> whole = defined_region(*instance, name::kClipSource, time);
    if (!whole) whole = defined_region(*instance, "Normal", time);
    if (!whole) return kReplyDefault;
    put(out, (std::string(name::kPropClipRegionPrefix) + name::kClipSource).c_str(), *whole);
    for (const DataClip& clip : kDataClips)
        put(out, (std::string(name::kPropClipRegionPrefix) + clip.name).c_str(), *whole);
    return kOk;
}

OfxStatus clip_preferences(OfxImageEffectHandle effect, const Properties& out) {
    const std::shared_ptr<const Instance> instance = instance_of(effect);
    out.set((std::string(name::kPropClipComponentsPrefix) + name::kClipOutput).c_str(), name::kRgba);
    out.set(name::kPropPremultiplication, name::kPremultiplied);
    int varying = 0;
    try {
        varying = node_rig(*instance, 0).varying ? 1 : 0;
    } catch (const Error&) {
        varying = 1;  // whatever it is, it may be another the next frame
    }
    out.set(name::kPropFrameVarying, varying);
    return kOk;
}

}  // namespace relume::ofx
