// SPDX-License-Identifier: Apache-2.0
#include "gbuffer/select.h"

#include <algorithm>
#include <set>

#include "cryptomatte/cryptomatte.h"
#include "gbuffer/names.h"
#include "relume/error.h"

namespace relume::gbuffer {

namespace {

constexpr int kQualifiedPenalty = 100'000;
constexpr int kFallbackPenalty = 1'000'000;

/// Whether the layer is called by its part's name and that name means something: then it is not the plain RGB.
bool named_by_hint(const Layer& layer) {
    if (!layer.name.empty() || layer.hint.empty()) return false;
    return std::any_of(channel_rows().begin(), channel_rows().end(), [&](const ChannelRow& row) {
        if (row.semantic == "beauty" || row.names.empty()) return false;
        for (const std::string_view name : split(row.names, '|')) {
            const Fit fit = match_layer(layer.hint, name).fit;
            if (fit == Fit::exact || fit == Fit::tolerant) return true;
        }
        return false;
    });
}

Match match(const Layer& layer, std::string_view pattern) {
    if (!pattern.empty()) return match_layer(layer.label(), pattern);
    if (layer.name.empty() && !layer.data && !named_by_hint(layer)) return {Fit::exact, {}};
    return {};
}

int group_preference(const SourceFile& file, const Candidate& candidate, const Choice& choice) {
    if (candidate.group == choice.group) return 0;
    if (candidate.group.empty()) return 1;
    if (choice.group.starts_with(candidate.group + ".") || candidate.group.starts_with(choice.group + ".")) return 2;
    // Blender's view layers are pictures of their own; elsewhere what stands before a name is only an ordering.
    return file.producer.producer == Producer::blender ? -1 : 3;
}

std::string join(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
    return text;
}

std::string group_label(const std::string& group) { return group.empty() ? "(none)" : group; }

}  // namespace

std::vector<const Component*> components_for(const Layer& layer, Quantity quantity, std::string_view letters) {
    const bool three = quantity == Quantity::color || quantity == Quantity::direction || quantity == Quantity::point;
    if (letters == "1") {
        return layer.components.size() == 1 ? std::vector{&layer.components.front()} : std::vector<const Component*>{};
    }
    if (!letters.empty()) {
        std::vector<const Component*> picked = layer.pick(letters);
        if (three && picked.size() == 1) picked.assign(3, picked.front());
        return picked;
    }
    if (three) {
        const bool color = quantity == Quantity::color;
        std::vector<const Component*> picked = layer.pick(color ? "RGB" : "XYZ");
        if (picked.empty()) picked = layer.pick(color ? "XYZ" : "RGB");
        if (picked.empty() && color && layer.components.size() == 1) picked.assign(3, &layer.components.front());
        return picked;
    }
    for (const char letter : {'X', 'V', 'Z', 'R', 'Y', 'T', '\0'}) {
        // A scalar is a layer of one channel, or the first channel of three equal ones; never the X of X, Y, Z.
        if (letter == 'X' && quantity == Quantity::depth && layer.find('Z')) continue;
        if (const Component* component = layer.find(letter)) return {component};
    }
    return layer.components.empty() ? std::vector<const Component*>{} : std::vector{&layer.components.front()};
}

std::vector<Candidate> candidates(const SourceFile& file, std::string_view semantic) {
    const SemanticName* meaning = find_semantic(semantic);
    std::vector<Candidate> result;
    if (!meaning) return result;
    int row_rank = 0;
    for (const ChannelRow& row : channel_rows()) {
        row_rank += 1000;
        if (row.semantic != semantic) continue;
        if (row.producer != Producer::unknown && row.producer != file.producer.producer) continue;
        int name_rank = 0;
        for (const std::string_view pattern : split(row.names, '|')) {
            name_rank += 10;
            for (const Layer& layer : file.layers) {
                Match fit = match(layer, pattern);
                if (fit.fit == Fit::none) continue;
                std::vector<const Component*> components = components_for(layer, meaning->quantity, row.components);
                // X, Y, Z of a vector file hold no depth.
                if (components.empty() || (row.components == "Z" && layer.find('X'))) continue;
                const auto known =
                    std::find_if(result.begin(), result.end(), [&](const Candidate& c) { return c.layer == &layer; });
                const int rank = row_rank + name_rank + static_cast<int>(fit.fit) +
                                 (fit.fit == Fit::qualified ? kQualifiedPenalty : 0) +
                                 (row.fallback ? kFallbackPenalty : 0);
                if (known != result.end() && known->rank <= rank) continue;
                Candidate candidate{&layer, std::move(components), &row, std::move(fit.group), rank};
                if (known != result.end()) {
                    *known = std::move(candidate);
                } else {
                    result.push_back(std::move(candidate));
                }
            }
        }
    }
    std::stable_sort(result.begin(), result.end(),
                     [](const Candidate& a, const Candidate& b) { return a.rank < b.rank; });
    return result;
}

Choice choose_group(const SourceFile& file, const std::vector<Candidate>& normals, const GBufferOptions& options) {
    const auto part_fits = [&](const Candidate& candidate) {
        if (!options.part) return true;
        const std::string& part = *options.part;
        return candidate.group == part || candidate.layer->part == part || candidate.layer->name == part ||
               candidate.layer->name.starts_with(part + ".");
    };
    const auto view_fits = [&](const Candidate& c) { return !options.view || c.layer->view == *options.view; };

    std::vector<std::string> groups, all_views;
    for (const Candidate& candidate : normals) {
        if (candidate.rank >= normals.front().rank + kQualifiedPenalty) continue;
        const auto add = [](std::vector<std::string>& list, const std::string& word) {
            if (std::find(list.begin(), list.end(), word) == list.end()) list.push_back(word);
        };
        add(groups, candidate.group);
        add(all_views, candidate.layer->view);
    }
    const auto chosen =
        std::find_if(normals.begin(), normals.end(), [&](const Candidate& c) { return part_fits(c) && view_fits(c); });
    if (chosen == normals.end()) {
        const bool part_known = std::any_of(normals.begin(), normals.end(), part_fits);
        std::vector<std::string> labels;
        for (const std::string& word : part_known ? all_views : groups) labels.push_back(group_label(word));
        throw Error(ErrorKind::channel, file.path.string() + ": no normal channel in " +
                                            (part_known ? "view '" + *options.view + "'; views with one: "
                                                        : "part '" + *options.part + "'; layers with one: ") +
                                            join(labels));
    }
    Choice choice{chosen->group, chosen->layer->view, {}};
    if (!options.part && groups.size() > 1) {
        std::vector<std::string> labels;
        for (const std::string& group : groups) labels.push_back(group_label(group));
        choice.notes.push_back("the file has " + std::to_string(groups.size()) + " layers with a normal (" +
                               join(labels) + "): '" + group_label(choice.group) +
                               "' is taken; `part` chooses another");
    }
    if (!options.view && all_views.size() > 1) {
        choice.notes.push_back("the file has the views " + join(all_views) + ": '" + choice.view +
                               "' is taken; `view` chooses another");
    }
    return choice;
}

std::optional<Candidate> choose(const SourceFile& file, std::string_view semantic, const Choice& choice) {
    std::optional<Candidate> best;
    std::pair<int, int> best_key;
    for (Candidate& candidate : candidates(file, semantic)) {
        if (candidate.layer->view != choice.view) continue;
        const int preference = group_preference(file, candidate, choice);
        if (preference < 0) continue;
        // A fallback within the group still loses to the real thing in the file's plain channels.
        const std::pair key{candidate.row->fallback ? 10 + preference : preference, candidate.rank};
        if (!best || key < best_key) {
            best = std::move(candidate);
            best_key = key;
        }
    }
    return best;
}

std::vector<const Component*> find_by_name(const SourceFile& file, std::string_view name, std::string_view group,
                                           std::string_view view, Quantity quantity) {
    const bool three = quantity == Quantity::color || quantity == Quantity::direction || quantity == Quantity::point;
    const auto one = [&](const Component& component) {
        return std::vector<const Component*>(three ? 3 : 1, &component);
    };
    const auto view_fits = [&](const Layer& layer) { return layer.view.empty() || view.empty() || layer.view == view; };
    for (const Layer& layer : file.layers) {
        for (const Component& component : layer.components) {
            if (component.full_name == name && view_fits(layer)) return one(component);
        }
    }
    const std::string in_group = group.empty() ? std::string(name) : std::string(group) + "." + std::string(name);
    const auto whole = [&](auto&& same) -> std::vector<const Component*> {
        for (const Layer& layer : file.layers) {
            if (!view_fits(layer) || !same(layer)) continue;
            std::vector<const Component*> components = components_for(layer, quantity, "");
            if (!components.empty()) return components;
        }
        return {};
    };
    auto found = whole([&](const Layer& layer) { return layer.label() == name; });
    if (found.empty()) found = whole([&](const Layer& layer) { return layer.label() == in_group; });
    // A component of a layer in the group: "albedo.R" for "ViewLayer.albedo.R".
    if (found.empty()) {
        const std::size_t dot = name.rfind('.');
        const std::string_view suffix = dot == std::string_view::npos ? name : name.substr(dot + 1);
        const std::string_view rest = dot == std::string_view::npos ? std::string_view() : name.substr(0, dot);
        const char letter = component_letter(suffix);
        for (const Layer& layer : file.layers) {
            if (letter == '\0' || !view_fits(layer)) continue;
            const Component* component = layer.find(letter);
            if (!component) continue;
            const std::string grouped =
                group.empty() ? std::string(rest) : std::string(group) + "." + std::string(rest);
            if (layer.label() == rest || layer.label() == grouped) return one(*component);
        }
    }
    if (found.empty()) found = whole([&](const Layer& layer) { return layer.part == name; });
    if (found.empty()) found = whole([&](const Layer& layer) { return fold(layer.label()) == fold(in_group); });
    if (found.empty()) found = whole([&](const Layer& layer) { return fold(layer.label()) == fold(name); });
    if (found.empty()) {
        found = whole([&](const Layer& layer) {
            const Match fit = match_layer(layer.label(), name);
            return (fit.fit == Fit::exact || fit.fit == Fit::tolerant) && (fit.group == group || group.empty());
        });
    }
    return found;
}

std::vector<std::string> full_names(const std::vector<const Component*>& components) {
    std::vector<std::string> names;
    for (const Component* component : components) {
        if (std::find(names.begin(), names.end(), component->full_name) == names.end()) {
            names.push_back(component->full_name);
        }
    }
    return names;
}

std::string contents(const SourceFile& file) {
    std::string text;
    std::set<const Component*> told;
    const auto add = [&](const std::string& words) { text += (text.empty() ? "" : ", ") + words; };
    for (const SemanticName& semantic : semantic_names()) {
        const std::vector<Candidate> found = candidates(file, semantic.name);
        if (found.empty() || told.contains(found.front().components.front())) continue;
        told.insert(found.front().components.begin(), found.front().components.end());
        add(std::string(semantic.label) + " (" + join(full_names(found.front().components)) + ")");
    }
    for (const cryptomatte::LayerInfo& info : cryptomatte::layer_infos(file.header))
        add("Cryptomatte '" + info.name + "'");
    constexpr int kMostOthers = 12;
    int others = 0;
    for (const Layer& layer : file.layers) {
        const bool known = std::any_of(layer.components.begin(), layer.components.end(),
                                       [&](const Component& component) { return told.contains(&component); });
        if (known || ++others > kMostOthers) continue;
        std::vector<std::string> names;
        for (const Component& component : layer.components) names.push_back(component.full_name);
        add(layer.label().empty() ? join(names) : "'" + std::string(layer.label()) + "'");
    }
    if (others > kMostOthers) text += " and " + std::to_string(others - kMostOthers) + " more layers";
    return text.empty() ? "no channels that can be read" : text;
}

}  // namespace relume::gbuffer
