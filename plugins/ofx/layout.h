// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "relume/parameter.h"

namespace relume::ofx {

inline constexpr int kLights = 8;

/// One parameter of the node that stands for a row of one of Relume's tables.
struct Knob {
    std::string name;   ///< script name: "light1_direction"
    std::string group;  ///< script name of its group
    std::string label;
    std::string hint;
    ParameterType type = ParameterType::scalar;
    int count = 0;          ///< of a list of numbers: 3 become a vector, other counts a text
    bool optional = false;  ///< has a state "not given": 0, "" or the first choice
    std::array<double, 3> value{};
    double min = 0, max = 0, soft_min = 0, soft_max = 0;
    std::vector<std::string> choices;  ///< with "auto" first where it is optional
};

struct Group {
    std::string name, label, hint;
    bool open = false;
};

/// The knobs of one light. A row of several types is one knob: each type has it under the same name.
struct LightKnobs {
    std::string prefix;                      ///< "light1"
    std::vector<int> all;                    ///< indices into Layout::knobs
    std::vector<std::vector<int>> of_types;  ///< by light type, by row of its table
};

/// The knobs of one shading model, by row of its table.
struct ShaderKnobs {
    std::string use;
    std::vector<int> rows;
};

/// A section of the rig: its dotted path ("camera", "gbuffer.channels.normal"), and the knobs of its rows.
struct SectionKnobs {
    std::string path;
    std::vector<std::string_view> keys;
    std::vector<int> knobs;
};

/// Every parameter that comes from a table: what a new row, light type or shader adds appears here by itself.
struct Layout {
    std::vector<Group> groups;
    std::vector<Knob> knobs;
    std::vector<LightKnobs> lights;
    std::vector<ShaderKnobs> shaders;
    std::vector<SectionKnobs> sections;
    std::vector<std::string> light_choices;   ///< "off", then the types
    std::vector<std::string> shader_choices;  ///< "from the rig", then the models
};

const Layout& layout();

/// Parameters of the node's own. Those with a light's prefix follow it: "light1" + kPick.
namespace own {
inline constexpr const char *kRig = "rig", *kGBuffer = "gbuffer_file", *kOverrides = "overrides", *kPicture = "picture",
                            *kWorkLight = "work_light", *kShader = "shader", *kShaderRecord = "shader_name",
                            *kOverrideChannels = "override_channels";
inline constexpr const char *kType = "_type", *kTypeRecord = "_type_name", *kPick = "_pick", *kPickMode = "_pick_mode",
                            *kPickDistance = "_pick_distance";
}  // namespace own

/// What a pick does with the light.
enum class PickMode : int {
    facing,     ///< stands over the point, along its normal
    highlight,  ///< stands where the point mirrors it into the camera
    aim,        ///< stays and turns to the point
};

/// A choice is stored by its index, and models are listed by name: one that is added moves the others. So the name that
/// an index meant is kept beside it. Gives the name that `index` with the record "INDEX NAME" means: the record's where
/// it is of this index, else the option at the index. "" when there is neither.
std::string recorded_choice(const std::vector<std::string>& options, int index, std::string_view record);
std::string choice_record(const std::vector<std::string>& options, int index);

}  // namespace relume::ofx
