// SPDX-License-Identifier: Apache-2.0
#include "ofx_scene.h"

#include <unistd.h>

#include <atomic>
#include <cstring>
#include <filesystem>

#include "io/pixel_convert.h"
#include "relume/relight.h"
#include "relume/scenes.h"

namespace relume::ofx::test {

namespace {

struct Content {
    const char* clip;
    const char* semantic;
    int components;
};
constexpr Content kContents[] = {{"Source", "beauty", 3},        {"Normal", "normal", 3},
                                 {"BaseColor", "base_color", 3}, {"Roughness", "roughness", 1},
                                 {"Metallic", "metallic", 1},    {"Position", "position", 3},
                                 {"Depth", "depth", 1}};

}  // namespace

SceneFile::SceneFile(int width, int height) {
    static std::atomic<int> files{0};
    const std::string name = "relume_scene_" + std::to_string(getpid()) + "_" + std::to_string(++files) + ".exr";
    path_ = std::filesystem::temp_directory_path() / name;
    SceneOptions options;
    options.width = width;
    options.height = height;
    options.samples = 1;
    write_scene("sdf", path_, options);
}

SceneFile::~SceneFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
}

SceneClips::SceneClips(int w, int h, int origin_x, int origin_y)
    : width(w), height(h), bounds{origin_x, origin_y, origin_x + w, origin_y + h} {
    const SceneFile file(w, h);
    const GBuffer gbuffer = GBuffer::read(file.path());
    const auto take = [&](const char* semantic, int components) {
        ChannelRequest request;
        request.name = semantic;
        request.components = components;
        std::vector<std::vector<float>>& planes = channels[semantic];
        std::vector<Plane> out;
        planes.resize(static_cast<std::size_t>(components));
        for (std::vector<float>& plane : planes) {
            plane.resize(static_cast<std::size_t>(w) * static_cast<std::size_t>(h));
            out.push_back({reinterpret_cast<std::byte*>(plane.data()), PixelType::float32, 4, std::ptrdiff_t{4} * w});
        }
        read_channels(gbuffer, {&request, 1}, out);
    };
    for (const Content& content : kContents) take(content.semantic, content.components);
    take("alpha", 1);
    channels["beauty"].push_back(channels["alpha"][0]);
}

Picture SceneClips::picture(const std::string& clip) const {
    for (const Content& content : kContents) {
        if (clip != content.clip) continue;
        const auto& planes = channels.at(content.semantic);
        return {bounds, [&](int x, int y, int c) {
                    // One number stands in all of R, G and B, as compositors shuffle it.
                    const std::size_t k = planes.size() == 1 ? 0 : static_cast<std::size_t>(c);
                    if (c == 3 && planes.size() < 4) return 1.f;
                    return planes[k][static_cast<std::size_t>(bounds.y2 - 1 - y) * static_cast<std::size_t>(width) +
                                     static_cast<std::size_t>(x - bounds.x1)];
                }};
    }
    return {};
}

void SceneClips::connect(Node& node) const { connect(node, kAllClips); }

void SceneClips::connect(Node& node, std::initializer_list<const char*> clips) const {
    for (const char* clip : clips) node.connect(clip, picture(clip));
}

Arrays SceneClips::arrays(std::initializer_list<const char*> clips) const {
    Arrays wanted;
    for (const Content& content : kContents)
        for (const char* clip : clips)
            if (std::string_view(clip) == content.clip) wanted[content.semantic] = channels.at(content.semantic);
    return wanted;
}

std::vector<float> SceneClips::relit(const Rig& rig, std::initializer_list<const char*> clips) const {
    return test::relit(arrays(clips), frame(), rig);
}

std::vector<float> relit(const Arrays& arrays, const MemoryFrame& frame, const Rig& rig, const GBufferOptions& options,
                         PixelType type) {
    const int width = frame.data_window.width, height = frame.data_window.height;
    std::map<std::string, MemoryChannel> memory;
    std::list<std::vector<std::uint16_t>> halves;
    for (const auto& [name, planes] : arrays) {
        for (const std::vector<float>& plane : planes) {
            ConstPlane at{reinterpret_cast<const std::byte*>(plane.data()), PixelType::float32, 4,
                          std::ptrdiff_t{4} * width};
            if (type == PixelType::half) {
                std::vector<std::uint16_t>& half = halves.emplace_back();
                for (const float value : plane) half.push_back(io::float_to_half(value));
                at = {reinterpret_cast<const std::byte*>(half.data()), type, 2, std::ptrdiff_t{2} * width};
            }
            memory[name].planes.push_back(at);
        }
    }
    const GBuffer gbuffer = GBuffer::from_memory(frame, memory, options);
    std::vector<float> rgba(std::size_t{4} * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    std::vector<Plane> planes;
    for (std::size_t k = 0; k < 4; ++k)
        planes.push_back(
            {reinterpret_cast<std::byte*>(rgba.data() + k), PixelType::float32, 16, std::ptrdiff_t{16} * width});
    relight(gbuffer, rig, {{"beauty", planes}});
    return rgba;
}

void light_one(Node& node) {
    node.choose("light1_type", "sun");
    node.set("light1_direction", std::vector{-0.6, -0.8, 0.5});
    node.set("light1_irradiance", std::vector{2.0, 1.9, 1.7});
    node.set("light1_exposure", 0.5);
}

Rig rig_one() {
    return Rig::loads(R"([[light]]
type = "sun"
direction = [-0.6, -0.8, 0.5]
irradiance = [2.0, 1.9, 1.7]
exposure = 0.5
)");
}

std::vector<float> pixels(const Image& image) {
    std::vector<float> rgba;
    for (int y = image.bounds.y2 - 1; y >= image.bounds.y1; --y)
        for (int x = image.bounds.x1; x < image.bounds.x2; ++x)
            for (int c = 0; c < 4; ++c) rgba.push_back(c < image.component_count() ? image.number(x, y, c) : 1.f);
    return rgba;
}

std::vector<float> crop(const std::vector<float>& rgba, int width, const OfxRectI& bounds, const OfxRectI& part) {
    std::vector<float> out;
    for (int y = part.y2 - 1; y >= part.y1; --y)
        for (int x = part.x1; x < part.x2; ++x)
            for (std::size_t c = 0; c < 4; ++c)
                out.push_back(rgba[4 * (static_cast<std::size_t>(bounds.y2 - 1 - y) * static_cast<std::size_t>(width) +
                                        static_cast<std::size_t>(x - bounds.x1)) +
                                   c]);
    return out;
}

}  // namespace relume::ofx::test
