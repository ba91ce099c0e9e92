// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "gbuffer/attributes.h"
#include "gbuffer/channel_rules.h"
#include "gbuffer/names.h"

namespace relume::gbuffer {

namespace {

bool attribute_fits(const io::Attribute& attribute, const ProducerRow& row) {
    const bool prefix = row.attribute.ends_with('*');
    const std::string name = fold(attribute.name);
    const std::string wanted = fold(prefix ? row.attribute.substr(0, row.attribute.size() - 1) : row.attribute);
    if (prefix ? !name.starts_with(wanted) && !name.starts_with("exr/" + wanted) : name != wanted) return false;
    if (row.contains.empty()) return true;
    const auto* text = std::get_if<std::string>(&attribute.value);
    return text && text->find(row.contains) != std::string::npos;
}

bool fits(const io::Header& header, std::span<const Layer> layers, const ProducerRow& row) {
    if (!row.attribute.empty()) {
        const bool found = std::any_of(header.parts.begin(), header.parts.end(), [&](const io::Part& part) {
            return std::any_of(part.attributes.begin(), part.attributes.end(),
                               [&](const io::Attribute& attribute) { return attribute_fits(attribute, row); });
        });
        if (!found) return false;
    }
    return row.layer.empty() || std::any_of(layers.begin(), layers.end(), [&](const Layer& layer) {
               const Fit fit = match_layer(layer.label(), row.layer).fit;
               return fit == Fit::exact || fit == Fit::tolerant;
           });
}

}  // namespace

Detected detect_producer(const io::Header& header, std::span<const Layer> layers) {
    for (const ProducerRow& row : producer_rows()) {
        if (!fits(header, layers, row)) continue;
        Detected found{row.producer, std::string(traits(row.producer).name), std::string(row.reason)};
        const std::string* software = text_attribute(header, "Software");
        if (software && software->starts_with(found.name)) found.name = *software;
        return found;
    }
    return {Producer::unknown, "unknown", "no attribute or channel name that tells"};
}

}  // namespace relume::gbuffer
