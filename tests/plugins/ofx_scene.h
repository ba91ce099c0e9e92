// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ofx_node.h"
#include "relume/gbuffer.h"
#include "relume/rig.h"

namespace relume::ofx::test {

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

    /// What the library makes of the same arrays: R, G, B, A, row 0 at the top.
    std::vector<float> relit(const Rig& rig, std::initializer_list<const char*> clips,
                             const GBufferOptions& options = {}) const;

    std::map<std::string, std::vector<std::vector<float>>> channels;  ///< semantic → planes, row 0 at the top
};

/// The pixels of an image, R, G, B, A, row 0 at the top, as in SceneClips::relit.
std::vector<float> pixels(const Image& image);
std::vector<float> crop(const std::vector<float>& rgba, int width, const OfxRectI& bounds, const OfxRectI& part);

inline constexpr std::initializer_list<const char*> kAllClips = {"Source",    "Normal",   "BaseColor",
                                                                 "Roughness", "Metallic", "Position"};

}  // namespace relume::ofx::test
