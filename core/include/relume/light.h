// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

#include "relume/export.h"
#include "relume/parameter.h"

namespace relume {

/// One kind of light, as the rig names it.
struct LightType {
    std::string_view name;
    std::string_view label;
    std::string_view help;
    std::span<const Parameter> parameters;  ///< all keys: those common to every light, then the type's own
};

RELUME_API std::span<const LightType> light_types();
/// nullptr when there is none of that name.
RELUME_API const LightType* find_light_type(std::string_view name);

}  // namespace relume
