// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "relume/shading/register.h"
#include "relume/shading/standard_parameters.h"
#include "shaders/blender_principled/generation3.h"
#include "shaders/blender_principled/generation5.h"

namespace relume::shaders {

namespace principled_row {
/// A color that is below 0 where it isn't given: what that means differs between the generations.
constexpr Parameter tint(std::string_view name, int slot, std::string_view label, std::string_view help) {
    Parameter out = row::color(name, slot, -1, -1, -1, label, help);
    out.min = -1;
    return out;
}
}  // namespace principled_row

struct BlenderPrincipled {
    static constexpr std::string_view name = "blender_principled";
    static constexpr std::string_view label = "Blender Principled";
    static constexpr std::string_view help =
        "Blender's Principled BSDF as Cycles evaluates it, so that a render and its relight agree. Generation 5 is that of Blender 4 and 5, "
        "generation 3 that of Blender 2.8 to 3.6; auto takes the one of the Blender that wrote the G-buffer.\n"
        "Generation 5 is a stack, from above: sheen, coat, emission, metal, specular, diffuse. Each layer lets through, seen from v alone, "
        "what it does not reflect. Lobes are D·G/(4·NdotV)·F, GGX of alpha = roughness² [Walter2007, eq. 33] under height-correlated masking "
        "[Heitz2014, eq. 99].\n"
        "specular: F = f0+(1−f0)·(Fd(l·h)−R0)/(1−R0), f0 = R0·specular_tint, R0 that of ior times 2·specular, Fd the exact law "
        "[CookTorrance1982]. metallic: F = clamp(F0+(1−F0)·m⁵−b·(l·h)·m⁶), m = 1−l·h, F0 = base_color, b what specular_tint takes at 82° "
        "[Hoffman2019]. coat: Fd of coat_ior on geometric_normal, always compensated for multiple scattering; what passes it is tinted by "
        "coat_tint. sheen: microfibers, a linearly transformed cosine [Zeltner2022], from measured coefficients. diffuse: Lambert, or with "
        "diffuse_roughness Oren–Nayar that loses nothing [Portsmouth2025]. distribution multi_ggx compensates metal and specular too "
        "[KullaConty2017].\n"
        "From Blender, each input comes from the AOV of its name here (albedo for base_color, specular_ior_level for specular). "
        "geometric_normal is the smooth normal before the bump, as the Geometry node's Normal in a color AOV: with it the coat lies on the "
        "smooth surface, the bumped normal under a coat is recovered from the Normal pass, which holds their mean, and the diffuse and sheen "
        "lobes get the bump terminator [Estevez2019]; of light from behind it a bump reflects nothing. Weights of coat and sheen count above 1 too.\n"
        "Generation 3: f·NdotL = diffuse + sheen (both in the diffuse lobe) + specular + clearcoat (both in the specular lobe). "
        "diffuse = base_color·(1−metallic)/π·NdotL·((1−FV/2)(1−FL/2) + R·(FL+FV+FL·FV·(R−1))), FL, FV = (1−NdotL)⁵, (1−NdotV)⁵, "
        "R = roughness·(1+l·v): Burley's [Burley2012, section 5.3], expanded. "
        "specular = D·G·F/(4·NdotV): separable Smith masking [Walter2007, eq. 34], "
        "F = c0 + (1−c0)·(Fd(l·h)−Fd(1))/(1−Fd(1)) with c0 = mix(0.08·specular·mix(1, tint, specular_tint), base_color, metallic), Fd of "
        "ior = 2/(1−√(0.08·specular))−1. "
        "sheen = sheen·mix(1, tint, sheen_tint)·(1−metallic)·(1−l·h)⁵·NdotL; clearcoat = clearcoat/4·D·G·Fd/(4·NdotV), D of GTR1 with alpha "
        "= clearcoat_roughness², G of alpha 0.25, ior 1.5. tint = base_color over its luminance (weights 0.3, 0.6, 0.1). No energy is "
        "taken from the diffuse part by the highlight: the sum may pass 1 at grazing view. Reciprocal.\n"
        "Both: anisotropic stretches alpha to alpha/aspect (at most 1) and alpha·aspect, aspect = √(1−0.9·anisotropic). "
        "Roughness below 0.0038 (alpha² ≤ 2e-10; in generation 3 0.018, 1e-7) is a mirror, as in Cycles: no highlight of sun, point and spot "
        "lights. Left out: subsurface, "
        "transmission, thin film, and how Cycles bends a normal whose mirrored view would dip below the facet; in generation 3 also "
        "Multiscatter GGX and the bump terminator.";

    template <class T> using Params = BlenderPrincipledParams<T>;
    using Options = BlenderPrincipledOptions;

    static constexpr Parameter parameters[] = {
        row::base_color(RELUME_SLOT(base_color)),
        row::metallic(RELUME_SLOT(metallic)),
        row::roughness(RELUME_SLOT(roughness)),
        row::scalar(
            "specular", RELUME_SLOT(specular), 0.5, 0, kUnbounded, "Specular",
            "Generation 5: IOR Level, 0.5 is the reflectance of ior, 1 twice that. Generation 3: reflectance at normal "
            "incidence in units of 8 %."),
        principled_row::tint(
            "specular_tint", RELUME_SLOT(specular_tint), "Specular tint",
            "Generation 5: color of the highlight at normal incidence, for metals at 82°; below 0, it is white. Generation 3: one "
            "number from 0 to 1, how much a dielectric's highlight has of the base color's hue; below 0, none."),
        row::anisotropy(RELUME_SLOT(anisotropic), "anisotropic", 0),
        row::scalar("anisotropic_rotation", RELUME_SLOT(anisotropic_rotation), 0, 0, 1, "Anisotropic rotation",
                    "Turns the tangent about the normal; 1 is a full turn."),
        principled_row::tint(
            "sheen_tint", RELUME_SLOT(sheen_tint), "Sheen tint",
            "Generation 5: color of the sheen; below 0, it is white. Generation 3: one number from 0 to 1, how much it has of "
            "the base color's hue; below 0, half."),
        row::emission(RELUME_SLOT(emission)),
        row::scalar("ior", RELUME_SLOT(ior), 1.5, 1, kUnbounded, "IOR",
                    "Generation 5: index of refraction of the dielectric.", 1, 2.5),
        row::scalar("diffuse_roughness", RELUME_SLOT(diffuse_roughness), 0, 0, 1, "Diffuse roughness",
                    "Generation 5: 0 is Lambert, more is Oren–Nayar: flatter, as of clay."),
        row::scalar("coat_weight", RELUME_SLOT(coat_weight), 0, 0, 1, "Coat weight",
                    "Generation 5: how much of a clear coat lies on top."),
        row::wide(row::scalar("coat_roughness", RELUME_SLOT(coat_roughness), 0.03, 0, 1, "Coat roughness",
                              "Generation 5: perceptual roughness of the coat."),
                  LobeWidth::roughness),
        row::scalar("coat_ior", RELUME_SLOT(coat_ior), 1.5, 1, kUnbounded, "Coat IOR",
                    "Generation 5: index of refraction of the coat.", 1, 2.5),
        row::color("coat_tint", RELUME_SLOT(coat_tint), 1, 1, 1, "Coat tint",
                   "Generation 5: what of the light passes the coat, straight down and back."),
        row::scalar("sheen_weight", RELUME_SLOT(sheen_weight), 0, 0, 1, "Sheen weight",
                    "Generation 5: how much of a layer of fibers lies on top, as of velvet or dust."),
        row::scalar("sheen_roughness", RELUME_SLOT(sheen_roughness), 0.5, 0, 1, "Sheen roughness",
                    "Generation 5: low shows at grazing angles alone, high covers all as dust does."),
        Parameter{.name = "geometric_normal",
                  .type = ParameterType::vector,
                  .label = "Geometric normal",
                  .help = "Generation 5: the smooth normal before the bump, world space; 0 where there is no bump.",
                  .slot = RELUME_SLOT(geometric_normal)},
        row::sheen(RELUME_SLOT(sheen)),
        row::clearcoat(RELUME_SLOT(clearcoat)),
        row::wide(row::scalar("clearcoat_roughness", RELUME_SLOT(clearcoat_roughness), 0.03, 0, 1,
                              "Clearcoat roughness", "Perceptual roughness of the clearcoat."),
                  LobeWidth::roughness),
        row::choice(
            "generation", RELUME_OPTION(generation), Options::newest, "auto|3|5", "Generation",
            "Which Principled BSDF: 3 is that of Blender 2.8 to 3.6, 5 that of Blender 4 and 5. auto: that of the Blender that wrote "
            "the G-buffer, 5 where none did."),
        row::choice(
            "distribution", RELUME_OPTION(distribution), Options::ggx, "ggx|multi_ggx", "Distribution",
            "Generation 5: whether metal and specular are compensated for what is scattered between facets, as Blender's "
            "Multiscatter GGX."),
        row::choice(
            "emission_is", RELUME_OPTION(emission_is), Options::by_source, "auto|emitted|seen", "Emission is",
            "Generation 5: what the surface emits, which sheen and coat then darken, or what is seen of it, as Cycles' Emission pass "
            "holds. auto: seen where it comes from that pass."),
    };
    static constexpr bool needs_tangent = true;
    static constexpr bool has_variants = true;
    template <class F> static RELUME_INLINE void with_variant(const Options& o, F&& f) {
        if (o.generation == Options::three) f(static_cast<BlenderPrincipled3*>(nullptr));
        else f(static_cast<BlenderPrincipled5*>(nullptr));
    }
};

}  // namespace relume::shaders
