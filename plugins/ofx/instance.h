// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "host.h"
#include "layout.h"

namespace relume::ofx {

/// One node: handles alone, so that any number of threads may render it.
class Instance {
public:
    explicit Instance(OfxImageEffectHandle effect);

    OfxImageEffectHandle effect() const { return effect_; }
    const std::string& context() const { return context_; }
    /// nullptr where the context has no such clip.
    OfxImageClipHandle clip(const std::string& name) const;
    Properties clip_properties(const std::string& name) const;
    /// nullptr where the host has lost it.
    OfxParamHandle parameter(const std::string& name) const;

    double number(const std::string& name, double time, double fallback) const;
    std::array<double, 2> pair(const std::string& name, double time) const;
    std::array<double, 3> triple(const std::string& name, double time, const std::array<double, 3>& fallback) const;
    int integer(const std::string& name, double time, int fallback) const;
    std::string text(const std::string& name, double time) const;

    /// For the InstanceChanged action alone: a render may write nothing.
    void set(const std::string& name, int value) const;
    void set(const std::string& name, const std::string& value) const;
    void set(const std::string& name, const std::array<double, 3>& value) const;

    /// The light type of a slot, "" when it is off; the shader's name, "" for the rig's.
    std::string light_type(const LightKnobs& light, double time) const;
    std::string shader(double time) const;

    /// Shows the knobs of the chosen light types and shader, and hides the others.
    void show_knobs() const;
    /// Keeps the name of a choice that was made (choice_record); other parameters have none.
    void record_choice(const std::string& name) const;

private:
    struct Clip {
        OfxImageClipHandle handle = nullptr;
        Properties properties;
    };
    std::string chosen(const std::string& name, const std::string& record, const std::vector<std::string>& options,
                       double time) const;
    void show(const std::string& name, bool visible) const;

    OfxImageEffectHandle effect_;
    std::string context_;
    std::map<std::string, Clip> clips_;
    struct Parameter {
        OfxParamHandle handle = nullptr;
        Properties properties;
    };
    std::map<std::string, Parameter> parameters_;
};

/// The instance of a handle, made where the host has not said CreateInstance.
std::shared_ptr<const Instance> instance_of(OfxImageEffectHandle effect);
void create_instance(OfxImageEffectHandle effect);
void destroy_instance(OfxImageEffectHandle effect);
void destroy_instances();

}  // namespace relume::ofx
