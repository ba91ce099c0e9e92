// SPDX-License-Identifier: Apache-2.0
#pragma once

// Directional albedo ∫f·NdotL dω by quadrature, without luck: Gauss–Legendre over the half vector.

#include <cmath>
#include <utility>
#include <vector>

#include "shader_model.h"

namespace relume::testing {

/// Nodes and weights on [0, 1] (Newton on Legendre's polynomial).
inline std::vector<std::pair<double, double>> gauss_legendre(int count) {
    std::vector<std::pair<double, double>> out;
    for (int i = 0; i < count; ++i) {
        double x = std::cos(kPi * (i + 0.75) / (count + 0.5)), slope = 0;
        for (int step = 0; step < 100; ++step) {
            double p0 = 1, p1 = x;
            for (int k = 2; k <= count; ++k) {
                const double p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
                p0 = p1;
                p1 = p2;
            }
            slope = count * (x * p1 - p0) / (x * x - 1);
            const double change = p1 / slope;
            x -= change;
            if (std::fabs(change) < 1e-15) break;
        }
        out.emplace_back((1 + x) / 2, 1 / ((1 - x * x) * slope * slope));
    }
    return out;
}

/// ∫₀^end g(x) dx for a g with detail down to `scale` at 0: x = scale·sinh(u). Returns nodes and weights.
inline std::vector<std::pair<double, double>> sinh_nodes(double end, double scale, int count) {
    static thread_local std::vector<std::vector<std::pair<double, double>>> cache(200);
    auto& unit_nodes = cache.at(static_cast<std::size_t>(count));
    if (unit_nodes.empty()) unit_nodes = gauss_legendre(count);
    const double last = std::asinh(end / scale);
    std::vector<std::pair<double, double>> out;
    for (const auto& [x, w] : unit_nodes)
        out.emplace_back(scale * std::sinh(last * x), w * last * scale * std::cosh(last * x));
    return out;
}

struct Sample {
    V3 l;
    double weight;  ///< dω
};

/// Directions to the light over the hemisphere around +z and their solid angles, for v = (sinθ, 0, cosθ), dense where h
/// is near n
/// (`width`: alpha of the narrowest lobe) and around grazing exitance. dω_l = 4·v·h·dω_h; l leaves the hemisphere at
/// 2θh = atan2(cosθv, −sinθv·cosφ), so every integrand is smooth inside. What is symmetric in y is assumed to be so.
inline std::vector<Sample> half_vector_samples(double theta_v, double width, int count = 48) {
    const V3 v = direction(theta_v, 0);
    std::vector<Sample> out;
    for (const double side : {-1., 1.}) {
        for (const auto& [x, phi_weight] : sinh_nodes(kPi / 2, std::max(v[2], 0.01), count)) {
            const double phi = kPi / 2 + side * x;
            const double last = std::atan2(v[2], -v[0] * std::cos(phi)) / 2;
            for (const auto& [theta, theta_weight] : sinh_nodes(last, width, count)) {
                const V3 h = direction(theta, phi);
                const double vh = dot(v, h);
                out.push_back({h * (2 * vh) - v, 2 * phi_weight * theta_weight * std::sin(theta) * 4 * vh});
            }
        }
    }
    return out;
}

/// Albedo at view angle theta_v (radians) per lobe; tangent along x.
inline Answer albedo(const Model& model, double theta_v, double width, int count = 48, const V3& tangent = {1, 0, 0}) {
    const auto samples = half_vector_samples(theta_v, width, count);
    std::vector<V3> l;
    for (const Sample& s : samples) l.push_back(s.l);
    const auto values = model.evaluate({{0, 0, 1}}, {direction(theta_v, 0)}, l, tangent);
    Answer out;
    for (std::size_t i = 0; i < values.size(); ++i) {
        out.diffuse = out.diffuse + values[i].diffuse * samples[i].weight;
        out.specular = out.specular + values[i].specular * samples[i].weight;
        out.transmission = out.transmission + values[i].transmission * samples[i].weight;
    }
    return out;
}

/// Highest total albedo over view angles 0…89°, any channel.
inline double highest_albedo(const Model& model, double width, int count = 48) {
    double highest = 0;
    for (const double degrees : {0., 15., 30., 45., 60., 70., 75., 80., 83., 86., 88., 89.}) {
        const V3 total = albedo(model, radians(degrees), width, count).total();
        highest = std::max({highest, total[0], total[1], total[2]});
    }
    return highest;
}

}  // namespace relume::testing
