// SPDX-License-Identifier: Apache-2.0
#include "describe.h"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "layout.h"

namespace relume::ofx {

namespace {

constexpr double kWide = std::numeric_limits<float>::max();
constexpr const char* kMainGroup = "";

double bounded(double x) { return std::clamp(x, -kWide, kWide); }

class Definer {
public:
    Definer(OfxParamSetHandle set) : set_(set) {}

    Properties define(const std::string& name, const char* type, const std::string& label, const std::string& hint,
                      const std::string& group) {
        OfxPropertySetHandle handle = nullptr;
        if (host().parameter->paramDefine(set_, type, name.c_str(), &handle) != kOk) return {};
        const Properties p(handle);
        p.set(name::kPropLabel, label);
        p.set(name::kPropScriptName, name);
        if (!hint.empty()) p.set(name::kPropHint, hint);
        if (!group.empty()) p.set(name::kPropParent, group);
        return p;
    }

    /// Also a member of the page that is being filled.
    Properties add(const std::string& name, const char* type, const std::string& label, const std::string& hint,
                   const std::string& group) {
        children_.push_back(name);
        return define(name, type, label, hint, group);
    }

    void range(const Properties& p, int components, double min, double max, double soft_min, double soft_max) const {
        for (int k = 0; k < components; ++k) {
            p.set(name::kPropMin, bounded(min), k);
            p.set(name::kPropMax, bounded(max), k);
            p.set(name::kPropDisplayMin, bounded(std::max(soft_min, min)), k);
            p.set(name::kPropDisplayMax, bounded(std::min(soft_max, max)), k);
        }
    }

    void text(const std::string& name, const std::string& label, const std::string& hint, const std::string& group,
              const char* mode) {
        const Properties p = add(name, name::kParamString, label, hint, group);
        p.set(name::kPropStringMode, mode);
        p.set(name::kPropDefault, "");
        if (mode == name::kStringIsFile) p.set(name::kPropFilePathExists, 0);  // a frame pattern is no file
        p.set(name::kPropAnimates, 0);
    }

    void boolean(const std::string& name, const std::string& label, const std::string& hint, const std::string& group,
                 bool value) {
        const Properties p = add(name, name::kParamBoolean, label, hint, group);
        p.set(name::kPropDefault, value ? 1 : 0);
    }

    Properties choice(const std::string& name, const std::string& label, const std::string& hint,
                      const std::string& group, const std::vector<std::string>& options, int value) {
        const Properties p = add(name, name::kParamChoice, label, hint, group);
        for (std::size_t k = 0; k < options.size(); ++k)
            p.set(name::kPropChoiceOption, options[k], static_cast<int>(k));
        p.set(name::kPropDefault, value);
        return p;
    }

    /// What a choice's index meant, kept with the project.
    void record(const std::string& name, const std::string& group) {
        const Properties p = add(name, name::kParamString, name, "", group);
        p.set(name::kPropStringMode, name::kStringIsSingleLine);
        p.set(name::kPropDefault, "");
        p.set(name::kPropSecret, 1);
        p.set(name::kPropAnimates, 0);
        p.set(name::kPropEvaluateOnChange, 0);
    }

    void knob(const Knob& k) {
        const int components = k.type == ParameterType::color || k.type == ParameterType::vector ? 3 : 1;
        switch (k.type) {
            case ParameterType::scalar:
            case ParameterType::color:
            case ParameterType::vector:
                numbers(k, components);
                return;
            case ParameterType::number_list:
                if (k.count == 3) numbers(k, 3);
                else
                    text(k.name, k.label, k.hint + " Numbers with spaces between.", k.group, name::kStringIsSingleLine);
                return;
            case ParameterType::boolean:
                boolean(k.name, k.label, k.hint, k.group, k.value[0] != 0);
                return;
            case ParameterType::integer:
                integer(k);
                return;
            case ParameterType::choice:
                choice(k.name, k.label, k.hint, k.group, k.choices, static_cast<int>(k.value[0]));
                return;
            case ParameterType::table:
                text(k.name, k.label, k.hint, k.group, name::kStringIsFile);
                return;
            case ParameterType::text_list:
                text(k.name, k.label, k.hint + " Patterns with commas between.", k.group, name::kStringIsSingleLine);
                return;
            case ParameterType::text:
                text(k.name, k.label, k.hint, k.group, name::kStringIsSingleLine);
                return;
        }
    }

    void group(const Group& g) {
        const Properties p = define(g.name, name::kParamGroup, g.label, g.hint, "");
        p.set(name::kPropGroupOpen, g.open ? 1 : 0);
    }

    void page(const std::string& name, const std::string& label) {
        const Properties p = define(name, name::kParamPage, label, "", "");
        for (std::size_t k = 0; k < children_.size(); ++k)
            p.set(name::kPropPageChild, children_[k], static_cast<int>(k));
        children_.clear();
    }

private:
    void numbers(const Knob& k, int components) {
        const char* type = components == 1                  ? name::kParamDouble
                           : k.type == ParameterType::color ? name::kParamRgb
                                                            : name::kParamDouble3D;
        const Properties p = add(k.name, type, k.label, k.hint, k.group);
        for (int c = 0; c < components; ++c) p.set(name::kPropDefault, k.value[static_cast<std::size_t>(c)], c);
        if (k.type != ParameterType::color) p.set(name::kPropDoubleType, name::kDoublePlain);
        range(p, components, k.min, k.max, k.soft_min, k.soft_max);
        p.set(name::kPropAnimates, 1);
    }

    void integer(const Knob& k) {
        constexpr double kMost = std::numeric_limits<int>::max();
        const auto whole = [&](double x) { return static_cast<int>(std::clamp(x, -kMost, kMost)); };
        const Properties p = add(k.name, name::kParamInteger, k.label, k.hint, k.group);
        p.set(name::kPropDefault, whole(k.value[0]));
        p.set(name::kPropMin, whole(k.min));
        p.set(name::kPropMax, whole(k.max));
        p.set(name::kPropDisplayMin, whole(std::max(k.min, k.soft_min)));
        p.set(name::kPropDisplayMax, whole(std::min(k.max, std::max(k.soft_max, k.soft_min + 1))));
    }

    OfxParamSetHandle set_;
    std::vector<std::string> children_;
};

void define_clip(OfxImageEffectHandle effect, const char* name, const char* label, bool optional) {
    OfxPropertySetHandle handle = nullptr;
    if (host().effect->clipDefine(effect, name, &handle) != kOk) return;
    const Properties p(handle);
    p.set(name::kPropLabel, label);
    p.set(name::kPropSupportedComponents, name::kRgba, 0);
    p.set(name::kPropSupportedComponents, name::kRgb, 1);
    if (optional) p.set(name::kPropOptional, 1);
    p.set(name::kPropSupportsTiles, 1);
}

void define_light(Definer& definer, const LightKnobs& light) {
    const std::string group = light.prefix + "_group";
    const Properties type =
        definer.choice(light.prefix + own::kType, "Type", "Kind of light; it decides which knobs there are.", group,
                       layout().light_choices, 0);
    type.set(name::kPropAnimates, 0);
    definer.record(light.prefix + own::kTypeRecord, group);
    const Properties pick =
        definer.add(light.prefix + own::kPick, name::kParamDouble2D, "Pick",
                    "Places the light: put this on the spot of the picture that it is to light. Position and normal "
                    "there are read from the G-buffer.",
                    group);
    pick.set(name::kPropDoubleType, name::kDoubleXyAbsolute);
    pick.set(name::kPropHostOverlay, 1);  // a cross to drag on the picture
    for (int k = 0; k < 2; ++k) pick.set(name::kPropDefault, 0.0, k);
    definer.range(pick, 2, -kWide, kWide, 0, 4096);
    pick.set(name::kPropAnimates, 0);
    definer
        .choice(light.prefix + own::kPickMode, "Pick mode",
                "facing: the light stands over the point, along its normal. highlight: where the point mirrors it "
                "into the camera. aim: it stays where it is and turns to the point.",
                group, {"facing", "highlight", "aim"}, 0)
        .set(name::kPropAnimates, 0);
    const Properties distance = definer.add(
        light.prefix + own::kPickDistance, name::kParamDouble, "Pick distance",
        "From the point to a light with a position; 0 keeps the distance that it has. (scene units)", group);
    distance.set(name::kPropDefault, 0.0);
    definer.range(distance, 1, 0, kWide, 0, 10);
    distance.set(name::kPropAnimates, 0);
    for (const int k : light.all) definer.knob(layout().knobs[static_cast<std::size_t>(k)]);
}

void define_parameters(OfxImageEffectHandle effect) {
    const OfxParamSetHandle set = parameter_set(effect);
    if (set == nullptr) return;
    const Layout& all = layout();
    Definer definer(set);
    definer.text(
        own::kRig, "Rig file",
        "A .relume file (docs/rig.md), or the name of a built-in rig as \"outdoor\". The lights below are added to "
        "its own.",
        kMainGroup, name::kStringIsFile);
    definer.text(
        own::kGBuffer, "G-buffer file",
        "The EXR that holds the G-buffer; ####, %04d or {frame} stands for the frame's number. Empty: the clips.",
        kMainGroup, name::kStringIsFile);
    for (const Group& group : all.groups) definer.group(group);
    const auto knobs_of = [&](std::string_view group) {
        for (const Knob& knob : all.knobs)
            if (knob.group == group) definer.knob(knob);
    };
    definer.boolean(
        own::kWorkLight, "Work light",
        "Where neither the rig nor a knob has a light: a sun from the camera's upper left, so that a fresh node "
        "shows something.",
        kMainGroup, true);
    definer.text(own::kOverrides, "Overrides",
                 "Any key of the rig, one a line, as on the command line: light.key.exposure = 1", kMainGroup,
                 name::kStringIsMultiLine);
    definer.page("main_page", "Relume");

    for (const LightKnobs& light : all.lights) {
        define_light(definer, light);
        definer.page(light.prefix + "_page", "Light " + light.prefix.substr(5));
    }

    definer
        .choice(own::kShader, "Model", "The shading model of pixels that the rig gives to no other.", "shader_group",
                all.shader_choices, 0)
        .set(name::kPropAnimates, 0);
    definer.record(own::kShaderRecord, "shader_group");
    definer.boolean(own::kOverrideChannels, "Override channels",
                    "Off: a knob is for what the G-buffer has no channel of. On: the knobs alone decide.",
                    "shader_group", false);
    knobs_of("shader_group");
    definer.page("shader_page", "Shader");

    knobs_of("gbuffer_group");
    definer.page("gbuffer_page", "G-buffer");
    knobs_of("camera_group");
    definer.page("camera_page", "Camera");
    definer.text(own::kPicture, "Picture", "beauty (also when empty), diffuse, specular, transmission, or light:NAME.",
                 "output_group", name::kStringIsSingleLine);
    knobs_of("output_group");
    definer.page("output_page", "Output");
}

}  // namespace

void describe(OfxImageEffectHandle effect) {
    const Properties p = effect_properties(effect);
    p.set(name::kPropLabel, "Relume");
    p.set(name::kPropGrouping, "Relume");
    p.set(name::kPropDescription,
          "Relights a rendered picture from its G-buffer: normals, base colours, roughness and positions, by clips or "
          "from a multilayer EXR. Lights and shading models are those of renderers.");
    int context = 0;
    for (const char* name : {name::kContextGeneral, name::kContextFilter, name::kContextGenerator})
        p.set(name::kPropSupportedContexts, name, context++);
    int depth = 0;
    for (const char* name : {name::kDepthFloat, name::kDepthHalf, name::kDepthShort, name::kDepthByte})
        p.set(name::kPropSupportedDepths, name, depth++);
    p.set(name::kPropSupportsTiles, 1);
    p.set(name::kPropMultiResolution, 1);
    p.set(name::kPropTemporalAccess, 0);
    p.set(name::kPropMultipleDepths, 1);
    p.set(name::kPropMultiplePars, 0);
    p.set(name::kPropSingleInstance, 0);
    p.set(name::kPropThreadSafety, name::kFullySafe);
    p.set(name::kPropHostFrameThreading, 0);
}

void describe_in_context(OfxImageEffectHandle effect, std::string_view context) {
    if (context != name::kContextGenerator) define_clip(effect, name::kClipSource, "Source", false);
    if (context == name::kContextGeneral)
        for (const DataClip& clip : kDataClips) define_clip(effect, clip.name, clip.label, true);
    define_clip(effect, name::kClipOutput, "Output", false);
    define_parameters(effect);
}

}  // namespace relume::ofx
