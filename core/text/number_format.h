// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

namespace relume {

/// What printf makes of "%g", "%.3g" and "%%" in the "C" locale, whatever locale the program that we are loaded into
/// has chosen: these texts stand in files too, as metadata.
std::string format_numbers(std::string_view pattern, std::initializer_list<double> numbers);

}  // namespace relume
