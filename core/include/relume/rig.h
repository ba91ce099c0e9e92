// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "relume/export.h"
#include "relume/gbuffer.h"
#include "relume/lookup_table.h"
#include "relume/parameter.h"

namespace relume {

/// A shader parameter taken from a channel of the file: value·scale + offset.
struct ChannelRef {
    std::string channel;
    double scale = 1;
    double offset = 0;
    bool operator==(const ChannelRef&) const = default;
};

/// A number, colour or vector that changes over the frames of a sequence.
struct RELUME_API Keys {
    enum class Interpolation : std::uint8_t {
        linear,
        hold,    ///< the value of the key before
        smooth,  ///< t²(3 − 2t) from key to key
    };
    Interpolation interpolation = Interpolation::linear;
    int components = 1;                         ///< 1 or 3 of each value
    std::vector<double> frames;                 ///< rising; at least one
    std::vector<std::array<double, 3>> values;  ///< of each frame
    /// Before the first key its value, after the last one that one's.
    std::array<double, 3> at(double frame) const;
    bool operator==(const Keys&) const = default;
};

/// What a key holds. ParameterValues keeps one form per row type: scalar double, integer int64, color and vector three
/// doubles (a single number given for a color is grey), choice and text a string, lists as vectors, table a file's name
/// or its numbers.
using Value = std::variant<bool, std::int64_t, double, std::array<double, 3>, std::string, std::vector<std::string>,
                           std::vector<double>, ChannelRef, LookupTable, Keys>;

/// Values for the rows of a parameter table: only what was given is stored, the rest is the table's default.
class RELUME_API ParameterValues {
public:
    /// Checks type, range and choice; `what` names the owner in messages ("light 'key'"). Throws Error(parameter) with
    /// the nearest right name. A ChannelRef is accepted for rows with a slot that hold numbers (a shader's).
    void set(std::span<const Parameter> table, std::string_view name, const Value& value, std::string_view what);
    void unset(std::string_view name);
    bool given(std::string_view name) const;
    const Value* find(std::string_view name) const;

    /// What is keyed becomes what it is at that frame.
    void resolve(double frame);

    /// Given or default, converted; keyed values as they are at their first key. Throws std::logic_error when the table
    /// has no such row (a programming error).
    double number(std::span<const Parameter> table, std::string_view name) const;
    std::array<double, 3> triple(std::span<const Parameter> table, std::string_view name) const;
    bool boolean(std::span<const Parameter> table, std::string_view name) const;
    int choice(std::span<const Parameter> table, std::string_view name) const;
    std::string text(std::span<const Parameter> table, std::string_view name) const;
    std::vector<std::string> texts(std::span<const Parameter> table, std::string_view name) const;
    std::vector<double> numbers(std::span<const Parameter> table, std::string_view name) const;

    const std::map<std::string, Value, std::less<>>& all() const { return values_; }
    bool operator==(const ParameterValues&) const = default;

private:
    std::map<std::string, Value, std::less<>> values_;
};

struct Light {
    std::string name;
    std::string type;        ///< see light_types() in relume/light.h
    ParameterValues values;  ///< over the type's table: the keys common to all lights and the type's own
    bool operator==(const Light&) const = default;
};

/// One [[shader]]: which pixels, which model, which parameters.
struct ShaderUse {
    std::vector<std::string> cryptomatte;
    std::vector<std::int64_t> object_id;
    std::vector<std::int64_t> material_id;
    std::vector<std::int64_t> shading_model_id;
    std::string use;         ///< shader name, or "from_material_expression": the pixel's shading-model ID names it
    ParameterValues values;  ///< over shader_use_parameters(use); a Value may be a ChannelRef
    bool operator==(const ShaderUse&) const = default;
    bool matches_all() const {
        return cryptomatte.empty() && object_id.empty() && material_id.empty() && shading_model_id.empty();
    }
};

struct Output {
    ParameterValues values;  ///< over output_parameters(): mode, aovs, type, compression, metadata, …
    bool operator==(const Output&) const = default;
};

class RELUME_API Rig {
public:
    int version = 1;
    /// The file's own path (for relative names and messages), empty for loads().
    std::filesystem::path path;
    std::optional<std::string> gbuffer_file;  ///< [gbuffer] file; relative names resolved as load() says, patterns kept
    std::optional<std::int64_t> frame;        ///< [gbuffer] frame: that of a sequence, where nobody says which
    GBufferOptions gbuffer;                   ///< [gbuffer] and [camera]
    std::vector<Light> lights;                ///< names are unique
    std::vector<ShaderUse> shaders;
    Output output;

    /// Reads a rig and what it includes. `path` may also be the name of a built-in rig ("outdoor"), where no file has
    /// it. Names of files in it are relative to the folder of the rig file that they stand in, and become absolute
    /// here. A light without a name gets its type's ("sun", "sun_2", …). Errors: file (missing, a directory,
    /// unreadable, over 16 MiB), rig (syntax, unknown or ill-typed key, unknown light type, shader or choice: with the
    /// nearest name and file:line:column), parameter (a value out of its range).
    static Rig load(const std::filesystem::path& path);
    /// The same from text. Names of files stay as written; includes are relative to the current folder.
    static Rig loads(std::string_view toml, std::string_view name = "<rig>");
    /// A rig that relume brings. Throws Error(rig) with the nearest name.
    static Rig builtin(std::string_view name);

    Light* light(std::string_view name);
    const Light* light(std::string_view name) const;

    /// A dotted path as on the command line: set("light.key.exposure", "1"), set("output.type", "float"),
    /// set("shader.0.roughness", "0.4"), set("camera.fov", "39.6"). The value is parsed as TOML, a bare word is a
    /// string. Lights go by name or index, shaders by index; a name with dots is quoted: light."a.b".exposure. Sets
    /// what is optional and absent, but makes no lights; on a rig without shaders, shader.0 is the default,
    /// `principled`. One of several ways to say the same (power for intensity, focal_length for fov) replaces the
    /// other. Throws Error(parameter) with the nearest name, and leaves the rig as it was.
    void set(std::string_view dotted, std::string_view value);
    /// The value at a dotted path, as TOML text; the default where it was not given. Throws Error(parameter) when there
    /// is neither.
    std::string get(std::string_view dotted) const;

    /// A rig file that loads to an equal rig, if this one is complete: set() may leave focal_length without its
    /// aperture or a point light without a position, which load() refuses. Includes are merged into it.
    std::string to_toml() const;

    /// The rig of one frame: what is keyed has that frame's value.
    Rig at(double number) const;
    /// The same, with the frame's number in the names of files.
    Rig of_frame(std::int64_t number) const;

    /// The G-buffer's file: [gbuffer] file, else, where each channel has a file of its own, the normal's.
    std::optional<std::string> main_file() const;
    /// Every file that the rig names: the main one, those of channels and of tables.
    std::vector<std::filesystem::path> input_files() const;
    /// Relative names of files become those of that folder, as load() does with its rig's; for names that were set.
    void resolve_files(const std::filesystem::path& folder);

    /// Same contents; `path` is not compared.
    bool operator==(const Rig& other) const;
};

/// The tables behind the sections (shaders and lights have theirs in relume/shader.h and relume/light.h).
RELUME_API std::span<const Parameter> rig_parameters();           ///< the keys above all sections: version, include
RELUME_API std::span<const Parameter> gbuffer_parameters();       ///< [gbuffer]
RELUME_API std::span<const Parameter> channel_rule_parameters();  ///< a table under [gbuffer.channels]
RELUME_API std::span<const Parameter> camera_parameters();        ///< [camera]
RELUME_API std::span<const Parameter> light_key_parameters();     ///< name and type of a [[light]]
RELUME_API std::span<const Parameter> shader_key_parameters();    ///< use and the match keys of a [[shader]]
RELUME_API std::span<const Parameter> channel_ref_parameters();   ///< { channel, scale, offset } for a shader parameter
RELUME_API std::span<const Parameter> output_parameters();        ///< [output]

/// The shader that a pixel's shading-model ID names, by ID (0 "unlit", 1 "default_lit", …).
RELUME_API std::span<const std::string_view> shading_model_names();
inline constexpr std::string_view kFromMaterialExpression = "from_material_expression";

/// The parameters that a [[shader]] with this `use` takes: the shader's, or for from_material_expression those that
/// mean the same in every shading model that has them. Throws Error(parameter) with the nearest name for an unknown
/// shader.
RELUME_API std::span<const Parameter> shader_use_parameters(std::string_view use);

/// Names that [gbuffer.channels] takes: relume's semantic names, "cryptomatte" (a file that holds it), then every
/// parameter of a shader that a channel can give.
RELUME_API std::vector<std::string_view> channel_names();

/// The rigs that relume brings, by name, and their text.
struct BuiltinRig {
    std::string_view name;
    std::string_view toml;
};
RELUME_API std::span<const BuiltinRig> builtin_rigs();

/// The candidate nearest to `word` (Damerau–Levenshtein, case-insensitive), or "" when none is near.
RELUME_API std::string nearest_name(std::string_view word, std::span<const std::string_view> candidates);

}  // namespace relume
