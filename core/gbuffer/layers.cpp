// SPDX-License-Identifier: Apache-2.0
#include "gbuffer/layers.h"

#include <algorithm>

#include "gbuffer/attributes.h"
#include "gbuffer/names.h"
#include "text/printable.h"

namespace relume::gbuffer {

namespace {

/// "N" of "shot_012_N": what a file that holds one unnamed channel is called.
std::string_view last_word(std::string_view stem) {
    // Frame numbers come last in most pipelines: "shot_N.1001".
    while (!stem.empty() && (stem.back() == '.' || stem.back() == '_' || (stem.back() >= '0' && stem.back() <= '9'))) {
        stem.remove_suffix(1);
    }
    const std::size_t cut = stem.find_last_of("._");
    return cut == std::string_view::npos ? stem : stem.substr(cut + 1);
}

std::string without_view(std::string_view part_name, std::string_view view) {
    if (!view.empty() && part_name.size() > view.size() && part_name.ends_with(view)) {
        const char before = part_name[part_name.size() - view.size() - 1];
        if (before == '-' || before == '.' || before == '_') part_name.remove_suffix(view.size() + 1);
    }
    return std::string(part_name);
}

}  // namespace

const Component* Layer::find(char letter) const {
    for (const Component& component : components) {
        if (component.letter == letter) return &component;
    }
    return nullptr;
}

std::vector<const Component*> Layer::pick(std::string_view letters) const {
    std::vector<const Component*> picked;
    for (const char letter : letters) {
        const Component* component = find(letter);
        if (!component) return {};
        picked.push_back(component);
    }
    return picked;
}

std::vector<std::string> views(const io::Header& header) {
    for (const io::Part& part : header.parts) {
        if (const io::Attribute* attribute = find_attribute(part, "multiView")) {
            const auto* list = std::get_if<std::vector<std::string>>(&attribute->value);
            if (!list) continue;
            std::vector<std::string> names;
            for (const std::string& name : *list) names.push_back(printable(name));
            return names;
        }
    }
    std::vector<std::string> result;
    for (const io::Part& part : header.parts) {
        if (!part.view.empty() && std::find(result.begin(), result.end(), part.view) == result.end()) {
            result.push_back(part.view);
        }
    }
    return result;
}

std::vector<Layer> index_layers(const io::Header& header, int file, std::string_view file_stem) {
    const std::vector<std::string> all_views = views(header);
    std::vector<Layer> layers;
    for (std::size_t p = 0; p < header.parts.size(); ++p) {
        const io::Part& part = header.parts[p];
        if (part.deep) continue;
        const std::string* interop = text_attribute(part, "colorInteropID");
        const std::size_t first_of_part = layers.size();
        for (std::size_t c = 0; c < part.channels.size(); ++c) {
            const io::Channel& channel = part.channels[c];
            const std::string_view full = channel.name;
            const std::size_t dot = full.rfind('.');
            const std::string_view suffix = dot == std::string_view::npos ? full : full.substr(dot + 1);
            const char letter = component_letter(suffix);
            std::string_view name = letter == '\0'                  ? full
                                    : dot == std::string_view::npos ? std::string_view()
                                                                    : full.substr(0, dot);
            std::string view = part.view;
            if (view.empty() && !all_views.empty()) {
                const std::size_t last = name.rfind('.');
                const std::string_view word = last == std::string_view::npos ? name : name.substr(last + 1);
                if (std::find(all_views.begin(), all_views.end(), word) != all_views.end()) {
                    view = word;
                    name = last == std::string_view::npos ? std::string_view() : name.substr(0, last);
                } else {
                    view = all_views.front();
                }
            }
            auto layer = std::find_if(layers.begin() + static_cast<std::ptrdiff_t>(first_of_part), layers.end(),
                                      [&](const Layer& l) { return l.name == name && l.view == view; });
            if (layer == layers.end()) {
                Layer fresh;
                fresh.name = name;
                fresh.hint = header.parts.size() > 1 && !part.name.empty() ? without_view(part.name, view)
                                                                           : printable(last_word(file_stem));
                fresh.view = view;
                fresh.part = part.name;
                fresh.data = interop && *interop == "data";
                layers.push_back(std::move(fresh));
                layer = layers.end() - 1;
            }
            layer->components.push_back(
                {letter, channel.name, Address{file, static_cast<int>(p), static_cast<int>(c)}, channel.type});
        }
    }
    // "shot_N.exr" with X, Y, Z is a normal; but R, G, B are the beauty whatever the file is called.
    if (header.parts.size() == 1) {
        for (Layer& layer : layers) {
            if (layer.find('R') && !layer.data) layer.hint.clear();
        }
    }
    return layers;
}

}  // namespace relume::gbuffer
