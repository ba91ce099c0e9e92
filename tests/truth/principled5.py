# SPDX-License-Identifier: Apache-2.0
# ruff: noqa: E741 (l is the direction to the light, as everywhere in this project)
"""The Principled BSDF of Blender 4 and 5 in double precision, written independently of the core.

Plain closed forms, one closure after the other. What it looks up are the tables that the shader has, read out of their
headers; they are tested on their own (tests/python/test_principled_tables.py).
"""

from __future__ import annotations

import functools
import itertools
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from truth_scenes import ROOT

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

# A bump this small is the rounding of a half-float AOV.
NO_BUMP = 5e-4
# alpha_x * alpha_y at and below which Cycles has a mirror, which no delta light reaches.
MIRROR = 2e-10


@dataclass(frozen=True)
class Principled5:
    """Inputs; colours (..., 3), the rest (...)."""

    base: Array
    metallic: Array
    roughness: Array
    ior: Array
    specular: Array  # the IOR level
    specular_tint: Array
    diffuse_roughness: Array
    anisotropic: Array
    anisotropic_rotation: Array
    tangent: Array
    coat_weight: Array
    coat_roughness: Array
    coat_ior: Array
    coat_tint: Array
    sheen_weight: Array
    sheen_roughness: Array
    sheen_tint: Array


def dot(a: Array, b: Array) -> Array:
    return np.einsum("...i,...i->...", a, b)


def unit(a: Array) -> Array:
    length = np.linalg.norm(a, axis=-1, keepdims=True)
    return a / np.where(length > 0, length, 1.0)


@functools.cache
def table(name: str, *shape: int) -> Array:
    """A table of the shader's, out of its header."""
    folder = ROOT / "plugins" / "shaders" / "blender_principled"
    text = "".join((folder / file).read_text(encoding="utf-8") for file in ("ggx_tables.h", "sheen_tables.h"))
    found = re.search(rf"float {name}\[\d+\] = {{(.*?)}};", text, re.DOTALL)
    if found is None:
        raise ValueError(f"no table {name}")
    return np.array([float(number.rstrip("f")) for number in found[1].replace(",", " ").split()]).reshape(shape)


def interpolated(values: Array, *at: Array) -> Array:
    """Linear between nodes from 0 to 1 along each axis."""
    where = [np.clip(np.nan_to_num(x), 0, 1) * (n - 1) for x, n in zip(at, values.shape, strict=True)]
    first = [np.minimum(x.astype(int), n - 2) for x, n in zip(where, values.shape, strict=True)]
    total: Array = np.zeros(np.broadcast(*at).shape)
    for corner in itertools.product((0, 1), repeat=len(at)):
        weight: Array | float = 1.0
        for x, i, c in zip(where, first, corner, strict=True):
            weight = weight * ((x - i) if c else (1 - x + i))
        total = total + weight * values[tuple(i + c for i, c in zip(first, corner, strict=True))]
    return total


def fresnel(cosine: Array, eta: Array) -> Array:
    """Unpolarised, by Snell's law and the two polarisations."""
    inside = np.sqrt(1 - (1 - cosine**2) / eta**2)
    s = (cosine - eta * inside) / (cosine + eta * inside)
    p = (eta * cosine - inside) / (eta * cosine + inside)
    return 0.5 * (s**2 + p**2)


def _column(x: Array) -> Array:
    return x[..., None]


class _Compensation:
    """Kulla and Conty 2017."""

    def __init__(self, mu: Array, roughness: Array) -> None:
        self.albedo = interpolated(table("kAlbedo", 32, 32), mu, roughness)
        self.mean = interpolated(table("kMeanAlbedo", 32), roughness)

    def __call__(self, fss: Array) -> Array:
        extra = (slice(None),) * self.mean.ndim + (None,) * (fss.ndim - self.mean.ndim)
        mean, albedo = self.mean[extra], self.albedo[extra]
        return 1 + fss * mean / (1 - fss * (1 - mean)) * (1 - albedo) / albedo


def _alphas(m: Principled5) -> tuple[Array, Array]:
    """Along the tangent and across; Cycles bounds both."""
    aspect, alpha = np.sqrt(1 - 0.9 * m.anisotropic), m.roughness**2
    return np.minimum(alpha / aspect, 1), np.minimum(alpha * aspect, 1)


def _mean_fresnel(eta: Array) -> Array:
    return (eta - 1) / (4.08567 + 1.00071 * eta)


class _Layers:
    """Weights of all closures for the bumped normal n and the smooth s, seen from v."""

    def __init__(self, m: Principled5, n: Array, s: Array, v: Array, multi: bool) -> None:
        mu, mu_coat = np.clip(dot(n, v), 1e-4, 1), np.clip(dot(s, v), 1e-4, 1)
        w = np.ones_like(m.base)
        share = np.minimum(m.coat_weight, 1)
        self.sheen_axis = unit(n + (s - n) * _column(share))
        cosine = np.clip(dot(self.sheen_axis, v), 0, 1)
        self.sheen_a, self.sheen_b, albedo = (
            interpolated(table(f"kSheen{name}", 32, 32), cosine, m.sheen_roughness) for name in "ABR"
        )
        self.sheen = m.sheen_tint * _column(m.sheen_weight * albedo)
        w = w * np.maximum(1 - self.sheen.max(axis=-1, keepdims=True), 0)

        rise = table("kRise", 16, 16, 16)
        at_normal = ((m.coat_ior - 1) / (m.coat_ior + 1)) ** 2
        lost = _Compensation(mu_coat, m.coat_roughness)
        factor = lost(_mean_fresnel(m.coat_ior))
        self.coat = w * _column(m.coat_weight * factor)
        coat_closure = self.coat.mean(axis=-1) * lost.albedo
        single = at_normal + (1 - at_normal) * interpolated(rise, at_normal**0.25, mu_coat, m.coat_roughness)
        path = 1 / np.sqrt(1 - (1 - mu_coat**2) / m.coat_ior**2)
        w = w * np.maximum(1 - _column(m.coat_weight * factor * lost.albedo * single), 0)
        w = w * np.maximum(1 + (m.coat_tint ** _column(path) - 1) * _column(m.coat_weight), 0)

        tint, f0 = m.specular_tint, np.minimum(m.base, 1)
        self.metal_f0 = f0
        self.metal_dip = (f0 + (1 - f0) * (6 / 7) ** 5) * 7 / (6 / 7) ** 6 * (1 - tint)
        # What is looked up is that of a round lobe as wide as the stretched one.
        roughness = np.prod(_alphas(m), axis=0) ** 0.25
        lost = _Compensation(mu, roughness)
        self.metal = w * _column(m.metallic)
        base_closures = self.metal.mean(axis=-1)
        if multi:
            self.metal = self.metal * lost(f0 + (1 - f0) / 21 - self.metal_dip / 126)
            base_closures = self.metal.mean(axis=-1) * lost.albedo
        w = w * _column(1 - m.metallic)

        of_ior = ((m.ior - 1) / (m.ior + 1)) ** 2
        given = np.where(m.specular == 0.5, of_ior, of_ior * 2 * m.specular)
        self.at_normal = np.minimum(given, 0.99)  # bounds the IOR alone
        self.eta = (1 + np.sqrt(self.at_normal)) / (1 - np.sqrt(self.at_normal))
        self.f0 = _column(np.minimum(given, 1)) * tint
        taken = self.f0 + (1 - self.f0) * _column(interpolated(rise, self.at_normal**0.25, mu, roughness))
        self.specular = w
        specular_closure = w.mean(axis=-1)
        if multi:
            of_white = (_mean_fresnel(self.eta) - self.at_normal) / (1 - self.at_normal)
            more = lost(self.f0 + (1 - self.f0) * _column(of_white))
            self.specular, taken = w * more, taken * more * _column(lost.albedo)
            specular_closure = self.specular.mean(axis=-1) * lost.albedo
        w = w * np.maximum(1 - taken.max(axis=-1, keepdims=True), 0)
        self.diffuse = w * m.base

        specular_closure = np.where(self.at_normal > 0, specular_closure, 0)  # no lobe, no closure
        sheen_closure = self.sheen.mean(axis=-1)
        self.on_smooth = coat_closure + sheen_closure * share
        self.on_bump = base_closures + specular_closure + self.diffuse.mean(axis=-1) + sheen_closure * (1 - share)


def bumped_normal(m: Principled5, mixed: Array, s: Array, v: Array, multi: bool) -> Array:
    """Of Cycles' Normal pass, the mean of the closures' normals by weight, the part that is the base's."""
    n = mixed
    for _ in range(8):
        layers = _Layers(m, n, s, v, multi)
        a, b, cosine = layers.on_smooth, layers.on_bump, dot(mixed, s)
        length = a * cosine + np.sqrt(np.maximum(b**2 - a**2 * (1 - cosine**2), 0))
        n = unit(_column(length) * mixed - _column(a) * s)
        n = np.where(_column((m.coat_weight > 0) & (b > 0)), n, mixed)
    return n


def _ggx(n: Array, v: Array, l: Array, frame: tuple[Array, Array], ax: Array, ay: Array) -> Array:
    """D*G2/(4 NdotV), height-correlated (Heitz 2014)."""
    h = unit(v + l)
    x, y = frame
    rough = ax * ay > MIRROR
    ax, ay = np.where(rough, ax, 1.0), np.where(rough, ay, 1.0)
    nv, nl = np.maximum(dot(n, v), 1e-4), dot(n, l)
    hx, hy = dot(x, h), dot(y, h)
    bracket = hx**2 / ax**2 + hy**2 / ay**2 + dot(n, h) ** 2
    d = 1 / (np.pi * ax * ay * bracket**2)

    def smith(direction: Array, cosine: Array) -> Array:
        slope2 = ((ax * dot(x, direction)) ** 2 + (ay * dot(y, direction)) ** 2) / np.maximum(cosine, 1e-9) ** 2
        return 0.5 * (np.sqrt(1 + slope2) - 1)

    lobe = d / (1 + smith(v, nv) + smith(l, nl)) / (4 * nv)
    return np.where((nl > 0) & rough, lobe, 0.0)


def _frame(n: Array, tangent: Array, turns: Array) -> tuple[Array, Array]:
    """Tangent and bitangent, turned; any where there is no tangent."""
    fallback = np.where(np.abs(n[..., :1]) < 0.9, np.array([1.0, 0, 0]), np.array([0.0, 1, 0]))
    given = np.linalg.norm(tangent, axis=-1, keepdims=True) > 0
    t = np.where(given, tangent, fallback)
    t = unit(t - n * _column(dot(n, t)))
    b = np.cross(n, t)
    angle = _column(2 * np.pi * turns)
    return t * np.cos(angle) + b * np.sin(angle), b * np.cos(angle) - t * np.sin(angle)


def _terminator(n: Array, s: Array, l: Array) -> Array:
    """Estevez, Lecocq, Stein 2019."""

    def tangent2(cosine: Array) -> Array:
        return 1 / np.clip(cosine, 1e-6, 1.0) ** 2 - 1

    k = np.clip(tangent2(dot(n, s)) / 8, 0, 1)
    return np.where(dot(s, l) <= 0, 0.0, 2 / (1 + np.sqrt(1 + k * tangent2(dot(s, l)))))


def _oren_nayar(m: Principled5, n: Array, v: Array, l: Array) -> Array:
    """f/base of Fujii's fit, energy-preserving; 1/pi at roughness 0."""
    sigma = m.diffuse_roughness
    a = 1 / (np.pi + sigma * (np.pi / 2 - 2 / 3))
    b = sigma * a
    nv, nl = np.clip(dot(n, v), 1e-4, 1), np.clip(dot(n, l), 1e-4, 1)
    s = dot(l, v) - nl * nv
    s = np.where(s > 0, s / np.maximum(nl, nv), s)

    def albedo(c: Array) -> Array:
        sine = np.sqrt(1 - c**2)
        return np.pi * a + b * (sine * (np.arccos(c) - 2 / 3 - sine * c) + 2 / 3 * (sine / c) * (1 - sine**3))

    mean = _column(np.pi * a + b * (2 * np.pi - 5.6) / 3)
    color = np.minimum(m.base, 1)
    back = color**2 * mean / np.maximum(1 - mean, 1e-12) / (1 - color * (1 - mean)) / np.pi
    rough = _column(a + b * s) + _column((1 - albedo(nv)) * (1 - albedo(nl))) * back
    return np.where(_column(sigma) > 0, rough, 1 / np.pi)


def reflected(m: Principled5, pass_normal: Array, smooth: Array | None, v: Array, l: Array, multi: bool) -> Array:
    """f·NdotL of one direction l per pixel."""
    s = pass_normal if smooth is None else smooth
    s = np.where(np.linalg.norm(s - pass_normal, axis=-1, keepdims=True) > NO_BUMP, s, pass_normal)
    n = bumped_normal(m, pass_normal, s, v, multi)
    layers = _Layers(m, n, s, v, multi)
    h = unit(v + l)
    c = dot(l, h)

    # Of light from behind the surface a facet reflects none, though the bump turns it there.
    base = _ggx(n, v, l, _frame(n, m.tangent, m.anisotropic_rotation), *_alphas(m)) * (dot(s, l) > 0)
    schlick = _column(1 - c)
    metal = layers.metal_f0 + (1 - layers.metal_f0) * schlick**5 - layers.metal_dip * _column(c) * schlick**6
    out = layers.metal * np.clip(metal, 0, 1) * _column(base)
    rise = np.maximum((fresnel(c, layers.eta) - layers.at_normal) / (1 - layers.at_normal), 0)
    out = out + layers.specular * (layers.f0 + (1 - layers.f0) * _column(rise)) * _column(base)

    coat_alpha = m.coat_roughness**2
    coat = _ggx(s, v, l, _frame(s, np.zeros_like(s), np.zeros_like(c)), coat_alpha, coat_alpha)
    out = out + layers.coat * _column(coat * fresnel(c, m.coat_ior))

    nl = np.maximum(dot(n, l), 0)
    out = out + layers.diffuse * _oren_nayar(m, n, v, l) * _column(nl * _terminator(n, s, l))

    axis = layers.sheen_axis
    x = unit(v - axis * _column(dot(v, axis)))
    lx, ly, lz = dot(l, x), dot(l, np.cross(axis, x)), np.maximum(dot(l, axis), 0)
    a, b = layers.sheen_a, layers.sheen_b
    fibers = lz / np.pi * (a / np.maximum((a * lx + b * lz) ** 2 + (a * ly) ** 2 + lz**2, 1e-12)) ** 2
    return out + layers.sheen * _column(fibers * _terminator(axis, s, l))
