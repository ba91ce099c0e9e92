// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "gbuffer/gbuffer_impl.h"
#include "gbuffer/names.h"
#include "gbuffer/pixel_steps.h"
#include "gbuffer/understood_frames.h"
#include "relume/error.h"
#include "text/number_format.h"

namespace relume {

namespace {

using gbuffer::Quantity;
using gbuffer::Semantic;

static_assert(MemoryFrame::kReach >= gbuffer::kRepairReach);

Quantity quantity_of(const std::string& name, std::size_t planes) {
    if (name == "view") return Quantity::direction;
    if (const gbuffer::SemanticName* semantic = gbuffer::find_semantic(name)) return semantic->quantity;
    return planes == 1 ? Quantity::scalar : Quantity::color;
}

[[noreturn]] void wrong(const std::string& name, const std::string& what) {
    throw Error(ErrorKind::channel, "G-buffer in memory: channel " + name + " " + what);
}

void check_planes(const std::string& name, const MemoryChannel& channel, Quantity quantity) {
    const std::size_t count = channel.planes.size();
    const bool vector = quantity == Quantity::color || quantity == Quantity::direction || quantity == Quantity::point;
    const bool four = name == "beauty" || gbuffer::fold(name).find("crypto") != std::string::npos;
    if (count != 1 && count != 3 && !(count == 4 && four)) {
        wrong(name,
              "has " + std::to_string(count) + " planes; 1 or 3 are expected" + (four ? ", or 4 with alpha" : ""));
    }
    if (gbuffer::find_semantic(name) && vector && count == 1 && quantity != Quantity::color)
        wrong(name, "has 1 plane; 3 are expected");
    for (const ConstPlane& plane : channel.planes) {
        if (!plane.data) wrong(name, "has a plane without data");
    }
}

/// The frame as it is said to be, before anybody has looked at pixels.
std::unique_ptr<GBuffer::Impl> set_up(const MemoryFrame& frame, const std::map<std::string, MemoryChannel>& channels,
                                      const GBufferOptions& options) {
    const int width = frame.data_window.width, height = frame.data_window.height;
    if (width < 0 || height < 0) {
        throw Error(ErrorKind::value,
                    "G-buffer in memory: " + std::to_string(width) + "x" + std::to_string(height) + " pixels");
    }
    if (std::int64_t{width} * height > gbuffer::read_limits(options).max_pixels) {
        throw Error(ErrorKind::value, "G-buffer in memory: " + std::to_string(width) + "x" + std::to_string(height) +
                                          " pixels are more than max_pixels allows");
    }
    if (!(frame.pixel_aspect > 0) || !std::isfinite(frame.pixel_aspect)) {
        throw Error(ErrorKind::value, format_numbers("G-buffer in memory: a pixel aspect of %g", {frame.pixel_aspect}));
    }
    auto impl = std::make_unique<GBuffer::Impl>();
    impl->data_window = frame.data_window;
    impl->display_window = frame.display_window.empty() ? frame.data_window : frame.display_window;
    impl->pixel_aspect = frame.pixel_aspect;
    impl->resampled = frame.resampled;
    impl->producer = "memory";
    impl->producer_reason = "arrays";
    if (options.working_space) {
        impl->working_space = gbuffer::canonical_space(*options.working_space);
        impl->working_space_reason = "given";
    } else {
        impl->working_space_reason = "nothing says otherwise";
    }
    impl->straight_alpha = options.alpha == AlphaMode::straight;

    const auto add_plane = [&](const std::string& name, const ConstPlane& plane) {
        impl->raws.push_back({name, plane.type, {}, plane});
        return static_cast<int>(impl->raws.size()) - 1;
    };
    const bool has_coverage = channels.contains("coverage");
    for (const auto& [name, channel] : channels) {
        const Quantity quantity = quantity_of(name, channel.planes.size());
        check_planes(name, channel, quantity);
        const bool crypto = channel.planes.size() == 4 && name != "beauty";
        if (crypto) {
            gbuffer::CryptoLayer* layer = nullptr;
            const std::string base = name.size() > 2 && name[name.size() - 1] >= '0' && name[name.size() - 1] <= '9' &&
                                             name[name.size() - 2] >= '0' && name[name.size() - 2] <= '9'
                                         ? name.substr(0, name.size() - 2)
                                         : name;
            for (gbuffer::CryptoLayer& known : impl->crypto_layers) {
                if (known.name == base) layer = &known;
            }
            if (!layer) {
                layer = &impl->crypto_layers.emplace_back();
                layer->name = base;
                impl->crypto_names[base];
            }
            for (const std::size_t k : {std::size_t{0}, std::size_t{2}}) {
                const int id = add_plane(name, channel.planes[k]);
                layer->ranks.emplace_back(id, add_plane(name, channel.planes[k + 1]));
            }
            continue;
        }
        Semantic s;
        s.quantity = quantity;
        s.info.name = name;
        s.info.reason = "given as an array";
        s.info.sources = {name};
        const bool grey = quantity == Quantity::color && channel.planes.size() == 1 && gbuffer::find_semantic(name);
        const std::size_t count = grey ? 3 : std::min<std::size_t>(channel.planes.size(), 3);
        for (std::size_t k = 0; k < count; ++k) {
            if (grey && k > 0) {
                s.raws.push_back(s.raws.front());
            } else {
                s.raws.push_back(add_plane(name, channel.planes[k]));
            }
        }
        s.info.components = static_cast<int>(count);
        gbuffer::apply_rule(s, channel.rule);
        const auto rule = options.channels.find(name);
        if (rule != options.channels.end()) gbuffer::apply_rule(s, rule->second);
        if (s.averaged && !has_coverage)
            wrong(name, "is premultiplied by coverage, but there is no channel `coverage`");
        if (name == "coverage") {
            impl->coverage.raws = {s.raws.front()};
            impl->coverage.reason = "given as an array";
        }
        impl->semantics.push_back(std::move(s));
        if (name == "beauty" && channel.planes.size() == 4 && !channels.contains("alpha")) {
            Semantic alpha;
            alpha.info.name = "alpha";
            alpha.info.reason = "the beauty's fourth plane";
            alpha.info.sources = {name};
            alpha.raws = {add_plane(name, channel.planes[3])};
            impl->semantics.push_back(std::move(alpha));
        }
    }
    if (!impl->find("normal")) {
        std::string names;
        for (const auto& entry : channels) names += (names.empty() ? "" : ", ") + entry.first;
        throw Error(ErrorKind::channel,
                    "G-buffer in memory: no normal channel; given are " + (names.empty() ? "none" : names));
    }
    impl->fill_row = frame.fill_row;
    return impl;
}

}  // namespace

GBuffer GBuffer::from_memory(int width, int height, const std::map<std::string, MemoryChannel>& channels,
                             const GBufferOptions& options) {
    const Window window{0, 0, width, height};
    return from_memory(MemoryFrame{window, window}, channels, options);
}

GBuffer GBuffer::from_memory(const MemoryFrame& frame, const std::map<std::string, MemoryChannel>& channels,
                             const GBufferOptions& options) {
    std::unique_ptr<Impl> impl = set_up(frame, channels, options);
    gbuffer::finish(*impl, options, 1);
    impl->fill_row = nullptr;
    return GBuffer(std::move(impl));
}

GBuffer GBuffer::from_memory(const MemoryFrame& frame, const std::map<std::string, MemoryChannel>& channels,
                             const GBufferOptions& options, UnderstoodFrames& known) {
    return GBuffer(gbuffer::understand_once(set_up(frame, channels, options), channels, options, *known.impl_));
}

}  // namespace relume
