// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

#include "ofx_abi.h"

namespace relume::ofx {

/// What the host gave at the Load action. Optional suites and members may be null.
struct Host {
    const OfxPropertySuiteV1* property = nullptr;
    const OfxImageEffectSuiteV1* effect = nullptr;
    const OfxParameterSuiteV1* parameter = nullptr;
    const OfxMessageSuiteV1* message = nullptr;
    const OfxMessageSuiteV2* persistent = nullptr;  ///< null where a host has it but must not be trusted with it
    OfxPropertySetHandle properties = nullptr;
    std::string name;  ///< "DaVinciResolve", …, or ""
};

/// Remembers the host that setHost or OfxSetHost brings; may come again at any time before Load.
void take_host(const OfxHost* host);

/// Fetches the suites anew: a host loads, unloads and loads again in one process. False where one that the node cannot
/// do without is missing, or lacks a member.
bool load_host();
void unload_host();
const Host& host();

/// A property set. Hosts lack properties, and say so by an error: reading then gives the fallback, writing false.
class Properties {
public:
    Properties() = default;
    explicit Properties(OfxPropertySetHandle handle) : handle_(handle) {}
    OfxPropertySetHandle handle() const { return handle_; }
    explicit operator bool() const { return handle_ != nullptr; }

    bool set(const char* name, int value, int index = 0) const;
    bool set(const char* name, double value, int index = 0) const;
    bool set(const char* name, const char* value, int index = 0) const;
    bool set(const char* name, const std::string& value, int index = 0) const {
        return set(name, value.c_str(), index);
    }

    bool get(const char* name, int& value, int index = 0) const;
    bool get(const char* name, double& value, int index = 0) const;
    bool get(const char* name, void*& value, int index = 0) const;
    int integer(const char* name, int fallback, int index = 0) const;
    double number(const char* name, double fallback, int index = 0) const;
    std::string text(const char* name) const;  ///< "" where there is none

    /// Several numbers, or false where one is missing.
    template <class T, std::size_t N> bool get(const char* name, std::array<T, N>& values) const {
        for (std::size_t k = 0; k < N; ++k)
            if (!get(name, values[k], static_cast<int>(k))) return false;
        return true;
    }

private:
    OfxPropertySetHandle handle_ = nullptr;
};

Properties effect_properties(OfxImageEffectHandle effect);
OfxParamSetHandle parameter_set(OfxImageEffectHandle effect);

/// Whether the host wants the render to stop.
bool aborted(OfxImageEffectHandle effect);

/// Tells the user, by the channel that the host has: a message that stays until clear_message(), or a dialog.
void show_error(OfxImageEffectHandle effect, const std::string& text);
void clear_message(OfxImageEffectHandle effect);

}  // namespace relume::ofx
