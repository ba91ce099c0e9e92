// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "gbuffer/attributes.h"
#include "gbuffer/gbuffer_impl.h"
#include "relume/working_space.h"
#include "text/printable.h"

namespace relume::gbuffer {

std::string canonical_space(std::string_view name) {
    if (const WorkingSpace* known = find_working_space(name)) return std::string(known->name);
    return std::string(name);
}

std::optional<std::pair<std::string, std::string>> stated_working_space(const io::Header& header, int beauty_part) {
    const auto part_index = static_cast<std::size_t>(beauty_part);
    const io::Part* beauty = part_index < header.parts.size() ? &header.parts[part_index] : nullptr;
    const std::string* interop = beauty ? text_attribute(*beauty, "colorInteropID") : nullptr;
    if (!interop || *interop == "data") interop = text_attribute(header, "colorInteropID");
    if (interop && *interop != "data" && *interop != "unknown" && !interop->empty()) {
        const std::string name = printable(*interop);
        return std::pair(canonical_space(name), "the header's colorInteropID is " + name);
    }
    const std::vector<double>* xy = numbers_attribute(header, "chromaticities", 8);
    if (!xy) return std::nullopt;
    Chromaticities stated{};
    std::copy(xy->begin(), xy->end(), stated.begin());
    if (const WorkingSpace* known = find_working_space(stated)) {
        return std::pair(std::string(known->name),
                         "the header's chromaticities are those of " + std::string(known->label));
    }
    return std::pair(std::string("unknown"), std::string("the header's chromaticities are those of no known space"));
}

}  // namespace relume::gbuffer
