// SPDX-License-Identifier: Apache-2.0
#include "oiio/picture_spec.h"

#include <algorithm>
#include <array>

#include "relume/working_space.h"

namespace relume::oiio {

namespace {

/// EXR's names of what OpenImageIO names otherwise.
std::string host_name(const std::string& name) {
    constexpr std::array<std::array<std::string_view, 2>, 11> kNames{{{"capDate", "DateTime"},
                                                                      {"comments", "ImageDescription"},
                                                                      {"owner", "Copyright"},
                                                                      {"pixelAspectRatio", "PixelAspectRatio"},
                                                                      {"expTime", "ExposureTime"},
                                                                      {"aperture", "FNumber"},
                                                                      {"worldToCamera", "worldtocamera"},
                                                                      {"worldToNDC", "worldtoscreen"},
                                                                      {"isoSpeed", "ISO"},
                                                                      {"xDensity", "XResolution"},
                                                                      {"screenWindowWidth", "screenWindowWidth"}}};
    for (const auto& [exr, host] : kNames)
        if (name == exr) return std::string(host);
    return name;
}

template <class T> std::vector<T> converted(const std::vector<double>& numbers) {
    std::vector<T> out(numbers.size());
    std::transform(numbers.begin(), numbers.end(), out.begin(), [](double v) { return static_cast<T>(v); });
    return out;
}

void add_numbers(OIIO::ImageSpec& spec, const std::string& name, const std::string& type,
                 const std::vector<double>& numbers) {
    using OIIO::TypeDesc;
    struct Kind {
        std::string_view exr;
        TypeDesc host;
    };
    const std::array<Kind, 14> kinds{{{"int", TypeDesc::INT},
                                      {"float", TypeDesc::FLOAT},
                                      {"double", TypeDesc::DOUBLE},
                                      {"v2i", TypeDesc(TypeDesc::INT, TypeDesc::VEC2)},
                                      {"v2f", TypeDesc(TypeDesc::FLOAT, TypeDesc::VEC2)},
                                      {"v3i", TypeDesc(TypeDesc::INT, TypeDesc::VEC3, TypeDesc::VECTOR)},
                                      {"v3f", TypeDesc(TypeDesc::FLOAT, TypeDesc::VEC3, TypeDesc::VECTOR)},
                                      {"m33f", TypeDesc(TypeDesc::FLOAT, TypeDesc::MATRIX33)},
                                      {"m44f", TypeDesc(TypeDesc::FLOAT, TypeDesc::MATRIX44)},
                                      {"m33d", TypeDesc(TypeDesc::DOUBLE, TypeDesc::MATRIX33)},
                                      {"m44d", TypeDesc(TypeDesc::DOUBLE, TypeDesc::MATRIX44)},
                                      {"box2i", TypeDesc(TypeDesc::INT, TypeDesc::VEC2, 2)},
                                      {"box2f", TypeDesc(TypeDesc::FLOAT, TypeDesc::VEC2, 2)},
                                      {"chromaticities", TypeDesc(TypeDesc::FLOAT, 8)}}};
    const auto kind = std::find_if(kinds.begin(), kinds.end(), [&](const Kind& k) { return k.exr == type; });
    if (kind == kinds.end() || kind->host.numelements() * kind->host.aggregate != numbers.size()) return;
    switch (kind->host.basetype) {
        case TypeDesc::INT:
            spec.attribute(name, kind->host, converted<int>(numbers).data());
            break;
        case TypeDesc::FLOAT:
            spec.attribute(name, kind->host, converted<float>(numbers).data());
            break;
        default:
            spec.attribute(name, kind->host, numbers.data());
    }
}

void add_metadata(OIIO::ImageSpec& spec, const io::Attribute& attribute) {
    const std::string name = host_name(attribute.name);
    if (const auto* text = std::get_if<std::string>(&attribute.value)) spec.attribute(name, *text);
    else if (const auto* numbers = std::get_if<std::vector<double>>(&attribute.value))
        add_numbers(spec, name, attribute.type, *numbers);
    else if (const auto* texts = std::get_if<std::vector<std::string>>(&attribute.value)) {
        std::vector<OIIO::ustring> list(texts->begin(), texts->end());
        if (!list.empty())
            spec.attribute(name, OIIO::TypeDesc(OIIO::TypeDesc::STRING, static_cast<int>(list.size())), list.data());
    }
}

}  // namespace

OIIO::ImageSpec picture_spec(const RelitFrame& frame, int picture) {
    const Picture& wanted = frame.pictures()[static_cast<std::size_t>(picture)];
    const Window& data = frame.window();
    const io::Part& header = frame.header();
    const auto type = frame.type() == PixelType::half ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT;
    OIIO::ImageSpec spec(data.width, data.height, wanted.components, type);
    spec.x = data.x;
    spec.y = data.y;
    spec.full_x = header.display_window.x;
    spec.full_y = header.display_window.y;
    spec.full_width = header.display_window.width;
    spec.full_height = header.display_window.height;
    spec.tile_width = kTile;
    spec.tile_height = kTile;
    spec.tile_depth = 1;
    spec.channelnames = {"R", "G", "B"};
    if (wanted.components == 4) spec.channelnames.push_back("A");
    spec.alpha_channel = wanted.components == 4 ? 3 : -1;
    // As in the file that `relume relight` writes, all stands on the beauty, its colours' name on every picture.
    for (const io::Attribute& attribute : header.attributes)
        if (picture == 0 || attribute.name == "colorInteropID") add_metadata(spec, attribute);
    spec.attribute("oiio:subimagename", wanted.name);
    spec.attribute("oiio:subimages", static_cast<int>(frame.pictures().size()));
    // OpenImageIO calls linear Rec.709 so until its 3.1; other spaces have no name but their own.
    const bool rec709 = frame.working_space() == "lin_rec709";
    spec.attribute("oiio:ColorSpace", rec709 ? (OIIO_VERSION < 30100 ? "Linear" : "lin_rec709_scene")
                                             : std::string(frame.working_space()).c_str());
    if (header.pixel_aspect != 1.0f) spec.attribute("PixelAspectRatio", header.pixel_aspect);
    return spec;
}

}  // namespace relume::oiio
