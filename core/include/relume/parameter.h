// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <string_view>

namespace relume {

/// What a parameter holds. Shaders, lights and every section of the rig are described with the same table entries, and
/// every front end (Python, TOML, command line, OIIO, OFX, Blender, manual) is generated from them.
enum class ParameterType : std::uint8_t {
    scalar,       ///< one number
    color,        ///< scene-linear RGB; one number stands for grey
    vector,       ///< three numbers: a position or a direction, never colour-converted
    boolean,      ///< true or false
    integer,      ///< whole number
    choice,       ///< one of `choices`
    text,         ///< a string
    text_list,    ///< strings, e.g. Cryptomatte patterns; one string stands for a list of one
    number_list,  ///< numbers, e.g. the attenuation coefficients; `count` of them (0: any number)
    table,        ///< a picture of numbers to look things up in (relume/lookup_table.h): a file's name; "" is built in
};

/// How a shader parameter says how wide a highlight is. Where a pixel averages several normals, its highlight is wider
/// than theirs: alpha², twice the variance of the slopes along one axis, grows by twice the normals' own variance.
enum class LobeWidth : std::uint8_t {
    none,             ///< nothing of the kind
    roughness,        ///< perceptual: alpha = value²; 0 is a mirror and stays one
    alpha,            ///< alpha itself
    half_exponent,    ///< cosine power about the half vector: alpha² = 2/(value + 2) (Walter 2007, section 5.2)
    mirror_exponent,  ///< cosine power about the mirrored view: as a fourfold one about the half vector
    gloss,            ///< alpha = 0.1 at 0 to 0.001 at 1 (Burley 2012, of his clearcoat)
};

inline constexpr double kUnbounded = std::numeric_limits<double>::infinity();

/// One row of a parameter table. A literal type: tables are constexpr, in read-only memory, and hold no owning pointer.
struct Parameter {
    std::string_view name{};
    ParameterType type = ParameterType::scalar;
    std::array<double, 3> value{};  ///< default; scalars, booleans, integers and choices (index) use [0]
    double min = -kUnbounded;       ///< hard range, inclusive: outside is an error
    double max = kUnbounded;
    double soft_min = 0;  ///< range of a slider
    double soft_max = 1;
    std::string_view unit{};                 ///< "W/sr", "degrees", "" when dimensionless
    std::string_view label{};                ///< "Base Color"
    std::string_view help{};                 ///< one or two sentences
    std::string_view choices{};              ///< '|'-separated names of a choice, in index order
    std::string_view text{};                 ///< default of text, text_list ('|'-separated)
    int count = 0;                           ///< number_list: required length, 0 for any
    bool has_default = true;                 ///< false: absent unless given (a rig key without a default)
    LobeWidth lobe_width = LobeWidth::none;  ///< shaders: what the variance of averaged normals widens
    /// Shaders: index of the first float of the parameter in Params<float> (is_number()), of the int in Options
    /// (is_option()), or of the view in Tables (table). Elsewhere unused.
    int slot = -1;

    constexpr int components() const { return type == ParameterType::color || type == ParameterType::vector ? 3 : 1; }
    /// Shaders: may differ from pixel to pixel, and come from a channel.
    constexpr bool is_number() const { return type == ParameterType::scalar || components() == 3; }
    /// Shaders: one whole number for all pixels.
    constexpr bool is_option() const {
        return type == ParameterType::boolean || type == ParameterType::integer || type == ParameterType::choice;
    }
};

}  // namespace relume
