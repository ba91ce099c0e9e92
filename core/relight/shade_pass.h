// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "gbuffer/band_reader.h"
#include "relight/compose_kernel.h"
#include "relight/plan.h"

namespace relume {

/// Where one picture's rows go: planes over the rows [y, y + rows) of the data window.
struct Target {
    std::vector<Plane> planes;
};

/// Shades tiles. One per thread: it owns all scratch memory and allocates none per tile.
class ShadePass {
public:
    explicit ShadePass(const Plan& plan);

    /// Shades `count` ≤ kTilePixels pixels. `planes` are the plan's, `targets` (one per AOV of the plan, its planes
    /// empty where nobody asks) point at the tile's first pixel.
    void shade(std::span<const float* const> planes, int count, std::span<const Target> targets, bool stream);

    std::int64_t shaded = 0;
    std::int64_t background = 0;
    std::map<std::string, std::int64_t> nonfinite;

private:
    struct Planar {
        std::vector<float> data = std::vector<float>(kTilePixels);
        float* get() { return data.data(); }
    };
    using Rgb = std::array<float*, 3>;

    Rgb rgb(int first);
    void compute_masks(std::span<const float* const> planes, int count);
    void compute_weights(std::span<const float* const> planes, int count);
    void run(const ShaderBinding& binding, const LightGroup& group, std::span<const float* const> planes, int count,
             const float* weight, bool accumulate, bool emission, const Rgb& total);
    void run_gathered(const ShaderBinding& binding, const LightGroup& group, std::span<const float* const> planes,
                      int count, const float* weight, bool emission, const Rgb& total);
    void count_nonfinite(std::span<const float* const> planes, int count);
    void write_aov(const Target& target, const Rgb& light, int count);

    const Plan& plan_;
    ComposeFunction compose_;
    int group_planes_;                   // first scratch plane of the light groups' own sums
    std::vector<Planar> scratch_;        // total, lobes, cover, rgba, weights, masks, groups
    std::vector<const float*> weights_;  // per rule; null: nothing of it here
    std::vector<int> weight_counts_;     // pixels with a weight above 0
    std::vector<bool> weight_full_;      // every pixel wholly its own
    std::vector<const float*> masks_;
    std::vector<float> interleaved_;
    std::vector<const float*> slot_pointers_;
    std::vector<DirectLight> direct_;
    std::vector<AmbientLight> ambient_;
    // Pixels of one shader, gathered.
    struct Run {
        int first, count;
    };
    std::vector<Run> runs_;
    std::vector<Planar> gathered_planes_, gathered_masks_, gathered_outputs_;
    std::vector<const float*> gathered_pointers_;
    std::vector<const float*> gathered_mask_pointers_;
    Planar gathered_weight_;
    bool saw_nonfinite_ = false;
};

/// Writes `count` floats into a plane of any type and stride, from its first pixel on.
void store_row(const Plane& plane, const float* values, int count);

}  // namespace relume
