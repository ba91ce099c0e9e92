// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

#include <glm/vec3.hpp>

#include "relume/scenes.h"

namespace relume {

/// A pixel of a scene's channel, named without the view layer. Throws when there is none.
inline float at(const SceneImage& image, std::string_view channel, int i, int j) {
    const SceneChannel* found = image.find("ViewLayer." + std::string(channel));
    if (!found) throw std::runtime_error("no channel " + std::string(channel));
    return found->pixels[static_cast<std::size_t>(j) * static_cast<std::size_t>(image.window.width) +
                         static_cast<std::size_t>(i)];
}

/// Three channels of a layer.
inline glm::dvec3 triple(const SceneImage& image, const std::string& layer, const char* components, int i, int j) {
    glm::dvec3 value;
    for (int k = 0; k < 3; ++k) value[k] = at(image, layer + "." + components[k], i, j);
    return value;
}

}  // namespace relume
