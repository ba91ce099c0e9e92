// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "instance.h"

namespace relume::ofx {

/// Places a light by the point of the picture that it is to light: writes its direction and position. `name` is the
/// parameter that was changed; others than a light's pick are left alone. Errors: as reading the G-buffer, and value (a
/// point beside the surface; no position known).
void pick(const Instance& instance, const std::string& name, double time, double scale_x, double scale_y);

}  // namespace relume::ofx
