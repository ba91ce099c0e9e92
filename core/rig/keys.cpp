// SPDX-License-Identifier: Apache-2.0
// Values that change over the frames of a sequence.
#include <algorithm>
#include <cmath>

#include "relume/rig.h"

namespace relume {

std::array<double, 3> Keys::at(double frame) const {
    const auto after = std::upper_bound(frames.begin(), frames.end(), frame);
    if (after == frames.begin()) return values.front();
    const auto k = static_cast<std::size_t>(after - frames.begin());
    if (after == frames.end() || interpolation == Interpolation::hold) return values[k - 1];
    double t = (frame - frames[k - 1]) / (frames[k] - frames[k - 1]);
    if (interpolation == Interpolation::smooth) t = t * t * (3 - 2 * t);
    std::array<double, 3> out{};
    // Not a + t·(b − a): the difference of two huge values is infinite.
    for (std::size_t c = 0; c < 3; ++c) out[c] = (1 - t) * values[k - 1][c] + t * values[k][c];
    return out;
}

void ParameterValues::resolve(double frame) {
    for (auto& [name, value] : values_) {
        const auto* keys = std::get_if<Keys>(&value);
        if (keys == nullptr) continue;
        const std::array<double, 3> now = keys->at(frame);
        if (keys->components == 1) value = now[0];
        else value = now;
    }
}

Rig Rig::at(double number) const {
    Rig rig = *this;
    for (Light& light : rig.lights) light.values.resolve(number);
    for (ShaderUse& shader : rig.shaders) shader.values.resolve(number);
    rig.output.values.resolve(number);
    return rig;
}

}  // namespace relume
