// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gbuffer/channel_rules.h"
#include "gbuffer/gbuffer_impl.h"

namespace relume::gbuffer {

/// A layer that may be a semantic channel, by which row of the rule table.
struct Candidate {
    const Layer* layer = nullptr;
    std::vector<const Component*> components;
    const ChannelRow* row = nullptr;
    std::string group;  ///< what stands before the name that matched
    int rank = 0;       ///< smaller is better
};

/// Every layer of the file that a row of the table takes for `semantic`, best first.
std::vector<Candidate> candidates(const SourceFile& file, std::string_view semantic);

/// Which group (Blender's view layer) and view of the file is taken.
struct Choice {
    std::string group;
    std::string view;
    std::vector<std::string> notes;
};

/// Chooses by the normal channels that the file holds. Throws Error(channel) when `part` or `view` names none.
Choice choose_group(const SourceFile& file, const std::vector<Candidate>& normals, const GBufferOptions& options);

/// The best candidate for `semantic` within the choice.
std::optional<Candidate> choose(const SourceFile& file, std::string_view semantic, const Choice& choice);

/// "beauty (R, G, B), depth (Z)": what the file holds, for messages.
std::string contents(const SourceFile& file);

/// Full names of the components, as a list for messages.
std::vector<std::string> full_names(const std::vector<const Component*>& components);

}  // namespace relume::gbuffer
