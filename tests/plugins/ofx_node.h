// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ofx_host.h"

namespace relume::ofx::test {

/// The bundle's binary, opened as hosts open it.
class Binary {
public:
    /// `own`: a plugin of this program, where nothing is opened.
    explicit Binary(OfxPlugin* own = nullptr);
    ~Binary();
    Binary(const Binary&) = delete;
    Binary& operator=(const Binary&) = delete;
    OfxPlugin* plugin() const { return plugin_; }
    void* symbol(const char* name) const;

private:
    void* library_ = nullptr;
    OfxPlugin* plugin_ = nullptr;
};

struct RenderJob {
    double time = 0;
    OfxRectI window{};
    double scale = 1;
    OfxRectI bounds{};  ///< of the output image; empty: the window
    std::string depth = name::kDepthFloat, components = name::kRgba;
    int padding = 0;
    bool top_down = false;
};

/// The node, loaded, described and with one instance.
class Node {
public:
    /// Loads; `context` "" leaves it there. `own` as for Binary.
    Node(Host& host, const char* context, OfxPlugin* own = nullptr);
    ~Node();
    Node(const Node&) = delete;
    Node& operator=(const Node&) = delete;

    OfxStatus act(const char* action, Effect* effect, PropertySet* in = nullptr, PropertySet* out = nullptr);
    OfxStatus loaded() const { return loaded_; }
    OfxStatus describe(const char* context);
    OfxStatus create();
    void destroy();
    OfxStatus unload();

    Effect& descriptor() { return *descriptor_; }
    Effect& instance() { return *instance_; }
    Clip& clip(const std::string& name) { return *instance_->clips.at(name); }
    void connect(const std::string& name, std::function<Picture(double)> picture);
    void connect(const std::string& name, Picture picture);

    Parameter& parameter(const std::string& name) { return *instance_->parameters.at(name); }
    void set(const std::string& name, const std::string& text) { parameter(name).value = text; }
    void set(const std::string& name, const char* text) { parameter(name).value = std::string(text); }
    void set(const std::string& name, int value) { parameter(name).value = value; }
    void set(const std::string& name, double value) { parameter(name).value = std::vector{value}; }
    void set(const std::string& name, std::vector<double> values) { parameter(name).value = std::move(values); }
    /// The choice whose option is called so.
    void choose(const std::string& name, const std::string& option);
    std::vector<double> numbers(const std::string& name) {
        return std::get<std::vector<double>>(parameter(name).value);
    }

    /// As the user's change in the panel; runs the InstanceChanged action.
    OfxStatus changed(const std::string& name, double time = 0, const char* reason = name::kChangeUserEdited);

    /// Renders into a new image whose pixels are first set to 0.25; `image` is it.
    OfxStatus render(const RenderJob& job, std::unique_ptr<Image>& image);
    /// Renders into an image that is there.
    OfxStatus render_into(const RenderJob& job, Image& image);
    std::optional<OfxRectD> region_of_definition(double time = 0, double scale = 1);
    std::map<std::string, OfxRectD> regions_of_interest(const OfxRectD& wanted, double time = 0);
    PropertySet clip_preferences();
    void set_project(double width, double height, double offset_x = 0, double offset_y = 0, double aspect = 1);

private:
    Host& host_;
    Binary binary_;
    OfxStatus loaded_ = kFailed;
    std::unique_ptr<Effect> descriptor_;
    std::unique_ptr<Effect> instance_;
    std::string context_;
};

}  // namespace relume::ofx::test
