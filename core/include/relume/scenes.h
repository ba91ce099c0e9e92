// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "relume/camera.h"
#include "relume/export.h"
#include "relume/image.h"

namespace relume {

/// The built-in scenes: small G-buffers with a beauty whose making is known to the last formula, for demos and tests.
/// Their shading shares no code with the relighting core, so that the two can be held against each other.
///   sdf      a sphere on a checkered ground, sphere-traced; ambient occlusion and a soft sun shadow from the distance
///            field; the beauty has one bounce of light from a sun, the sky and a back light
///            (examples/rigs/sdf.relume).
///   cornell  a box with a ceiling light, three glossy and five shiny spheres, ray-traced; the beauty is path-traced
///            (the light alone: examples/rigs/cornell.relume).
/// Both worlds are y-up; lengths have no unit.
struct SceneInfo {
    std::string_view name;
    std::string_view help;
    int width = 0;  ///< what SceneOptions::width = 0 means
    int height = 0;
    int samples = 0;  ///< what SceneOptions::samples = 0 means
};
RELUME_API std::span<const SceneInfo> scenes();

struct SceneOptions {
    int width = 0;  ///< pixels, 1…32768; 0: the scene's own size
    int height = 0;
    /// Camera rays per pixel, 1…65536; 0: the scene's own number. One ray goes through the pixel's centre; several are
    /// spread evenly over the pixel, and what they see is averaged.
    int samples = 0;
    /// Light paths per camera ray (cornell): the beauty averages samples × paths of them. 0 leaves the beauty out;
    /// −1: 4.
    int paths = -1;
    int bounces = 8;         ///< of a light path (cornell), 0…64; 1 is direct light alone, 0 emission alone
    double time = 0;         ///< seconds: the camera of sdf goes round by 0.3 rad a second
    bool opaque = false;     ///< the beauty has the sky behind it and alpha 1, else alpha is coverage
    std::uint64_t seed = 0;  ///< of the light paths; renders with different seeds are independent and may be averaged
    int threads = 0;         ///< 0: as many as the process may use. Pixels do not depend on it.
};

/// One channel of a scene, width × height floats, row 0 at the top.
struct SceneChannel {
    std::string name;
    std::vector<float> pixels;
};

/// A G-buffer with Blender's channel names and habits. Depth, position and the indices come from the pixel's centre and
/// are 1e10 or 0 where it sees the background; everything else is averaged over the pixel with 0 for the background, so
/// that it is premultiplied by coverage, which `ViewLayer.albedo.A` holds.
struct SceneImage {
    Window window;
    std::vector<SceneChannel> channels;             ///< sorted by name
    std::map<std::string, std::string> attributes;  ///< header strings: Cryptomatte's, and what made the file
    Camera camera;                                  ///< the one it was made with

    /// nullptr when there is none of that name.
    const SceneChannel* find(std::string_view name) const;
};

/// Errors: parameter (no such scene), value (an option out of its range).
RELUME_API SceneImage render_scene(std::string_view name, const SceneOptions& options = {});

/// Renders into an EXR: one part, float32, ZIP. Errors: as render_scene, and file.
RELUME_API void write_scene(std::string_view name, const std::filesystem::path& path, const SceneOptions& options = {});

}  // namespace relume
