// SPDX-License-Identifier: Apache-2.0
#include "instance.h"

#include <algorithm>
#include <mutex>

#include "describe.h"

namespace relume::ofx {

namespace {

std::mutex instances_mutex;

/// By handle, and not in the host's OfxPropInstanceData: not every host keeps that.
std::map<OfxImageEffectHandle, std::shared_ptr<const Instance>>& instances() {
    static std::map<OfxImageEffectHandle, std::shared_ptr<const Instance>> all;
    return all;
}

/// paramGetValueAtTime, or without it the value that is.
template <class... Values> bool read(OfxParamHandle handle, double time, Values*... values) {
    if (handle == nullptr) return false;
    const OfxParameterSuiteV1& suite = *host().parameter;
    if (suite.paramGetValueAtTime) return suite.paramGetValueAtTime(handle, time, values...) == kOk;
    return suite.paramGetValue(handle, values...) == kOk;
}

}  // namespace

Instance::Instance(OfxImageEffectHandle effect)
    : effect_(effect), context_(effect_properties(effect).text(name::kPropContext)) {
    const auto add_clip = [&](const char* name) {
        Clip clip;
        OfxPropertySetHandle properties = nullptr;
        if (host().effect->clipGetHandle(effect, name, &clip.handle, &properties) != kOk || !clip.handle) return;
        if (properties == nullptr && host().effect->clipGetPropertySet)
            host().effect->clipGetPropertySet(clip.handle, &properties);
        clip.properties = Properties(properties);
        clips_[name] = clip;
    };
    add_clip(name::kClipOutput);
    if (context_ != name::kContextGenerator) add_clip(name::kClipSource);
    if (context_ != name::kContextGenerator && context_ != name::kContextFilter)
        for (const DataClip& clip : kDataClips) add_clip(clip.name);

    const OfxParamSetHandle set = parameter_set(effect);
    const auto add = [&](const std::string& name) {
        Parameter parameter;
        OfxPropertySetHandle properties = nullptr;
        if (set == nullptr) return;
        if (host().parameter->paramGetHandle(set, name.c_str(), &parameter.handle, &properties) != kOk) return;
        if (properties == nullptr && host().parameter->paramGetPropertySet)
            host().parameter->paramGetPropertySet(parameter.handle, &properties);
        parameter.properties = Properties(properties);
        parameters_[name] = parameter;
    };
    for (const char* name : {own::kRig, own::kGBuffer, own::kOverrides, own::kPicture, own::kWorkLight, own::kShader,
                             own::kShaderRecord, own::kOverrideChannels})
        add(name);
    for (const LightKnobs& light : layout().lights)
        for (const char* suffix : {own::kType, own::kTypeRecord, own::kPick, own::kPickMode, own::kPickDistance})
            add(light.prefix + suffix);
    for (const Knob& knob : layout().knobs) add(knob.name);
}

OfxImageClipHandle Instance::clip(const std::string& name) const {
    const auto found = clips_.find(name);
    return found == clips_.end() ? nullptr : found->second.handle;
}

Properties Instance::clip_properties(const std::string& name) const {
    const auto found = clips_.find(name);
    return found == clips_.end() ? Properties() : found->second.properties;
}

OfxParamHandle Instance::parameter(const std::string& name) const {
    const auto found = parameters_.find(name);
    return found == parameters_.end() ? nullptr : found->second.handle;
}

double Instance::number(const std::string& name, double time, double fallback) const {
    double value = fallback;
    return read(parameter(name), time, &value) ? value : fallback;
}

std::array<double, 2> Instance::pair(const std::string& name, double time) const {
    std::array<double, 2> v{};
    if (!read(parameter(name), time, &v[0], &v[1])) v = {};
    return v;
}

std::array<double, 3> Instance::triple(const std::string& name, double time,
                                       const std::array<double, 3>& fallback) const {
    std::array<double, 3> v = fallback;
    return read(parameter(name), time, &v[0], &v[1], &v[2]) ? v : fallback;
}

int Instance::integer(const std::string& name, double time, int fallback) const {
    int value = fallback;
    return read(parameter(name), time, &value) ? value : fallback;
}

std::string Instance::text(const std::string& name, double time) const {
    char* value = nullptr;
    if (!read(parameter(name), time, &value) || value == nullptr) return {};
    return value;
}

void Instance::set(const std::string& name, int value) const {
    if (const OfxParamHandle handle = parameter(name); handle && host().parameter->paramSetValue)
        host().parameter->paramSetValue(handle, value);
}

void Instance::set(const std::string& name, const std::string& value) const {
    if (const OfxParamHandle handle = parameter(name); handle && host().parameter->paramSetValue)
        host().parameter->paramSetValue(handle, value.c_str());
}

void Instance::set(const std::string& name, const std::array<double, 3>& value) const {
    if (const OfxParamHandle handle = parameter(name); handle && host().parameter->paramSetValue)
        host().parameter->paramSetValue(handle, value[0], value[1], value[2]);
}

std::string Instance::chosen(const std::string& name, const std::string& record,
                             const std::vector<std::string>& options, double time) const {
    const int index = integer(name, time, 0);
    return index == 0 ? std::string() : recorded_choice(options, index, text(record, time));
}

std::string Instance::light_type(const LightKnobs& light, double time) const {
    return chosen(light.prefix + own::kType, light.prefix + own::kTypeRecord, layout().light_choices, time);
}

std::string Instance::shader(double time) const {
    return chosen(own::kShader, own::kShaderRecord, layout().shader_choices, time);
}

void Instance::show(const std::string& name, bool visible) const {
    const auto found = parameters_.find(name);
    if (found == parameters_.end()) return;
    const int secret = visible ? 0 : 1;
    // Hosts redraw their panel for every change.
    if (found->second.properties.integer(name::kPropSecret, -1) != secret)
        found->second.properties.set(name::kPropSecret, secret);
}

void Instance::show_knobs() const {
    const Layout& all = layout();
    const auto name_of = [&](int knob) -> const std::string& { return all.knobs[static_cast<std::size_t>(knob)].name; };
    for (const LightKnobs& light : all.lights) {
        const std::string type = light_type(light, 0);
        std::vector<int> shown;
        for (std::size_t k = 1; k < all.light_choices.size(); ++k)
            if (all.light_choices[k] == type) shown = light.of_types[k - 1];
        bool placed = false;
        for (const int knob : light.all) {
            const bool visible = std::find(shown.begin(), shown.end(), knob) != shown.end();
            show(name_of(knob), visible);
            placed =
                placed || (visible && (name_of(knob).ends_with("_direction") || name_of(knob).ends_with("_position")));
        }
        for (const char* suffix : {own::kPick, own::kPickMode, own::kPickDistance}) show(light.prefix + suffix, placed);
    }
    const std::string shader_name = shader(0);
    for (const ShaderKnobs& knobs : all.shaders)
        for (const int knob : knobs.rows) show(name_of(knob), knobs.use == shader_name);
    show(own::kOverrideChannels, !shader_name.empty());
}

void Instance::record_choice(const std::string& name) const {
    if (name == own::kShader) set(own::kShaderRecord, choice_record(layout().shader_choices, integer(name, 0, 0)));
    for (const LightKnobs& light : layout().lights)
        if (name == light.prefix + own::kType)
            set(light.prefix + own::kTypeRecord, choice_record(layout().light_choices, integer(name, 0, 0)));
}

std::shared_ptr<const Instance> instance_of(OfxImageEffectHandle effect) {
    const std::scoped_lock lock(instances_mutex);
    std::shared_ptr<const Instance>& instance = instances()[effect];
    if (!instance) instance = std::make_shared<const Instance>(effect);
    return instance;
}

void create_instance(OfxImageEffectHandle effect) {
    auto instance = std::make_shared<const Instance>(effect);
    {
        const std::scoped_lock lock(instances_mutex);
        instances()[effect] = instance;
    }
    instance->show_knobs();
}

void destroy_instance(OfxImageEffectHandle effect) {
    const std::scoped_lock lock(instances_mutex);
    instances().erase(effect);
}

void destroy_instances() {
    const std::scoped_lock lock(instances_mutex);
    instances().clear();
}

}  // namespace relume::ofx
