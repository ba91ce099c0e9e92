// SPDX-License-Identifier: Apache-2.0
#include "relight/shade_pass.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "io/pixel_convert.h"

namespace relume {

namespace {

// Scratch planes by purpose.
enum : int { kTotal = 0, kLobes = 3, kCover = 12, kRgba = 13, kTemporary = 17, kFixed = 18 };

bool finite(float x) { return std::isfinite(x); }

}  // namespace

void store_row(const Plane& plane, const float* values, int count) {
    std::byte* to = plane.data;
    if (plane.type == PixelType::half) {
        io::convert_run({reinterpret_cast<const std::byte*>(values), PixelType::float32, sizeof(float)},
                        {to, PixelType::half, plane.x_stride}, static_cast<std::size_t>(count));
    } else if (plane.x_stride == sizeof(float)) {
        std::memcpy(to, values, static_cast<std::size_t>(count) * sizeof(float));
    } else {
        for (int i = 0; i < count; ++i, to += plane.x_stride) std::memcpy(to, values + i, sizeof(float));
    }
}

ShadePass::ShadePass(const Plan& plan)
    : plan_(plan),
      compose_(compose_kernel()),
      group_planes_(static_cast<int>(kFixed + plan.rules.size() + plan.masks.size())),
      scratch_(kFixed + plan.rules.size() + plan.masks.size() + 3 * plan.groups.size()),
      weights_(plan.rules.size()),
      weight_counts_(plan.rules.size()),
      weight_full_(plan.rules.size()),
      masks_(plan.masks.size()),
      gathered_mask_pointers_(plan.masks.size()) {
    if (plan.rules.size() > 1) {
        runs_.reserve(kTilePixels / 2);
        gathered_planes_.resize(static_cast<std::size_t>(plan.plane_count));
        gathered_masks_.resize(plan.masks.size());
        gathered_outputs_.resize(12);
        gathered_pointers_.resize(static_cast<std::size_t>(plan.plane_count));
    }
}

ShadePass::Rgb ShadePass::rgb(int first) {
    const auto k = static_cast<std::size_t>(first);
    return {scratch_[k].get(), scratch_[k + 1].get(), scratch_[k + 2].get()};
}

void ShadePass::compute_masks(std::span<const float* const> planes, int count) {
    for (std::size_t m = 0; m < plan_.masks.size(); ++m) {
        const MaskPlan& mask = plan_.masks[m];
        const float* include = mask.include_plane < 0 ? nullptr : planes[static_cast<std::size_t>(mask.include_plane)];
        const float* exclude = mask.exclude_plane < 0 ? nullptr : planes[static_cast<std::size_t>(mask.exclude_plane)];
        const float* coverage = plan_.coverage < 0 ? nullptr : planes[static_cast<std::size_t>(plan_.coverage)];
        float* out = scratch_[kFixed + plan_.rules.size() + m].get();
        for (int i = 0; i < count; ++i) {
            // Mattes are shares of the pixel; the light is masked over the part that the surface covers.
            const float whole = coverage != nullptr && coverage[i] > 0 ? coverage[i] : 1.f;
            const float in = include != nullptr ? std::min(1.f, include[i] / whole) : 1.f;  // 1 for NaN, which ∞/∞ is
            const float ex = exclude != nullptr ? std::min(1.f, exclude[i] / whole) : 0.f;
            out[i] = in * (1.f - ex);
        }
        masks_[m] = out;
    }
}

void ShadePass::compute_weights(std::span<const float* const> planes, int count) {
    float* remaining = scratch_[kTemporary].get();
    std::fill_n(remaining, count, 1.f);
    const float* coverage = plan_.coverage < 0 ? nullptr : planes[static_cast<std::size_t>(plan_.coverage)];
    for (std::size_t r = 0; r < plan_.rules.size(); ++r) {
        const ShaderRule& rule = plan_.rules[r];
        float* weight = scratch_[kFixed + r].get();
        if (rule.everything()) std::copy_n(remaining, count, weight);
        else {
            if (rule.matte_plane >= 0) {
                const float* matte = planes[static_cast<std::size_t>(rule.matte_plane)];
                for (int i = 0; i < count; ++i) {
                    const float whole = coverage != nullptr && coverage[i] > 0 ? coverage[i] : 1.f;
                    const float share = matte[i] / whole;
                    weight[i] = share > 0 ? std::min(share, remaining[i]) : 0.f;
                }
            } else {
                std::copy_n(remaining, count, weight);
            }
            for (const auto& match : rule.ids) {
                const float* plane = planes[static_cast<std::size_t>(match.plane)];
                for (int i = 0; i < count; ++i) {
                    std::uint32_t id;
                    std::memcpy(&id, plane + i, sizeof id);
                    if (!std::binary_search(match.values.begin(), match.values.end(), id)) weight[i] = 0.f;
                }
            }
        }
        int used = 0;
        bool full = true;
        for (int i = 0; i < count; ++i) {
            remaining[i] -= weight[i];
            used += weight[i] > 0.f;
            full = full && weight[i] == 1.f;
        }
        weights_[r] = weight;
        weight_counts_[r] = used;
        weight_full_[r] = full;
    }
}

void ShadePass::run(const ShaderBinding& binding, const LightGroup& group, std::span<const float* const> planes,
                    int count, const float* weight, bool accumulate, bool emission, const Rgb& total) {
    const auto plane3 = [&](int first, const float*(&to)[3]) {
        for (int k = 0; k < 3; ++k) to[k] = first < 0 ? nullptr : planes[static_cast<std::size_t>(first + k)];
    };
    ShaderTile tile{};
    tile.size = sizeof tile;
    tile.count = count;
    plane3(plan_.normal, tile.normal);
    plane3(plan_.position, tile.position);
    plane3(plan_.view, tile.view);
    plane3(plan_.tangent, tile.tangent);
    tile.ambient_occlusion =
        plan_.ambient_occlusion < 0 ? nullptr : planes[static_cast<std::size_t>(plan_.ambient_occlusion)];
    std::copy(plan_.eye.begin(), plan_.eye.end(), tile.eye);
    tile.constant_view = plan_.constant_view;

    slot_pointers_.resize(binding.slot_planes.size() + 1);
    for (std::size_t k = 0; k < binding.slot_planes.size(); ++k)
        slot_pointers_[k] =
            binding.slot_planes[k] < 0 ? nullptr : planes[static_cast<std::size_t>(binding.slot_planes[k])];
    tile.slots = slot_pointers_.data();
    tile.constants = binding.constants.data();
    tile.options = binding.options.data();
    tile.tables = binding.table_views.data();

    direct_ = group.direct;
    ambient_ = group.ambient;
    for (std::size_t k = 0; k < direct_.size(); ++k)
        direct_[k].mask = group.direct_masks[k] < 0 ? nullptr : masks_[static_cast<std::size_t>(group.direct_masks[k])];
    for (std::size_t k = 0; k < ambient_.size(); ++k)
        ambient_[k].mask =
            group.ambient_masks[k] < 0 ? nullptr : masks_[static_cast<std::size_t>(group.ambient_masks[k])];
    tile.lights = direct_.data();
    tile.light_count = static_cast<std::int32_t>(direct_.size());
    tile.ambients = ambient_.data();
    tile.ambient_count = static_cast<std::int32_t>(ambient_.size());

    tile.weight = weight;
    tile.accumulate = accumulate;
    tile.emission = emission;
    std::copy(total.begin(), total.end(), tile.total);
    for (int k = 0; k < 3; ++k) {
        if (plan_.lobe_aovs[static_cast<std::size_t>(k)] < 0) continue;
        const Rgb lobe = rgb(kLobes + 3 * k);
        std::copy(lobe.begin(), lobe.end(), tile.lobe[k]);
    }
    binding.kernel(&tile);
    saw_nonfinite_ = saw_nonfinite_ || tile.nonfinite > 0;
}

void ShadePass::run_gathered(const ShaderBinding& binding, const LightGroup& group,
                             std::span<const float* const> planes, int count, const float* weight, bool emission,
                             const Rgb& total) {
    // Pixels of a material lie side by side, mostly: they are moved by runs.
    int used = 0;
    runs_.clear();
    for (int i = 0; i < count; ++i) {
        if (!(weight[i] > 0.f)) continue;
        if (runs_.empty() || runs_.back().first + runs_.back().count != i) runs_.push_back({i, 0});
        ++runs_.back().count;
        ++used;
    }
    const auto gather = [&](const float* from, float* to) {
        for (const Run& run : runs_) to = std::copy_n(from + run.first, run.count, to);
    };
    for (std::size_t p = 0; p < planes.size(); ++p) {
        gather(planes[p], gathered_planes_[p].get());
        gathered_pointers_[p] = gathered_planes_[p].get();
    }
    gather(weight, gathered_weight_.get());
    const std::vector<const float*> masks = masks_;
    for (std::size_t m = 0; m < masks.size(); ++m) {
        gather(masks[m], gathered_masks_[m].get());
        gathered_mask_pointers_[m] = gathered_masks_[m].get();
    }
    masks_ = gathered_mask_pointers_;

    // The lobes' scratch is swapped for gathered planes while the kernel runs.
    for (int k = 0; k < 9; ++k)
        std::swap(scratch_[static_cast<std::size_t>(kLobes + k)].data,
                  gathered_outputs_[static_cast<std::size_t>(3 + k)].data);
    const Rgb out{gathered_outputs_[0].get(), gathered_outputs_[1].get(), gathered_outputs_[2].get()};
    run(binding, group, gathered_pointers_, used, gathered_weight_.get(), false, emission, out);
    for (int k = 0; k < 9; ++k)
        std::swap(scratch_[static_cast<std::size_t>(kLobes + k)].data,
                  gathered_outputs_[static_cast<std::size_t>(3 + k)].data);
    masks_ = masks;

    const auto scatter = [&](const float* from, float* to) {
        for (const Run& run : runs_)
            for (int i = run.first; i < run.first + run.count; ++i) to[i] += *from++;
    };
    for (std::size_t k = 0; k < 3; ++k) scatter(out[k], total[k]);
    for (int k = 0; k < 9; ++k)
        if (plan_.lobe_aovs[static_cast<std::size_t>(k / 3)] >= 0)
            scatter(gathered_outputs_[static_cast<std::size_t>(3 + k)].get(),
                    scratch_[static_cast<std::size_t>(kLobes + k)].get());
}

void ShadePass::count_nonfinite(std::span<const float* const> planes, int count) {
    std::map<std::string, std::vector<bool>> bad;
    // What stands behind the surfaces (positions at infinity) does not matter. A normal of NaN is no background.
    const auto surface = [&](int i) {
        const auto n = [&](int k) { return planes[static_cast<std::size_t>(plan_.normal + k)][i]; };
        return plan_.normal < 0 || !(n(0) * n(0) + n(1) * n(1) + n(2) * n(2) <= 1e-12f);
    };
    const auto look = [&](int plane, int components) {
        if (plane < 0) return;
        for (int k = 0; k < components; ++k) {
            const float* values = planes[static_cast<std::size_t>(plane + k)];
            for (int i = 0; i < count; ++i) {
                if (finite(values[i]) || !surface(i)) continue;
                auto& flags = bad[plan_.plane_names[static_cast<std::size_t>(plane)]];
                flags.resize(static_cast<std::size_t>(count));
                flags[static_cast<std::size_t>(i)] = true;
            }
        }
    };
    look(plan_.normal, 3);
    look(plan_.position, 3);
    look(plan_.view, 3);
    look(plan_.tangent, 3);
    look(plan_.ambient_occlusion, 1);
    look(plan_.coverage, 1);
    look(plan_.alpha, 1);
    look(plan_.beauty, 3);
    std::vector<int> seen;
    for (const ShaderBinding& binding : plan_.bindings)
        for (const int plane : binding.slot_planes)
            if (plane >= 0 && std::find(seen.begin(), seen.end(), plane) == seen.end()) {
                seen.push_back(plane);
                look(plane, 1);
            }
    for (const auto& [name, flags] : bad) nonfinite[name] += std::count(flags.begin(), flags.end(), true);
}

void ShadePass::write_aov(const Target& target, const Rgb& light, int count) {
    const float* cover = scratch_[kCover].get();
    float* row = scratch_[kTemporary].get();
    for (std::size_t k = 0; k < target.planes.size() && k < 3; ++k) {
        for (int i = 0; i < count; ++i) row[i] = light[k][i] * cover[i];
        store_row(target.planes[k], row, count);
    }
}

void ShadePass::shade(std::span<const float* const> planes, int count, std::span<const Target> targets, bool stream) {
    compute_masks(planes, count);
    const bool several = plan_.rules.size() > 1;
    if (several) compute_weights(planes, count);
    saw_nonfinite_ = false;

    const Rgb total = rgb(kTotal);
    // One shader over everything, one light group: the kernel overwrites, nothing has to be cleared.
    const bool clear = several || plan_.groups.size() > 1;
    if (clear) {
        for (float* plane : total) std::fill_n(plane, count, 0.f);
        for (int k = 0; k < 9; ++k)
            if (plan_.lobe_aovs[static_cast<std::size_t>(k / 3)] >= 0)
                std::fill_n(scratch_[static_cast<std::size_t>(kLobes + k)].get(), count, 0.f);
    }
    for (std::size_t g = 0; g < plan_.groups.size(); ++g) {
        const LightGroup& group = plan_.groups[g];
        const bool own = group.aov >= 0;
        const Rgb to = own ? rgb(group_planes_ + 3 * static_cast<int>(g)) : total;
        if (own)
            for (float* plane : to) std::fill_n(plane, count, 0.f);
        for (std::size_t r = 0; r < plan_.rules.size(); ++r) {
            const ShaderBinding& binding = plan_.bindings[static_cast<std::size_t>(plan_.rules[r].binding)];
            const bool emission = g == 0;
            if (!several || weight_full_[r]) run(binding, group, planes, count, nullptr, clear, emission, to);
            else if (weight_counts_[r] > 0) run_gathered(binding, group, planes, count, weights_[r], emission, to);
        }
        if (own) {
            for (std::size_t k = 0; k < 3; ++k)
                for (int i = 0; i < count; ++i) total[k][i] += to[k][i];
        }
    }

    ComposeTile tile{};
    tile.count = count;
    const auto plane_at = [&](int plane) { return plane < 0 ? nullptr : planes[static_cast<std::size_t>(plane)]; };
    for (int k = 0; k < 3; ++k) {
        tile.normal[k] = plane_at(plan_.normal + k);
        tile.beauty[k] = plan_.beauty < 0 ? nullptr : plane_at(plan_.beauty + k);
        tile.light[k] = total[static_cast<std::size_t>(k)];
    }
    tile.coverage = plane_at(plan_.coverage);
    tile.alpha = plane_at(plan_.alpha);
    tile.add = plan_.mode == OutputMode::add;
    tile.cover = plan_.aovs.size() > 1 ? scratch_[kCover].get() : nullptr;

    const std::vector<Plane>& rgba = targets[0].planes;
    const auto pixel_interleaved = [&] {
        if (rgba.size() != 4) return false;
        for (std::size_t k = 0; k < 4; ++k)
            if (rgba[k].type != PixelType::float32 || rgba[k].x_stride != 16 || rgba[k].data != rgba[0].data + 4 * k)
                return false;
        return reinterpret_cast<std::uintptr_t>(rgba[0].data) % 16 == 0;
    };
    const auto direct = [&](std::size_t k) {
        return k < rgba.size() && rgba[k].type == PixelType::float32 && rgba[k].x_stride == 4;
    };
    bool copy[4] = {};
    tile.stream = stream;
    if (pixel_interleaved()) {
        tile.interleaved = 1;
        tile.rgba[0] = reinterpret_cast<float*>(rgba[0].data);
    } else {
        for (std::size_t k = 0; k < std::max<std::size_t>(rgba.size(), 3); ++k) {
            copy[k] = !direct(k);
            if (copy[k]) tile.stream = 0;
            tile.rgba[k] = copy[k] ? scratch_[kRgba + k].get() : reinterpret_cast<float*>(rgba[k].data);
        }
    }
    compose_(&tile);
    for (std::size_t k = 0; k < 4 && k < rgba.size(); ++k)
        if (copy[k]) store_row(rgba[k], tile.rgba[k], count);

    for (std::size_t k = 0; k < 3; ++k)
        if (plan_.lobe_aovs[k] >= 0)
            write_aov(targets[static_cast<std::size_t>(plan_.lobe_aovs[k])], rgb(kLobes + 3 * static_cast<int>(k)),
                      count);
    for (std::size_t g = 0; g < plan_.groups.size(); ++g)
        if (plan_.groups[g].aov >= 0)
            write_aov(targets[static_cast<std::size_t>(plan_.groups[g].aov)],
                      rgb(group_planes_ + 3 * static_cast<int>(g)), count);
    shaded += tile.shaded;
    background += count - tile.shaded;
    if (saw_nonfinite_ || tile.nonfinite > 0) count_nonfinite(planes, count);
}

}  // namespace relume
