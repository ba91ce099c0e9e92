// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "relume/scenes.h"
#include "scenes/scene.h"

namespace relume::scene {

/// `options` with every number in its range and none of the "0 means" left.
SceneImage render(const Scene& scene, const SceneOptions& options);

}  // namespace relume::scene
