// SPDX-License-Identifier: Apache-2.0
#include "relume/scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "io/exr.h"
#include "relume/error.h"
#include "relume/version.h"
#include "scenes/cornell_scene.h"
#include "scenes/renderer.h"
#include "scenes/sdf_scene.h"
#include "threads/workers.h"

namespace relume {
namespace {

constexpr std::array<SceneInfo, 2> kScenes{{
    {"sdf", "A sphere on a checkered ground under sun and sky, sphere-traced.", 960, 540, 4},
    {"cornell", "A box with coloured sides, a ceiling light and eight spheres, path-traced.", 640, 640, 16},
}};

const SceneInfo& require_scene(std::string_view name) {
    const auto found = std::ranges::find(kScenes, name, &SceneInfo::name);
    if (found != kScenes.end()) return *found;
    throw Error(ErrorKind::parameter, "there is no scene '" + std::string(name) + "'; the scenes are sdf and cornell");
}

void require_range(std::string_view what, int value, int low, int high) {
    if (value >= low && value <= high) return;
    throw Error(ErrorKind::value, "a scene's " + std::string(what) + " is " + std::to_string(value) + "; it can be " +
                                      std::to_string(low) + " to " + std::to_string(high));
}

SceneOptions complete(const SceneInfo& scene, SceneOptions options) {
    if (options.width == 0) options.width = scene.width;
    if (options.height == 0) options.height = scene.height;
    if (options.samples == 0) options.samples = scene.samples;
    if (options.paths == -1) options.paths = 4;
    if (options.threads == 0) options.threads = default_threads();
    require_range("width", options.width, 1, 32768);
    require_range("height", options.height, 1, 32768);
    require_range("samples", options.samples, 1, 65536);
    require_range("paths", options.paths, 0, 16384);
    require_range("bounces", options.bounces, 0, 64);
    require_range("threads", options.threads, 1, 4096);
    if (!std::isfinite(options.time)) throw Error(ErrorKind::value, "a scene's time is not a finite number");
    return options;
}

}  // namespace

std::span<const SceneInfo> scenes() { return kScenes; }

const SceneChannel* SceneImage::find(std::string_view name) const {
    const auto found = std::ranges::find(channels, name, &SceneChannel::name);
    return found == channels.end() ? nullptr : &*found;
}

SceneImage render_scene(std::string_view name, const SceneOptions& options) {
    const SceneOptions o = complete(require_scene(name), options);
    std::unique_ptr<scene::Scene> built;
    if (name == "sdf") {
        built = std::make_unique<scene::SdfScene>(o.width, o.height, o.time);
    } else {
        built = std::make_unique<scene::CornellScene>(o.width, o.height, o.bounces);
    }
    SceneImage image = scene::render(*built, o);
    image.attributes["Software"] = "relume " + std::string(version());
    image.attributes["relume/scene"] = name;
    image.attributes["comments"] =
        "relume's built-in scene '" + std::string(name) + "': world space, y up, scene-linear Rec.709";
    return image;
}

void write_scene(std::string_view name, const std::filesystem::path& path, const SceneOptions& options) {
    const SceneImage image = render_scene(name, options);
    io::Part part;
    part.data_window = part.display_window = image.window;
    for (const SceneChannel& channel : image.channels) part.channels.push_back({channel.name, PixelType::float32});
    for (const auto& [key, value] : image.attributes) part.attributes.push_back({key, "string", value});

    io::ExrWriter writer(path, io::Header{{part}});
    const int band = writer.rows_per_chunk();
    const std::ptrdiff_t row_bytes = std::ptrdiff_t{4} * image.window.width;
    parallel_for((image.window.height + band - 1) / band, complete(require_scene(name), options).threads, nullptr,
                 [&](int, int chunk) {
                     const int y = chunk * band;
                     std::vector<ConstPlane> planes;
                     for (const SceneChannel& channel : image.channels) {
                         const auto* top = reinterpret_cast<const std::byte*>(channel.pixels.data());
                         planes.push_back({top + y * row_bytes, PixelType::float32, 4, row_bytes});
                     }
                     writer.write(0, y, std::min(band, image.window.height - y), planes);
                 });
    writer.commit();
}

}  // namespace relume
