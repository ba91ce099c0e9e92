// SPDX-License-Identifier: Apache-2.0
#include "host.h"

namespace relume::ofx {

namespace {

const OfxHost* given_host = nullptr;
Host current;

template <class Suite> const Suite* fetch(const char* name, int version) {
    return static_cast<const Suite*>(given_host->fetchSuite(given_host->host, name, version));
}

/// The members that are called without a look.
bool is_complete(const Host& h) {
    const OfxPropertySuiteV1* p = h.property;
    const OfxImageEffectSuiteV1* e = h.effect;
    const OfxParameterSuiteV1* q = h.parameter;
    return p && e && q && p->propSetString && p->propSetDouble && p->propSetInt && p->propGetPointer &&
           p->propGetString && p->propGetDouble && p->propGetInt && e->getPropertySet && e->getParamSet &&
           e->clipDefine && e->clipGetHandle && e->clipGetImage && e->clipReleaseImage && q->paramDefine &&
           q->paramGetHandle && q->paramGetValue;
}

}  // namespace

void take_host(const OfxHost* host) { given_host = host; }

bool load_host() {
    if (given_host == nullptr || given_host->fetchSuite == nullptr) return false;
    Host h;
    h.property = fetch<OfxPropertySuiteV1>(name::kPropertySuite, 1);
    h.effect = fetch<OfxImageEffectSuiteV1>(name::kImageEffectSuite, 1);
    h.parameter = fetch<OfxParameterSuiteV1>(name::kParameterSuite, 1);
    h.message = fetch<OfxMessageSuiteV1>(name::kMessageSuite, 1);
    if (!is_complete(h)) return false;
    h.properties = given_host->host;
    current = h;
    current.name = Properties(h.properties).text(name::kPropName);
    // Resolve answers version 2 with a suite whose persistent functions lead nowhere.
    if (current.name.find("DaVinciResolve") == std::string::npos)
        current.persistent = fetch<OfxMessageSuiteV2>(name::kMessageSuite, 2);
    return true;
}

void unload_host() { current = {}; }

const Host& host() { return current; }

bool Properties::set(const char* name, int value, int index) const {
    return handle_ && current.property->propSetInt(handle_, name, index, value) == kOk;
}

bool Properties::set(const char* name, double value, int index) const {
    return handle_ && current.property->propSetDouble(handle_, name, index, value) == kOk;
}

bool Properties::set(const char* name, const char* value, int index) const {
    return handle_ && current.property->propSetString(handle_, name, index, value) == kOk;
}

bool Properties::get(const char* name, int& value, int index) const {
    return handle_ && current.property->propGetInt(handle_, name, index, &value) == kOk;
}

bool Properties::get(const char* name, double& value, int index) const {
    return handle_ && current.property->propGetDouble(handle_, name, index, &value) == kOk;
}

bool Properties::get(const char* name, void*& value, int index) const {
    return handle_ && current.property->propGetPointer(handle_, name, index, &value) == kOk;
}

int Properties::integer(const char* name, int fallback, int index) const {
    int value = fallback;
    return get(name, value, index) ? value : fallback;
}

double Properties::number(const char* name, double fallback, int index) const {
    double value = fallback;
    return get(name, value, index) ? value : fallback;
}

std::string Properties::text(const char* name) const {
    char* value = nullptr;
    if (!handle_ || current.property->propGetString(handle_, name, 0, &value) != kOk || value == nullptr) return {};
    return value;
}

Properties effect_properties(OfxImageEffectHandle effect) {
    OfxPropertySetHandle set = nullptr;
    return current.effect->getPropertySet(effect, &set) == kOk ? Properties(set) : Properties();
}

OfxParamSetHandle parameter_set(OfxImageEffectHandle effect) {
    OfxParamSetHandle set = nullptr;
    return current.effect->getParamSet(effect, &set) == kOk ? set : nullptr;
}

bool aborted(OfxImageEffectHandle effect) { return current.effect->abort && current.effect->abort(effect) != 0; }

void show_error(OfxImageEffectHandle effect, const std::string& text) {
    if (current.persistent && current.persistent->setPersistentMessage) {
        const OfxStatus shown =
            current.persistent->setPersistentMessage(effect, name::kMessageError, "relume", "%s", text.c_str());
        if (shown == kOk) return;
    }
    if (current.message && current.message->message)
        current.message->message(effect, name::kMessageError, "relume", "%s", text.c_str());
}

void clear_message(OfxImageEffectHandle effect) {
    if (current.persistent && current.persistent->clearPersistentMessage)
        current.persistent->clearPersistentMessage(effect);
}

}  // namespace relume::ofx
