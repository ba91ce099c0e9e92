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
#include "relume/parameter.h"

namespace relume {

/// A shader parameter taken from a channel of the file: value·scale + offset.
struct ChannelRef {
    std::string channel;
    double scale = 1;
    double offset = 0;
    bool operator==(const ChannelRef&) const = default;
};

/// choice values are held by name. A single number is accepted where a color is asked for.
using Value = std::variant<bool, std::int64_t, double, std::array<double, 3>, std::string, std::vector<std::string>,
                           std::vector<double>, ChannelRef>;

/// Values for the rows of a parameter table: only what was given is stored, the rest is the table's default.
class RELUME_API ParameterValues {
public:
    /// Checks type, range and choice; `what` names the owner in messages ("light 'key'"). Throws Error(parameter) with
    /// the nearest right name.
    void set(std::span<const Parameter> table, std::string_view name, const Value& value, std::string_view what);
    void unset(std::string_view name);
    bool given(std::string_view name) const;
    const Value* find(std::string_view name) const;

    /// Given or default, converted; throws std::logic_error when the table has no such row (a programming error).
    double number(std::span<const Parameter> table, std::string_view name) const;
    std::array<double, 3> triple(std::span<const Parameter> table, std::string_view name) const;
    bool boolean(std::span<const Parameter> table, std::string_view name) const;
    int choice(std::span<const Parameter> table, std::string_view name) const;
    std::string text(std::span<const Parameter> table, std::string_view name) const;
    std::vector<std::string> texts(std::span<const Parameter> table, std::string_view name) const;
    std::vector<double> numbers(std::span<const Parameter> table, std::string_view name) const;

    const std::map<std::string, Value, std::less<>>& all() const { return values_; }

private:
    std::map<std::string, Value, std::less<>> values_;
};

struct Light {
    std::string name;
    std::string type;        ///< see light_types() in relume/light.h
    ParameterValues values;  ///< over light_parameters(type): the keys common to all lights and the type's own
};

/// One [[shader]]: which pixels, which model, which parameters.
struct ShaderUse {
    std::vector<std::string> cryptomatte;
    std::vector<std::int64_t> object_id;
    std::vector<std::int64_t> material_id;
    std::vector<std::int64_t> shading_model_id;
    std::string use;         ///< shader name, or "from_material_expression": the pixel's shading-model ID names it
    ParameterValues values;  ///< over the shader's table; a Value may be a ChannelRef
    bool matches_all() const {
        return cryptomatte.empty() && object_id.empty() && material_id.empty() && shading_model_id.empty();
    }
};

struct Output {
    ParameterValues values;  ///< over output_parameters(): mode, aovs, type, compression, metadata, …
};

class RELUME_API Rig {
public:
    int version = 1;
    /// The file's own path (for relative names and messages), empty for loads().
    std::filesystem::path path;
    std::optional<std::string> gbuffer_file;  ///< [gbuffer] file, as written
    GBufferOptions gbuffer;                   ///< [gbuffer] and [camera]
    std::vector<Light> lights;
    std::vector<ShaderUse> shaders;
    Output output;

    /// Errors: file, rig (syntax, unknown or ill-typed key: nearest name, line and column), parameter (range).
    static Rig load(const std::filesystem::path& path);
    static Rig loads(std::string_view toml, std::string_view name = "<rig>");

    Light* light(std::string_view name);
    const Light* light(std::string_view name) const;

    /// A dotted path as on the command line: set("light.key.exposure", "1"), set("output.type", "float"),
    /// set("shader.0.roughness", "0.4"), set("camera.fov", "39.6"). The value is parsed as TOML, a bare word is a string.
    void set(std::string_view dotted, std::string_view value);
    /// The value at a dotted path, as TOML text; the default where it was not given.
    std::string get(std::string_view dotted) const;

    /// A rig file that loads to an equal rig.
    std::string to_toml() const;
};

/// The tables behind the sections (shaders and lights have theirs in relume/shader.h and relume/light.h).
RELUME_API std::span<const Parameter> output_parameters();
RELUME_API std::span<const Parameter> camera_parameters();
RELUME_API std::span<const Parameter> gbuffer_parameters();
RELUME_API std::span<const Parameter> channel_rule_parameters();

/// The candidate nearest to `word` (Damerau–Levenshtein, case-insensitive), or "" when none is near.
RELUME_API std::string nearest_name(std::string_view word, std::span<const std::string_view> candidates);

}  // namespace relume
