// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "io/exr.h"

namespace relume::gbuffer {

/// Where the pixels of one channel stand: a channel of a part of a file (an index into Impl::files).
struct Address {
    int file = 0;
    int part = 0;
    int channel = 0;
    bool operator==(const Address&) const = default;
};

struct Component {
    char letter = '\0';     ///< 'R', 'X', … or 0 when the layer is one channel without a suffix
    std::string full_name;  ///< as in the file
    Address address;
    PixelType type = PixelType::float32;
};

/// The channels of one part that share everything but the last word of their names.
struct Layer {
    std::string name;   ///< without view and component: "ViewLayer.Normal"; "" for channels such as plain "R"
    std::string hint;   ///< stands in for an empty name: the part's name, or the last word of the file's name where
                        ///< the channels are no plain colours
    std::string view;   ///< "left", …; "" in files without views
    std::string part;   ///< name of the part
    bool data = false;  ///< the header says that this is not a colour (colorInteropID "data")
    std::vector<Component> components;

    std::string_view label() const { return name.empty() ? std::string_view(hint) : std::string_view(name); }
    /// nullptr when the layer has no such component.
    const Component* find(char letter) const;
    /// The components that `letters` lists, or none when one of them is missing.
    std::vector<const Component*> pick(std::string_view letters) const;
};

/// The views of a stereo file, the default one first; empty in others.
std::vector<std::string> views(const io::Header& header);

/// All layers of a file in the order of their first channels; deep parts are left out.
std::vector<Layer> index_layers(const io::Header& header, int file, std::string_view file_stem);

}  // namespace relume::gbuffer
