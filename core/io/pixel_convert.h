// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "relume/image.h"

namespace relume::io {

/// One IEEE 754 binary16 value, exactly. NaNs keep their payload and become quiet.
float half_to_float(std::uint16_t half);

/// Rounds to nearest, ties to even. What is finite stays so: beyond the largest half it becomes that, ±65504.
/// Infinities and NaNs stay what they are.
std::uint16_t float_to_half(float value);

/// A run of `count` values at `data`, `stride` bytes apart (negative strides run backwards; nothing need be aligned).
struct Run {
    std::byte* data = nullptr;
    PixelType type = PixelType::float32;
    std::ptrdiff_t stride = 4;
};
struct ConstRun {
    const std::byte* data = nullptr;
    PixelType type = PixelType::float32;
    std::ptrdiff_t stride = 4;
};

/// Copies with conversion. To uint32: NaN and negative become 0, fractions are cut, overflow saturates.
void convert_run(ConstRun from, Run to, std::size_t count);

/// Whole contiguous runs, by the widest instructions of this machine (`scalar`: by the reference).
void halves_to_floats(const std::byte* halves, std::byte* floats, std::size_t count, bool scalar = false);
void floats_to_halves(const std::byte* floats, std::byte* halves, std::size_t count, bool scalar = false);

}  // namespace relume::io
