// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "relume/gbuffer.h"
#include "relume/image.h"

// The CMake target relume::ocio (option RELUME_OCIO); librelume itself does without OpenColorIO.

namespace relume {

/// Which OpenColorIO transform. Names that are empty take the config's defaults.
struct OcioChoice {
    std::string
        config;  ///< a config's file (.ocio or .ocioz), "ocio://…" for a built-in one of OpenColorIO ≥ 2.2; "": $OCIO
    std::string display;  ///< "": the config's default
    std::string view;     ///< "": the display's default
    std::string space;    ///< what the colours are in: a colour space, role or alias; "": the role scene_linear
    std::string look;     ///< looks on top of the view's own; "": none
};

/// A display and its views, each list in the config's order, the default first.
struct OcioDisplay {
    std::string name;
    std::vector<std::string> views;
};

/// The displays of a config ("": $OCIO). Errors: file (no config, not readable, not valid).
std::vector<OcioDisplay> ocio_displays(const std::string& config = {});

/// A transform of an OpenColorIO config, ready to run on the CPU. Copies share it; all members are thread-safe.
class OcioTransform {
public:
    /// Scene-linear to what the display is sent. Errors: file (as above), parameter (no such display, view, space or
    /// look: with the nearest name), value (the config cannot make the transform: OpenColorIO's reason).
    static OcioTransform display(const OcioChoice& choice = {});

    /// From one colour space to another, each by name, role, alias, or a working space's name that the config knows by
    /// another ("lin_rec709" for "Linear Rec.709 (sRGB)"). Errors: as display().
    static OcioTransform conversion(const std::string& config, const std::string& from, const std::string& to);

    /// R, G, B interleaved, in place. NaN and infinities become what the config makes of 0 and of the largest half.
    void apply(std::span<float> colors) const;
    /// A picture in place; planes and alpha as change_colors() in relume/display.h has them.
    void apply(std::span<const Plane> planes, int width, int height, AlphaMode in = AlphaMode::premultiplied,
               AlphaMode out = AlphaMode::premultiplied) const;

    /// What was chosen where the choice left it open.
    const OcioChoice& choice() const { return choice_; }

private:
    struct Impl;
    OcioTransform(std::shared_ptr<const Impl> impl, OcioChoice choice);
    std::shared_ptr<const Impl> impl_;
    OcioChoice choice_;
};

}  // namespace relume
