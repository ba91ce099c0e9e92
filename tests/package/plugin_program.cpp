// SPDX-License-Identifier: Apache-2.0
// Shading models from outside the tree, found on RELUME_SHADER_PATH: one that loads and shades, and some that must not.
#include <relume/relight.h>
#include <relume/shader.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iostream>
#include <map>
#include <string>
#include <vector>

namespace {

int failures = 0;

void expect(bool condition, const std::string& what) {
    if (condition) return;
    ++failures;
    std::cerr << "FAILED: " << what << '\n';
}

relume::ConstPlane plane(const float& value) {
    return {reinterpret_cast<const std::byte*>(&value), relume::PixelType::float32, 4, 4};
}

/// One pixel of a white surface, its normal along z, under a sun of irradiance π at `height` over the horizon.
float relit(float height) {
    const float zero = 0, one = 1;
    const std::map<std::string, relume::MemoryChannel> channels{
        {"normal", {{plane(zero), plane(zero), plane(one)}, {}}},
        {"base_color", {{plane(one), plane(one), plane(one)}, {}}},
    };
    const auto gbuffer = relume::GBuffer::from_memory(1, 1, channels);
    const float across = std::sqrt(1 - height * height);
    const auto rig = relume::Rig::loads(
        "version = 1\n[[light]]\nname = 'sun'\ntype = 'sun'\nirradiance = 3.14159265\ndirection = [" +
        std::to_string(across) + ", 0, " + std::to_string(-height) +
        "]\n[[shader]]\nuse = 'toon'\nthreshold = 0.5\nshade = 0.25\n");
    std::array<float, 4> rgba{};
    std::vector<relume::Plane> out;
    for (float& component : rgba)
        out.push_back({reinterpret_cast<std::byte*>(&component), relume::PixelType::float32, 4, 4});
    relume::relight(gbuffer, rig, {{"beauty", out}});
    return rgba[0];
}

}  // namespace

int main() {
    const relume::ShaderInfo* toon = relume::find_shader("toon");
    expect(toon != nullptr, "toon is registered");
    if (toon != nullptr) {
        expect(toon->parameters.size() == 4, "toon has its four parameters");
        expect(toon->file.filename() == "toon.relume.so", "toon says where it comes from");
        expect(std::abs(relit(0.8f) - 1.f) < 1e-5f, "toon in the light");
        expect(std::abs(relit(0.3f) - 0.25f) < 1e-5f, "toon's dark tone");
    }
    const auto report_of = [](const std::string& file) -> const relume::PluginReport* {
        const auto reports = relume::plugin_reports();
        const auto found =
            std::find_if(reports.begin(), reports.end(), [&](const auto& r) { return r.file.filename() == file; });
        return found == reports.end() ? nullptr : &*found;
    };
    const auto refused = [&](const std::string& file, const std::string& reason) {
        const relume::PluginReport* report = report_of(file);
        expect(report != nullptr && !report->loaded && report->message.find(reason) != std::string::npos,
               file + " is refused: " + (report != nullptr ? report->message : "not even looked at"));
    };
    expect(report_of("toon.relume.so") != nullptr && report_of("toon.relume.so")->loaded, "toon's report");
    refused("old_abi.relume.so", "shader ABI 0");
    refused("half_old.relume.so", "shader ABI 1");
    expect(relume::find_shader("half_good") == nullptr, "of a file that is refused nothing is taken");
    refused("no_entry.relume.so", "relume_shader_plugin_v1");
    refused("no_library.relume.so", "no_library.relume.so");
    refused("no_such_folder", "cannot be read");
    if (failures == 0) std::cout << "plugins: all well\n";
    return failures == 0 ? 0 : 1;
}
