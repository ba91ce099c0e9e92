// SPDX-License-Identifier: Apache-2.0
#include "relight_picture.h"

#include <map>
#include <vector>

#include "relume/relight.h"

namespace relume::ofx {

void relight_picture(const GBuffer& gbuffer, const Rig& rig, const std::string& picture, const Window& region,
                     std::span<const Plane> planes, const std::atomic<bool>& cancel, const std::function<void()>& ask) {
    RelightOptions options;
    if (ask) options.progress = [&](double) { ask(); };
    options.cancel = &cancel;
    options.region = region;
    std::map<std::string, std::vector<Plane>> out;
    std::vector<float> unseen;
    if (picture == "beauty") {
        out["beauty"].assign(planes.begin(), planes.end());
    } else {
        out[picture].assign(planes.begin(), planes.begin() + 3);
        if (planes.size() == 4) {
            // The beauty's colours have to go somewhere: into one plane, one after the other.
            unseen.resize(static_cast<std::size_t>(region.width) * static_cast<std::size_t>(region.height));
            const Plane plane{reinterpret_cast<std::byte*>(unseen.data()), PixelType::float32, 4,
                              std::ptrdiff_t{4} * region.width};
            out["beauty"] = {plane, plane, plane, planes[3]};
        }
    }
    relight(gbuffer, rig, out, options);
}

}  // namespace relume::ofx
