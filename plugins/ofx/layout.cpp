// SPDX-License-Identifier: Apache-2.0
#include "layout.h"

#include <algorithm>
#include <charconv>
#include <map>

#include "relume/light.h"
#include "relume/rig.h"
#include "relume/shader.h"

namespace relume::ofx {

namespace {

constexpr const char *kGroupGBuffer = "gbuffer_group", *kGroupCamera = "camera_group", *kGroupOutput = "output_group",
                     *kGroupShader = "shader_group";

std::vector<std::string> split(std::string_view names) {
    std::vector<std::string> parts;
    while (!names.empty()) {
        const std::size_t bar = std::min(names.find('|'), names.size());
        parts.emplace_back(names.substr(0, bar));
        names.remove_prefix(std::min(bar + 1, names.size()));
    }
    return parts;
}

Knob make_knob(const Parameter& row, std::string name, std::string group, bool optional) {
    Knob knob;
    knob.name = std::move(name);
    knob.group = std::move(group);
    knob.label = row.label.empty() ? std::string(row.name) : std::string(row.label);
    knob.hint = std::string(row.help);
    if (!row.unit.empty()) knob.hint += " (" + std::string(row.unit) + ")";
    knob.type = row.type;
    knob.count = row.count;
    knob.optional = optional;
    knob.value = row.value;
    knob.min = row.min;
    knob.max = row.max;
    knob.soft_min = row.soft_min;
    knob.soft_max = row.soft_max;
    knob.choices = split(row.choices);
    if (!optional) return knob;
    // Where there is no default, the value that means "not given" must be inside the range.
    knob.value = {};
    switch (knob.type) {
        case ParameterType::choice:
            knob.choices.insert(knob.choices.begin(), "auto");
            break;
        case ParameterType::boolean:
            knob.type = ParameterType::choice;
            knob.choices = {"auto", "no", "yes"};
            break;
        case ParameterType::text:
        case ParameterType::text_list:
        case ParameterType::table:
        case ParameterType::vector:
            break;
        default:
            knob.min = std::min(knob.min, 0.0);
            knob.soft_min = std::min(knob.soft_min, 0.0);
            knob.hint += " 0: not given.";
    }
    return knob;
}

class Builder {
public:
    Layout build() {
        out_.groups.push_back({kGroupGBuffer, "G-buffer", "How files and clips are to be understood."});
        out_.groups.push_back({kGroupCamera, "Camera", "Where nothing else tells: clips have no header."});
        out_.groups.push_back({kGroupOutput, "Output", "What the node gives."});
        for (int k = 0; k < kLights; ++k) add_light(k);
        add_section("gbuffer", gbuffer_parameters(), kGroupGBuffer, "gbuffer_", [](std::string_view key) {
            return key != "file";  // a parameter of its own
        });
        for (const char* channel : {"normal", "position", "depth"})
            add_section(std::string("gbuffer.channels.") + channel, channel_rule_parameters(), kGroupGBuffer,
                        std::string(channel) + "_", [](std::string_view) { return true; });
        add_section("camera", camera_parameters(), kGroupCamera, "camera_", [](std::string_view) { return true; });
        // The rest of [output] is about files.
        add_section("output", output_parameters(), kGroupOutput, "output_",
                    [](std::string_view key) { return key == "mode"; });
        add_shaders();
        return std::move(out_);
    }

private:
    int add(Knob knob) {
        out_.knobs.push_back(std::move(knob));
        return static_cast<int>(out_.knobs.size()) - 1;
    }

    bool is_taken(const std::string& name) const {
        return std::any_of(out_.knobs.begin(), out_.knobs.end(), [&](const Knob& knob) { return knob.name == name; });
    }

    void add_light(int index) {
        LightKnobs light;
        light.prefix = "light" + std::to_string(index + 1);
        const std::string group = light.prefix + "_group";
        out_.groups.push_back({group, "Light " + std::to_string(index + 1), "", index == 0});
        std::map<std::string, int, std::less<>> known;
        for (const LightType& type : light_types()) {
            std::vector<int>& rows = light.of_types.emplace_back();
            for (const Parameter& row : type.parameters) rows.push_back(light_row(light, known, type, row, group));
        }
        out_.lights.push_back(std::move(light));
        if (index > 0) return;
        out_.light_choices = {"off"};
        for (const LightType& type : light_types()) out_.light_choices.emplace_back(type.name);
    }

    int light_row(LightKnobs& light, std::map<std::string, int, std::less<>>& known, const LightType& type,
                  const Parameter& row, const std::string& group) {
        std::string name(row.name);
        const auto found = known.find(name);
        if (found != known.end()) {
            Knob& knob = out_.knobs[static_cast<std::size_t>(found->second)];
            const Knob wanted = make_knob(row, "", "", !row.has_default);
            if (knob.type == wanted.type && knob.optional == wanted.optional && knob.choices == wanted.choices) {
                knob.min = std::min(knob.min, wanted.min);
                knob.max = std::max(knob.max, wanted.max);
                knob.soft_min = std::min(knob.soft_min, wanted.soft_min);
                knob.soft_max = std::max(knob.soft_max, wanted.soft_max);
                return found->second;
            }
            name = std::string(type.name) + "_" + name;
        }
        const int index = add(make_knob(row, light.prefix + "_" + name, group, !row.has_default));
        known.emplace(name, index);
        light.all.push_back(index);
        return index;
    }

    void add_shaders() {
        out_.groups.push_back({kGroupShader, "Shader", "The model of every pixel that the rig gives to no other."});
        out_.shader_choices = {"from the rig"};
        std::vector<std::string> uses;
        for (const ShaderInfo& shader : shaders()) uses.emplace_back(shader.name);
        uses.emplace_back(kFromMaterialExpression);
        for (const std::string& use : uses) {
            ShaderKnobs knobs;
            knobs.use = use;
            for (const Parameter& row : shader_use_parameters(use)) {
                std::string name = use + "_" + std::string(row.name);
                if (is_taken(name)) name = "shader_" + name;
                knobs.rows.push_back(add(make_knob(row, std::move(name), kGroupShader, !row.has_default)));
            }
            out_.shader_choices.push_back(use);
            out_.shaders.push_back(std::move(knobs));
        }
    }

    template <class Wanted>
    void add_section(std::string path, std::span<const Parameter> table, const char* group, const std::string& prefix,
                     Wanted&& wanted) {
        SectionKnobs section;
        section.path = std::move(path);
        for (const Parameter& row : table) {
            if (!wanted(row.name)) continue;
            // The rig speaks where a knob does not: all of them may be left alone.
            Knob knob = make_knob(row, prefix + std::string(row.name), group, true);
            if (section.path.starts_with("gbuffer.channels."))
                knob.label = section.path.substr(section.path.rfind('.') + 1) + ": " + knob.label;
            section.keys.push_back(row.name);
            section.knobs.push_back(add(std::move(knob)));
        }
        out_.sections.push_back(std::move(section));
    }

    Layout out_;
};

}  // namespace

const Layout& layout() {
    static const Layout built = Builder().build();
    return built;
}

std::string choice_record(const std::vector<std::string>& options, int index) {
    if (index < 0 || index >= static_cast<int>(options.size())) return {};
    return std::to_string(index) + " " + options[static_cast<std::size_t>(index)];
}

std::string recorded_choice(const std::vector<std::string>& options, int index, std::string_view record) {
    int recorded = -1;
    const auto [end, error] = std::from_chars(record.data(), record.data() + record.size(), recorded);
    const auto used = static_cast<std::size_t>(end - record.data());
    if (error == std::errc{} && recorded == index && used + 1 < record.size() && record[used] == ' ')
        return std::string(record.substr(used + 1));
    if (index < 0 || index >= static_cast<int>(options.size())) return {};
    return options[static_cast<std::size_t>(index)];
}

}  // namespace relume::ofx
