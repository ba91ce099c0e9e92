// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace relume::gbuffer {

/// Lower case, without blanks, underscores and hyphens; dots stay: "Base Color", "base_color" and "BaseColor" are one
/// name.
std::string fold(std::string_view name);

/// The parts of "a.b.c"; one empty part for "".
std::vector<std::string_view> split(std::string_view text, char separator);

/// Last part of a channel's name as one upper-case letter: R for "R", "r" and "red", A for "alpha", X, Y, Z, W, U, V,
/// T; 0 for anything else.
char component_letter(std::string_view suffix);

/// How well a layer's name fits a pattern of the rule table; smaller is better.
enum class Fit : unsigned char {
    exact,      ///< letter by letter
    tolerant,   ///< but for case, blanks, underscores and hyphens
    qualified,  ///< with words after it: "albedo.diffuse" for "albedo"
    none,
};

struct Match {
    Fit fit = Fit::none;
    std::string group;  ///< what stands before the match: Blender's view layer, "char" of "char.Normal"
};

/// Matches a layer's name against a pattern: the whole name, or its last parts ("ViewLayer.Normal" for "Normal"). A
/// pattern that starts with '*' matches any ending ("FinalImageMovieRenderQueue_WorldNormal" for "*WorldNormal"), one
/// that ends with '*' any last word that starts so.
Match match_layer(std::string_view layer, std::string_view pattern);

}  // namespace relume::gbuffer
