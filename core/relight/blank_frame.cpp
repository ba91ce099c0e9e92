// SPDX-License-Identifier: Apache-2.0
#include "relight/blank_frame.h"

#include "relume/error.h"

namespace relume {

void refuse_blank(const GBuffer& gbuffer, std::int64_t surfaces, const std::map<std::string, std::int64_t>& nonfinite) {
    for (const auto& [name, count] : nonfinite) {
        if (count == 0 || count < surfaces) continue;
        const ChannelInfo* info = gbuffer.find(name);
        const std::string file = info != nullptr && !info->file.empty() ? info->file + ": " : "";
        throw Error(ErrorKind::format, file + name + " is NaN or infinite in all " + std::to_string(count) +
                                           " pixels that hold a surface: nothing is left to light; render the frame "
                                           "again");
    }
}

}  // namespace relume
