// SPDX-License-Identifier: Apache-2.0
#include "relume/display.h"

#include <vector>

#include "io/pixel_convert.h"
#include "relume/error.h"

namespace relume {

namespace {

float encoded(DisplayEncoding encoding, float x) {
    switch (encoding) {
        case DisplayEncoding::srgb:
            return srgb_encode(x);
        case DisplayEncoding::gamma22:
            return gamma22_encode(x);
        case DisplayEncoding::linear:
            return x;
    }
    return x;
}

/// `x` is exposed, positive and no NaN.
float shown(const DisplayTransform& t, float x) {
    if (t.tone == ToneCurve::reinhard) x = reinhard(x);
    else if (t.tone == ToneCurve::aces) x = aces_film(x);
    // The curves meet 1 only up to rounding.
    return x >= 1 ? 1.0f : std::min(encoded(t.encoding, x), 1.0f);
}

float exposed(float x, float gain) {
    // NaN fails the comparison; infinity times a gain of 0 would be one.
    return x > 0 ? std::min(x, std::numeric_limits<float>::max()) * gain : 0.0f;
}

void check_planes(std::span<const Plane> planes, int width, int height) {
    if (planes.size() != 3 && planes.size() != 4)
        throw Error(ErrorKind::value, "a picture has 3 or 4 planes (R, G, B, A), not " + std::to_string(planes.size()));
    if (width < 0 || height < 0)
        throw Error(ErrorKind::value,
                    "a picture of " + std::to_string(width) + "x" + std::to_string(height) + " pixels");
    for (const Plane& plane : planes) {
        if (plane.data == nullptr) throw Error(ErrorKind::value, "a plane without pixels");
        if (plane.type == PixelType::uint32) throw Error(ErrorKind::value, "colours are half or float32, not integers");
    }
}

/// Row `y` of a plane to or from every third float of `colors`.
io::Run row_run(const Plane& plane, int y) { return {plane.data + y * plane.y_stride, plane.type, plane.x_stride}; }
io::Run color_run(std::vector<float>& colors, std::size_t component, std::ptrdiff_t stride) {
    return {reinterpret_cast<std::byte*>(colors.data() + component), PixelType::float32, stride};
}
void copy(const io::Run& from, const io::Run& to, std::size_t count) {
    io::convert_run({from.data, from.type, from.stride}, to, count);
}

}  // namespace

void change_colors(std::span<const Plane> planes, int width, int height, AlphaMode in, AlphaMode out,
                   const std::function<void(std::span<float>)>& change) {
    check_planes(planes, width, height);
    const auto count = static_cast<std::size_t>(width);
    constexpr std::ptrdiff_t kTriple = 3 * sizeof(float);
    std::vector<float> colors(3 * count), alpha(count, 1.0f);
    for (int y = 0; y < height; ++y) {
        for (std::size_t c = 0; c < 3; ++c) copy(row_run(planes[c], y), color_run(colors, c, kTriple), count);
        if (planes.size() == 4) copy(row_run(planes[3], y), color_run(alpha, 0, sizeof(float)), count);
        for (std::size_t i = 0; i < count; ++i) {
            if (!(alpha[i] > 0)) alpha[i] = 1;
            if (in == AlphaMode::premultiplied && alpha[i] != 1)
                for (std::size_t c = 0; c < 3; ++c) colors[3 * i + c] /= alpha[i];
        }
        change(colors);
        if (out == AlphaMode::premultiplied)
            for (std::size_t i = 0; i < 3 * count; ++i) colors[i] *= alpha[i / 3];
        for (std::size_t c = 0; c < 3; ++c) copy(color_run(colors, c, kTriple), row_run(planes[c], y), count);
    }
}

float DisplayTransform::operator()(float linear) const {
    return shown(*this, exposed(linear, static_cast<float>(std::exp2(exposure))));
}

void DisplayTransform::apply(std::span<const Plane> planes, int width, int height, AlphaMode in, AlphaMode out) const {
    const float gain = static_cast<float>(std::exp2(exposure));
    change_colors(planes, width, height, in, out, [&](std::span<float> colors) {
        for (float& x : colors) x = shown(*this, exposed(x, gain));
    });
}

}  // namespace relume
