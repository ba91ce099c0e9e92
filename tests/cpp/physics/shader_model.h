// SPDX-License-Identifier: Apache-2.0
#pragma once

// A shader with values set by name, evaluated in float or double on directions around n = +z (or any n): what the
// physics tests share.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "relume/shader.h"
#include "relume/shader_abi.h"
#include "shading/evaluate.h"

namespace relume::testing {

inline constexpr double kPi = std::numbers::pi;

using V3 = std::array<double, 3>;

inline V3 operator+(const V3& a, const V3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline V3 operator-(const V3& a, const V3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline V3 operator*(const V3& a, double s) { return {a[0] * s, a[1] * s, a[2] * s}; }
inline V3 operator*(const V3& a, const V3& b) { return {a[0] * b[0], a[1] * b[1], a[2] * b[2]}; }
inline double dot(const V3& a, const V3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline V3 cross(const V3& a, const V3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline V3 unit(const V3& a) { return a * (1 / std::sqrt(dot(a, a))); }
inline V3 mix(const V3& a, const V3& b, double t) { return a * (1 - t) + b * t; }
inline double mix(double a, double b, double t) { return a * (1 - t) + b * t; }
/// Colatitude and azimuth around +z, radians.
inline V3 direction(double theta, double phi) {
    return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}
inline double radians(double degrees) { return degrees * kPi / 180; }

/// f·NdotL (1/sr), RGB, of one pair of directions.
struct Answer {
    V3 diffuse{}, specular{}, transmission{};
    V3 total() const { return diffuse + specular + transmission; }
};

inline std::vector<std::string> choices_of(const Parameter& p) {
    std::vector<std::string> names{""};
    for (const char c : p.choices) {
        if (c == '|') names.emplace_back();
        else names.back() += c;
    }
    return names;
}

class Model {
public:
    explicit Model(std::string_view name) : Model(require_shader(name)) {}
    explicit Model(const ShaderInfo& info)
        : info_(&info), params_(default_params(info)), options_(default_options(info)), tables_(default_tables(info)) {}

    const ShaderInfo& info() const { return *info_; }
    std::vector<double>& params() { return params_; }
    const std::vector<double>& params() const { return params_; }
    std::vector<std::int32_t>& options() { return options_; }
    const std::vector<std::int32_t>& options() const { return options_; }
    Model& set_options(const std::vector<std::int32_t>& options) {
        options_ = options;
        return *this;
    }
    /// Views of what the caller keeps.
    std::vector<TableView>& tables() { return tables_; }

    bool has(std::string_view name) const {
        return std::any_of(info_->parameters.begin(), info_->parameters.end(),
                           [&](const Parameter& p) { return p.name == name; });
    }
    const Parameter& parameter(std::string_view name) const {
        for (const Parameter& p : info_->parameters)
            if (p.name == name) return p;
        throw std::invalid_argument(std::string(info_->name) + " has no parameter " + std::string(name));
    }
    /// A number; a colour becomes grey; a boolean or choice takes the index.
    Model& set(std::string_view name, double value) {
        const Parameter& p = parameter(name);
        const auto slot = static_cast<std::size_t>(p.slot);
        if (p.is_option()) options_[slot] = static_cast<std::int32_t>(value);
        else std::fill_n(params_.begin() + p.slot, p.components(), value);
        return *this;
    }
    Model& set(std::string_view name, const V3& value) {
        std::copy(value.begin(), value.end(), params_.begin() + parameter(name).slot);
        return *this;
    }
    Model& choose(std::string_view name, std::string_view choice) {
        const auto names = choices_of(parameter(name));
        const auto found = std::find(names.begin(), names.end(), choice);
        if (found == names.end())
            throw std::invalid_argument(std::string(choice) + " is no choice of " + std::string(name));
        return set(name, static_cast<double>(found - names.begin()));
    }

    template <class T = double>
    std::vector<Answer> evaluate(const std::vector<V3>& n, const std::vector<V3>& v, const std::vector<V3>& l,
                                 const V3& tangent = {1, 0, 0}) const {
        const std::size_t count = l.size();
        std::vector<std::vector<T>> arrays;
        arrays.reserve(params_.size() + 21);
        const auto filled = [&](double value) -> T* {
            return arrays.emplace_back(count, static_cast<T>(value)).data();
        };
        std::vector<const T*> params;
        for (const double value : params_) params.push_back(filled(value));
        ShaderEvaluation<T> e{};
        e.count = static_cast<std::int64_t>(count);
        e.params = params.data();
        e.options = options_.data();
        e.tables = tables_.data();
        T* outputs[9];
        for (std::size_t k = 0; k < 3; ++k) {
            const auto vectors = [&](const std::vector<V3>& from) {
                T* to = filled(0);
                for (std::size_t i = 0; i < count; ++i)
                    to[i] = static_cast<T>(from.size() == 1 ? from[0][k] : from[i][k]);
                return to;
            };
            e.n[k] = vectors(n);
            e.v[k] = vectors(v);
            e.l[k] = vectors(l);
            e.tangent[k] = filled(tangent[k]);
            e.diffuse[k] = outputs[k] = filled(-1);
            e.specular[k] = outputs[3 + k] = filled(-1);
            e.transmission[k] = outputs[6 + k] = filled(-1);
        }
        evaluate_shader(*info_, e);
        std::vector<Answer> out(count);
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t k = 0; k < 3; ++k) {
                out[i].diffuse[k] = outputs[k][i];
                out[i].specular[k] = outputs[3 + k][i];
                out[i].transmission[k] = outputs[6 + k][i];
            }
        return out;
    }
    Answer at(const V3& v, const V3& l, const V3& tangent = {1, 0, 0}) const {
        return evaluate({{0, 0, 1}}, {v}, {l}, tangent)[0];
    }

    /// Every parameter at random within its table's range (unbounded ones within the slider's), now and then at an end;
    /// options too. Emission and the constant ambient, which no light changes, stay 0.
    Model& randomize(std::mt19937& random) {
        const auto uniform = [&] { return std::uniform_real_distribution<double>(0, 1)(random); };
        for (const Parameter& p : info_->parameters) {
            if (p.name == "emission" || p.name == "ambient") continue;
            if (p.is_option()) {
                const int count = p.type == ParameterType::boolean ? 2 : static_cast<int>(choices_of(p).size());
                options_[static_cast<std::size_t>(p.slot)] = std::uniform_int_distribution<int>(0, count - 1)(random);
                continue;
            }
            if (!p.is_number()) continue;
            const double low = std::isfinite(p.min) ? p.min : p.soft_min;
            const double high = std::isfinite(p.max) ? p.max : std::max(p.soft_max, low);
            const double end = uniform();
            for (int k = 0; k < p.components(); ++k) {
                const double x = end < 0.1 ? 0 : end < 0.2 ? 1 : uniform();
                params_[static_cast<std::size_t>(p.slot + k)] = mix(low, high, x);
            }
        }
        return *this;
    }

    std::string describe() const {
        std::string text(info_->name);
        for (const Parameter& p : info_->parameters) {
            text += ' ' + std::string(p.name) + '=';
            if (p.type == ParameterType::table) text += "…";
            else if (p.is_option()) text += std::to_string(options_[static_cast<std::size_t>(p.slot)]);
            else
                for (int k = 0; k < p.components(); ++k)
                    text += (k > 0 ? "," : "") + std::to_string(params_[static_cast<std::size_t>(p.slot + k)]);
        }
        return text;
    }

private:
    const ShaderInfo* info_;
    std::vector<double> params_;
    std::vector<std::int32_t> options_;
    std::vector<TableView> tables_;
};

/// Width in the half angle, radians, of a model's narrowest lobe: what a quadrature or an error bound has to resolve.
inline double narrowest_width(const Model& m) {
    double width = 1;
    const auto value = [&](std::string_view name) {
        return m.params()[static_cast<std::size_t>(m.parameter(name).slot)];
    };
    const auto square = [](double x) { return x * x; };
    if (m.has("roughness")) width = std::min(width, square(value("roughness")));
    if (m.has("width")) width = std::min(width, value("width"));
    if (m.has("exponent")) width = std::min(width, std::sqrt(2 / (value("exponent") + 2)));
    if (m.has("anisotropic")) width *= std::sqrt(1 - 0.9 * value("anisotropic"));
    if (m.has("anisotropy")) width *= 1 - std::fabs(value("anisotropy"));
    if (m.has("clearcoat_roughness") && value("clearcoat") > 0)
        width = std::min(width, square(value("clearcoat_roughness")));
    if (m.has("clearcoat_gloss") && value("clearcoat") > 0)
        width = std::min(width, mix(0.1, 0.001, value("clearcoat_gloss")));
    if (m.info().name != "blender_principled") return std::max(width, 1e-3);
    if (value("coat_weight") > 0) width = std::min(width, square(value("coat_roughness")));
    const auto generation = m.options()[static_cast<std::size_t>(m.parameter("generation").slot)];
    return std::max(width, generation == 1 ? 3e-4 : 1.4e-5);
}

/// Uniform over the hemisphere, a share of them within a degree of the horizon or of the pole.
inline V3 random_direction(std::mt19937& random) {
    std::uniform_real_distribution<double> uniform(0, 1);
    const double kind = uniform(random);
    double z = uniform(random);
    if (kind < 0.1) z *= 0.017;
    else if (kind < 0.2) z = 1 - z * 1.5e-4;
    z = std::max(z, 1e-6);
    const double phi = 2 * kPi * uniform(random), r = std::sqrt(1 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
}

}  // namespace relume::testing
