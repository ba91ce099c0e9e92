// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "gbuffer/pinhole.h"

namespace relume::gbuffer {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kThinning = 8;          ///< one sighting of so many makes the first guess
constexpr std::size_t kWorthThinning = 1600;  ///< fewer sightings are taken all at once

double squared_error(const Pinhole& p, std::span<const Sighting> sightings, std::span<const std::uint8_t> kept) {
    double sum = 0;
    for (std::size_t i = 0; i < sightings.size(); ++i) {
        if (!kept[i]) continue;
        const Vector<2> r = residual(p, sightings[i]);
        sum += r[0] * r[0] + r[1] * r[1];
    }
    return sum;
}

/// The rotation by the vector `w` (Rodrigues 1840).
Matrix<3> rotation_by(const Vector3& w) {
    const double angle = length(w);
    if (angle < 1e-300) return {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    const Vector3 k = scaled(w, 1 / angle);
    const double c = std::cos(angle), s = std::sin(angle), d = 1 - c;
    return {{{c + k[0] * k[0] * d, k[0] * k[1] * d - k[2] * s, k[0] * k[2] * d + k[1] * s},
             {k[1] * k[0] * d + k[2] * s, c + k[1] * k[1] * d, k[1] * k[2] * d - k[0] * s},
             {k[2] * k[0] * d - k[1] * s, k[2] * k[1] * d + k[0] * s, c + k[2] * k[2] * d}}};
}

/// What of the lens may move: `free_lens` all four numbers, else the focal length alone with fy = fx·aspect.
Pinhole step(const Pinhole& p, const Vector<10>& d, bool free_lens, double aspect) {
    Pinhole q = p;
    q.rotation = times(rotation_by({d[0], d[1], d[2]}), p.rotation);
    q.translation = plus(times(rotation_by({d[0], d[1], d[2]}), p.translation), {d[3], d[4], d[5]});
    q.fx += d[6];
    if (free_lens) {
        q.fy += d[7];
        q.cx += d[8];
        q.cy += d[9];
    } else {
        q.fy = q.fx * aspect;
    }
    return q;
}

}  // namespace

Vector<2> residual(const Pinhole& p, const Sighting& s) {
    const Vector3 c = plus(times(p.rotation, s.point), p.translation);
    if (!(c[2] > 0)) return {kInfinity, kInfinity};
    return {p.fx * c[0] / c[2] + p.cx - s.u, p.fy * c[1] / c[2] + p.cy - s.v};
}

/// Levenberg 1944, Marquardt 1963 on the reprojection error.
void refine(Pinhole& p, std::span<const Sighting> sightings, std::span<const std::uint8_t> kept, bool free_lens,
            double aspect) {
    if (sightings.size() >= kWorthThinning) {
        // Most of the way goes by few of them; a step or two by all of them remain.
        std::vector<Sighting> few;
        for (std::size_t i = 0; i < sightings.size(); i += kThinning)
            if (kept[i]) few.push_back(sightings[i]);
        Pinhole guess = p;
        refine(guess, few, std::vector<std::uint8_t>(few.size(), 1), free_lens, aspect);
        if (squared_error(guess, sightings, kept) < squared_error(p, sightings, kept)) p = guess;
    }
    double error = squared_error(p, sightings, kept);
    double damping = 1e-6;
    for (int iteration = 0; iteration < 60; ++iteration) {
        Matrix<10> a{};
        Vector<10> b{};
        for (std::size_t i = 0; i < sightings.size(); ++i) {
            if (!kept[i]) continue;
            const Sighting& s = sightings[i];
            const Vector3 c = plus(times(p.rotation, s.point), p.translation);
            if (!(c[2] > 0)) continue;
            const double x = c[0] / c[2], y = c[1] / c[2], w = 1 / c[2];
            // Derivatives of (fx·x + cx, fy·y + cy) by rotation of the camera frame, translation and lens.
            Vector<10> ju{p.fx * -x * y, p.fx * (1 + x * x), p.fx * -y, p.fx * w, 0, p.fx * -x * w, x, 0, 1, 0};
            Vector<10> jv{p.fy * -(1 + y * y), p.fy * x * y, p.fy * x, 0, p.fy * w, p.fy * -y * w, 0, y, 0, 1};
            if (!free_lens) {
                jv[6] = y * aspect;
                ju[8] = jv[7] = jv[9] = 0;
            }
            const double ru = p.fx * x + p.cx - s.u, rv = p.fy * y + p.cy - s.v;
            for (std::size_t r = 0; r < 10; ++r) {
                b[r] -= ju[r] * ru + jv[r] * rv;
                for (std::size_t k = 0; k <= r; ++k) a[r][k] += ju[r] * ju[k] + jv[r] * jv[k];
            }
        }
        if (!free_lens) a[7][7] = a[8][8] = a[9][9] = 1;
        bool better = false;
        for (int attempt = 0; attempt < 8 && !better; ++attempt) {
            Matrix<10> damped = a;
            for (std::size_t r = 0; r < 10; ++r) damped[r][r] *= 1 + damping;
            Vector<10> d{};
            if (!solve(damped, b, d)) {
                damping = damping * 10 + 1e-12;
                continue;
            }
            const Pinhole q = step(p, d, free_lens, aspect);
            const double new_error = squared_error(q, sightings, kept);
            if (new_error < error) {
                better = true;
                const bool done = error - new_error < 1e-6 * error;
                p = q;
                error = new_error;
                damping = std::max(damping / 10, 1e-14);
                if (done) return;
            } else {
                damping *= 10;
            }
        }
        if (!better) return;
    }
}

}  // namespace relume::gbuffer
