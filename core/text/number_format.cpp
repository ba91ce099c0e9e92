// SPDX-License-Identifier: Apache-2.0
#include "text/number_format.h"

#include <array>
#include <charconv>

namespace relume {

std::string format_numbers(std::string_view pattern, std::initializer_list<double> numbers) {
    constexpr int kPrecision = 6;  // printf's, where the pattern names none
    std::string out;
    const double* next = numbers.begin();
    for (std::size_t at = 0; at < pattern.size(); ++at) {
        if (pattern[at] != '%' || pattern.substr(at + 1, 1) == "%") {
            out += pattern[at];
            if (pattern[at] == '%') ++at;
            continue;
        }
        int precision = kPrecision;
        if (pattern.substr(++at, 1) == ".")
            at = static_cast<std::size_t>(
                std::from_chars(pattern.data() + at + 1, pattern.data() + pattern.size(), precision).ptr -
                pattern.data());
        // Now at the "g".
        std::array<char, 64> digits{};
        const double number = next != numbers.end() ? *next++ : 0;
        const auto end =
            std::to_chars(digits.data(), digits.data() + digits.size(), number, std::chars_format::general, precision);
        out.append(digits.data(), end.ptr);
    }
    return out;
}

}  // namespace relume
