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

/// A file's columns and rows as the node counts them: from the display window's lower left, y up.
struct Frame {
    explicit Frame(const FileFrame& of)
        : left(of.data_window.x - of.display_window.x),
          bottom(of.display_window.y_end() - of.data_window.y_end()),
          width(of.data_window.width),
          height(of.data_window.height),
          rgba(of.rgba.get()) {}
    const float* row(int y) const {
        return rgba +
               std::size_t{4} * static_cast<std::size_t>(width) * static_cast<std::size_t>(bottom + height - 1 - y);
    }
    int left, bottom, width, height;
    const float* rgba;
};

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

void copy_rows(const FileFrame& frame, const Placement& placement, const OfxRectI& rect, std::byte* to,
               std::ptrdiff_t row_bytes) {
    constexpr std::size_t kPixel = 4 * sizeof(float);
    const Frame pixels(frame);
    const int dx = static_cast<int>(placement.offset_x), dy = static_cast<int>(placement.offset_y);
    const int x1 = std::clamp(pixels.left + dx, rect.x1, rect.x2);
    const int x2 = std::clamp(pixels.left + dx + pixels.width, x1, rect.x2);
    const auto bytes = [](int first, int end) { return kPixel * static_cast<std::size_t>(end - first); };
    for (int y = rect.y2 - 1; y >= rect.y1; --y, to -= row_bytes) {
        if (y - dy < pixels.bottom || y - dy >= pixels.bottom + pixels.height || x1 == x2) {
            std::memset(to, 0, bytes(rect.x1, rect.x2));
            continue;
        }
        std::memset(to, 0, bytes(rect.x1, x1));
        std::memcpy(to + bytes(rect.x1, x1), pixels.row(y - dy) + 4 * (x1 - dx - pixels.left), bytes(x1, x2));
        std::memset(to + bytes(rect.x1, x2), 0, bytes(x2, rect.x2));
    }
}

std::vector<float> resample(const FileFrame& frame, const Placement& placement, const OfxRectI& rect) {
    const auto width = static_cast<std::size_t>(rect.x2 - rect.x1),
               height = static_cast<std::size_t>(rect.y2 - rect.y1);
    std::vector<float> out(4 * width * height);
    if (is_empty(rect)) return out;
    if (placement.is_identity()) {
        const auto row_bytes = static_cast<std::ptrdiff_t>(16 * width);
        copy_rows(frame, placement, rect, reinterpret_cast<std::byte*>(out.data()), -row_bytes);
        return out;
    }
    const Frame pixels(frame);
    std::vector<Cover> columns;
    for (int x = rect.x1; x < rect.x2; ++x)
        columns.push_back(cover(x, placement.step_x, placement.offset_x, pixels.left, pixels.left + pixels.width));
    for (std::size_t j = 0; j < height; ++j) {
        const Cover rows = cover(rect.y2 - 1 - static_cast<int>(j), placement.step_y, placement.offset_y, pixels.bottom,
                                 pixels.bottom + pixels.height);
        for (std::size_t i = 0; i < width; ++i) {
            std::array<double, 4> sum{};
            for (std::size_t r = 0; r < rows.shares.size(); ++r) {
                const float* row = pixels.row(rows.first + static_cast<int>(r)) + 4 * (columns[i].first - pixels.left);
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
