// SPDX-License-Identifier: Apache-2.0
#include "relume/ocio_display.h"

#include <OpenColorIO/OpenColorIO.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "relume/display.h"
#include "relume/error.h"
#include "relume/rig.h"
#include "relume/working_space.h"

namespace relume {

namespace {

namespace ocio = OCIO_NAMESPACE;

constexpr float kLargestHalf = 65504.0f;

/// OpenColorIO's reasons may run over several lines.
std::string one_line(std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    while (!text.empty() && text.back() == ' ') text.pop_back();
    return text;
}

/// The file of the config: as given, else $OCIO.
std::string config_file(const std::string& given) {
    if (!given.empty()) return given;
    const char* variable = std::getenv("OCIO");
    if (variable == nullptr || *variable == '\0')
        throw Error(
            ErrorKind::file,
            "no OpenColorIO config: the environment variable OCIO is not set; set it to a config's file, or name one");
    return variable;
}

ocio::ConstConfigRcPtr open_config(const std::string& given) {
    const std::string file = config_file(given);
    const std::string whose = given.empty() ? " (named by the environment variable OCIO)" : "";
    // OpenColorIO says little of these, and yaml-cpp leaks on a folder.
    if (std::error_code error; !file.starts_with("ocio://")) {
        const auto status = std::filesystem::status(file, error);
        if (!std::filesystem::exists(status))
            throw Error(ErrorKind::file, file + whose + ": no such OpenColorIO config");
        if (std::filesystem::is_directory(status))
            throw Error(ErrorKind::file, file + whose + ": is a directory; an OpenColorIO config is a file");
    }
    try {
        return ocio::Config::CreateFromFile(file.c_str());
    } catch (const std::exception& error) {
        throw Error(ErrorKind::file, file + whose + ": not an OpenColorIO config: " + one_line(error.what()));
    }
}

[[noreturn]] void refuse(const std::string& what, const std::string& name, const std::vector<std::string>& names,
                         const std::string& where = "") {
    const std::vector<std::string_view> views(names.begin(), names.end());
    const std::string near = nearest_name(name, views);
    std::string list;
    for (const std::string& n : names) list += (list.empty() ? "" : ", ") + n;
    throw Error(ErrorKind::parameter, "the OpenColorIO config has no " + what + " '" + name + "'" + where +
                                          (!near.empty()  ? "; did you mean '" + near + "'?"
                                           : list.empty() ? ""
                                                          : "; there are " + list));
}

std::vector<std::string> displays_of(const ocio::Config& config) {
    std::vector<std::string> out;
    for (int k = 0; k < config.getNumDisplays(); ++k) out.emplace_back(config.getDisplay(k));
    return out;
}

std::vector<std::string> views_of(const ocio::Config& config, const std::string& display) {
    std::vector<std::string> out;
    for (int k = 0; k < config.getNumViews(display.c_str()); ++k) out.emplace_back(config.getView(display.c_str(), k));
    return out;
}

void default_first(std::vector<std::string>& names, const std::string& first) {
    std::stable_partition(names.begin(), names.end(), [&](const std::string& name) { return name == first; });
}

std::string one_of(const std::string& what, const std::string& wanted, const std::string& fallback,
                   const std::vector<std::string>& names, const std::string& where = "") {
    const std::string& name = wanted.empty() ? fallback : wanted;
    if (std::find(names.begin(), names.end(), name) == names.end()) refuse(what, name, names, where);
    return name;
}

/// The config's own name for a space: by name, role or alias, or by another name of the same working space.
std::string space_of(const ocio::Config& config, const std::string& wanted) {
    const auto known = [&](const std::string& name) { return config.getColorSpace(name.c_str()) != nullptr; };
    if (wanted.empty()) {
        if (known(ocio::ROLE_SCENE_LINEAR)) return ocio::ROLE_SCENE_LINEAR;
        throw Error(ErrorKind::parameter,
                    "the OpenColorIO config has no role scene_linear; name the space that the colours are in");
    }
    if (known(wanted)) return wanted;
    const WorkingSpace* same = find_working_space(wanted);
    std::vector<std::string> names;
    for (int k = 0; k < config.getNumColorSpaces(); ++k) {
        names.emplace_back(config.getColorSpaceNameByIndex(k));
        if (same != nullptr && find_working_space(names.back()) == same) return names.back();
    }
    refuse("colour space", wanted, names);
}

ocio::ConstCPUProcessorRcPtr processor(const ocio::Config& config, const ocio::ConstTransformRcPtr& transform) {
    try {
        return config.getProcessor(transform)->getDefaultCPUProcessor();
    } catch (const ocio::Exception& error) {
        throw Error(ErrorKind::value, "OpenColorIO cannot make the transform: " + one_line(error.what()));
    }
}

std::vector<std::string> looks_of(const ocio::Config& config) {
    std::vector<std::string> out;
    for (int k = 0; k < config.getNumLooks(); ++k) out.emplace_back(config.getLookNameByIndex(k));
    return out;
}

}  // namespace

struct OcioTransform::Impl {
    ocio::ConstCPUProcessorRcPtr cpu;
};

OcioTransform::OcioTransform(std::shared_ptr<const Impl> impl, OcioChoice choice)
    : impl_(std::move(impl)), choice_(std::move(choice)) {}

std::vector<OcioDisplay> ocio_displays(const std::string& given) {
    const auto config = open_config(given);
    std::vector<std::string> names = displays_of(*config);
    default_first(names, config->getDefaultDisplay());
    std::vector<OcioDisplay> out;
    for (const std::string& name : names) {
        out.push_back({name, views_of(*config, name)});
        default_first(out.back().views, config->getDefaultView(name.c_str()));
    }
    return out;
}

OcioTransform OcioTransform::display(const OcioChoice& wanted) {
    const auto config = open_config(wanted.config);
    OcioChoice choice = wanted;
    choice.config = config_file(wanted.config);
    choice.display = one_of("display", wanted.display, config->getDefaultDisplay(), displays_of(*config));
    choice.view = one_of("view", wanted.view, config->getDefaultView(choice.display.c_str()),
                         views_of(*config, choice.display), " for display '" + choice.display + "'");
    choice.space = space_of(*config, wanted.space);
    if (!wanted.look.empty()) one_of("look", wanted.look, {}, looks_of(*config));

    const auto group = ocio::GroupTransform::Create();
    if (!wanted.look.empty()) {
        const auto look = ocio::LookTransform::Create();
        look->setSrc(choice.space.c_str());
        look->setDst(choice.space.c_str());
        look->setLooks(wanted.look.c_str());
        group->appendTransform(look);
    }
    const auto view = ocio::DisplayViewTransform::Create();
    view->setSrc(choice.space.c_str());
    view->setDisplay(choice.display.c_str());
    view->setView(choice.view.c_str());
    group->appendTransform(view);
    return {std::make_shared<Impl>(Impl{processor(*config, group)}), std::move(choice)};
}

OcioTransform OcioTransform::conversion(const std::string& given, const std::string& from, const std::string& to) {
    const auto config = open_config(given);
    const auto transform = ocio::ColorSpaceTransform::Create();
    OcioChoice choice;
    choice.config = config_file(given);
    choice.space = space_of(*config, from);
    transform->setSrc(choice.space.c_str());
    transform->setDst(space_of(*config, to).c_str());
    return {std::make_shared<Impl>(Impl{processor(*config, transform)}), std::move(choice)};
}

void OcioTransform::apply(std::span<float> colors) const {
    if (colors.size() % 3 != 0)
        throw Error(ErrorKind::value,
                    "colours are three numbers each, not " + std::to_string(colors.size()) + " in all");
    if (colors.empty()) return;
    for (float& x : colors) x = std::isnan(x) ? 0 : std::clamp(x, -kLargestHalf, kLargestHalf);
    ocio::PackedImageDesc image(colors.data(), static_cast<long>(colors.size() / 3), 1, 3);
    impl_->cpu->apply(image);
}

void OcioTransform::apply(std::span<const Plane> planes, int width, int height, AlphaMode in, AlphaMode out) const {
    change_colors(planes, width, height, in, out, [&](std::span<float> colors) { apply(colors); });
}

}  // namespace relume
