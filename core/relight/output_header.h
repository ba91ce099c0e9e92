// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "io/exr.h"
#include "relight/plan.h"
#include "relume/gbuffer.h"
#include "relume/rig.h"

namespace relume {

/// The output file: which part and channel each component of each AOV goes to.
struct OutputLayout {
    io::Header header;
    struct Slot {
        int part = 0;
        std::vector<int> channels;  ///< by component, index into the part's channels
    };
    std::vector<Slot> slots;  ///< by AOV
    io::WriteOptions options;
};

/// A single-part source (and one in memory) gives a single part: R, G, B, A and a layer per AOV. A multi-part source
/// gives a part per AOV, so that a reader that expects parts finds them, and calls the beauty's as the source does:
/// Blender 5 names passes by their parts. The source's colour space stands on every part. Windows, pixel aspect and,
/// with metadata = "keep", the source's attributes carry over; Cryptomatte manifests do not, since their channels do
/// not either.
OutputLayout output_layout(const GBuffer& gbuffer, const Rig& rig, const Plan& plan);

/// A layer's name from an AOV's: "light:key.001" becomes "light_key_001", since dots and colons mean something to
/// readers.
std::string layer_name(std::string name);

}  // namespace relume
