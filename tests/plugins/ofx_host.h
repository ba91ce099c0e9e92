// SPDX-License-Identifier: Apache-2.0
#pragma once

// A host of OpenFX image effects, to try the node in: property sets that know what they hold, parameters with keys,
// clips with images of any depth, bounds and row order. It complains about what a strict host would refuse.

#include <atomic>
#include <cstddef>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <tuple>
#include <variant>
#include <vector>

#include "ofx/ofx_abi.h"

namespace relume::ofx::test {

class Host;

/// Properties of declared names, types and dimensions.
class PropertySet {
public:
    using Value = std::variant<int, double, std::string, void*>;
    explicit PropertySet(Host* host = nullptr) : host_(host) {}

    /// `dimension` 0: any number of values.
    void declare(const std::string& name, Value initial, int dimension = 1);
    template <class T> OfxStatus set(const char* name, int index, T value);
    template <class T> OfxStatus get(const char* name, int index, T* value);
    OfxStatus get_string(const char* name, int index, char** value);
    OfxStatus dimension(const char* name, int* count);

    // For the tests: throw where there is none.
    int integer(const std::string& name, int index = 0) const;
    double number(const std::string& name, int index = 0) const;
    std::string text(const std::string& name, int index = 0) const;
    std::vector<std::string> texts(const std::string& name) const;
    bool has(const std::string& name) const { return entries_.contains(name); }
    OfxPropertySetHandle handle() { return reinterpret_cast<OfxPropertySetHandle>(this); }

private:
    struct Entry {
        std::vector<Value> values;
        Value initial;
        int dimension = 1;
    };
    Entry* find(const char* name);
    Host* host_;
    std::map<std::string, Entry> entries_;
};

/// A parameter: described, then with a value that may have keys.
struct Parameter {
    using Value = std::variant<int, std::vector<double>, std::string>;
    Parameter(Host* host, std::string type_name);
    std::string type;
    PropertySet properties;
    Value value;
    std::map<double, Value> keys;  ///< numbers: linear between
    std::string returned;          ///< what a string query points to

    Value at(double time) const;
    void reset();  ///< to the default
};

/// What a clip delivers: full-resolution pixels, from which proxies are filtered.
struct Picture {
    OfxRectI bounds{};          ///< pixels at full scale, y up
    std::vector<float> pixels;  ///< R, G, B, A from the bottom row up
    Picture() = default;
    Picture(const OfxRectI& rect, const std::function<float(int x, int y, int component)>& value);
    float at(int x, int y, int component) const;  ///< 0 outside
};

struct Image;

struct Clip {
    explicit Clip(Host* owner);
    ~Clip();
    Host* host;
    std::string name;
    PropertySet properties;
    bool connected = false;
    bool has_image = true;                         ///< a connected clip may have none
    std::optional<OfxRectD> region_of_definition;  ///< else the picture's bounds
    std::function<Picture(double time)> picture;
    std::string depth = name::kDepthFloat, components = name::kRgba;
    double aspect = 1;
    int padding = 0;        ///< bytes after each row
    bool top_down = false;  ///< negative row bytes
    int margin = 0;         ///< pixels that the image has beyond what it must
    /// Where it is set, this image is handed out each time, as hosts do that keep what they have: the same memory.
    std::unique_ptr<Image> lasting;
    std::atomic<int> fetched{0};

    OfxRectD region(double time) const;
    /// The image of a time and scale, new.
    std::unique_ptr<Image> image(double time, double scale) const;
};

/// An image that a clip gave: memory with a margin on every side that nobody may touch.
struct Image {
    explicit Image(Host* host);
    PropertySet properties;
    OfxRectI bounds{};
    std::vector<std::byte> memory;
    std::byte* first = nullptr;  ///< of the bottom row
    std::ptrdiff_t row_bytes = 0;
    std::string depth, components;
    std::thread::id owner = std::this_thread::get_id();  ///< who asked for it
    int component_count() const;
    std::size_t component_bytes() const;
    std::byte* at(int x, int y, int component) const;
    float number(int x, int y, int component) const;  ///< integers as 0..1
    void put(int x, int y, int component, float value);
    void allocate(int padding, bool top_down);
    bool margins_untouched() const;
};

/// An effect: a descriptor, or an instance of the node.
struct Effect {
    explicit Effect(Host* owner) : host(owner), properties(owner) {}
    Host* host;
    PropertySet properties;
    std::map<std::string, std::unique_ptr<Clip>> clips;
    std::map<std::string, std::unique_ptr<Parameter>> parameters;
    std::vector<std::string> order;  ///< of the parameters
    bool is_descriptor = false;
    std::function<bool()> abort;
    std::string message;  ///< persistent; "" when cleared
    OfxImageEffectHandle handle() { return reinterpret_cast<OfxImageEffectHandle>(this); }
};

struct HostOptions {
    std::set<std::string> missing_suites{};       ///< "OfxMessageSuite"; with version: "OfxMessageSuite 2"
    std::map<std::string, int> suite_versions{};  ///< suites that are there in this version alone
    std::set<std::string> null_members{};         ///< "abort", "clipGetRegionOfDefinition", …
    std::set<std::string> unknown_properties{};   ///< that no set has
    std::string name = "org.relume.testhost";
    bool complain = true;  ///< about properties that are not known; off for hosts that lack some on purpose
};

class Host {
public:
    explicit Host(HostOptions options = {});
    Host(const Host&) = delete;
    Host& operator=(const Host&) = delete;
    ~Host();
    static Host* current;  ///< the latest: some calls of the ABI say nothing of whose they are

    OfxHost* abi() { return &abi_; }
    const void* suite(const char* name, int version);
    bool unknown(const std::string& property) const { return options_.unknown_properties.contains(property); }
    void complain(const std::string& what);
    std::vector<std::string> complaints() const;

    // Images that the node has and has to give back.
    std::mutex images_mutex;
    std::map<Image*, std::unique_ptr<Image>> images;
    std::multiset<OfxPropertySetHandle> lent;  ///< of the images that last
    std::vector<std::string> dialogs;          ///< of the message suite

    /// Where the output of this thread's render goes.
    static thread_local Image* output;

private:
    HostOptions options_;
    PropertySet properties_{nullptr};
    OfxHost abi_{};
    OfxPropertySuiteV1 property_suite_{};
    OfxImageEffectSuiteV1 effect_suite_{};
    OfxParameterSuiteV1 parameter_suite_{};
    OfxMessageSuiteV2 message_suite_{};
    mutable std::mutex complaints_mutex_;
    std::vector<std::string> complaints_;
};

// The suites' tables, complete.
OfxPropertySuiteV1 property_suite();
OfxImageEffectSuiteV1 effect_suite();
OfxParameterSuiteV1 parameter_suite();
OfxMessageSuiteV2 message_suite();

void declare_effect_descriptor(PropertySet& set);
void declare_clip_descriptor(PropertySet& set);
void declare_parameter(PropertySet& set, const std::string& type);
int component_count_of(const std::string& components);

}  // namespace relume::ofx::test
