// SPDX-License-Identifier: Apache-2.0
// libFuzzer's target for rigs: any text either is a rig that survives being written and read, or gives an Error of one
// short line; the same for KEY=VALUE as --set has it, where an Error leaves the rig as it was.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

#include "lights/bake.h"
#include "relume/error.h"
#include "relume/rig.h"
#include "relume/shader.h"
#include "text/printable.h"

namespace relume {

// A shading model of every type of parameter, so that no shader need be linked.
namespace {
constexpr Parameter kParameters[] = {
    {.name = "base_color", .type = ParameterType::color, .value = {0.8, 0.8, 0.8}, .min = 0, .slot = 0},
    {.name = "roughness", .value = {0.5}, .min = 0, .max = 1, .slot = 3},
    {.name = "distribution", .type = ParameterType::choice, .choices = "ggx|beckmann", .slot = 0},
    {.name = "energy_conserving", .type = ParameterType::boolean, .value = {1}, .slot = 1},
};
const ShaderInfo kShader{"ggx", "GGX", "", kParameters, {}, nullptr};
}  // namespace

std::span<const ShaderInfo> shaders() { return {&kShader, 1}; }
const ShaderInfo* find_shader(std::string_view name) { return name == kShader.name ? &kShader : nullptr; }
std::span<const BuiltinRig> builtin_rigs() { return {}; }

namespace {

void demand(bool holds) {
    if (!holds) std::abort();
}

void check_message(const Error& error) {
    const std::string message = error.what();
    demand(message.size() < 1000 && message == printable(message));
}

void load(const std::string& text) {
    try {
        const Rig rig = Rig::loads(text);
        demand(Rig::loads(rig.to_toml()) == rig);
    } catch (const Error& error) {
        check_message(error);
    }
}

/// One key at a time may leave a rig that waits for another: focal_length for its aperture, a point light for a
/// position, a direction of length 0 for a better one.
bool is_complete(const Rig& rig) {
    for (const Light& light : rig.lights) {
        if ((light.type == "point" || light.type == "spot") && !light.values.given("position")) return false;
        try {
            std::vector<std::string> warnings;
            bake_light(light, std::nullopt, warnings);
        } catch (const Error&) {
            return false;
        }
    }
    return rig.gbuffer.focal_length.has_value() == rig.gbuffer.horizontal_aperture.has_value();
}

void set(const std::string& key, const std::string& value) {
    static const Rig base = Rig::loads("[[light]]\nname='key'\ntype='spot'\nposition=[0,0,0]\n[[shader]]\nuse='ggx'\n");
    Rig rig = base;
    try {
        rig.set(key, value);
        if (is_complete(rig)) demand(Rig::loads(rig.to_toml()) == rig);
    } catch (const Error& error) {
        check_message(error);
        demand(rig == base);
    }
}

}  // namespace
}  // namespace relume

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string text(reinterpret_cast<const char*>(data), size);
    // An include could name any file of the machine.
    if (text.find("include") == std::string::npos) relume::load(text);
    if (const std::size_t equals = text.find('='); equals < 200)
        relume::set(text.substr(0, equals), text.substr(equals + 1));
    return 0;
}
