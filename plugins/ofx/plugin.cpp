// SPDX-License-Identifier: Apache-2.0
// The three symbols that the bundle exports, and the one function that every action comes through.
#include <exception>
#include <new>
#include <string_view>

#include "clip_gbuffer.h"
#include "describe.h"
#include "file_frames.h"
#include "host.h"
#include "instance.h"
#include "pick.h"
#include "relume/error.h"
#include "relume/shader.h"
#include "render.h"

namespace relume::ofx {

namespace {

OfxStatus instance_changed(OfxImageEffectHandle effect, const Properties& in) {
    const std::shared_ptr<const Instance> instance = instance_of(effect);
    if (in.text(name::kPropType) != name::kTypeParameter) return kReplyDefault;
    if (in.text(name::kPropChangeReason) == name::kChangeTime) return kReplyDefault;
    const std::string changed = in.text(name::kPropName);
    instance->record_choice(changed);
    if (changed == own::kShader || changed.ends_with(own::kType)) instance->show_knobs();
    // What the node itself wrote, or a project that is being loaded, is no click.
    if (in.text(name::kPropChangeReason) != name::kChangeUserEdited) return kOk;
    try {
        pick(*instance, changed, in.number(name::kPropTime, 0), in.number(name::kPropRenderScale, 1, 0),
             in.number(name::kPropRenderScale, 1, 1));
    } catch (const Error& error) {
        show_error(effect, "Relume: " + std::string(error.what()));
        return kFailed;
    }
    return kOk;
}

OfxStatus load() {
    if (!load_host()) return kErrMissingHostFeature;
    shaders();  // loads what is on RELUME_SHADER_PATH
    return kOk;
}

OfxStatus unload() {
    end_frames();
    understood_frames().clear();
    destroy_instances();
    unload_host();
    return kOk;
}

OfxStatus act(std::string_view action, OfxImageEffectHandle effect, const Properties& in, const Properties& out) {
    if (action == name::kActionLoad) return load();
    if (host().effect == nullptr) return kErrFatal;  // not loaded
    if (action == name::kActionUnload) return unload();
    if (action == name::kActionDescribe) {
        describe(effect);
        return kOk;
    }
    if (action == name::kActionDescribeInContext) {
        describe_in_context(effect, in.text(name::kPropContext));
        return kOk;
    }
    if (action == name::kActionCreateInstance) {
        create_instance(effect);
        return kOk;
    }
    if (action == name::kActionDestroyInstance) {
        destroy_instance(effect);
        return kOk;
    }
    if (action == name::kActionRender) return render(effect, in);
    if (action == name::kActionRegionOfDefinition) return region_of_definition(effect, in, out);
    if (action == name::kActionRegionsOfInterest) return regions_of_interest(effect, in, out);
    if (action == name::kActionClipPreferences) return clip_preferences(effect, out);
    if (action == name::kActionInstanceChanged) return instance_changed(effect, in);
    if (action == name::kActionPurgeCaches) {
        purge_frames();
        understood_frames().clear();
        return kOk;
    }
    return kReplyDefault;
}

/// Nothing is thrown through the ABI.
OfxStatus main_entry(const char* action, const void* handle, OfxPropertySetHandle in, OfxPropertySetHandle out) {
    if (action == nullptr) return kErrValue;
    const auto effect = static_cast<OfxImageEffectHandle>(const_cast<void*>(handle));
    try {
        return act(action, effect, Properties(in), Properties(out));
    } catch (const std::bad_alloc&) {
        try {
            if (host().effect && effect) show_error(effect, "Relume: there is not enough memory for this frame");
        } catch (...) {
            return kErrMemory;
        }
        return kErrMemory;
    } catch (const std::exception& error) {
        try {
            if (host().effect && effect) show_error(effect, std::string("Relume: ") + error.what());
        } catch (...) {
            return kFailed;
        }
        return kFailed;
    } catch (...) {
        return kFailed;
    }
}

void set_host(OfxHost* host) { take_host(host); }

OfxPlugin node = {name::kImageEffectApi, 1,        kIdentifier, RELUME_VERSION_MAJOR,
                  RELUME_VERSION_MINOR,  set_host, main_entry};

}  // namespace
}  // namespace relume::ofx

#define RELUME_OFX_ENTRY extern "C" __attribute__((visibility("default")))

RELUME_OFX_ENTRY int OfxGetNumberOfPlugins() { return 1; }

RELUME_OFX_ENTRY OfxPlugin* OfxGetPlugin(int nth) { return nth == 0 ? &relume::ofx::node : nullptr; }

RELUME_OFX_ENTRY OfxStatus OfxSetHost(const OfxHost* host) {
    relume::ofx::take_host(host);
    return relume::ofx::kOk;
}
