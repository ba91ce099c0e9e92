// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "relume/light.h"
#include "relume/rig.h"
#include "relume/shader.h"

namespace relume::test {

/// Random values for rows of parameter tables, and random rigs made of them: what the tables allow, the rig must carry.
class RandomRig {
public:
    explicit RandomRig(unsigned seed) : engine_(seed) {}

    bool coin(double share = 0.5) { return std::bernoulli_distribution(share)(engine_); }
    int below(int count) { return std::uniform_int_distribution<int>(0, count - 1)(engine_); }

    double number(const Parameter& row) {
        switch (below(6)) {
            case 0:
                return std::isfinite(row.min) ? row.min : -1e300;
            case 1:
                return std::isfinite(row.max) ? row.max : 1e300;
            case 2:
                return clamped(row, 3);
            case 3:
                return clamped(row, std::ldexp(1.0, -1074));
            default: {
                const double u = std::uniform_real_distribution<double>(0, 1)(engine_);
                return clamped(row, row.soft_min + u * (row.soft_max - row.soft_min));
            }
        }
    }

    std::string text() {
        static const std::string pieces[] = {"a",    "Key",  "9", ".",       " ", "\"", "\\", "'", "\n", "\t",
                                             "\x01", "\x7f", "é", "равнина", "#", "=",  "]",  "{", "*",  "/"};
        std::string out = coin(0.7) ? "x" : "-";
        for (int k = below(6); k > 0; --k) out += pieces[below(std::size(pieces))];
        return out;
    }

    std::vector<double> ids() {
        std::vector<double> out;
        for (int k = below(3) + 1; k > 0; --k) out.push_back(coin() ? below(20) : 4294967295.0);
        return out;
    }

    Value value(const Parameter& row) {
        switch (row.type) {
            case ParameterType::scalar:
                return number(row);
            case ParameterType::integer:
                return static_cast<std::int64_t>(std::floor(clamped(row, below(9))));
            case ParameterType::color:
                if (coin(0.3)) return number(row);
                [[fallthrough]];
            case ParameterType::vector:
                return std::array<double, 3>{number(row), number(row), number(row)};
            case ParameterType::boolean:
                return coin();
            case ParameterType::choice:
                return choice(row.choices);
            case ParameterType::text:
                return text();
            case ParameterType::table: {
                if (coin()) return text();
                LookupTable table{1 + below(4), 1 + below(3), {}};
                for (int k = 0; k < table.width * table.height; ++k)
                    table.texels.push_back(std::ldexp(static_cast<float>(number({})), below(200) - 100));
                for (float& texel : table.texels)
                    if (!std::isfinite(texel)) texel = 0.1f;
                return table;
            }
            case ParameterType::text_list: {
                std::vector<std::string> list;
                for (int k = below(4); k > 0; --k) list.push_back(text());
                return list;
            }
            case ParameterType::number_list: {
                std::vector<double> list;
                const int count = row.count > 0 ? row.count : below(5);
                for (int k = 0; k < count; ++k) list.push_back(number(row));
                return list;
            }
        }
        return false;
    }

    std::string choice(std::string_view choices) {
        std::vector<std::string> words(1);
        for (const char c : choices) {
            if (c == '|') words.emplace_back();
            else words.back() += c;
        }
        return words[static_cast<std::size_t>(below(static_cast<int>(words.size())))];
    }

    /// Keys over frames for a number or colour.
    Keys keys(const Parameter& row) {
        Keys out;
        out.interpolation = static_cast<Keys::Interpolation>(below(3));
        out.components = row.components();
        double frame = number({});
        for (int k = below(4); k >= 0; --k) {
            out.frames.push_back(frame);
            std::array<double, 3> value{};
            for (int c = 0; c < out.components; ++c) value[static_cast<std::size_t>(c)] = number(row);
            out.values.push_back(value);
            frame = std::nextafter(frame, 1e308) + below(50);
        }
        return out;
    }

    Light light(const LightType& type, const std::string& name) {
        Light out{name, std::string(type.name), {}};
        const bool power = coin();
        for (const Parameter& row : type.parameters) {
            if (row.name == (power ? "intensity" : "power")) continue;
            const bool required = !row.has_default && row.type == ParameterType::vector;
            if (!required && !coin()) continue;
            // Within single precision, and together still so: brighter lights are refused.
            const double limit = row.name == "exposure" ? 20 : 1e6;
            Parameter bounded = row;
            bounded.min = std::max(row.min, -limit);
            bounded.max = std::min(row.max, limit);
            Value any = value(bounded);
            // No direction has length 0, and no light fades by 0 everywhere: those rigs are refused.
            if (row.type == ParameterType::vector && row.name != "position")
                std::get<std::array<double, 3>>(any)[0] = 1;
            if (row.name == "attenuation") std::get<std::vector<double>>(any)[0] = 1;
            if (row.is_number() && row.type != ParameterType::vector && coin(0.2)) any = keys(bounded);
            out.values.set(type.parameters, row.name, any, name);
        }
        return out;
    }

    ShaderUse shader(std::string_view use) {
        ShaderUse out;
        out.use = use;
        if (coin()) out.cryptomatte = {text(), text()};
        for (auto* list : {&out.object_id, &out.material_id, &out.shading_model_id})
            if (coin(0.3))
                for (const double id : ids()) list->push_back(static_cast<std::int64_t>(id));
        const auto parameters = shader_use_parameters(use);
        for (const Parameter& row : parameters) {
            if (coin(0.6)) continue;
            const bool channel = coin(0.3) && (row.type == ParameterType::scalar || row.type == ParameterType::color);
            if (channel) out.values.set(parameters, row.name, ChannelRef{text(), number({}), number({})}, use);
            else out.values.set(parameters, row.name, value(row), use);
        }
        return out;
    }

    ChannelRule rule() {
        ChannelRule out;
        if (coin()) out.channel = text();
        if (coin(0.3)) out.part = text();
        if (coin(0.3)) out.encoding = coin() ? Encoding::as_is : Encoding::zero_to_one;
        if (coin(0.3)) out.space = coin() ? Space::world : Space::camera;
        if (coin(0.3)) out.flip = choice("x|y|z|xy|zx|xyz");
        if (coin(0.3)) out.kind = coin() ? DepthKind::planar : DepthKind::ray;
        if (coin(0.3)) out.near = number({});
        if (coin(0.3)) out.far = number({});
        if (coin(0.3)) out.invert = coin();
        if (coin(0.3)) out.premultiplied = coin();
        return out;
    }

    Rig rig() {
        Rig out;
        if (coin()) out.gbuffer_file = text();
        if (coin(0.3)) out.frame = below(2000) - 500;
        if (coin(0.3)) out.gbuffer.max_pixels = 1 + below(1 << 30);
        if (coin(0.3)) out.gbuffer.max_channels = 1 + below(1 << 20);
        if (coin(0.3)) out.gbuffer.max_parts = 1 + below(1 << 20);
        if (coin(0.3)) out.gbuffer.part = text();
        if (coin(0.3)) out.gbuffer.view = text();
        if (coin(0.3)) out.gbuffer.alpha = coin() ? AlphaMode::premultiplied : AlphaMode::straight;
        if (coin(0.3)) out.gbuffer.working_space = text();
        if (coin(0.3)) out.gbuffer.normal_variance = static_cast<NormalVariance>(below(3));
        const auto names = channel_names();
        for (int k = below(4); k > 0; --k)
            out.gbuffer.channels[std::string(names[static_cast<std::size_t>(below(static_cast<int>(names.size())))])] =
                rule();
        if (coin())
            out.gbuffer.camera_matrix = {1, 0, 0, number({}), 0, 2, 0, number({}), 0, 0, -3, number({}), 0, 0, 0, 1};
        switch (below(3)) {
            case 0:
                out.gbuffer.fov = 39.6;
                break;
            case 1:
                out.gbuffer.focal_length = 50;
                out.gbuffer.horizontal_aperture = 36.1;
                break;
            default:
                break;
        }
        if (coin(0.3)) out.gbuffer.projection = coin() ? Projection::perspective : Projection::orthographic;
        if (coin(0.3)) out.gbuffer.width = 7.25;
        const auto types = light_types();
        for (int k = below(5); k > 0; --k)
            out.lights.push_back(light(types[static_cast<std::size_t>(below(static_cast<int>(types.size())))],
                                       text() + std::to_string(k)));
        const auto models = shaders();
        for (int k = below(4); k > 0; --k)
            out.shaders.push_back(
                coin(0.1) ? shader(kFromMaterialExpression)
                          : shader(models[static_cast<std::size_t>(below(static_cast<int>(models.size())))].name));
        for (const Parameter& row : output_parameters())
            if (coin()) out.output.values.set(output_parameters(), row.name, value(row), "[output]");
        return out;
    }

private:
    static double clamped(const Parameter& row, double x) { return std::min(std::max(x, row.min), row.max); }

    std::mt19937 engine_;
};

}  // namespace relume::test
