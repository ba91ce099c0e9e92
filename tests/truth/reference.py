# SPDX-License-Identifier: Apache-2.0
# ruff: noqa: E741 (l is the direction to the light, as everywhere in this project)
"""Direct light on a G-buffer in double precision: the formulas that Cycles follows, written independently of the core.

Vectors n, v, l are unit, point away from the surface, world space, shape (..., 3). BRDFs return f·NdotL (1/sr), lights
irradiance perpendicular to the ray (W/m²). alpha = roughness².
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from principled5 import Principled5, reflected

if TYPE_CHECKING:
    from exr_files import Surface
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

Model = Literal["lambert", "lambertggx", "blender3", "blender5", "blender5_multi_ggx"]


def dot(a: Array, b: Array) -> Array:
    return np.einsum("...i,...i->...", a, b)


def normalized(a: Array) -> Array:
    length = np.linalg.norm(a, axis=-1, keepdims=True)
    return a / np.where(length > 0, length, 1.0)


# ---------------------------------------------------------------- microfacets


def _lambda(alpha2: Array, cosine: Array) -> Array:
    """Smith's Λ of GGX: (√(1 + α² tan²θ) − 1)/2 (Heitz 2014, eq. 72)."""
    cosine2 = np.maximum(cosine, 1e-8) ** 2
    return 0.5 * (np.sqrt(1 + alpha2 * (1 - cosine2) / cosine2) - 1)


def ggx(n: Array, v: Array, l: Array, roughness: Array, *, correlated: bool) -> Array:
    """D·G/(4·NdotV): the GGX lobe without Fresnel, NdotL included. Walter 2007 eq. 33; G separable or correlated.

    0 at alpha² ≤ 1e-7, where Cycles makes the lobe a mirror that no delta light reaches.
    """
    alpha2 = roughness**4
    h = normalized(v + l)
    sine2 = dot(np.cross(n, h), np.cross(n, h))  # Lagrange: no cancellation near the peak
    d = alpha2 / (np.pi * np.maximum(sine2 + alpha2 * dot(n, h) ** 2, 1e-150) ** 2)
    at_v, at_l = _lambda(alpha2, dot(n, v)), _lambda(alpha2, dot(n, l))
    g = 1 / (1 + at_v + at_l) if correlated else 1 / ((1 + at_v) * (1 + at_l))
    return np.where(alpha2 > 1e-7, d * g / (4 * np.maximum(dot(n, v), 1e-8)), 0.0)


def dielectric_fresnel(cosine: Array, eta: Array) -> Array:
    """Unpolarised reflectance of a dielectric seen from outside, eta = inside/outside."""
    g = np.sqrt(eta**2 - 1 + cosine**2)
    a = (g - cosine) / (g + cosine)
    b = (cosine * (g + cosine) - 1) / (cosine * (g - cosine) + 1)
    return 0.5 * a**2 * (1 + b**2)


# --------------------------------------------------------------------- models


@dataclass(frozen=True)
class Material:
    """base (..., 3); the rest (...)."""

    base: Array
    roughness: Array
    metallic: Array
    specular: Array


def lambert(n: Array, l: Array, m: Material) -> Array:
    return m.base / np.pi * dot(n, l)[..., None]


def lambert_ggx(n: Array, v: Array, l: Array, m: Material, *, correlated: bool) -> tuple[Array, Array]:
    """Diffuse, specular: Lambert of base·(1 − metallic); GGX with constant F = lerp(0.08·specular, base, metallic)."""
    metallic = m.metallic[..., None]
    f = 0.08 * m.specular[..., None] * (1 - metallic) + m.base * metallic
    diffuse = m.base * (1 - metallic) / np.pi * dot(n, l)[..., None]
    return diffuse, f * ggx(n, v, l, m.roughness, correlated=correlated)[..., None]


def blender3(n: Array, v: Array, l: Array, m: Material) -> tuple[Array, Array]:
    """Diffuse, specular of the Principled BSDF of Blender ≤ 3.6: Burley 2012; GGX with a Fresnel of its own."""
    metallic = m.metallic[..., None]
    nl, nv, lh = dot(n, l), dot(n, v), dot(l, normalized(v + l))
    fl, fv = (1 - nl) ** 5, (1 - nv) ** 5
    rr = m.roughness * (dot(l, v) + 1)
    burley = (1 - 0.5 * fv) * (1 - 0.5 * fl) + rr * (fl + fv + fl * fv * (rr - 1))
    diffuse = m.base * (1 - metallic) / np.pi * (nl * burley)[..., None]
    root = np.sqrt(0.08 * m.specular)
    ior = 2 / (1 - root) - 1
    at_normal = dielectric_fresnel(np.ones_like(ior), ior)
    # ior = 1 (specular 0): no interface, its rise is taken as 0 rather than 0/0.
    rise = np.where(ior > 1, (dielectric_fresnel(lh, ior) - at_normal) / (1 - at_normal), 0.0)[..., None]
    c0 = 0.08 * m.specular[..., None] * (1 - metallic) + m.base * metallic
    return diffuse, (c0 + (1 - c0) * rise) * ggx(n, v, l, m.roughness, correlated=False)[..., None]


def bump_terminator(n: Array, l: Array, smooth: Array, *, generation: int) -> Array:
    """Factor that Cycles puts on the diffuse closure of a bumped surface; `smooth` is the normal before the bump.

    Blender 3: a cubic in g = (smooth·l)/((n·l)(smooth·n)); Blender 5: Estevez et al. 2019, after Smith's shadowing.
    """
    over = dot(smooth, l)
    if generation == 3:
        g = over / np.maximum(dot(n, l) * dot(smooth, n), 1e-12)
        return np.where(g >= 1, 1.0, np.where(g <= 0, 0.0, -(g**3) + g**2 + g))

    def tangent2(cosine: Array) -> Array:
        return 1 / np.clip(cosine, 1e-6, 1.0) ** 2 - 1

    k = np.clip(tangent2(dot(n, smooth)) / 8, 0, 1)
    return np.where(over <= 0, 0.0, 2 / (1 + np.sqrt(1 + k * tangent2(over))))


# --------------------------------------------------------------------- lights


def illuminate(light: dict[str, Any], position: Array, *, generation: int) -> tuple[Array, Array]:
    """Unit vector to the light (..., 3) and irradiance perpendicular to it (..., 3), from Blender's own numbers.

    SUN: energy is W/m². POINT: energy P in W, intensity P/4π. SPOT: the same times smoothstep over the cosine;
    Blender 3 multiplies by the cosine to the axis besides.
    """
    color = np.asarray(light["color"], dtype=np.float64)
    if light["type"] == "SUN":
        to_light = np.broadcast_to(-np.asarray(light["direction"], dtype=np.float64), position.shape)
        return to_light, np.broadcast_to(light["energy"] * color, position.shape)
    offset = np.asarray(light["location"], dtype=np.float64) - position
    distance2 = dot(offset, offset)
    to_light = normalized(offset)
    strength = light["energy"] / (4 * np.pi * np.maximum(distance2, 1e-12))
    if light["type"] == "SPOT":
        cosine = -dot(to_light, np.asarray(light["direction"], dtype=np.float64))
        outer = np.cos(0.5 * light["spot_size_rad"])
        t = np.clip((cosine - outer) / max((1 - outer) * light["spot_blend"], 1e-12), 0, 1)
        strength = strength * t * t * (3 - 2 * t)
        if generation == 3:
            strength = strength * np.maximum(cosine, 0)
    return to_light, strength[..., None] * color


# --------------------------------------------------------------------- whole


def _principled5(surface: Surface) -> Principled5:
    """A surface's inputs, Blender's defaults where no AOV holds one."""
    shape, given = surface.depth.shape, surface.principled5

    def number(name: str, default: float) -> Array:
        return given.get(name, np.full(shape, default))

    def color(name: str, default: float) -> Array:
        return given.get(name, np.full((*shape, 3), default))

    return Principled5(
        base=surface.albedo,
        metallic=surface.metallic,
        roughness=surface.roughness,
        ior=np.maximum(number("ior", 1.5), 1.0),
        specular=surface.specular,
        specular_tint=color("specular_tint", 1.0),
        diffuse_roughness=number("diffuse_roughness", 0.0),
        anisotropic=number("anisotropic", 0.0),
        anisotropic_rotation=number("anisotropic_rotation", 0.0),
        tangent=color("tangent", 0.0),
        coat_weight=number("coat_weight", 0.0),
        coat_roughness=number("coat_roughness", 0.03),
        coat_ior=np.maximum(number("coat_ior", 1.5), 1.0),
        coat_tint=color("coat_tint", 1.0),
        sheen_weight=number("sheen_weight", 0.0),
        sheen_roughness=number("sheen_roughness", 0.5),
        sheen_tint=color("sheen_tint", 1.0),
    )


def shade(
    surface: Surface,
    eye: Array,
    light: dict[str, Any],
    model: Model,
    *,
    generation: int,
    lambert_ids: tuple[int, ...] = (),
    bump_ids: tuple[int, ...] = (),
) -> tuple[Array, Array]:
    """Radiance (H, W, 3) of one light without shadows, 0 where there is no surface; and N·L (H, W).

    `lambert_ids` are the material IDs that are plain Lambert whatever `model` says; `bump_ids` those that get the bump
    terminator, where the G-buffer has the normal before the bump.
    """
    n = normalized(surface.normal)
    v = normalized(eye - surface.position)
    l, irradiance = illuminate(light, surface.position, generation=generation)
    material = Material(surface.albedo, surface.roughness, surface.metallic, surface.specular)
    plain = lambert(n, l, material)
    if model == "blender3":
        diffuse, specular = blender3(n, v, l, material)
    elif model in ("blender5", "blender5_multi_ggx"):
        # Everything at once; its bump terminator is its own.
        smooth = None if surface.smooth is None else normalized(surface.smooth)
        diffuse = reflected(_principled5(surface), n, smooth, v, l, model == "blender5_multi_ggx")
        specular, bump_ids = np.zeros_like(diffuse), ()
    elif model == "lambertggx":
        diffuse, specular = lambert_ggx(n, v, l, material, correlated=generation >= 5)
    else:
        diffuse, specular = plain, np.zeros_like(plain)
    if surface.smooth is not None and bump_ids:
        factor = bump_terminator(n, l, normalized(surface.smooth), generation=generation)
        bumped = np.isin(surface.material_id, bump_ids)
        diffuse = diffuse * np.where(bumped, factor, 1.0)[..., None]
    f = np.where(np.isin(surface.material_id, lambert_ids)[..., None], plain, diffuse + specular)
    lit = dot(n, l)
    seen = (dot(n, v) > 0) & (lit > 0) & (dot(surface.normal, surface.normal) > 0)
    return np.where(seen[..., None], f * irradiance, 0.0), lit
