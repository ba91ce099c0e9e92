// SPDX-License-Identifier: Apache-2.0
#include "gbuffer/pixel_steps.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "gbuffer/planes.h"
#include "gbuffer/step_run.h"

namespace relume::gbuffer {

namespace {

void scale(const Run& r) {
    const float* a = r.in(0);
    float* out = r.out(0);
    for (int i = 0; i < r.count; ++i) out[i] = a[i] * r.step.scale + r.step.offset;
}

void divide(const Run& r) {
    const float *a = r.in(0), *b = r.in(1);
    float* out = r.out(0);
    for (int i = 0; i < r.count; ++i) out[i] = a[i] * b[i] * r.step.scale + r.step.offset;
}

void product(const Run& r) {
    const float *a = r.in(0), *b = r.in(1);
    float* out = r.out(0);
    for (int i = 0; i < r.count; ++i) out[i] = a[i] * b[i];
}

void coverage(const Run& r) {
    float *share = r.out(0), *reciprocal = r.out(1);
    std::memcpy(share, r.registers[r.step.sum.front()], static_cast<std::size_t>(r.count) * sizeof(float));
    for (std::size_t k = 1; k < r.step.sum.size(); ++k) {
        const float* a = r.registers[r.step.sum[k]];
        for (int i = 0; i < r.count; ++i) share[i] += a[i];
    }
    for (int i = 0; i < r.count; ++i) {
        // The comparisons let NaN through: the shading pass counts it.
        const float c = share[i] > 1.0f ? 1.0f : share[i] < kLeastCoverage ? 0.0f : share[i];
        share[i] = c;
        reciprocal[i] = c == 0.0f ? 0.0f : 1.0f / c;
    }
}

/// Decoding, flips, the way to world space and unit length in one pass; without branches, so that it becomes SIMD code.
template <bool kTransform> void direction(const Run& r, const float* share, const float* reciprocal) {
    const Step& s = r.step;
    const float *ax = r.in(0), *ay = r.in(1), *az = r.in(2);
    float *ox = r.out(0), *oy = r.out(1), *oz = r.out(2);
    const std::array<float, 12>& m = s.matrix;
    const float mx = s.multiply[0], my = s.multiply[1], mz = s.multiply[2];
    const float bx = s.add[0], by = s.add[1], bz = s.add[2];
    const float least = s.background;
    for (int i = 0; i < r.count; ++i) {
        const float w = reciprocal ? reciprocal[i] : 1.0f;
        const float rx = ax[i] * w, ry = ay[i] * w, rz = az[i] * w;
        float x = rx * mx + bx, y = ry * my + by, z = rz * mz + bz;
        if constexpr (kTransform) {
            const float tx = m[0] * x + m[1] * y + m[2] * z;
            const float ty = m[4] * x + m[5] * y + m[6] * z;
            z = m[8] * x + m[9] * y + m[10] * z;
            x = tx;
            y = ty;
        }
        const float square = x * x + y * y + z * z;
        const bool blank = rx == 0.0f && ry == 0.0f && rz == 0.0f;
        const bool none = blank || square <= least || (share && share[i] == 0.0f);
        const float factor = none ? 0.0f : 1.0f / std::sqrt(square);
        ox[i] = none ? 0.0f : x * factor;
        oy[i] = none ? 0.0f : y * factor;
        oz[i] = none ? 0.0f : z * factor;
    }
    const std::int32_t* face = r.offsets(5);
    for (int i = 0; face && i < r.count; ++i) {
        if (face[i] == 0) continue;
        const std::array<float, 3> n = vector_at(r, i + stand_in_column(face[i]), stand_in_row(face[i]));
        const float factor = 1.0f / length_of(n);
        ox[i] = n[0] * factor;
        oy[i] = n[1] * factor;
        oz[i] = n[2] * factor;
    }
}

void turn(const Run& r) {
    const float *ax = r.in(0), *ay = r.in(1), *az = r.in(2), *vx = r.in(3), *vy = r.in(4), *vz = r.in(5);
    float *ox = r.out(0), *oy = r.out(1), *oz = r.out(2);
    for (int i = 0; i < r.count; ++i) {
        const float sign = ax[i] * vx[i] + ay[i] * vy[i] + az[i] * vz[i] < 0.0f ? -1.0f : 1.0f;
        ox[i] = sign * ax[i];
        oy[i] = sign * ay[i];
        oz[i] = sign * az[i];
    }
}

/// The pixel's ray in world space, with a component of 1 along the view axis; for parallel rays, where it starts.
std::array<double, 3> ray_at(const RunGeometry& g, int column) {
    return {g.row_ray[0] + column * g.column_ray[0], g.row_ray[1] + column * g.column_ray[1],
            g.row_ray[2] + column * g.column_ray[2]};
}

std::array<double, 3> at_depth(const RunGeometry& g, int column, double depth) {
    const std::array<double, 3> ray = ray_at(g, column);
    std::array<double, 3> point{};
    for (std::size_t k = 0; k < 3; ++k) {
        point[k] = g.perspective ? g.origin[k] + depth * ray[k] : ray[k] + depth * g.forward[k];
    }
    return point;
}

double depth_of(const RunGeometry& g, double x, double y, double z) {
    return (x - g.origin[0]) * g.forward[0] + (y - g.origin[1]) * g.forward[1] + (z - g.origin[2]) * g.forward[2];
}

std::array<float, 3> to_world(const Step& s, float x, float y, float z) {
    const std::array<float, 12>& m = s.matrix;
    if (!s.transform) return {x, y, z};
    return {m[0] * x + m[1] * y + m[2] * z + m[3], m[4] * x + m[5] * y + m[6] * z + m[7],
            m[8] * x + m[9] * y + m[10] * z + m[11]};
}

void point(const Run& r) {
    const Step& s = r.step;
    const float *ax = r.in(0), *ay = r.in(1), *az = r.in(2), *reciprocal = r.in(4);
    float *ox = r.out(0), *oy = r.out(1), *oz = r.out(2);
    const std::int32_t* offset = r.offsets(3);
    const auto decode = [&](float x, float y, float z) {
        return to_world(s, x * s.multiply[0] + s.add[0], y * s.multiply[1] + s.add[1], z * s.multiply[2] + s.add[2]);
    };
    for (int i = 0; i < r.count; ++i) {
        const float w = reciprocal ? reciprocal[i] : 1.0f;
        const std::array<float, 3> p = decode(ax[i] * w, ay[i] * w, az[i] * w);
        ox[i] = p[0];
        oy[i] = p[1];
        oz[i] = p[2];
    }
    if (!offset) return;
    for (int i = 0; i < r.count; ++i) {
        if (offset[i] == 0) continue;
        const int j = i + stand_in_column(offset[i]), dy = stand_in_row(offset[i]);
        std::array<float, 3> p = decode(r.raw(0, j, dy), r.raw(1, j, dy), r.raw(2, j, dy));
        if (s.ray) {
            // The neighbour's depth, along this pixel's own ray.
            const std::array<double, 3> q = at_depth(r.geometry, r.x + i, depth_of(r.geometry, p[0], p[1], p[2]));
            for (std::size_t k = 0; k < 3; ++k) p[k] = static_cast<float>(q[k]);
        }
        ox[i] = p[0];
        oy[i] = p[1];
        oz[i] = p[2];
    }
}

/// How far the ray goes for one unit along the view axis.
double ray_length(const RunGeometry& g, int column, int dy) {
    if (!g.perspective) return 1.0;
    std::array<double, 3> ray = ray_at(g, column);
    for (std::size_t k = 0; k < 3; ++k) ray[k] += dy * g.next_row[k];
    return std::sqrt(ray[0] * ray[0] + ray[1] * ray[1] + ray[2] * ray[2]);
}

void depth(const Run& r) {
    const Step& s = r.step;
    const float *a = r.in(0), *reciprocal = r.in(2);
    const std::int32_t* offset = r.offsets(1);
    float* out = r.out(0);
    for (int i = 0; i < r.count; ++i) {
        int column = i, dy = 0;
        float stored = a[i] * (reciprocal ? reciprocal[i] : 1.0f);
        if (offset && offset[i] != 0) {
            column += stand_in_column(offset[i]);
            dy = stand_in_row(offset[i]);
            stored = r.raw(0, column, dy);
        }
        const float distance = stored * s.scale + s.offset;
        out[i] = s.ray ? static_cast<float>(distance / ray_length(r.geometry, r.x + column, dy) + s.near) : distance;
    }
}

void depth_of_point(const Run& r) {
    const float *ax = r.in(0), *ay = r.in(1), *az = r.in(2);
    float* out = r.out(0);
    for (int i = 0; i < r.count; ++i) out[i] = static_cast<float>(depth_of(r.geometry, ax[i], ay[i], az[i]));
}

void point_at_depth(const Run& r) {
    constexpr float kFar = 1e9f;
    const float* a = r.in(0);
    float *ox = r.out(0), *oy = r.out(1), *oz = r.out(2);
    for (int i = 0; i < r.count; ++i) {
        const std::array<double, 3> p = at_depth(r.geometry, r.x + i, a[i]);
        // Renderers write 1e10, 1e30 or infinity where nothing was hit.
        const bool background = a[i] >= kFar;
        ox[i] = background ? 0.0f : static_cast<float>(p[0]);
        oy[i] = background ? 0.0f : static_cast<float>(p[1]);
        oz[i] = background ? 0.0f : static_cast<float>(p[2]);
    }
}

void view(const Run& r) {
    float *ox = r.out(0), *oy = r.out(1), *oz = r.out(2);
    const RunGeometry& g = r.geometry;
    if (!g.perspective) {
        std::fill_n(ox, r.count, static_cast<float>(-g.forward[0]));
        std::fill_n(oy, r.count, static_cast<float>(-g.forward[1]));
        std::fill_n(oz, r.count, static_cast<float>(-g.forward[2]));
        return;
    }
    const float bx = static_cast<float>(g.row_ray[0]), by = static_cast<float>(g.row_ray[1]),
                bz = static_cast<float>(g.row_ray[2]);
    const float dx = static_cast<float>(g.column_ray[0]), dy = static_cast<float>(g.column_ray[1]),
                dz = static_cast<float>(g.column_ray[2]);
    for (int i = 0; i < r.count; ++i) {
        const float column = static_cast<float>(r.x + i);
        const float x = bx + column * dx, y = by + column * dy, z = bz + column * dz;
        const float factor = -1.0f / std::sqrt(x * x + y * y + z * z);
        ox[i] = x * factor;
        oy[i] = y * factor;
        oz[i] = z * factor;
    }
}

/// Judges pixels by what their single sample hit: a position other than the origin, or a depth before the background's.
class Samples {
public:
    explicit Samples(const Run& run) : run_(run), by_depth_(run.step.ray) {}

    bool present(float x, float y, float z) const {
        if (by_depth_) return x > 0.0f && x < run_.step.scale;
        return (x != 0.0f || y != 0.0f || z != 0.0f) && std::isfinite(x + y + z);
    }
    bool present(int i) const {
        return present(run_.in(0)[i], by_depth_ ? 0 : run_.in(1)[i], by_depth_ ? 0 : run_.in(2)[i]);
    }
    bool present(int column, int dy) const {
        const int absolute = run_.rows.first_column + column;
        if (absolute < 0 || absolute >= run_.rows.width) return false;
        if (by_depth_) return present(run_.raw(0, column, dy), 0, 0);
        return present(run_.raw(0, column, dy), run_.raw(1, column, dy), run_.raw(2, column, dy));
    }
    /// No number at all, where a surface or the background should be.
    bool broken(int i) const {
        if (by_depth_) return std::isnan(run_.in(0)[i]);
        return !std::isfinite(run_.in(0)[i] + run_.in(1)[i] + run_.in(2)[i]);
    }

    /// The pixel that stands in for `i`, nearest first. What stands in another chunk of the file comes last, since it
    /// must be decoded for the purpose; chunks are where they are whatever rows were loaded, and so is the answer.
    std::int32_t stand_in_for(int i) const {
        const RowPlanes& rows = run_.rows;
        for (int d = 1; d <= kRepairReach; ++d) {
            if (present(i - d, 0)) return stand_in(-d, 0);
            if (present(i + d, 0)) return stand_in(d, 0);
            if (d > 2) continue;
            if (const std::int32_t found = beside(i, d, rows.above_close, rows.below_close)) return found;
        }
        for (int d = 1; d <= 2; ++d) {
            if (const std::int32_t found =
                    beside(i, d, rows.above && !rows.above_close, rows.below && !rows.below_close)) {
                return found;
            }
        }
        return 0;
    }

private:
    /// In the rows above and below, `d` − 1 columns away.
    std::int32_t beside(int i, int d, bool above, bool below) const {
        for (const int dy : {-1, 1}) {
            if (dy < 0 ? !above : !below) continue;
            if (present(i - d + 1, dy)) return stand_in(1 - d, dy);
            if (d > 1 && present(i + d - 1, dy)) return stand_in(d - 1, dy);
        }
        return 0;
    }

    const Run& run_;
    bool by_depth_;
};

void repair(const Run& r) {
    auto* out = reinterpret_cast<std::int32_t*>(r.out(0));
    const bool share = r.step.in[4] < 0;
    const Samples samples(r);
    for (int i = 0; i < r.count; ++i) {
        out[i] = 0;
        if (samples.present(i)) continue;
        const float c = r.in(3)[i];
        const bool covered = share ? c > 0.0f : c != 0.0f || r.in(4)[i] != 0.0f || r.in(5)[i] != 0.0f;
        // A number that is none on a surface seen in full is a fault of the file, to be counted, not an edge.
        if (!covered || (samples.broken(i) && !(share && c < 1.0f))) continue;
        out[i] = samples.stand_in_for(i);
    }
}

void metal_base(const Run& r) {
    const float *diffuse = r.in(0), *metallic = r.in(1), *glossy = r.in(2), *reciprocal = r.in(3);
    float* out = r.out(0);
    for (int i = 0; i < r.count; ++i) {
        out[i] = (diffuse[i] + metallic[i] * glossy[i]) * (reciprocal ? reciprocal[i] : 1.0f);
    }
}

void identifier(const Run& r) {
    auto* out = reinterpret_cast<std::uint32_t*>(r.out(0));
    const std::int32_t* offset = r.offsets(1);
    const bool stored = r.step.ray;
    if (stored) {
        std::memcpy(out, r.in(0), static_cast<std::size_t>(r.count) * sizeof(std::uint32_t));
    } else {
        const float* a = r.in(0);
        for (int i = 0; i < r.count; ++i) out[i] = to_identifier(a[i]);
    }
    if (!offset) return;
    for (int i = 0; i < r.count; ++i) {
        if (offset[i] == 0) continue;
        gather(r.plane(0, stand_in_row(offset[i])), 0, r.rows.first_column + i + stand_in_column(offset[i]), 1,
               out + i);
    }
}

void matte(const Run& r) {
    float* out = r.out(0);
    std::fill_n(out, r.count, 0.0f);
    for (const MatteLayer& layer : r.step.layers) {
        for (int i = 0; i < r.count; ++i) {
            float sum = 0;
            for (const auto& [id, share] : layer.ranks) {
                const float part = r.registers[share][i];
                if (part == 0.0f) break;  // ranks are sorted: nothing covers less
                const auto bits = std::bit_cast<std::uint32_t>(r.registers[id][i]);
                if (std::binary_search(layer.ids.begin(), layer.ids.end(), bits)) sum += part;
            }
            out[i] = std::max(out[i], sum);
        }
    }
}

}  // namespace

void run(const Step& step, const float* const* registers, float* const* results, int count, int x,
         const RunGeometry& geometry, const RowPlanes& rows) {
    const Run r{step, registers, results, count, x, geometry, rows};
    switch (step.op) {
        case Op::scale:
            scale(r);
            return;
        case Op::divide:
            divide(r);
            return;
        case Op::product:
            product(r);
            return;
        case Op::coverage:
            coverage(r);
            return;
        case Op::direction:
            if (step.transform) {
                direction<true>(r, r.in(3), r.in(4));
            } else {
                direction<false>(r, r.in(3), r.in(4));
            }
            return;
        case Op::turn:
            turn(r);
            return;
        case Op::point:
            point(r);
            return;
        case Op::depth:
            depth(r);
            return;
        case Op::depth_of_point:
            depth_of_point(r);
            return;
        case Op::point_at_depth:
            point_at_depth(r);
            return;
        case Op::view:
            view(r);
            return;
        case Op::repair:
            repair(r);
            return;
        case Op::metal_base:
            metal_base(r);
            return;
        case Op::identifier:
            identifier(r);
            return;
        case Op::matte:
            matte(r);
            return;
        case Op::ones:
            std::fill_n(r.out(0), count, 1.0f);
            return;
        case Op::variance:
            variance(r);
            return;
        case Op::face:
            face(r);
            return;
        case Op::widen:
            widen(r);
            return;
    }
}

}  // namespace relume::gbuffer
