// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "ofx_node.h"
#include "relume/gbuffer.h"
#include "relume/rig.h"

namespace relume::ofx::test {

/// Planes of channels by semantic name, row 0 at the top.
using Arrays = std::map<std::string, std::vector<std::vector<float>>>;

/// The library on arrays in memory: R, G, B, A, row 0 at the top.
std::vector<float> relit(const Arrays& arrays, const MemoryFrame& frame, const Rig& rig,
                         const GBufferOptions& options = {}, PixelType type = PixelType::float32);

/// An EXR of the built-in scene sdf, one ray a pixel, as long as this lives.
class SceneFile {
public:
    SceneFile(int width, int height);
    ~SceneFile();
    SceneFile(const SceneFile&) = delete;
    SceneFile& operator=(const SceneFile&) = delete;
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

/// A picture of the built-in scene sdf, once as clips for the node and once as arrays for the library.
class SceneClips {
public:
    /// `origin`: where its lower left pixel lies.
    explicit SceneClips(int width = 96, int height = 64, int origin_x = 0, int origin_y = 0);

    int width, height;
    OfxRectI bounds;
    /// "Source", "Normal", …
    Picture picture(const std::string& clip) const;
    void connect(Node& node) const;
    void connect(Node& node, std::initializer_list<const char*> clips) const;

    /// Those channels that the clips hold.
    Arrays arrays(std::initializer_list<const char*> clips) const;
    /// What the library makes of them: R, G, B, A, row 0 at the top.
    std::vector<float> relit(const Rig& rig, std::initializer_list<const char*> clips) const;
    /// Where they stand in a project of 1920 × 1080, as an EXR says it.
    MemoryFrame frame() const { return {{bounds.x1, 1080 - bounds.y2, width, height}, {0, 0, 1920, 1080}}; }

    Arrays channels;
};

inline std::string complaints(const Host& host) {
    std::string text;
    for (const std::string& line : host.complaints()) text += line + "\n";
    return text.substr(0, 2000);
}

/// One sun, by knobs and as a rig.
void light_one(Node& node);
Rig rig_one();

/// The pixels of an image, R, G, B, A, row 0 at the top, as in SceneClips::relit.
std::vector<float> pixels(const Image& image);
std::vector<float> crop(const std::vector<float>& rgba, int width, const OfxRectI& bounds, const OfxRectI& part);

inline constexpr std::initializer_list<const char*> kAllClips = {"Source",    "Normal",   "BaseColor",
                                                                 "Roughness", "Metallic", "Position"};

}  // namespace relume::ofx::test
