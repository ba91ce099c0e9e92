// SPDX-License-Identifier: Apache-2.0
#include "relight/output_header.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "gbuffer/attributes.h"
#include "gbuffer/gbuffer_impl.h"
#include "relume/version.h"
#include "relume/working_space.h"

namespace relume {

namespace {

/// Which colours a part holds, or "data": the one attribute that Blender 5 and OpenImageIO want on every part.
constexpr std::string_view kColorID = "colorInteropID";

/// Attributes that describe the source's own channels, views or file, and would be wrong in the output.
bool describes_source(std::string_view name) {
    constexpr std::array<std::string_view, 10> kExact{"multiView",           "view",  "name",    "type",
                                                      "chunkCount",          "tiles", "preview", "envmap",
                                                      "dwaCompressionLevel", kColorID};
    return name.starts_with("cryptomatte/") || name.starts_with("exr/cryptomatte/") || name.starts_with("relume/") ||
           std::find(kExact.begin(), kExact.end(), name) != kExact.end();
}

std::string reasons(const GBuffer& gbuffer) {
    std::string out;
    for (const ChannelInfo& info : gbuffer.channels()) {
        out += info.name + ':';
        for (const auto& source : info.sources) out += ' ' + source;
        out += " (" + info.interpretation + "; " + info.reason + ")\n";
    }
    for (const auto& note : gbuffer.notes()) out += note + '\n';
    return out;
}

/// Where the beauty was read from; nothing in memory and where there is none.
std::optional<gbuffer::Address> beauty_address(const GBuffer::Impl& source) {
    const gbuffer::Semantic* beauty = source.find("beauty");
    if (source.in_memory() || !beauty || beauty->raws.empty()) return std::nullopt;
    return source.raws[static_cast<std::size_t>(beauty->raws.front())].address;
}

/// What the source says of its colours: where its beauty is, else in the first part that holds no data.
std::optional<io::Attribute> color_id(const GBuffer::Impl& source) {
    std::vector<const io::Part*> parts;
    if (const auto beauty = beauty_address(source))
        parts.push_back(
            &source.files[static_cast<std::size_t>(beauty->file)].header.parts[static_cast<std::size_t>(beauty->part)]);
    for (const gbuffer::SourceFile& file : source.files)
        for (const io::Part& part : file.header.parts) parts.push_back(&part);
    for (const io::Part* part : parts)
        if (const std::string* id = gbuffer::text_attribute(*part, kColorID); id && *id != "data")
            return io::Attribute{std::string(kColorID), "string", *id};
    return std::nullopt;
}

/// The working space where the source says none or another one: colours of the rig's are what the output holds.
const WorkingSpace* restated_space(const GBuffer& gbuffer) {
    const WorkingSpace* space = find_working_space(gbuffer.working_space());
    if (!space) return nullptr;
    const GBuffer::Impl& source = gbuffer.impl();
    std::string stated = "lin_rec709";  // what an EXR without a word is taken for
    if (!source.files.empty()) {
        const auto beauty = beauty_address(source);
        const io::Header& header = source.files[static_cast<std::size_t>(beauty ? beauty->file : 0)].header;
        if (const auto said = gbuffer::stated_working_space(header, beauty ? beauty->part : 0)) stated = said->first;
    }
    return stated == space->name ? nullptr : space;
}

/// Puts an attribute in the place of one of its name.
void set_attribute(std::vector<io::Attribute>& attributes, io::Attribute attribute) {
    std::erase_if(attributes, [&](const io::Attribute& a) { return a.name == attribute.name; });
    attributes.push_back(std::move(attribute));
}

/// What the beauty's part is called among several: as the source's own layer, without the view layer ("Combined" for
/// "ViewLayer.Combined"), for Blender 5 names the pass by it; "rgba" where the source's channels are plain R, G, B.
std::string beauty_part_name(const GBuffer::Impl& source, const Plan& plan) {
    std::string name;
    if (const auto beauty = beauty_address(source))
        for (const gbuffer::Layer& layer : source.files[static_cast<std::size_t>(beauty->file)].layers)
            for (const gbuffer::Component& component : layer.components)
                if (component.address == *beauty) name = layer.name.substr(layer.name.rfind('.') + 1);  // npos + 1 is 0
    const bool taken = std::any_of(plan.aovs.begin() + 1, plan.aovs.end(),
                                   [&](const auto& aov) { return layer_name(aov.name) == name; });
    return name.empty() || taken ? "rgba" : name;
}

std::vector<io::Attribute> metadata(const GBuffer& gbuffer, const Rig& rig) {
    std::vector<io::Attribute> out;
    const auto table = output_parameters();
    if (rig.output.values.choice(table, "metadata") != 0) return out;
    if (!gbuffer.impl().files.empty()) {
        const auto& parts = gbuffer.impl().files.front().header.parts;
        if (!parts.empty())
            for (const io::Attribute& a : parts.front().attributes)
                if (!describes_source(a.name)) out.push_back(a);
    }
    if (const WorkingSpace* space = restated_space(gbuffer)) {
        const auto& xy = space->chromaticities;
        set_attribute(out, {"chromaticities", "chromaticities", std::vector<double>(xy.begin(), xy.end())});
        set_attribute(out, {std::string(kColorID), "string", std::string(space->name) + "_scene"});
    } else if (const auto id = color_id(gbuffer.impl())) {
        out.push_back(*id);
    }
    out.push_back({"relume/version", "string", std::string(version())});
    out.push_back({"relume/rig", "string", rig.to_toml()});
    out.push_back({"relume/channels", "string", reasons(gbuffer)});
    return out;
}

/// The name that a choice has in the table.
std::string_view choice_name(const Rig& rig, std::string_view parameter) {
    const auto table = output_parameters();
    const auto row = std::find_if(table.begin(), table.end(), [&](const Parameter& p) { return p.name == parameter; });
    std::string_view names = row->choices;
    for (int k = rig.output.values.choice(table, parameter); k > 0; --k) names.remove_prefix(names.find('|') + 1);
    return names.substr(0, names.find('|'));
}

}  // namespace

std::string layer_name(std::string name) {
    for (char& c : name)
        if (c == '.' || c == ':' || c == ' ') c = '_';
    return name;
}

OutputLayout output_layout(const GBuffer& gbuffer, const Rig& rig, const Plan& plan) {
    OutputLayout out;
    // The table offers what EXR has, so the name is known.
    out.options.compression = io::compression_from_name(choice_name(rig, "compression")).value();
    out.options.zip_level = static_cast<int>(rig.output.values.number(output_parameters(), "compression_level"));
    const PixelType type = choice_name(rig, "type") == "float" ? PixelType::float32 : PixelType::half;

    const auto& files = gbuffer.impl().files;
    const bool multipart = !files.empty() && files.front().header.parts.size() > 1;

    io::Part blank;
    blank.data_window = gbuffer.data_window();
    blank.display_window = gbuffer.display_window();
    blank.pixel_aspect = gbuffer.pixel_aspect();
    out.header.parts.push_back(blank);
    out.header.parts.front().attributes = metadata(gbuffer, rig);
    if (multipart) out.header.parts.front().name = beauty_part_name(gbuffer.impl(), plan);

    std::vector<std::vector<std::string>> names(plan.aovs.size());
    for (std::size_t a = 0; a < plan.aovs.size(); ++a) {
        const std::string layer = a == 0 ? "" : layer_name(plan.aovs[a].name);
        for (int k = 0; k < plan.aovs[a].components; ++k)
            names[a].push_back((layer.empty() ? "" : layer + '.') + "RGBA"[k]);
        OutputLayout::Slot slot;
        if (multipart && a > 0) {
            io::Part part = blank;
            part.name = layer;
            if (const auto* id = gbuffer::find_attribute(out.header.parts.front(), kColorID))
                part.attributes.push_back(*id);
            out.header.parts.push_back(part);
            slot.part = static_cast<int>(out.header.parts.size()) - 1;
        }
        for (const std::string& name : names[a])
            out.header.parts[static_cast<std::size_t>(slot.part)].channels.push_back({.name = name, .type = type});
        out.slots.push_back(slot);
    }
    for (io::Part& part : out.header.parts)
        std::sort(part.channels.begin(), part.channels.end(),
                  [](const io::Channel& a, const io::Channel& b) { return a.name < b.name; });
    for (std::size_t a = 0; a < plan.aovs.size(); ++a) {
        const auto& channels = out.header.parts[static_cast<std::size_t>(out.slots[a].part)].channels;
        for (const std::string& name : names[a]) {
            const auto found =
                std::find_if(channels.begin(), channels.end(), [&](const io::Channel& c) { return c.name == name; });
            out.slots[a].channels.push_back(static_cast<int>(found - channels.begin()));
        }
    }
    return out;
}

}  // namespace relume
