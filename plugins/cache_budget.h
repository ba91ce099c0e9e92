// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdlib>
#include <cstring>

namespace relume {

/// Bytes of relit frames that a plugin keeps: RELUME_CACHE_MB of the environment, else 1024 MiB.
inline std::size_t cache_budget() {
    std::size_t megabytes = 1024;
    if (const char* text = std::getenv("RELUME_CACHE_MB")) std::from_chars(text, text + std::strlen(text), megabytes);
    return std::min(megabytes, std::size_t{1} << 30) << 20;
}

}  // namespace relume
