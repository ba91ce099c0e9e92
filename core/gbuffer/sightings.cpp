// SPDX-License-Identifier: Apache-2.0
#include "gbuffer/sightings.h"

#include <algorithm>
#include <cmath>

namespace relume::gbuffer {

namespace {

constexpr std::size_t kMostSightings = 6000;
/// Candidates looked at for each sighting that is kept: some of them lie on edges.
constexpr std::size_t kCandidates = 3;
constexpr double kFarAway = 1e9;  ///< depths of the background start here

struct RowPoints {
    const SampledRow& row;
    std::size_t first;
    const Semantic& position;

    std::size_t width() const { return row.planes[first].size(); }

    Vector3 at(std::size_t i) const {
        Vector3 p{};
        for (std::size_t k = 0; k < 3; ++k) {
            double v = row.planes[first + k][i];
            if (position.encoding == Encoding::zero_to_one) v = 2 * v - 1;
            p[k] = v * static_cast<double>(position.sign[k]);
        }
        return p;
    }

    bool valid(std::size_t i) const {
        const auto value = [&](std::size_t k) { return row.planes[first + k][i]; };
        return (value(0) != 0 || value(1) != 0 || value(2) != 0) && std::isfinite(value(0) + value(1) + value(2));
    }

    /// No edge: a mixture of two surfaces stands far from its neighbours, compared with their own steps.
    bool even(std::size_t i) const {
        // Narrow images have no neighbours to ask.
        if (width() < 16) return true;
        if (i < 2 || i + 2 >= width()) return false;
        if (!valid(i - 2) || !valid(i - 1) || !valid(i + 1) || !valid(i + 2)) return false;
        const auto step = [&](std::size_t j) { return length(minus(at(j), at(j + 1))); };
        return std::max(step(i - 1), step(i)) <= 4 * std::max(step(i - 2), step(i + 1));
    }
};

}  // namespace

std::vector<Sighting> sightings(const GBuffer::Impl& impl, std::span<const SampledRow> rows, int first, int depth) {
    const Semantic& position = *impl.find("position");
    const auto points_of = [&](const SampledRow& row) {
        return RowPoints{row, static_cast<std::size_t>(first), position};
    };
    std::size_t surface = 0;
    for (const SampledRow& row : rows) {
        const RowPoints points = points_of(row);
        for (std::size_t i = 0; i < points.width(); ++i) surface += points.valid(i);
    }
    const std::size_t stride = std::max<std::size_t>(1, surface / (kCandidates * kMostSightings));
    std::vector<Sighting> all;
    std::size_t turn = 0;
    for (const SampledRow& row : rows) {
        const RowPoints points = points_of(row);
        for (std::size_t i = 0; i < points.width(); ++i) {
            if (!points.valid(i) || ++turn % stride != 0 || !points.even(i)) continue;
            const double d = depth < 0 ? 0 : static_cast<double>(row.planes[static_cast<std::size_t>(depth)][i]);
            all.push_back({impl.data_window.x + static_cast<double>(i) + 0.5, row.y + 0.5, points.at(i),
                           d > 0 && d < kFarAway ? d : 0});
        }
    }
    if (all.size() <= kMostSightings) return all;
    std::vector<Sighting> some;
    some.reserve(kMostSightings);
    for (std::size_t k = 0; k < kMostSightings; ++k) some.push_back(all[k * all.size() / kMostSightings]);
    return some;
}

}  // namespace relume::gbuffer
