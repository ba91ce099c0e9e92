// SPDX-License-Identifier: Apache-2.0
#include <string_view>

#include "relight/compose_kernel.h"
#include "relume/isa.h"

extern "C" void relume_kernel_compose_scalar(relume::ComposeTile*);
#if defined(RELUME_HAVE_X86_KERNELS)
extern "C" void relume_kernel_compose_v2(relume::ComposeTile*);
extern "C" void relume_kernel_compose_v3(relume::ComposeTile*);
extern "C" void relume_kernel_compose_v4(relume::ComposeTile*);
#elif defined(RELUME_HAVE_NEON_KERNELS)
extern "C" void relume_kernel_compose_neon(relume::ComposeTile*);
#endif

namespace relume {

ComposeFunction compose_kernel() {
    const std::string_view isa = active_isa();
#if defined(RELUME_HAVE_X86_KERNELS)
    if (isa == "x86-64-v4") return relume_kernel_compose_v4;
    if (isa == "x86-64-v3") return relume_kernel_compose_v3;
    if (isa == "x86-64-v2") return relume_kernel_compose_v2;
#elif defined(RELUME_HAVE_NEON_KERNELS)
    if (isa == "neon") return relume_kernel_compose_neon;
#endif
    static_cast<void>(isa);
    return relume_kernel_compose_scalar;
}

}  // namespace relume
