// SPDX-License-Identifier: Apache-2.0
// libFuzzer's target for the whole reading path: an EXR of any bytes is understood as a G-buffer and every channel of
// it read in canonical form, or gives an Error; what is said of it is UTF-8 on one line.
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "relume/error.h"
#include "relume/gbuffer.h"
#include "relume/shader.h"
#include "text/printable.h"

namespace relume {

// Parameters that channels may give, so that no shader need be linked.
namespace {
constexpr Parameter kParameters[] = {
    {.name = "base_color", .type = ParameterType::color, .value = {0.8, 0.8, 0.8}, .min = 0, .slot = 0},
    {.name = "roughness", .value = {0.5}, .min = 0, .max = 1, .slot = 3},
    {.name = "metallic", .value = {0.}, .min = 0, .max = 1, .slot = 4},
};
const ShaderInfo kShader{"ggx", "GGX", "", kParameters, {}, nullptr};
}  // namespace

std::span<const ShaderInfo> shaders() { return {&kShader, 1}; }
const ShaderInfo* find_shader(std::string_view name) { return name == kShader.name ? &kShader : nullptr; }

namespace {

constexpr std::int64_t kMostValues = 1 << 20;

void expect_printable(std::string_view text) {
    if (text != printable(text)) std::abort();
}

void check_words(const GBuffer& gbuffer) {
    for (const ChannelInfo& info : gbuffer.channels()) {
        for (const std::string& text : {info.name, info.part, info.interpretation, info.reason}) expect_printable(text);
        for (const std::string& source : info.sources) expect_printable(source);
    }
    for (const std::string& note : gbuffer.notes()) expect_printable(note);
    for (const auto& [layer, names] : gbuffer.cryptomatte()) {
        expect_printable(layer);
        for (const std::string& name : names) expect_printable(name);
    }
    expect_printable(gbuffer.working_space());
    expect_printable(gbuffer.camera_reason());
}

void read_all(const GBuffer& gbuffer) {
    const Window window = gbuffer.data_window();
    for (const ChannelInfo& info : gbuffer.channels()) {
        const bool id = info.name.ends_with("_id");
        const ChannelRequest request{
            id ? ChannelRequest::Kind::id : ChannelRequest::Kind::semantic, info.name, info.components, {}, 1, 0};
        const std::int64_t values = std::int64_t{window.width} * window.height * info.components;
        if (values > kMostValues) return;
        std::vector<float> pixels(static_cast<std::size_t>(values));
        std::vector<Plane> planes;
        for (int c = 0; c < info.components; ++c)
            planes.push_back({reinterpret_cast<std::byte*>(pixels.data()) + 4 * c,
                              id ? PixelType::uint32 : PixelType::float32, 4 * info.components,
                              std::ptrdiff_t{4} * info.components * window.width});
        try {
            read_channels(gbuffer, {&request, 1}, planes, 1);
        } catch (const Error&) {
            // a damaged chunk, or a channel that cannot be had: the next may be
        }
    }
}

}  // namespace
}  // namespace relume

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const int file = ::memfd_create("gbuffer", 0);
    static const std::string path = "/proc/self/fd/" + std::to_string(file);
    if (::ftruncate(file, 0) != 0 || ::pwrite(file, data, size, 0) != static_cast<ssize_t>(size)) return 0;
    relume::GBufferOptions options;
    options.max_pixels = 1 << 20;
    try {
        const relume::GBuffer gbuffer = relume::GBuffer::read(path, options);
        relume::check_words(gbuffer);
        relume::read_all(gbuffer);
    } catch (const relume::Error& error) {
        relume::expect_printable(error.what());
    }
    return 0;
}
