// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "gbuffer/step_run.h"

namespace relume::gbuffer {

namespace {

int floor_divide(int a, int b) { return a >= 0 ? a / b : -((-a + b - 1) / b); }

/// What alpha² grows by where the mean normal has this length.
float growth(float length, float dead_zone) {
    const float seen = length + dead_zone;
    return seen < 1.0f ? 2.0f * (1.0f - seen) / seen : 0.0f;
}

}  // namespace

void variance(const Run& r) {
    // Σ of the shares that were rounded one by one.
    constexpr float kWhole = 0.999f;
    const Step& s = r.step;
    const float *ax = r.in(0), *ay = r.in(1), *az = r.in(2), *share = r.in(3), *reciprocal = r.in(4);
    const float mx = s.multiply[0], my = s.multiply[1], mz = s.multiply[2];
    const float bx = s.add[0], by = s.add[1], bz = s.add[2];
    const float least = s.background;
    float* out = r.out(0);
    for (int i = 0; i < r.count; ++i) {
        const float w = reciprocal ? reciprocal[i] : 1.0f;
        const float rx = ax[i] * w, ry = ay[i] * w, rz = az[i] * w;
        const float x = rx * mx + bx, y = ry * my + by, z = rz * mz + bz;
        const float square = x * x + y * y + z * z;
        const bool blank = (rx == 0.0f && ry == 0.0f && rz == 0.0f) || square <= least;
        // Nobody knows whether a normal that was not averaged with the background is short for that.
        const bool partial = share && !reciprocal && share[i] < kWhole;
        const float dead_zone = share && share[i] < 1.0f ? s.near : s.scale;
        const float grown = growth(std::sqrt(square), dead_zone);
        out[i] = blank || partial ? 0.0f : grown;
    }
}

/// A pixel across a crease, or across the border of two objects, shows two faces, each of which the pixel beside it on
/// that side shows alone. The mean of their normals may look where neither does; the nearer of them has the larger
/// share.
void face(const Run& r) {
    // A mix of less than 36° is taken for the bend of one surface, which really shows what lies between; and what is
    // not clearly less of a mix is no face. Both measured against Blender's antialiased frames.
    constexpr float kMixed = 0.1f, kPure = 0.1f;
    const Step& s = r.step;
    auto* out = reinterpret_cast<std::int32_t*>(r.out(0));
    const float* mixed = r.in(3);
    float* left = r.out(1);
    const auto block = [&](int y) { return s.block_rows > 0 ? floor_divide(y - s.block_top, s.block_rows) : 0; };
    const bool above = r.rows.above && block(r.rows.y - 1) == block(r.rows.y);
    const bool below = r.rows.below && block(r.rows.y + 1) == block(r.rows.y);
    for (int i = 0; i < r.count; ++i) {
        out[i] = 0;
        left[i] = mixed[i];
        if (!(mixed[i] > kMixed)) continue;
        const std::array<float, 3> mean = decoded(s, r.in(0)[i], r.in(1)[i], r.in(2)[i]);
        float nearest = -HUGE_VALF;
        const auto look = [&](int dx, int dy) {
            const int column = r.rows.first_column + i + dx;
            if (column < 0 || column >= r.rows.width) return;
            // By its length as stored, so that a pixel that the background has a share of is no face.
            const std::array<float, 3> n = vector_at(r, i + dx, dy);
            const float length = length_of(n), its = growth(length, s.scale);
            if (!(its < kPure * mixed[i]) || !(length < 1.0f + 2.0f * s.scale)) return;
            const float cosine = (n[0] * mean[0] + n[1] * mean[1] + n[2] * mean[2]) / length;
            if (cosine <= nearest) return;
            nearest = cosine;
            out[i] = stand_in(dx, dy);
            left[i] = its;
        };
        look(-1, 0);
        look(1, 0);
        if (above) look(0, -1);
        if (below) look(0, 1);
    }
}

void widen(const Run& r) {
    const float *a = r.in(0), *variance = r.in(1);
    float* out = r.out(0);
    if (!a) {
        std::fill_n(out, r.count, r.step.offset);
        a = out;
    }
    // Written so that NaN comes through; where nothing is averaged the value stays what it is, to the bit.
    const auto each = [&](auto wider) {
        for (int i = 0; i < r.count; ++i) {
            const float value = a[i] < 0.0f ? 0.0f : a[i];
            const float wide = wider(value, variance[i]);
            out[i] = variance[i] > 0.0f ? wide : a[i];
        }
    };
    const auto most = [](float alpha2) { return alpha2 > 1.0f ? 1.0f : alpha2; };
    switch (r.step.lobe_width) {
        case LobeWidth::none:
            each([](float x, float) { return x; });
            return;
        case LobeWidth::roughness:
            // A light without a size shows in no mirror, however it is bent.
            each([&](float x, float v) { return x == 0.0f ? 0.0f : std::sqrt(std::sqrt(most(x * x * x * x + v))); });
            return;
        case LobeWidth::alpha:
            each([&](float x, float v) { return std::sqrt(most(x * x + v)); });
            return;
        case LobeWidth::half_exponent:
            each([&](float x, float v) { return 2.0f / most(2.0f / (x + 2.0f) + v) - 2.0f; });
            return;
        case LobeWidth::mirror_exponent:
            each([&](float x, float v) { return 0.5f / most(2.0f / (4.0f * x + 2.0f) + v) - 0.5f; });
            return;
        case LobeWidth::gloss:
            each([&](float x, float v) {
                const float alpha = 0.1f - 0.099f * (x > 1.0f ? 1.0f : x);
                const float wide = std::sqrt(alpha * alpha + v);
                return wide > 0.1f ? 0.0f : (0.1f - wide) / 0.099f;
            });
            return;
    }
}

}  // namespace relume::gbuffer
