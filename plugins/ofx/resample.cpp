// SPDX-License-Identifier: Apache-2.0
#include "resample.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace relume::ofx {

namespace {

/// The file's pixels under one of the node's, along one axis.
struct Cover {
    int first = 0;
    std::vector<double> shares;  ///< of the node's pixel; they sum to less than 1 at the window's edge
};

/// Of pixel [at, at + 1) over [begin, end) of the file.
Cover cover(double at, double step, double offset, int begin, int end) {
    const double low = (at - offset) / step, high = (at + 1 - offset) / step;
    Cover result;
    result.first = static_cast<int>(std::clamp<double>(std::floor(low), begin, end));
    const int last = static_cast<int>(std::clamp<double>(std::ceil(high), result.first, end));
    for (int k = result.first; k < last; ++k)
        result.shares.push_back(std::max(0.0, std::min(high, k + 1.0) - std::max(low, double{1} * k)) / (high - low));
    return result;
}

}  // namespace

bool Placement::is_identity() const {
    return step_x == 1 && step_y == 1 && offset_x == std::floor(offset_x) && offset_y == std::floor(offset_y);
}

Placement placement(const FileFrame& frame, double scale_x, double scale_y, double aspect, double origin_x,
                    double origin_y) {
    Placement p;
    p.step_x = frame.aspect == aspect ? scale_x : scale_x * frame.aspect / aspect;
    p.offset_x = origin_x * scale_x / aspect;
    p.step_y = scale_y;
    p.offset_y = origin_y * scale_y;
    return p;
}

std::vector<float> resample(const FileFrame& frame, const Placement& placement, const OfxRectI& rect) {
    const auto width = static_cast<std::size_t>(rect.x2 - rect.x1),
               height = static_cast<std::size_t>(rect.y2 - rect.y1);
    std::vector<float> out(4 * width * height);
    const Window& data = frame.data_window;
    // The file's columns and rows as the node counts them: from the display window's lower left, y up.
    const int left = data.x - frame.display_window.x, bottom = frame.display_window.y_end() - data.y_end();
    const auto row_of = [&](int y) {
        return frame.rgba.get() + std::size_t{4} * static_cast<std::size_t>(data.width) *
                                      static_cast<std::size_t>(bottom + data.height - 1 - y);
    };
    if (placement.is_identity()) {
        const int dx = static_cast<int>(placement.offset_x), dy = static_cast<int>(placement.offset_y);
        const OfxRectI part =
            intersection(rect, {left + dx, bottom + dy, left + dx + data.width, bottom + dy + data.height});
        if (is_empty(part)) return out;
        for (int y = part.y1; y < part.y2; ++y)
            std::memcpy(out.data() + 4 * (static_cast<std::size_t>(rect.y2 - 1 - y) * width +
                                          static_cast<std::size_t>(part.x1 - rect.x1)),
                        row_of(y - dy) + 4 * (part.x1 - dx - left),
                        static_cast<std::size_t>(part.x2 - part.x1) * 4 * sizeof(float));
        return out;
    }
    std::vector<Cover> columns;
    for (int x = rect.x1; x < rect.x2; ++x)
        columns.push_back(cover(x, placement.step_x, placement.offset_x, left, left + data.width));
    for (std::size_t j = 0; j < height; ++j) {
        const Cover rows = cover(rect.y2 - 1 - static_cast<int>(j), placement.step_y, placement.offset_y, bottom,
                                 bottom + data.height);
        for (std::size_t i = 0; i < width; ++i) {
            std::array<double, 4> sum{};
            for (std::size_t r = 0; r < rows.shares.size(); ++r) {
                const float* row = row_of(rows.first + static_cast<int>(r)) + 4 * (columns[i].first - left);
                for (std::size_t c = 0; c < columns[i].shares.size(); ++c)
                    for (std::size_t k = 0; k < 4; ++k)
                        sum[k] += rows.shares[r] * columns[i].shares[c] * static_cast<double>(row[4 * c + k]);
            }
            for (std::size_t k = 0; k < 4; ++k) out[4 * (j * width + i) + k] = static_cast<float>(sum[k]);
        }
    }
    return out;
}

}  // namespace relume::ofx
