// SPDX-License-Identifier: Apache-2.0
// The host's property sets and their suite.
#include <stdexcept>

#include "ofx_host.h"

namespace relume::ofx::test {

void PropertySet::declare(const std::string& name, Value initial, int dimension) {
    Entry entry;
    entry.initial = initial;
    entry.dimension = dimension;
    entry.values.assign(static_cast<std::size_t>(dimension), initial);
    entries_[name] = std::move(entry);
}

PropertySet::Entry* PropertySet::find(const char* name) {
    if (name == nullptr || (host_ && host_->unknown(name))) return nullptr;
    const auto found = entries_.find(name);
    if (found == entries_.end()) {
        if (host_) host_->complain(std::string("no property ") + name);
        return nullptr;
    }
    return &found->second;
}

template <class T> OfxStatus PropertySet::set(const char* name, int index, T value) {
    Entry* entry = find(name);
    if (entry == nullptr) return kErrUnknown;
    Value stored(std::move(value));
    if (stored.index() != entry->initial.index()) {
        if (host_) host_->complain(std::string("wrong type of property ") + name);
        return kErrValue;
    }
    if (index < 0 || (entry->dimension > 0 && index >= entry->dimension)) {
        if (host_) host_->complain(std::string("index beyond property ") + name);
        return kErrBadIndex;
    }
    if (static_cast<std::size_t>(index) >= entry->values.size())
        entry->values.resize(static_cast<std::size_t>(index) + 1, entry->initial);
    entry->values[static_cast<std::size_t>(index)] = std::move(stored);
    return kOk;
}

template <class T> OfxStatus PropertySet::get(const char* name, int index, T* value) {
    const Entry* entry = find(name);
    if (entry == nullptr) return kErrUnknown;
    if (index < 0 || static_cast<std::size_t>(index) >= entry->values.size()) return kErrBadIndex;
    const T* stored = std::get_if<T>(&entry->values[static_cast<std::size_t>(index)]);
    if (stored == nullptr) {
        if (host_) host_->complain(std::string("wrong type asked of property ") + name);
        return kErrValue;
    }
    *value = *stored;
    return kOk;
}

OfxStatus PropertySet::get_string(const char* name, int index, char** value) {
    const Entry* entry = find(name);
    if (entry == nullptr) return kErrUnknown;
    if (index < 0 || static_cast<std::size_t>(index) >= entry->values.size()) return kErrBadIndex;
    const auto* stored = std::get_if<std::string>(&entry->values[static_cast<std::size_t>(index)]);
    if (stored == nullptr) return kErrValue;
    *value = const_cast<char*>(stored->c_str());
    return kOk;
}

OfxStatus PropertySet::dimension(const char* name, int* count) {
    const Entry* entry = find(name);
    if (entry == nullptr) return kErrUnknown;
    *count = static_cast<int>(entry->values.size());
    return kOk;
}

template OfxStatus PropertySet::set(const char*, int, int);
template OfxStatus PropertySet::set(const char*, int, double);
template OfxStatus PropertySet::set(const char*, int, std::string);
template OfxStatus PropertySet::set(const char*, int, void*);

int PropertySet::integer(const std::string& name, int index) const {
    return std::get<int>(entries_.at(name).values.at(static_cast<std::size_t>(index)));
}
double PropertySet::number(const std::string& name, int index) const {
    return std::get<double>(entries_.at(name).values.at(static_cast<std::size_t>(index)));
}
std::string PropertySet::text(const std::string& name, int index) const {
    return std::get<std::string>(entries_.at(name).values.at(static_cast<std::size_t>(index)));
}
std::vector<std::string> PropertySet::texts(const std::string& name) const {
    std::vector<std::string> all;
    for (const Value& value : entries_.at(name).values) all.push_back(std::get<std::string>(value));
    return all;
}

namespace {

PropertySet* of(OfxPropertySetHandle handle) { return reinterpret_cast<PropertySet*>(handle); }

template <class T> OfxStatus set_one(OfxPropertySetHandle handle, const char* name, int index, T value) {
    if (handle == nullptr) return kErrBadHandle;
    return of(handle)->set<T>(name, index, std::move(value));
}

template <class T> OfxStatus get_one(OfxPropertySetHandle handle, const char* name, int index, T* value) {
    if (handle == nullptr) return kErrBadHandle;
    return of(handle)->get<T>(name, index, value);
}

template <class T, class Given>
OfxStatus set_many(OfxPropertySetHandle handle, const char* name, int count, const Given* values) {
    for (int k = 0; k < count; ++k)
        if (const OfxStatus status = set_one<T>(handle, name, k, T(values[k])); status != kOk) return status;
    return kOk;
}

template <class T> OfxStatus get_many(OfxPropertySetHandle handle, const char* name, int count, T* values) {
    for (int k = 0; k < count; ++k)
        if (const OfxStatus status = get_one<T>(handle, name, k, values + k); status != kOk) return status;
    return kOk;
}

}  // namespace

OfxPropertySuiteV1 property_suite() {
    OfxPropertySuiteV1 s{};
    s.propSetPointer = [](OfxPropertySetHandle h, const char* n, int i, void* v) { return set_one<void*>(h, n, i, v); };
    s.propSetString = [](OfxPropertySetHandle h, const char* n, int i, const char* v) {
        return set_one<std::string>(h, n, i, v);
    };
    s.propSetDouble = [](OfxPropertySetHandle h, const char* n, int i, double v) {
        return set_one<double>(h, n, i, v);
    };
    s.propSetInt = [](OfxPropertySetHandle h, const char* n, int i, int v) { return set_one<int>(h, n, i, v); };
    s.propSetPointerN = [](OfxPropertySetHandle h, const char* n, int c, void* const* v) {
        return set_many<void*>(h, n, c, v);
    };
    s.propSetStringN = [](OfxPropertySetHandle h, const char* n, int c, const char* const* v) {
        return set_many<std::string>(h, n, c, v);
    };
    s.propSetDoubleN = [](OfxPropertySetHandle h, const char* n, int c, const double* v) {
        return set_many<double>(h, n, c, v);
    };
    s.propSetIntN = [](OfxPropertySetHandle h, const char* n, int c, const int* v) {
        return set_many<int>(h, n, c, v);
    };
    s.propGetPointer = [](OfxPropertySetHandle h, const char* n, int i, void** v) {
        return get_one<void*>(h, n, i, v);
    };
    s.propGetString = [](OfxPropertySetHandle h, const char* n, int i, char** v) -> OfxStatus {
        return h ? of(h)->get_string(n, i, v) : kErrBadHandle;
    };
    s.propGetDouble = [](OfxPropertySetHandle h, const char* n, int i, double* v) {
        return get_one<double>(h, n, i, v);
    };
    s.propGetInt = [](OfxPropertySetHandle h, const char* n, int i, int* v) { return get_one<int>(h, n, i, v); };
    s.propGetPointerN = [](OfxPropertySetHandle h, const char* n, int c, void** v) {
        return get_many<void*>(h, n, c, v);
    };
    s.propGetStringN = [](OfxPropertySetHandle h, const char* n, int c, char** v) -> OfxStatus {
        for (int k = 0; k < c; ++k)
            if (const OfxStatus status = of(h)->get_string(n, k, v + k); status != kOk) return status;
        return kOk;
    };
    s.propGetDoubleN = [](OfxPropertySetHandle h, const char* n, int c, double* v) {
        return get_many<double>(h, n, c, v);
    };
    // Clips of hosts on HostSupport answer this one with an error.
    s.propGetIntN = [](OfxPropertySetHandle, const char*, int, int*) -> OfxStatus { return kErrValue; };
    s.propReset = [](OfxPropertySetHandle, const char*) -> OfxStatus { return kOk; };
    s.propGetDimension = [](OfxPropertySetHandle h, const char* n, int* c) -> OfxStatus {
        return h ? of(h)->dimension(n, c) : kErrBadHandle;
    };
    return s;
}

void declare_effect_descriptor(PropertySet& set) {
    const std::string none;
    for (const char* text :
         {name::kPropLabel, name::kPropGrouping, name::kPropThreadSafety, name::kPropDescription, name::kPropContext})
        set.declare(text, none);
    set.declare(name::kPropSupportedContexts, none, 0);
    set.declare(name::kPropSupportedDepths, none, 0);
    for (const char* flag :
         {name::kPropSupportsTiles, name::kPropMultiResolution, name::kPropTemporalAccess, name::kPropMultipleDepths,
          name::kPropMultiplePars, name::kPropHostFrameThreading, name::kPropSingleInstance})
        set.declare(flag, 0);
}

void declare_clip_descriptor(PropertySet& set) {
    set.declare(name::kPropLabel, std::string());
    set.declare(name::kPropSupportedComponents, std::string(), 0);
    set.declare(name::kPropOptional, 0);
    set.declare(name::kPropTemporalAccess, 0);
    set.declare(name::kPropSupportsTiles, 1);
}

void declare_parameter(PropertySet& set, const std::string& type) {
    const std::string none;
    for (const char* text : {name::kPropLabel, name::kPropScriptName, name::kPropHint, name::kPropParent})
        set.declare(text, none);
    set.declare(name::kPropSecret, 0);
    if (type == name::kParamGroup) {
        set.declare(name::kPropGroupOpen, 1);
        return;
    }
    if (type == name::kParamPage) {
        set.declare(name::kPropPageChild, none, 0);
        return;
    }
    set.declare(name::kPropAnimates, type == name::kParamString ? 0 : 1);
    set.declare(name::kPropEvaluateOnChange, 1);
    const int dimension = type == name::kParamDouble2D                              ? 2
                          : type == name::kParamDouble3D || type == name::kParamRgb ? 3
                                                                                    : 1;
    const bool floating = type == name::kParamDouble || dimension > 1;
    if (type == name::kParamDouble2D) set.declare(name::kPropHostOverlay, 0);
    if (floating) {
        // A host that takes what is absent for a range of nothing, as some do.
        set.declare(name::kPropDefault, 0.0, dimension);
        for (const char* range : {name::kPropMin, name::kPropMax, name::kPropDisplayMin, name::kPropDisplayMax})
            set.declare(range, 0.0, dimension);
        if (type != name::kParamRgb) set.declare(name::kPropDoubleType, none);
    } else if (type == name::kParamString) {
        set.declare(name::kPropDefault, none);
        set.declare(name::kPropStringMode, std::string(name::kStringIsSingleLine));
        set.declare(name::kPropFilePathExists, 1);
    } else {
        set.declare(name::kPropDefault, 0);
        if (type == name::kParamInteger)
            for (const char* range : {name::kPropMin, name::kPropMax, name::kPropDisplayMin, name::kPropDisplayMax})
                set.declare(range, 0);
        if (type == name::kParamChoice) set.declare(name::kPropChoiceOption, none, 0);
    }
}

}  // namespace relume::ofx::test
