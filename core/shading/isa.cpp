// SPDX-License-Identifier: Apache-2.0
#include "relume/isa.h"

#include <algorithm>
#include <cstdlib>
#include <mutex>
#include <string>

#include "relume/error.h"

namespace relume {

std::vector<std::string_view> available_isas() {
    std::vector<std::string_view> isas{"scalar"};
#if defined(RELUME_HAVE_X86_KERNELS)
    __builtin_cpu_init();
    const bool v2 = __builtin_cpu_supports("sse4.2") && __builtin_cpu_supports("popcnt");
    const bool v3 =
        v2 && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2");
    const bool v4 = v3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                    __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
                    __builtin_cpu_supports("avx512vl");
    if (v2) isas.emplace_back("x86-64-v2");
    if (v3) isas.emplace_back("x86-64-v3");
    if (v4) isas.emplace_back("x86-64-v4");
#elif defined(RELUME_HAVE_NEON_KERNELS)
    isas.emplace_back("neon");
#endif
    return isas;
}

namespace {

std::string_view require_isa(std::string_view name, const char* who) {
    const auto isas = available_isas();
    const auto found = std::find(isas.begin(), isas.end(), name);
    if (found != isas.end()) return *found;
    std::string list;
    for (const auto isa : isas) list += (list.empty() ? "" : ", ") + std::string(isa);
    throw Error(ErrorKind::value,
                std::string(who) + " names '" + std::string(name) +
                    "', an instruction set that this build or this CPU does not have; choose one of: " + list);
}

std::string_view& selected_isa() {
    static std::string_view selected = [] {
        const char* wanted = std::getenv("RELUME_ISA");
        return wanted != nullptr && *wanted != '\0' ? require_isa(wanted, "RELUME_ISA") : available_isas().back();
    }();
    return selected;
}

}  // namespace

std::string_view active_isa() { return selected_isa(); }

void use_isa(std::string_view isa) {
    const std::string_view known = require_isa(isa, "use_isa");
    selected_isa() = known;
}

}  // namespace relume
