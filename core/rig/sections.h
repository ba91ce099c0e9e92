// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>
#include <type_traits>

#include "relume/rig.h"
#include "rig/canonical.h"
#include "rig/problem.h"
#include "rig/value_text.h"

namespace relume::rigfile {

// The sections whose values live in plain structs: which row is which member. `visit` is called with a row's name and
// the optional member, for every row of the section's table.

template <class Options, class Visit>
void for_each_member(Options& o, Visit visit) requires std::is_same_v<std::remove_const_t<Options>, ChannelRule> {
    visit("channel", o.channel);
    visit("part", o.part);
    visit("encoding", o.encoding);
    visit("space", o.space);
    visit("flip", o.flip);
    visit("kind", o.kind);
    visit("near", o.near);
    visit("far", o.far);
    visit("invert", o.invert);
    visit("premultiplied", o.premultiplied);
}

/// [gbuffer]: its file is a member of the Rig itself.
template <class SomeRig, class Visit> void for_each_gbuffer_member(SomeRig& rig, Visit visit) {
    visit("file", rig.gbuffer_file);
    visit("frame", rig.frame);
    visit("part", rig.gbuffer.part);
    visit("view", rig.gbuffer.view);
    visit("alpha", rig.gbuffer.alpha);
    visit("working_space", rig.gbuffer.working_space);
    visit("normal_variance", rig.gbuffer.normal_variance);
    visit("max_pixels", rig.gbuffer.max_pixels);
    visit("max_channels", rig.gbuffer.max_channels);
    visit("max_parts", rig.gbuffer.max_parts);
}

template <class Options, class Visit> void for_each_camera_member(Options& o, Visit visit) {
    visit("matrix", o.camera_matrix);
    visit("fov", o.fov);
    visit("focal_length", o.focal_length);
    visit("horizontal_aperture", o.horizontal_aperture);
    visit("projection", o.projection);
    visit("width", o.width);
}

template <class T> Value member_value(const Parameter& row, const T& member) {
    if constexpr (std::is_enum_v<T>)
        return std::string(split_choices(row.choices).at(static_cast<std::size_t>(member)));
    else if constexpr (std::is_same_v<T, std::array<double, 16>>)
        return std::vector<double>(member.begin(), member.end());
    else return member;
}

/// `value` is canonical for the row.
template <class T> void assign_member(const Parameter& row, const Value& value, std::optional<T>& member) {
    if constexpr (std::is_enum_v<T>) {
        const auto choices = split_choices(row.choices);
        const auto& word = std::get<std::string>(value);
        for (std::size_t k = 0; k < choices.size(); ++k)
            if (choices[k] == word) member = static_cast<T>(k);
    } else if constexpr (std::is_same_v<T, std::array<double, 16>>) {
        const auto& list = std::get<std::vector<double>>(value);
        std::array<double, 16> all{};
        for (std::size_t k = 0; k < all.size(); ++k) all[k] = list.at(k);
        member = all;
    } else {
        member = std::get<T>(value);
    }
}

/// Sets one key of such a section. `each` is called with a visitor. Throws Problem.
template <class Each>
void set_member(std::span<const Parameter> table, std::string_view name, const Value& value, std::string_view what,
                Each each) {
    const Parameter& row = require_row(table, name, what);
    const Value checked = canonical(row, value, what);
    each([&](std::string_view member_name, auto& member) {
        if (member_name == name) assign_member(row, checked, member);
    });
}

/// The value of one key, if it was given.
template <class Each> std::optional<Value> get_member(const Parameter& row, Each each) {
    std::optional<Value> out;
    each([&](std::string_view name, const auto& member) {
        if (name == row.name && member) out = member_value(row, *member);
    });
    return out;
}

/// [gbuffer], without its channels. Throws Problem.
void set_gbuffer(Rig& rig, std::string_view name, const Value& value);
std::optional<Value> get_gbuffer(const Rig& rig, const Parameter& row);

/// A key of a channel's rule. `what` names the channel. Throws Problem.
void set_channel_rule(ChannelRule& rule, std::string_view name, const Value& value, std::string_view what);
std::optional<Value> get_channel_rule(const ChannelRule& rule, const Parameter& row);

/// [camera]. fov, and focal_length with horizontal_aperture, replace each other. Throws Problem.
void set_camera(GBufferOptions& options, std::string_view name, const Value& value);
std::optional<Value> get_camera(const GBufferOptions& options, const Parameter& row);

/// A key of a light, type aside; one of power and intensity replaces the other. Throws Problem.
void set_light(Light& light, std::string_view name, const Value& value);
/// Gives the light another type; what the new one does not have is dropped. Throws Problem.
void set_light_type(Light& light, std::string_view type);
std::string light_label(const Light& light);

/// A key of a [[shader]], use aside: a match key or a parameter. Throws Problem.
void set_shader(ShaderUse& shader, std::string_view name, const Value& value);
void set_shader_use(ShaderUse& shader, std::string_view use);
/// The match keys' values; empty when the row is not a match key or not given.
std::optional<Value> get_shader_match(const ShaderUse& shader, std::string_view name);
std::string shader_label(const ShaderUse& shader);

/// A shader parameter's { channel, scale, offset }. Throws Problem when the channel is missing.
ChannelRef channel_ref(const ParameterValues& values, const std::string& what);

/// A key of [output]. Throws Problem.
void set_output(Output& output, std::string_view name, const Value& value);

/// Throws Problem(name) when [gbuffer.channels] knows no such name. `source`, what it was given, is for the hint.
void require_channel_name(std::string_view name, const Value* source = nullptr);

/// Whether a channel's source is a file by its ending (.exr, .png, …), not a channel's name.
bool names_a_file(std::string_view source);

}  // namespace relume::rigfile
