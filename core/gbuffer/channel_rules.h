// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "gbuffer/layers.h"
#include "relume/gbuffer.h"

namespace relume::gbuffer {

/// What a semantic channel holds, and with that which components it is made of and what may be done to it.
enum class Quantity : std::uint8_t { color, scalar, direction, point, depth, identifier };

struct SemanticName {
    std::string_view name;
    Quantity quantity = Quantity::scalar;
    std::string_view label;   ///< for messages: "base colour"
    std::string_view absent;  ///< what is assumed when a file has none; "" when nothing is lost
};

/// The semantic channels that a file may hold, in the order in which `inspect` lists them.
std::span<const SemanticName> semantic_names();
const SemanticName* find_semantic(std::string_view name);

enum class Producer : std::uint8_t { unknown, blender, arnold, vray, renderman, mitsuba, pbrt, unreal, karma, ml };

/// How a producer is known, best evidence first.
struct ProducerRow {
    Producer producer = Producer::unknown;
    std::string_view attribute{};  ///< a header attribute of this name, or starting so when it ends with '*'
    std::string_view contains{};   ///< that holds this text (any when empty)
    std::string_view layer{};      ///< or: a layer that fits this pattern
    std::string_view reason{};
};
std::span<const ProducerRow> producer_rows();

/// What is true of everything that a producer writes.
struct ProducerTraits {
    Producer producer = Producer::unknown;
    std::string_view name{};
    bool averaged = true;  ///< colours, normals and AOVs are means over the pixel, with 0 for the background
    std::string_view averaged_reason{};
};
const ProducerTraits& traits(Producer producer);

enum class Code : std::uint8_t { as_is, zero_to_one, detect };

/// One way in which a producer writes a semantic channel.
struct ChannelRow {
    Producer producer = Producer::unknown;  ///< unknown: any
    std::string_view semantic{};
    std::string_view names{};       ///< patterns for match_layer(), best first, separated by '|'; "" is a plain channel
    std::string_view components{};  ///< component letters that it needs ("XYZ", "T"), "1" for a layer of one channel,
                                    ///< "" leaves it to the quantity
    Code encoding = Code::as_is;
    Space space = Space::world;
    std::string_view flip{};
    DepthKind depth = DepthKind::planar;
    bool averaged = true;     ///< false: one sample, never mixed (only where the producer averages at all)
    double near = 0;          ///< depths along the ray: where the producer lets them start unless told otherwise
    bool normalised = false;  ///< depths between 0 and 1: worth nothing without near and far
    bool two_sided = false;   ///< the normal is not turned to the viewer
    bool invert = false;      ///< glossiness
    bool fallback = false;    ///< last resort: taken only when nothing else in the file will do
    std::string_view reason{};
};
std::span<const ChannelRow> channel_rows();

/// Layers that are light or serve the compositor: no shader parameter takes them by their name.
struct PassRow {
    Producer producer = Producer::unknown;  ///< unknown: any
    std::string_view names{};
};
std::span<const PassRow> pass_rows();

struct Detected {
    Producer producer = Producer::unknown;
    std::string name;  ///< "Blender 5.0.1"
    std::string reason;
};
Detected detect_producer(const io::Header& header, std::span<const Layer> layers);

}  // namespace relume::gbuffer
