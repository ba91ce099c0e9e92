// SPDX-License-Identifier: Apache-2.0
#pragma once

// What each model promises (the shaders' manual pages say the same). A model that is not listed here promises nothing
// beyond finite and non-negative values.

#include <map>
#include <string>

#include "shader_model.h"

namespace relume::testing {

enum class Reciprocity { promised, never, unspecified };

inline bool plain(const Model& m) {
    return m.has("energy_conserving") &&
           m.options()[static_cast<std::size_t>(m.parameter("energy_conserving").slot)] == 0;
}

inline Reciprocity reciprocity(const Model& m) {
    static const std::map<std::string_view, Reciprocity> kAlways{
        {"lambert", Reciprocity::promised},      {"oren_nayar", Reciprocity::promised},
        {"ggx", Reciprocity::promised},          {"cook_torrance", Reciprocity::promised},
        {"default_lit", Reciprocity::promised},  {"principled", Reciprocity::promised},
        {"lambert_wrapped", Reciprocity::never}, {"specular_mix", Reciprocity::never},
        {"unlit", Reciprocity::promised},
    };
    const std::string_view name = m.info().name;
    if (name == "phong" || name == "blinn_phong" || name == "gaussian" || name == "beckmann")
        return plain(m) ? Reciprocity::never : Reciprocity::promised;
    if (name == "cook_torrance" && m.options()[static_cast<std::size_t>(m.parameter("distribution").slot)] == 4)
        return Reciprocity::never;     // texture
    if (name == "blender_principled")  // each layer takes from the next what it reflects of the view, not of the light
        return m.options()[static_cast<std::size_t>(m.parameter("generation").slot)] == 1 ? Reciprocity::promised
                                                                                          : Reciprocity::never;
    const auto found = kAlways.find(name);
    return found == kAlways.end() ? Reciprocity::unspecified : found->second;
}

}  // namespace relume::testing
