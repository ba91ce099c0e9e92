// SPDX-License-Identifier: Apache-2.0
#include "relume/rig.h"

#include <algorithm>
#include <utility>

namespace relume {

const Light* Rig::light(std::string_view name) const {
    const auto found = std::find_if(lights.begin(), lights.end(), [&](const Light& l) { return l.name == name; });
    return found == lights.end() ? nullptr : &*found;
}

Light* Rig::light(std::string_view name) { return const_cast<Light*>(std::as_const(*this).light(name)); }

bool Rig::operator==(const Rig& other) const {
    return version == other.version && gbuffer_file == other.gbuffer_file && frame == other.frame &&
           gbuffer == other.gbuffer && lights == other.lights && shaders == other.shaders && output == other.output;
}

}  // namespace relume
