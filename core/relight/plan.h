// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "lights/bake.h"
#include "relume/gbuffer.h"
#include "relume/lookup_table.h"
#include "relume/relight.h"
#include "relume/rig.h"
#include "relume/shader.h"
#include "relume/shader_abi.h"

namespace relume {

/// A shader with its parameters resolved: each float slot is a plane of the G-buffer or a constant.
struct ShaderBinding {
    const ShaderInfo* shader = nullptr;
    ShadeFunction kernel = nullptr;
    std::vector<int> slot_planes;  ///< index into the segment's planes, −1: the constant
    std::vector<float> constants;
    std::vector<std::int32_t> options;
    std::vector<std::shared_ptr<const LookupTable>> tables;
    std::vector<TableView> table_views;
};

/// Which pixels a binding gets; all given conditions must hold.
struct ShaderRule {
    struct IdMatch {
        int plane = -1;
        std::vector<std::uint32_t> values;  ///< sorted
    };
    int binding = 0;
    std::vector<IdMatch> ids;
    int matte_plane = -1;
    bool everything() const { return ids.empty() && matte_plane < 0; }
};

/// Lights that are shaded together. A light with an AOV of its own is a group of one.
struct LightGroup {
    std::vector<DirectLight> direct;
    std::vector<AmbientLight> ambient;
    std::vector<int> direct_masks;  ///< index into Plan::masks, −1: none
    std::vector<int> ambient_masks;
    int aov = -1;  ///< index into Plan::aovs
};

/// Light linking: mask = include · (1 − exclude), each a Cryptomatte matte; −1: 1 or 0.
struct MaskPlan {
    int include_plane = -1;
    int exclude_plane = -1;
    bool operator==(const MaskPlan&) const = default;
};

enum class OutputMode : std::uint8_t { replace, add };

/// Everything a relight decides once per frame: which planes to read, which kernels to run on which pixels with which
/// lights, and what to write.
struct Plan {
    Plan(const GBuffer& gbuffer, const Rig& rig);

    std::vector<ChannelRequest> requests;
    std::vector<std::string> plane_names;  ///< of each plane of a segment, for reports
    int plane_count = 0;

    // First plane of each, −1 where the G-buffer has none or nobody needs it.
    int normal = -1, position = -1, view = -1, tangent = -1, ambient_occlusion = -1;
    int coverage = -1, alpha = -1, beauty = -1;
    bool constant_view = false;
    std::array<float, 3> eye{};

    std::vector<ShaderBinding> bindings;
    std::vector<ShaderRule> rules;  ///< in order; the last matches everything
    std::vector<LightGroup> groups;
    std::vector<MaskPlan> masks;

    std::vector<AovInfo> aovs;  ///< beauty first
    std::array<int, 3> lobe_aovs{-1, -1, -1};
    OutputMode mode = OutputMode::replace;
    std::vector<std::string> warnings;
    std::vector<std::string> notes;  ///< what was decided where the rig left it open

private:
    int request(ChannelRequest wanted);
    int request_semantic(const GBuffer& gbuffer, const std::string& name, int components,
                         LobeWidth widen = LobeWidth::none);
    int request_matte(const std::vector<std::string>& patterns);
    int add_mask(const BakedLight& light);
    void add_lights(const GBuffer& gbuffer, const Rig& rig);
    void add_shader(const GBuffer& gbuffer, const ShaderUse& use);
    void add_unreal_models(const GBuffer& gbuffer, const ShaderUse& use, const ShaderRule& base);
    int bind(const GBuffer& gbuffer, const ShaderInfo& shader, const ShaderUse& use);
    void add_view(const GBuffer& gbuffer, bool local_lights);
    std::map<std::string, int> known_;  // request key → first plane
};

}  // namespace relume
