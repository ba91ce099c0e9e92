// SPDX-License-Identifier: Apache-2.0
#include "gbuffer/normal_variance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "text/number_format.h"

namespace relume::gbuffer {

namespace {

/// How far storage may leave a unit normal from unit: float, 16-bit integers, half, 8-bit integers (√3/255).
constexpr std::array kDeadZones{1e-5f, 1e-4f, 1e-3f, 1e-2f};
/// Share of the whole pixels that may be longer than the dead zone allows, as the odd pixel of any file is.
constexpr double kOutliers = 1e-3;
/// Share of the short normals that must turn. Of Blender's antialiased frames it is 0.999, of interpolated ones 0.
constexpr double kTurning = 0.8;

std::string percent(double share) { return format_numbers("%.3g %%", {100 * share}); }

/// The dead zone that the planes' types ask for.
float stored_precision(const GBuffer::Impl& impl, const std::vector<int>& planes) {
    float zone = kDeadZones[0];
    const auto look = [&](int index) {
        const RawPlane& raw = impl.raws[static_cast<std::size_t>(index)];
        const int bits = raw.memory.data ? 0 : impl.files[static_cast<std::size_t>(raw.address.file)].integer_bits;
        if (bits == 16) zone = std::max(zone, kDeadZones[1]);
        if (raw.type == PixelType::half) zone = std::max(zone, kDeadZones[2]);
        if (bits == 8) zone = std::max(zone, kDeadZones[3]);
    };
    for (const int raw : planes) look(raw);
    return zone;
}

struct Direction {
    std::array<double, 3> unit{};
    double length = 0;  ///< 0 where there is no normal, or the pixel is not whole
};

class Lengths {
public:
    Lengths(const Semantic& normal, const LengthSample& sample) : normal_(normal), sample_(sample) {
        std::vector<Direction> above, row, below;
        bool surrounded = false;
        for (int pass = 0; pass < 2 && !surrounded; ++pass) {
            for (std::size_t r = 0; r < sample.rows.size(); ++r) {
                const bool follows = r > 0 && sample.rows[r - 1].y + 1 == sample.rows[r].y;
                const bool leads = r + 1 < sample.rows.size() && sample.rows[r].y + 1 == sample.rows[r + 1].y;
                // Without rows between two others, what turns from column to column must do.
                if (pass == 0 && !(follows && leads)) continue;
                surrounded = true;
                directions(sample.rows[r], row);
                above.clear();
                below.clear();
                if (follows) directions(sample.rows[r - 1], above);
                if (leads) directions(sample.rows[r + 1], below);
                count(row, above, below);
            }
        }
    }

    std::int64_t whole = 0;
    bool background = false;
    std::array<std::int64_t, kDeadZones.size()> longer{};  ///< than 1 by more than each dead zone

    struct Short {
        double by;    ///< 1 − length
        double turn;  ///< the squared chord to the neighbour that looks away furthest
    };
    std::vector<Short> shorter;

private:
    void directions(const SampledRow& row, std::vector<Direction>& out) {
        const std::size_t width = row.planes[sample_.normal].size();
        out.assign(width, {});
        for (std::size_t i = 0; i < width; ++i) {
            double coverage = 1;
            if (!sample_.coverage.empty()) {
                coverage = 0;
                for (const int plane : sample_.coverage) coverage += row.planes[static_cast<std::size_t>(plane)][i];
            }
            std::array<double, 3> n{};
            bool blank = true;
            for (std::size_t k = 0; k < 3; ++k) {
                const double v = row.planes[sample_.normal + k][i];
                blank = blank && v == 0;
                n[k] = normal_.encoding == Encoding::zero_to_one ? 2 * v - 1 : v;
            }
            const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
            if (!std::isfinite(length)) continue;
            // In 8 bits a zero vector comes back as nearly 0.
            blank = blank || length < (normal_.encoding == Encoding::zero_to_one ? 0.05 : 1e-6);
            background = background || blank;
            if (blank || !(coverage >= 0.999)) continue;
            out[i].length = length;
            for (std::size_t k = 0; k < 3; ++k) out[i].unit[k] = n[k] / length;
        }
    }

    void count(const std::vector<Direction>& row, const std::vector<Direction>& above,
               const std::vector<Direction>& below) {
        for (std::size_t i = 0; i < row.size(); ++i) {
            if (row[i].length == 0) continue;
            ++whole;
            for (std::size_t z = 0; z < kDeadZones.size(); ++z) {
                longer[z] += row[i].length > 1 + static_cast<double>(kDeadZones[z]);
            }
            const double by = 1 - row[i].length;
            if (by <= static_cast<double>(kDeadZones[0])) continue;
            double turn = 0;
            const auto look = [&](const Direction& other) {
                if (other.length == 0) return;
                double chord = 0;
                for (std::size_t k = 0; k < 3; ++k) {
                    const double d = other.unit[k] - row[i].unit[k];
                    chord += d * d;
                }
                turn = std::max(turn, chord);
            };
            if (i > 0) look(row[i - 1]);
            if (i + 1 < row.size()) look(row[i + 1]);
            if (!above.empty()) look(above[i]);
            if (!below.empty()) look(below[i]);
            shorter.push_back({by, turn});
        }
    }

    const Semantic& normal_;
    const LengthSample& sample_;
};

}  // namespace

void judge_normal_variance(GBuffer::Impl& impl, const GBufferOptions& options, const LengthSample& sample) {
    const Semantic* normal = impl.find("normal");
    const NormalVariance wanted = options.normal_variance.value_or(NormalVariance::automatic);
    if (!normal || wanted == NormalVariance::off) return;
    // A filter across edges shortens normals where no surface turns.
    if (impl.resampled && wanted != NormalVariance::on) return;
    const Lengths lengths(*normal, sample);
    Variance& variance = impl.normal_variance;
    variance.dead_zone = stored_precision(impl, normal->raws);
    // Engines pack normals into 8 or 10 bits, whatever floating-point file they are saved in later.
    if (normal->encoding == Encoding::zero_to_one && variance.dead_zone != kDeadZones[1])
        variance.dead_zone = kDeadZones[3];
    // Numbers that went through coarser storage before show it by normals that are too long, which no mean is.
    std::optional<float> zone;
    for (std::size_t z = 0; z < kDeadZones.size() && !zone; ++z) {
        if (kDeadZones[z] < variance.dead_zone) continue;
        if (static_cast<double>(lengths.longer[z]) <= kOutliers * static_cast<double>(lengths.whole))
            zone = kDeadZones[z];
    }
    if (zone) variance.dead_zone = *zone;
    variance.edge_dead_zone = std::max(variance.dead_zone, stored_precision(impl, impl.coverage.raws));
    if (wanted == NormalVariance::on) {
        variance.on = true;
        variance.reason = "asked for by normal_variance";
        return;
    }
    const std::string advice = ": highlights are not widened for it; normal_variance \"on\" does that";
    if (!zone) {
        impl.notes.push_back("normals are longer than 1, which no mean over a pixel is" + advice);
        return;
    }
    std::int64_t shorter = 0, turning = 0;
    for (const Lengths::Short& s : lengths.shorter) {
        const double by = s.by - static_cast<double>(*zone);
        shorter += by > 0;
        turning += by > 0 && by <= s.turn;
    }
    if (shorter == 0) return;
    const double share = static_cast<double>(turning) / static_cast<double>(shorter);
    const std::string count = percent(static_cast<double>(shorter) / static_cast<double>(lengths.whole)) + " of the " +
                              std::to_string(lengths.whole) + " sampled surface pixels";
    if (impl.coverage.raws.empty() && lengths.background) {
        impl.notes.push_back(
            "normals are shorter than 1 in " + count +
            ", and nothing tells which of these the background has a share of (no coverage, no alpha)" + advice);
        return;
    }
    if (share < kTurning) {
        impl.notes.push_back("normals are shorter than 1 in " + count + ", and only " + percent(share) +
                             " of these stand where they turn, as means over the pixel would" + advice);
        return;
    }
    variance.on = true;
    variance.reason = "normals are shorter than 1 in " + count + ", " + percent(share) +
                      " of them where the normal turns: they are means over the pixel";
}

}  // namespace relume::gbuffer
