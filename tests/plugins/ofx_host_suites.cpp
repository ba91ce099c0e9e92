// SPDX-License-Identifier: Apache-2.0
// The host's suites of effects, parameters and messages.
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstring>

#include "ofx_host.h"

namespace relume::ofx::test {

namespace {

Effect* of(OfxImageEffectHandle handle) { return reinterpret_cast<Effect*>(handle); }
Effect* of(OfxParamSetHandle handle) { return reinterpret_cast<Effect*>(handle); }
Clip* of(OfxImageClipHandle handle) { return reinterpret_cast<Clip*>(handle); }
Parameter* of(OfxParamHandle handle) { return reinterpret_cast<Parameter*>(handle); }

// ---- effects and clips

OfxStatus define_clip(OfxImageEffectHandle handle, const char* name, OfxPropertySetHandle* properties) {
    Effect& effect = *of(handle);
    if (effect.clips.contains(name)) return kErrExists;
    auto clip = std::make_unique<Clip>(effect.host);
    clip->name = name;
    declare_clip_descriptor(clip->properties);
    *properties = clip->properties.handle();
    effect.clips[name] = std::move(clip);
    return kOk;
}

OfxStatus clip_handle(OfxImageEffectHandle handle, const char* name, OfxImageClipHandle* clip,
                      OfxPropertySetHandle* properties) {
    Effect& effect = *of(handle);
    const auto found = effect.clips.find(name);
    if (found == effect.clips.end()) return kErrBadHandle;
    *clip = reinterpret_cast<OfxImageClipHandle>(found->second.get());
    if (properties) *properties = found->second->properties.handle();
    return kOk;
}

/// The pixels of a proxy are means of those they cover.
float filtered(const Picture& picture, int x, int y, int component, double scale) {
    if (scale == 1) return picture.at(x, y, component);
    const int low_x = static_cast<int>(std::floor(x / scale)), high_x = static_cast<int>(std::ceil((x + 1) / scale));
    const int low_y = static_cast<int>(std::floor(y / scale)), high_y = static_cast<int>(std::ceil((y + 1) / scale));
    double sum = 0;
    for (int j = low_y; j < high_y; ++j)
        for (int i = low_x; i < high_x; ++i) sum += static_cast<double>(picture.at(i, j, component));
    return static_cast<float>(sum / ((high_x - low_x) * (high_y - low_y)));
}

}  // namespace

std::unique_ptr<Image> Clip::image(double time, double scale) const {
    const Picture from = picture(time);
    auto made = std::make_unique<Image>(host);
    made->depth = depth;
    made->components = components;
    OfxRectI bounds{
        static_cast<int>(std::floor(from.bounds.x1 * scale)), static_cast<int>(std::floor(from.bounds.y1 * scale)),
        static_cast<int>(std::ceil(from.bounds.x2 * scale)), static_cast<int>(std::ceil(from.bounds.y2 * scale))};
    made->bounds = {bounds.x1 - margin, bounds.y1 - margin, bounds.x2 + margin, bounds.y2 + margin};
    made->allocate(padding, top_down);
    const bool as_it_is = scale == 1 && depth == name::kDepthFloat && components == name::kRgba && margin == 0;
    const std::size_t row = 4 * static_cast<std::size_t>(bounds.x2 - bounds.x1);
    for (int y = bounds.y1; as_it_is && y < bounds.y2; ++y)
        std::memcpy(made->at(bounds.x1, y, 0), from.pixels.data() + row * static_cast<std::size_t>(y - bounds.y1),
                    row * sizeof(float));
    for (int y = made->bounds.y1; !as_it_is && y < made->bounds.y2; ++y)
        for (int x = made->bounds.x1; x < made->bounds.x2; ++x)
            for (int c = 0; c < made->component_count(); ++c) made->put(x, y, c, filtered(from, x, y, c, scale));
    made->properties.set<double>(name::kPropImageAspect, 0, aspect);
    made->properties.set<std::string>(name::kPropPremultiplication, 0, properties.text(name::kPropPremultiplication));
    return made;
}

namespace {

OfxStatus clip_image(OfxImageClipHandle handle, OfxTime time, const OfxRectD*, OfxPropertySetHandle* result) {
    Clip& clip = *of(handle);
    ++clip.fetched;
    if (clip.name == name::kClipOutput) {
        Image* image = clip.host->output;
        if (image == nullptr || !clip.has_image) return kFailed;
        *result = image->properties.handle();
        return kOk;
    }
    if (!clip.connected) return kFailed;
    if (clip.lasting) {
        *result = clip.lasting->properties.handle();
        const std::scoped_lock lock(clip.host->images_mutex);
        clip.host->lent.insert(*result);
        return kOk;
    }
    if (!clip.has_image || !clip.picture) {
        // A host that says connected and gives an image without data.
        auto empty = std::make_unique<Image>(clip.host);
        empty->bounds = {0, 0, 0, 0};
        empty->allocate(0, false);
        empty->properties.set<void*>(name::kPropData, 0, nullptr);
        *result = empty->properties.handle();
        const std::scoped_lock lock(clip.host->images_mutex);
        Image* key = empty.get();
        clip.host->images[key] = std::move(empty);
        return kOk;
    }
    std::unique_ptr<Image> image = clip.image(time, clip.properties.number(name::kPropRenderScale));
    *result = image->properties.handle();
    const std::scoped_lock lock(clip.host->images_mutex);
    Image* key = image.get();
    clip.host->images[key] = std::move(image);
    return kOk;
}

Image* image_of(Host& host, OfxPropertySetHandle properties) {
    for (auto& [image, owner] : host.images)
        if (image->properties.handle() == properties) return image;
    return nullptr;
}

OfxStatus release_image(OfxPropertySetHandle handle) {
    Host& host = *Host::current;  // the image alone is given
    const std::scoped_lock lock(host.images_mutex);
    if (host.output && host.output->properties.handle() == handle) return kOk;
    if (const auto at = host.lent.find(handle); at != host.lent.end()) {
        host.lent.erase(at);
        return kOk;
    }
    Image* image = image_of(host, handle);
    if (image == nullptr) {
        host.complain("an image that the host does not know is given back");
        return kErrBadHandle;
    }
    if (!image->margins_untouched()) host.complain("an input image was written to, or beyond");
    host.images.erase(image);
    return kOk;
}

OfxStatus clip_region(OfxImageClipHandle handle, OfxTime time, OfxRectD* region) {
    Clip& clip = *of(handle);
    if (!clip.connected) return kFailed;
    *region = clip.region(time);
    return kOk;
}

// ---- parameters

OfxStatus define_parameter(OfxParamSetHandle handle, const char* type, const char* name,
                           OfxPropertySetHandle* properties) {
    Effect& effect = *of(handle);
    if (!effect.is_descriptor) return kErrUnsupported;
    if (effect.parameters.contains(name)) {
        effect.host->complain(std::string("two parameters are called ") + name);
        return kErrExists;
    }
    auto parameter = std::make_unique<Parameter>(effect.host, type);
    *properties = parameter->properties.handle();
    effect.parameters[name] = std::move(parameter);
    effect.order.emplace_back(name);
    return kOk;
}

OfxStatus parameter_handle(OfxParamSetHandle handle, const char* name, OfxParamHandle* parameter,
                           OfxPropertySetHandle* properties) {
    Effect& effect = *of(handle);
    const auto found = effect.parameters.find(name);
    if (found == effect.parameters.end()) {
        effect.host->complain(std::string("no parameter ") + name);
        return kErrUnknown;
    }
    *parameter = reinterpret_cast<OfxParamHandle>(found->second.get());
    if (properties) *properties = found->second->properties.handle();
    return kOk;
}

OfxStatus read_value(Parameter& parameter, double time, va_list arguments) {
    const Parameter::Value value = parameter.at(time);
    if (const auto* integer = std::get_if<int>(&value)) *va_arg(arguments, int*) = *integer;
    if (const auto* numbers = std::get_if<std::vector<double>>(&value))
        for (const double number : *numbers) *va_arg(arguments, double*) = number;
    if (const auto* text = std::get_if<std::string>(&value)) {
        static std::mutex mutex;
        const std::scoped_lock lock(mutex);
        if (parameter.returned != *text) parameter.returned = *text;
        *va_arg(arguments, char**) = parameter.returned.data();
    }
    return kOk;
}

OfxStatus write_value(Parameter& parameter, const double* time, va_list arguments) {
    Parameter::Value value = parameter.value;
    if (auto* integer = std::get_if<int>(&value)) *integer = va_arg(arguments, int);
    if (auto* numbers = std::get_if<std::vector<double>>(&value))
        for (double& number : *numbers) number = va_arg(arguments, double);
    if (auto* text = std::get_if<std::string>(&value)) *text = va_arg(arguments, const char*);
    if (time) parameter.keys[*time] = value;
    else parameter.value = value;
    return kOk;
}

OfxStatus get_value(OfxParamHandle handle, ...) {
    va_list arguments;
    va_start(arguments, handle);
    const OfxStatus status = read_value(*of(handle), 0, arguments);
    va_end(arguments);
    return status;
}
OfxStatus get_value_at(OfxParamHandle handle, OfxTime time, ...) {
    va_list arguments;
    va_start(arguments, time);
    const OfxStatus status = read_value(*of(handle), time, arguments);
    va_end(arguments);
    return status;
}
OfxStatus set_value(OfxParamHandle handle, ...) {
    va_list arguments;
    va_start(arguments, handle);
    const OfxStatus status = write_value(*of(handle), nullptr, arguments);
    va_end(arguments);
    return status;
}
OfxStatus set_value_at(OfxParamHandle handle, OfxTime time, ...) {
    va_list arguments;
    va_start(arguments, time);
    const OfxStatus status = write_value(*of(handle), &time, arguments);
    va_end(arguments);
    return status;
}

// ---- messages

std::string formatted(const char* format, va_list arguments) {
    char text[2000];
    std::vsnprintf(text, sizeof text, format, arguments);
    return text;
}

OfxStatus show_dialog(void* handle, const char*, const char*, const char* format, ...) {
    va_list arguments;
    va_start(arguments, format);
    of(static_cast<OfxImageEffectHandle>(handle))->host->dialogs.push_back(formatted(format, arguments));
    va_end(arguments);
    return kOk;
}

std::mutex message_mutex;

OfxStatus set_message(void* handle, const char*, const char*, const char* format, ...) {
    va_list arguments;
    va_start(arguments, format);
    const std::scoped_lock lock(message_mutex);
    of(static_cast<OfxImageEffectHandle>(handle))->message = formatted(format, arguments);
    va_end(arguments);
    return kOk;
}

OfxStatus clear_message(void* handle) {
    const std::scoped_lock lock(message_mutex);
    std::string& message = of(static_cast<OfxImageEffectHandle>(handle))->message;
    if (!message.empty()) message.clear();
    return kOk;
}

}  // namespace

OfxImageEffectSuiteV1 effect_suite() {
    OfxImageEffectSuiteV1 s{};
    s.getPropertySet = [](OfxImageEffectHandle h, OfxPropertySetHandle* set) -> OfxStatus {
        *set = of(h)->properties.handle();
        return kOk;
    };
    s.getParamSet = [](OfxImageEffectHandle h, OfxParamSetHandle* set) -> OfxStatus {
        *set = reinterpret_cast<OfxParamSetHandle>(h);
        return kOk;
    };
    s.clipDefine = define_clip;
    s.clipGetHandle = clip_handle;
    s.clipGetPropertySet = [](OfxImageClipHandle h, OfxPropertySetHandle* set) -> OfxStatus {
        *set = of(h)->properties.handle();
        return kOk;
    };
    s.clipGetImage = clip_image;
    s.clipReleaseImage = release_image;
    s.clipGetRegionOfDefinition = clip_region;
    s.abort = [](OfxImageEffectHandle h) { return of(h)->abort && of(h)->abort() ? 1 : 0; };
    return s;
}

OfxParameterSuiteV1 parameter_suite() {
    OfxParameterSuiteV1 s{};
    s.paramDefine = define_parameter;
    s.paramGetHandle = parameter_handle;
    s.paramSetGetPropertySet = [](OfxParamSetHandle h, OfxPropertySetHandle* set) -> OfxStatus {
        *set = of(h)->properties.handle();
        return kOk;
    };
    s.paramGetPropertySet = [](OfxParamHandle h, OfxPropertySetHandle* set) -> OfxStatus {
        *set = of(h)->properties.handle();
        return kOk;
    };
    s.paramGetValue = get_value;
    s.paramGetValueAtTime = get_value_at;
    s.paramSetValue = set_value;
    s.paramSetValueAtTime = set_value_at;
    return s;
}

OfxMessageSuiteV2 message_suite() { return {show_dialog, set_message, clear_message}; }

}  // namespace relume::ofx::test
