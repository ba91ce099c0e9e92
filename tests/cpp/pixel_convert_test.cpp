// SPDX-License-Identifier: Apache-2.0
#include "io/pixel_convert.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>
#include <vector>

namespace relume::io {
namespace {

// binary16 by its definition, in double.
double half_value(std::uint16_t half) {
    const int exponent = (half >> 10) & 31;
    const int fraction = half & 1023;
    const double sign = half & 0x8000 ? -1.0 : 1.0;
    if (exponent == 31) {
        return fraction != 0 ? std::numeric_limits<double>::quiet_NaN()
                             : sign * std::numeric_limits<double>::infinity();
    }
    return sign * (exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(1024 + fraction, exponent - 25));
}

// The nearest finite half by search, ties to the even one, in exact arithmetic: the sum of two neighbours is exact in
// double.
std::uint16_t nearest_half(float value) {
    const std::uint16_t sign = std::signbit(value) ? 0x8000 : 0;
    const double magnitude = std::abs(static_cast<double>(value));
    if (std::isinf(value)) {
        return static_cast<std::uint16_t>(sign | 0x7c00);
    }
    std::uint16_t low = 0;
    std::uint16_t high = 0x7bff;
    while (low < high) {  // the largest half that is not above the value
        const auto middle = static_cast<std::uint16_t>((low + high + 1) / 2);
        (half_value(middle) <= magnitude ? low : high) =
            half_value(middle) <= magnitude ? middle : static_cast<std::uint16_t>(middle - 1);
    }
    if (low == 0x7bff) {
        return static_cast<std::uint16_t>(sign | low);
    }
    const double middle = (half_value(low) + half_value(static_cast<std::uint16_t>(low + 1))) / 2;
    const bool up = magnitude > middle || (magnitude == middle && (low & 1) != 0);
    return static_cast<std::uint16_t>(sign | (low + (up ? 1 : 0)));
}

std::vector<float> interesting_floats() {
    std::vector<float> values;
    for (std::uint32_t exponent = 0; exponent < 256; ++exponent) {
        for (const std::uint32_t fraction : {0u, 1u, 0xfffu, 0x1000u, 0x1001u, 0x2fffu, 0x3000u, 0x3001u, 0x400000u,
                                             0x7fefffu, 0x7ff000u, 0x7ff001u, 0x7fffffu, 0x2aaaaau, 0x155000u}) {
            values.push_back(std::bit_cast<float>(exponent << 23 | fraction));
            values.push_back(std::bit_cast<float>(0x80000000u | exponent << 23 | fraction));
        }
    }
    for (std::uint32_t half = 0; half < 0x7c00u; ++half) {  // every tie between neighbours, and its neighbours
        const auto tie = static_cast<float>((half_value(static_cast<std::uint16_t>(half)) +
                                             half_value(static_cast<std::uint16_t>(std::min(half + 1, 0x7bffu)))) /
                                            2);
        values.insert(values.end(), {tie, std::nextafter(tie, 0.0f), -std::nextafter(tie, 1e9f)});
    }
    return values;
}

TEST(PixelConvert, EveryHalfToFloat) {
    std::vector<std::uint16_t> halves(65536);
    for (std::size_t i = 0; i < halves.size(); ++i) {
        halves[i] = static_cast<std::uint16_t>(i);
    }
    for (const bool scalar : {false, true}) {
        std::vector<float> floats(halves.size() + 1, -1.0f);
        halves_to_floats(std::as_bytes(std::span(halves)).data(), std::as_writable_bytes(std::span(floats)).data(),
                         halves.size(), scalar);
        for (std::size_t i = 0; i < halves.size(); ++i) {
            const double expected = half_value(halves[i]);
            if (std::isnan(expected)) {
                ASSERT_TRUE(std::isnan(floats[i])) << i;
            } else {
                ASSERT_EQ(std::bit_cast<std::uint32_t>(floats[i]),
                          std::bit_cast<std::uint32_t>(static_cast<float>(expected)))
                    << i;
            }
            ASSERT_EQ(std::bit_cast<std::uint32_t>(floats[i]), std::bit_cast<std::uint32_t>(half_to_float(halves[i])))
                << i;
        }
        EXPECT_EQ(floats.back(), -1.0f);
    }
}

TEST(PixelConvert, FloatToHalfRoundsToNearestEven) {
    const std::vector<float> floats = interesting_floats();
    for (const bool scalar : {false, true}) {
        std::vector<std::uint16_t> halves(floats.size());
        floats_to_halves(std::as_bytes(std::span(floats)).data(), std::as_writable_bytes(std::span(halves)).data(),
                         floats.size(), scalar);
        for (std::size_t i = 0; i < floats.size(); ++i) {
            if (std::isnan(floats[i])) {
                ASSERT_TRUE(std::isnan(half_value(halves[i]))) << i;
            } else {
                ASSERT_EQ(halves[i], nearest_half(floats[i])) << floats[i];
            }
        }
    }
}

TEST(PixelConvert, WhatIsFiniteStaysFiniteInHalf) {
    const float infinity = std::numeric_limits<float>::infinity(), largest = std::numeric_limits<float>::max();
    const std::vector<float> floats{65504,  65505,  65519.996f, 65520,    65536,     1e6f, largest, infinity,
                                    -65504, -65520, -1e30f,     -largest, -infinity, 1,    -0.0f,   3};
    const std::vector<double> expected{65504,  65504,  65504,  65504,  65504,     65504, 65504, HUGE_VAL,
                                       -65504, -65504, -65504, -65504, -HUGE_VAL, 1,     0,     3};
    for (const bool scalar : {false, true}) {
        std::vector<std::uint16_t> halves(floats.size());
        floats_to_halves(std::as_bytes(std::span(floats)).data(), std::as_writable_bytes(std::span(halves)).data(),
                         floats.size(), scalar);
        for (std::size_t i = 0; i < floats.size(); ++i) EXPECT_EQ(half_value(halves[i]), expected[i]) << floats[i];
    }
}

TEST(PixelConvert, FloatToUnsignedSaturates) {
    const std::vector<float> floats{-1.0f,
                                    -0.0f,
                                    0.0f,
                                    0.99f,
                                    1.0f,
                                    2.5f,
                                    4294967040.0f,
                                    4294967296.0f,
                                    1e30f,
                                    std::numeric_limits<float>::infinity(),
                                    -std::numeric_limits<float>::infinity(),
                                    std::numeric_limits<float>::quiet_NaN()};
    const std::vector<std::uint32_t> expected{0,           0,           0,           0,           1, 2,
                                              4294967040u, 0xffffffffu, 0xffffffffu, 0xffffffffu, 0, 0};
    std::vector<std::uint32_t> uints(floats.size());
    convert_run({std::as_bytes(std::span(floats)).data(), PixelType::float32, 4},
                {std::as_writable_bytes(std::span(uints)).data(), PixelType::uint32, 4}, floats.size());
    EXPECT_EQ(uints, expected);
}

// Arrays as large as their pixels, so that a sanitizer sees a load beyond them.
TEST(PixelConvert, InterleavedRunsStayWithinTheirArray) {
    for (const std::size_t components : {3u, 4u}) {
        for (std::size_t count = 1; count < 40; ++count) {
            std::vector<float> pixels(components * count);
            for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<float>(i);
            for (std::size_t c = 0; c < components; ++c) {
                std::vector<float> plane(count);
                convert_run({std::as_bytes(std::span(pixels)).data() + 4 * c, PixelType::float32,
                             static_cast<std::ptrdiff_t>(4 * components)},
                            {std::as_writable_bytes(std::span(plane)).data(), PixelType::float32, 4}, count);
                for (std::size_t i = 0; i < count; ++i) {
                    ASSERT_EQ(plane[i], static_cast<float>(i * components + c)) << components << " " << count;
                }
            }
        }
    }
}

TEST(PixelConvert, StridedRunsOfEveryPairOfTypes) {
    constexpr std::size_t kCount = 700;  // several blocks, and a rest
    constexpr PixelType kTypes[] = {PixelType::half, PixelType::float32, PixelType::uint32};
    const auto store = [](std::byte* at, PixelType type, float value) {
        const std::uint16_t half = float_to_half(value);
        const auto whole = static_cast<std::uint32_t>(value);
        std::memcpy(at,
                    type == PixelType::half      ? static_cast<const void*>(&half)
                    : type == PixelType::float32 ? static_cast<const void*>(&value)
                                                 : &whole,
                    size_of(type));
    };
    for (const PixelType from : kTypes) {
        for (const PixelType to : kTypes) {
            for (const std::ptrdiff_t from_stride : {static_cast<std::ptrdiff_t>(size_of(from)), std::ptrdiff_t{7},
                                                     std::ptrdiff_t{-12}, std::ptrdiff_t{12}, std::ptrdiff_t{16}}) {
                for (const std::ptrdiff_t to_stride :
                     {static_cast<std::ptrdiff_t>(size_of(to)), std::ptrdiff_t{13}, std::ptrdiff_t{-6}}) {
                    std::vector<std::byte> source(kCount * 16, std::byte{0xee});
                    std::vector<std::byte> target(kCount * 16, std::byte{0xee});
                    std::vector<std::byte> expected = target;
                    const auto start = [](std::ptrdiff_t stride) {
                        return stride > 0 ? std::ptrdiff_t{1} : static_cast<std::ptrdiff_t>(kCount) * 15;
                    };
                    for (std::size_t i = 0; i < kCount; ++i) {
                        const auto at = static_cast<std::ptrdiff_t>(i);
                        const auto value = static_cast<float>((i * 37) % 2000);
                        store(source.data() + start(from_stride) + at * from_stride, from, value);
                        store(expected.data() + start(to_stride) + at * to_stride, to, value);
                    }
                    convert_run({source.data() + start(from_stride), from, from_stride},
                                {target.data() + start(to_stride), to, to_stride}, kCount);
                    ASSERT_EQ(target, expected) << static_cast<int>(from) << "->" << static_cast<int>(to) << " "
                                                << from_stride << " " << to_stride;
                }
            }
        }
    }
}

}  // namespace
}  // namespace relume::io
