// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>

#include "gbuffer/attributes.h"
#include "gbuffer/gbuffer_impl.h"
#include "gbuffer/names.h"

namespace relume::gbuffer {

namespace {

/// x, y of red, green, blue and white, as in the attribute `chromaticities`.
struct Primaries {
    std::string_view space;
    std::string_view label;
    std::array<double, 8> xy;
};

constexpr std::array kPrimaries{
    Primaries{"lin_rec709", "Rec.709", {0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290}},
    Primaries{"lin_rec2020", "Rec.2020", {0.708, 0.292, 0.170, 0.797, 0.131, 0.046, 0.3127, 0.3290}},
    Primaries{"lin_p3d65", "P3-D65", {0.680, 0.320, 0.265, 0.690, 0.150, 0.060, 0.3127, 0.3290}},
    Primaries{"lin_ap0", "ACES AP0", {0.7347, 0.2653, 0.0, 1.0, 0.0001, -0.0770, 0.32168, 0.33767}},
    Primaries{"lin_ap1", "ACES AP1", {0.713, 0.293, 0.165, 0.830, 0.128, 0.044, 0.32168, 0.33767}},
    Primaries{"lin_adobergb", "Adobe RGB", {0.64, 0.33, 0.21, 0.71, 0.15, 0.06, 0.3127, 0.3290}},
};

}  // namespace

std::string canonical_space(std::string_view name) {
    std::string space(name);
    for (const std::string_view ending : {"_scene", "_display"}) {
        if (space.ends_with(ending) && space.starts_with("lin_")) space.resize(space.size() - ending.size());
    }
    const std::string folded = fold(space);
    if (folded == "acescg" || folded == "linap1") return "lin_ap1";
    if (folded == "aces20651" || folded == "linap0") return "lin_ap0";
    if (folded == "linearrec.709" || folded == "linearrec709" || folded == "linrec709" ||
        folded == "linearrec.709(srgb)" || folded == "scenelinearrec.709srgb") {
        return "lin_rec709";
    }
    if (folded == "linearrec.2020" || folded == "linearrec2020" || folded == "linrec2020") return "lin_rec2020";
    return space;
}

std::optional<std::pair<std::string, std::string>> stated_working_space(const io::Header& header, int beauty_part) {
    const auto part_index = static_cast<std::size_t>(beauty_part);
    const io::Part* beauty = part_index < header.parts.size() ? &header.parts[part_index] : nullptr;
    const std::string* interop = beauty ? text_attribute(*beauty, "colorInteropID") : nullptr;
    if (!interop || *interop == "data") interop = text_attribute(header, "colorInteropID");
    if (interop && *interop != "data" && *interop != "unknown" && !interop->empty()) {
        return std::pair(canonical_space(*interop), "the header's colorInteropID is " + *interop);
    }
    const std::vector<double>* xy = numbers_attribute(header, "chromaticities", 8);
    if (!xy) return std::nullopt;
    for (const Primaries& primaries : kPrimaries) {
        bool same = true;
        for (std::size_t i = 0; i < 8; ++i)
            same = same && std::abs((*xy)[i] - primaries.xy[i]) < 2e-3;
        if (same) {
            return std::pair(std::string(primaries.space),
                             "the header's chromaticities are those of " + std::string(primaries.label));
        }
    }
    return std::pair(std::string("unknown"), std::string("the header's chromaticities are those of no known space"));
}

}  // namespace relume::gbuffer
