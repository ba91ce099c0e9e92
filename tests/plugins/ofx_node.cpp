// SPDX-License-Identifier: Apache-2.0
#include "ofx_node.h"

#include <dlfcn.h>

#include <algorithm>
#include <stdexcept>

namespace relume::ofx::test {

Binary::Binary(OfxPlugin* own) : plugin_(own) {
    if (own != nullptr) return;
    library_ = dlopen(RELUME_OFX_BINARY, RTLD_LAZY | RTLD_LOCAL);
    if (library_ == nullptr) throw std::runtime_error(dlerror());
    const auto count = reinterpret_cast<int (*)()>(symbol("OfxGetNumberOfPlugins"));
    const auto get = reinterpret_cast<OfxPlugin* (*)(int)>(symbol("OfxGetPlugin"));
    if (count() != 1) throw std::runtime_error("not one plugin");
    plugin_ = get(0);
}

Binary::~Binary() {
    if (library_ != nullptr) dlclose(library_);
}

void* Binary::symbol(const char* name) const {
    void* found = dlsym(library_, name);
    if (found == nullptr) throw std::runtime_error(std::string("no symbol ") + name);
    return found;
}

Node::Node(Host& host, const char* context, OfxPlugin* own) : host_(host), binary_(own), context_(context) {
    binary_.plugin()->setHost(host.abi());
    loaded_ = act(name::kActionLoad, nullptr);
    if (context_.empty() || loaded_ != kOk) return;
    if (describe(context) != kOk || create() != kOk) throw std::runtime_error("the node does not start");
}

Node::~Node() {
    if (instance_) destroy();
    if (loaded_ == kOk) unload();
}

OfxStatus Node::act(const char* action, Effect* effect, PropertySet* in, PropertySet* out) {
    const OfxStatus status =
        binary_.plugin()->mainEntry(action, effect, in ? in->handle() : nullptr, out ? out->handle() : nullptr);
    const std::scoped_lock lock(host_.images_mutex);
    const auto kept = [](const auto& entry) { return entry.first->owner == std::this_thread::get_id(); };
    if (std::erase_if(host_.images, kept) > 0) host_.complain(std::string("images were kept after ") + action);
    return status;
}

OfxStatus Node::describe(const char* context) {
    context_ = context;
    descriptor_ = std::make_unique<Effect>(&host_);
    descriptor_->is_descriptor = true;
    declare_effect_descriptor(descriptor_->properties);
    OfxStatus status = act(name::kActionDescribe, descriptor_.get());
    if (status != kOk) return status;
    PropertySet in(&host_);
    in.declare(name::kPropContext, std::string(context));
    status = act(name::kActionDescribeInContext, descriptor_.get(), &in);
    return status;
}

OfxStatus Node::create() {
    instance_ = std::make_unique<Effect>(&host_);
    PropertySet& p = instance_->properties;
    p.declare(name::kPropContext, context_);
    set_project(1920, 1080);
    for (const std::string& name : descriptor_->order) {
        const Parameter& from = *descriptor_->parameters.at(name);
        auto parameter = std::make_unique<Parameter>(&host_, from.type);
        parameter->properties = from.properties;
        parameter->reset();
        instance_->parameters[name] = std::move(parameter);
    }
    instance_->order = descriptor_->order;
    for (const auto& [name, described] : descriptor_->clips) {
        auto clip = std::make_unique<Clip>(&host_);
        clip->name = name;
        clip->properties.declare(name::kPropConnected, 0);
        clip->properties.declare(name::kPropImageAspect, 1.0);
        clip->properties.declare(name::kPropRenderScale, 1.0);  // the host's own: what images are filtered to
        clip->properties.declare(name::kPropPremultiplication, std::string(name::kPremultiplied));
        clip->properties.declare(name::kPropPixelDepth, std::string(name::kDepthFloat));
        clip->properties.declare(name::kPropComponents, std::string(name::kRgba));
        instance_->clips[name] = std::move(clip);
    }
    return act(name::kActionCreateInstance, instance_.get());
}

void Node::destroy() {
    act(name::kActionDestroyInstance, instance_.get());
    instance_.reset();
}

OfxStatus Node::unload() {
    loaded_ = kFailed;
    return act(name::kActionUnload, nullptr);
}

void Node::connect(const std::string& name, std::function<Picture(double)> picture) {
    Clip& to = clip(name);
    to.connected = true;
    to.picture = std::move(picture);
    to.properties.set<int>(name::kPropConnected, 0, 1);
    to.properties.set<double>(name::kPropImageAspect, 0, to.aspect);
}

void Node::connect(const std::string& name, Picture picture) {
    connect(name, [picture = std::move(picture)](double) { return picture; });
}

void Node::choose(const std::string& name, const std::string& option) {
    const std::vector<std::string> options = parameter(name).properties.texts(name::kPropChoiceOption);
    const auto found = std::find(options.begin(), options.end(), option);
    if (found == options.end()) throw std::runtime_error(name + " has no option " + option);
    parameter(name).value = static_cast<int>(found - options.begin());
}

OfxStatus Node::changed(const std::string& name, double time, const char* reason) {
    PropertySet in(&host_);
    in.declare(name::kPropType, std::string(name::kTypeParameter));
    in.declare(name::kPropName, name);
    in.declare(name::kPropChangeReason, std::string(reason));
    in.declare(name::kPropTime, time);
    in.declare(name::kPropRenderScale, 1.0, 2);
    return act(name::kActionInstanceChanged, instance_.get(), &in);
}

OfxStatus Node::render(const RenderJob& job, std::unique_ptr<Image>& image) {
    image = std::make_unique<Image>(&host_);
    image->bounds = job.bounds.x1 < job.bounds.x2 ? job.bounds : job.window;
    image->depth = job.depth;
    image->components = job.components;
    image->allocate(job.padding, job.top_down);
    for (int y = image->bounds.y1; y < image->bounds.y2; ++y)
        for (int x = image->bounds.x1; x < image->bounds.x2; ++x)
            for (int c = 0; c < image->component_count(); ++c) image->put(x, y, c, 0.25f);
    const OfxStatus status = render_into(job, *image);
    if (!image->margins_untouched()) host_.complain("the render wrote beyond its image");
    return status;
}

OfxStatus Node::render_into(const RenderJob& job, Image& image) {
    for (auto& [name, clip] : instance_->clips)  // several renders at once have one scale
        if (clip->properties.number(name::kPropRenderScale) != job.scale)
            clip->properties.set<double>(name::kPropRenderScale, 0, job.scale);
    Host::output = &image;
    PropertySet in(&host_);
    in.declare(name::kPropTime, job.time);
    in.declare(name::kPropRenderScale, job.scale, 2);
    in.declare(name::kPropRenderWindow, 0, 4);
    const int w[4] = {job.window.x1, job.window.y1, job.window.x2, job.window.y2};
    for (int k = 0; k < 4; ++k) in.set<int>(name::kPropRenderWindow, k, w[k]);
    const OfxStatus status = act(name::kActionRender, instance_.get(), &in);
    Host::output = nullptr;
    return status;
}

std::optional<OfxRectD> Node::region_of_definition(double time, double scale) {
    PropertySet in(&host_), out(&host_);
    in.declare(name::kPropTime, time);
    in.declare(name::kPropRenderScale, scale, 2);
    out.declare(name::kPropRegionOfDefinition, 0.0, 4);
    if (act(name::kActionRegionOfDefinition, instance_.get(), &in, &out) != kOk) return std::nullopt;
    return OfxRectD{out.number(name::kPropRegionOfDefinition, 0), out.number(name::kPropRegionOfDefinition, 1),
                    out.number(name::kPropRegionOfDefinition, 2), out.number(name::kPropRegionOfDefinition, 3)};
}

std::map<std::string, OfxRectD> Node::regions_of_interest(const OfxRectD& wanted, double time) {
    PropertySet in(&host_), out(&host_);
    in.declare(name::kPropTime, time);
    in.declare(name::kPropRegionOfInterest, 0.0, 4);
    const double w[4] = {wanted.x1, wanted.y1, wanted.x2, wanted.y2};
    for (int k = 0; k < 4; ++k) in.set<double>(name::kPropRegionOfInterest, k, w[k]);
    std::map<std::string, OfxRectD> regions;
    for (const auto& [name, clip] : instance_->clips) {
        if (name == name::kClipOutput) continue;
        out.declare(name::kPropClipRegionPrefix + name, 0.0, 4);
        for (int k = 0; k < 4; ++k) out.set<double>((name::kPropClipRegionPrefix + name).c_str(), k, w[k]);
    }
    act(name::kActionRegionsOfInterest, instance_.get(), &in, &out);
    for (const auto& [name, clip] : instance_->clips) {
        if (name == name::kClipOutput) continue;
        const std::string key = name::kPropClipRegionPrefix + name;
        regions[name] = {out.number(key, 0), out.number(key, 1), out.number(key, 2), out.number(key, 3)};
    }
    return regions;
}

PropertySet Node::clip_preferences() {
    PropertySet out(&host_);
    for (const auto& [name, clip] : instance_->clips) {
        out.declare(name::kPropClipComponentsPrefix + name, std::string(name::kRgba));
        out.declare(name::kPropClipDepthPrefix + name, std::string(name::kDepthFloat));
    }
    out.declare(name::kPropPremultiplication, std::string());
    out.declare(name::kPropFrameVarying, 0);
    act(name::kActionClipPreferences, instance_.get(), nullptr, &out);
    return out;
}

void Node::set_project(double width, double height, double offset_x, double offset_y, double aspect) {
    PropertySet& p = instance_->properties;
    p.declare(name::kPropProjectSize, 0.0, 2);
    p.declare(name::kPropProjectOffset, 0.0, 2);
    p.declare(name::kPropProjectAspect, aspect);
    p.set<double>(name::kPropProjectSize, 0, width);
    p.set<double>(name::kPropProjectSize, 1, height);
    p.set<double>(name::kPropProjectOffset, 0, offset_x);
    p.set<double>(name::kPropProjectOffset, 1, offset_y);
}

}  // namespace relume::ofx::test
