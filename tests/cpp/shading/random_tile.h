// SPDX-License-Identifier: Apache-2.0
#pragma once

// A tile of random pixels, lights and parameters for one shader, which owns its planes: what the kernel tests shade.

#include <array>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "../physics/shader_model.h"

namespace relume::testing {

/// What the pixels are like. `typical`: rough enough and far enough from grazing that float loses nothing; `extreme`:
/// everything.
enum class Regime { typical, extreme };

class RandomTile {
public:
    using Plane = std::vector<float>;

    RandomTile(const ShaderInfo& info, int count, std::uint32_t seed, Regime regime)
        : random_(seed), info_(&info), count_(count), regime_(regime) {
        Model model = Model(info).randomize(random_);
        options_ = model.options();
        fill_surface();
        fill_parameters(model);
        fill_tables();
        fill_lights();
        weight_ = maybe(0.3) ? std::optional(plane([&] { return uniform(); })) : std::nullopt;
        accumulate_ = maybe(0.3);
        emission_ = maybe(0.5);
        for (Plane& p : before_) p = plane([&] { return uniform(); });
    }

    /// Takes a choice of the shader's instead of the random one.
    RandomTile& choose(std::string_view name, std::string_view choice) {
        options_ = Model(*info_).set_options(options_).choose(name, choice).options();
        return *this;
    }

    int count() const { return count_; }
    bool accumulates() const { return accumulate_; }

    struct Result {
        std::array<Plane, 12> planes;  ///< total, diffuse, specular, transmission, RGB each
        std::int64_t nonfinite = 0;
    };

    /// Pixels [begin, begin + count) as a tile of their own.
    Result shade(ShadeFunction kernel, int begin, int count) {
        Result out;
        ShaderTile tile{};
        tile.size = sizeof tile;
        tile.count = count;
        const auto at = [&](const Plane& p) { return p.empty() ? nullptr : p.data() + begin; };
        for (std::size_t k = 0; k < 3; ++k) {
            tile.normal[k] = at(normal_[k]);
            tile.position[k] = at(position_[k]);
            tile.view[k] = at(view_[k]);
            tile.tangent[k] = at(tangent_[k]);
            tile.eye[k] = eye_[k];
        }
        tile.constant_view = constant_view_;
        tile.ambient_occlusion = at(occlusion_);
        std::vector<const float*> slots;
        for (const Plane& p : slots_) slots.push_back(at(p));
        slots.push_back(nullptr);
        tile.slots = slots.data();
        tile.constants = constants_.data();
        tile.options = options_.data();
        tile.tables = tables_.data();
        std::vector<DirectLight> lights = lights_;
        std::vector<AmbientLight> ambients = ambients_;
        for (std::size_t k = 0; k < lights.size(); ++k) lights[k].mask = at(masks_[k]);
        for (std::size_t k = 0; k < ambients.size(); ++k) ambients[k].mask = at(masks_[lights.size() + k]);
        tile.lights = lights.data();
        tile.light_count = static_cast<std::int32_t>(lights.size());
        tile.ambients = ambients.data();
        tile.ambient_count = static_cast<std::int32_t>(ambients.size());
        tile.weight = weight_ ? at(*weight_) : nullptr;
        tile.accumulate = accumulate_;
        tile.emission = emission_;
        for (std::size_t k = 0; k < 12; ++k) {
            out.planes[k].assign(before_[k].begin() + begin, before_[k].begin() + begin + count);
            (k < 3 ? tile.total[k] : tile.lobe[(k - 3) / 3][k % 3]) = out.planes[k].data();
        }
        kernel(&tile);
        out.nonfinite = tile.nonfinite;
        return out;
    }
    Result shade(ShadeFunction kernel) { return shade(kernel, 0, count_); }

    /// Writes NaN or infinity into one input of the pixel that the shader reads.
    void poison(int pixel) {
        std::vector<Plane*> planes;
        for (auto* group : {&normal_, &position_, &view_, &tangent_})
            for (Plane& p : *group)
                if (!p.empty() && (group != &tangent_ || info_->abi->needs_tangent)) planes.push_back(&p);
        if (!occlusion_.empty()) planes.push_back(&occlusion_);
        for (Plane& p : slots_)
            if (!p.empty()) planes.push_back(&p);
        const float bad[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                             -std::numeric_limits<float>::infinity()};
        (*planes[random_() % planes.size()])[static_cast<std::size_t>(pixel)] = bad[random_() % 3];
    }

    /// Gives all pixels but [begin, end) other values, some of them not finite.
    void disturb_outside(int begin, int end) {
        RandomTile other(*info_, count_, static_cast<std::uint32_t>(random_()), Regime::extreme);
        const auto take = [&](Plane& mine, const Plane& theirs) {
            for (int i = 0; i < count_; ++i)
                if ((i < begin || i >= end) && !mine.empty() && !theirs.empty())
                    mine[static_cast<std::size_t>(i)] = theirs[static_cast<std::size_t>(i)];
        };
        for (std::size_t k = 0; k < 3; ++k) {
            take(normal_[k], other.normal_[k]);
            take(position_[k], other.position_[k]);
            take(view_[k], other.view_[k]);
            take(tangent_[k], other.tangent_[k]);
        }
        for (std::size_t k = 0; k < slots_.size(); ++k) take(slots_[k], other.slots_[k]);
        for (int i = 0; i < count_; ++i)
            if ((i < begin || i >= end) && maybe(0.1)) poison(i);
    }

    float before(std::size_t plane, int pixel) const { return before_[plane][static_cast<std::size_t>(pixel)]; }

private:
    float uniform(float low = 0, float high = 1) { return std::uniform_real_distribution<float>(low, high)(random_); }
    bool maybe(double probability) { return std::bernoulli_distribution(probability)(random_); }
    template <class F> Plane plane(F&& f) {
        Plane out(static_cast<std::size_t>(count_));
        for (float& x : out) x = f();
        return out;
    }
    V3 on_sphere() {
        const double z = uniform(-1, 1), phi = uniform(0, 6.2831853f), r = std::sqrt(1 - z * z);
        return {r * std::cos(phi), r * std::sin(phi), z};
    }

    void fill_surface() {
        const int view_kind = static_cast<int>(random_() % 3);  // planes, from the eye, constant
        constant_view_ = view_kind == 2;
        const V3 towards = on_sphere();
        for (std::size_t k = 0; k < 3; ++k) {
            normal_[k].resize(static_cast<std::size_t>(count_));
            position_[k].resize(static_cast<std::size_t>(count_));
            tangent_[k].resize(maybe(0.5) || k > 0 ? normal_[k].size() : 0);
            if (k > 0 && tangent_[0].empty()) tangent_[k].clear();
            if (view_kind == 0) view_[k].resize(normal_[k].size());
            eye_[k] = static_cast<float>(constant_view_ ? towards[k] : 6 * towards[k]);
        }
        if (maybe(0.5)) occlusion_ = plane([&] { return uniform(); });
        for (std::size_t i = 0; i < normal_[0].size(); ++i) {
            const V3 position = on_sphere() * uniform(0.f, 1.5f);
            V3 v = constant_view_ || view_kind == 0 ? towards : unit(towards * 6 - position);
            if (view_kind == 0) v = unit(v + on_sphere() * 0.3);
            V3 n = unit(v + on_sphere() * (regime_ == Regime::typical ? 0.8 : 1.5));
            if (regime_ == Regime::typical && dot(n, v) < 0.15) n = unit(n + v);
            if (regime_ == Regime::extreme && maybe(0.1))
                n = unit(unit(cross(v, on_sphere())) + v * uniform(1e-3f, 0.03f));  // grazing
            const double length = regime_ == Regime::extreme && maybe(0.05) ? 0 : maybe(0.5) ? 1 : uniform(0.3f, 2.f);
            mirrored_.push_back(n * (2 * dot(n, v)) - v);
            const V3 t = maybe(0.2) ? V3{0, 0, 0} : on_sphere() * uniform(0.1f, 3.f);
            for (std::size_t k = 0; k < 3; ++k) {
                normal_[k][i] = static_cast<float>(n[k] * length);
                position_[k][i] = static_cast<float>(position[k]);
                if (view_kind == 0) view_[k][i] = static_cast<float>(v[k]);
                if (!tangent_[0].empty()) tangent_[k][i] = static_cast<float>(t[k]);
            }
        }
    }

    void fill_parameters(const Model& model) {
        const auto bounded = [&](const Parameter& p, double x) {
            // Lobes of 0.2 rad and more.
            if (regime_ == Regime::typical && (p.name.ends_with("roughness") || p.name == "width"))
                x = mix(0.45, 1., x);
            if (regime_ == Regime::typical && p.name == "exponent") x = 1 + x / 8;
            if (regime_ == Regime::typical && p.name == "clearcoat") x = 0;
            if (regime_ == Regime::typical && p.name.find("anisotrop") != p.name.npos) x *= 0.5;
            return static_cast<float>(x);
        };
        slots_.resize(static_cast<std::size_t>(info_->abi->float_slots));
        constants_.resize(slots_.size() + 1);
        for (const Parameter& p : info_->parameters) {
            if (!p.is_number()) continue;
            const bool as_plane = maybe(0.6);
            for (int k = 0; k < p.components(); ++k) {
                const auto slot = static_cast<std::size_t>(p.slot + k);
                constants_[slot] = bounded(p, model.params()[slot]);
                if (p.name == "emission" || p.name == "ambient") constants_[slot] = uniform();
                if (as_plane) slots_[slot].resize(static_cast<std::size_t>(count_));
            }
            if (as_plane) {
                for (int i = 0; i < count_; ++i) {
                    const Model other = Model(*info_).randomize(random_);
                    for (int k = 0; k < p.components(); ++k) {
                        const auto slot = static_cast<std::size_t>(p.slot + k);
                        slots_[slot][static_cast<std::size_t>(i)] = bounded(p, other.params()[slot]);
                    }
                }
            }
        }
    }

    /// Of any size, a single texel too.
    void fill_tables() {
        texels_.resize(static_cast<std::size_t>(info_->abi->table_slots));
        for (std::vector<float>& texels : texels_) {
            const int width = 1 + static_cast<int>(random_() % 9), height = 1 + static_cast<int>(random_() % 5);
            for (int k = 0; k < width * height; ++k) texels.push_back(uniform());
            tables_.push_back({texels.data(), width, height});
        }
    }

    void fill_lights() {
        const int directs = static_cast<int>(random_() % 7), ambients = static_cast<int>(random_() % 3);
        for (int k = 0; k < directs; ++k) {
            DirectLight light{};
            light.kind = static_cast<LightKind>(random_() % 3);
            light.falloff = static_cast<SpotFalloff>(random_() % 4);
            light.inverse_square = maybe(0.5);
            V3 axis = on_sphere(), position = axis * uniform(2.5f, 8.f) + on_sphere() * 0.5;
            if (maybe(0.6)) {  // some pixel's highlight
                const std::size_t pixel = random_() % normal_[0].size();
                axis = unit(mirrored_[pixel] +
                            on_sphere() * std::pow(10., -uniform(0.f, regime_ == Regime::typical ? 1.f : 4.f)));
                position = axis * uniform(2.5f, 8.f);
                for (std::size_t c = 0; c < 3; ++c) position[c] += position_[c][pixel];
            }
            for (std::size_t c = 0; c < 3; ++c) {
                light.to_light[c] = static_cast<float>(axis[c]);
                light.position[c] = static_cast<float>(position[c]);
                light.attenuation[c] = uniform(0.01f, 1.f);
                for (auto& lobe : light.color) lobe[c] = uniform(0.f, 3.f);
            }
            const float half = uniform(0.3f, 1.4f), blend = uniform(0.1f, 1.f);
            light.cone[0] = std::cos(half);
            light.cone[1] = 1 / (light.falloff == SpotFalloff::linear ? half * blend : (1 - std::cos(half)) * blend);
            light.cone[2] = half;
            light.cone[3] = blend;
            lights_.push_back(light);
        }
        for (int k = 0; k < ambients; ++k) {
            AmbientLight light{};
            light.clamp = maybe(0.5);
            const V3 axis = on_sphere();
            for (std::size_t c = 0; c < 3; ++c) {
                light.axis[c] = static_cast<float>(axis[c]);
                light.low[c] = uniform();
                light.high[c] = uniform();
            }
            ambients_.push_back(light);
        }
        for (int k = 0; k < directs + ambients; ++k)
            masks_.push_back(maybe(0.3) ? plane([&] { return uniform(); }) : Plane{});
    }

    std::mt19937 random_;
    const ShaderInfo* info_;
    int count_;
    Regime regime_;
    std::array<Plane, 3> normal_, position_, view_, tangent_;
    std::vector<V3> mirrored_;
    Plane occlusion_;
    std::array<float, 3> eye_{};
    bool constant_view_ = false;
    std::vector<Plane> slots_;
    std::vector<float> constants_;
    std::vector<std::int32_t> options_;
    std::vector<std::vector<float>> texels_;
    std::vector<TableView> tables_;
    std::vector<DirectLight> lights_;
    std::vector<AmbientLight> ambients_;
    std::vector<Plane> masks_;
    std::optional<Plane> weight_;
    bool accumulate_ = false, emission_ = false;
    std::array<Plane, 12> before_;
};

}  // namespace relume::testing
