// SPDX-License-Identifier: Apache-2.0
#include "text/number_format.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <string>

namespace relume {
namespace {

TEST(NumberFormat, IsPrintfsInTheCLocale) {
    std::mt19937_64 bits(11);
    std::uniform_real_distribution<double> exponent(-30, 30), mantissa(-10, 10);
    for (int k = 0; k < 2000; ++k) {
        const double a = k % 7 == 0 ? static_cast<int>(mantissa(bits)) : mantissa(bits) * std::pow(10, exponent(bits));
        const double b = 1e3 * mantissa(bits);
        for (const char* pattern : {"%g", "%.2g and %g", "fov %.6g, %.3g %% of it", "100 %%", "", "%.17g|%.1g"}) {
            std::array<char, 200> wanted{};
            std::snprintf(wanted.data(), wanted.size(), pattern, a, b);
            EXPECT_EQ(format_numbers(pattern, {a, b}), wanted.data());
        }
    }
    const double infinity = std::numeric_limits<double>::infinity();
    EXPECT_EQ(format_numbers("%g %g", {infinity, -infinity}), "inf -inf");
}

}  // namespace
}  // namespace relume
