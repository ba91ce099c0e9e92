// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <span>
#include <string>

#include "relume/gbuffer.h"
#include "relume/rig.h"

namespace relume::ofx {

/// Relights a region of a G-buffer into four planes (the fourth may lack): the beauty, or an AOV with the beauty's
/// alpha. `ask` is called now and then, from any thread.
void relight_picture(const GBuffer& gbuffer, const Rig& rig, const std::string& picture, const Window& region,
                     std::span<const Plane> planes, const std::atomic<bool>& cancel,
                     const std::function<void()>& ask = {});

}  // namespace relume::ofx
