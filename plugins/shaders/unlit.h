// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "relume/shading/register.h"
#include "relume/shading/standard_parameters.h"

namespace relume::shaders {

struct Unlit {
    static constexpr std::string_view name = "unlit";
    static constexpr std::string_view label = "Unlit";
    static constexpr std::string_view help =
        "Emission alone: skies, screens, lamps, matte paintings. No light reaches it, lights without a direction included.";

    template <class T> struct Params { Color<T> emission; };
    struct Options {};
    static constexpr Parameter parameters[] = {row::emission(RELUME_SLOT(emission))};
    static constexpr bool needs_tangent = false;
    static constexpr bool lit_from_below = false;

    template <class T> struct Prepared {
        Color<T> ambient;
        Color<T> emission;
    };

    template <class T>
    static RELUME_INLINE Prepared<T> prepare(const Params<T>& p, const Options&, const Geometry<T>&) {
        return {splat(T(0.f)), p.emission};
    }

    template <class T>
    static RELUME_INLINE Lobes<T> evaluate(const Prepared<T>&, const Options&, const Geometry<T>&,
                                           const LightSample<T>&) {
        const Color<T> none = splat(T(0.f));
        return {none, none, none};
    }
};

}  // namespace relume::shaders
