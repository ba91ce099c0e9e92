# SPDX-License-Identifier: Apache-2.0
"""The frame that every contender shades: planar float32, Lambert + GGX with default_lit's inputs, point lights."""

from __future__ import annotations

import numpy as np

EYE = (0.0, 0.0, 5.0)
FOV = 60.0
CAMERA = np.array([[1, 0, 0, EYE[0]], [0, 1, 0, EYE[1]], [0, 0, 1, EYE[2]], [0, 0, 0, 1]], dtype=np.float64)


def planes(width: int, height: int) -> dict[str, np.ndarray]:
    """Channels as (components, height, width) float32, deterministic and smooth, so that neighbours see the
    same lights, as in a rendered picture; positions are where the camera's rays say."""
    y, x = np.meshgrid(
        np.linspace(-1, 1, height, dtype=np.float32), np.linspace(-1, 1, width, dtype=np.float32), indexing="ij"
    )
    normal = np.stack([0.5 * np.sin(9 * x), 0.5 * np.cos(7 * y), np.ones_like(x)])
    normal /= np.sqrt((normal * normal).sum(axis=0))
    # Rays through the pixels' centres, by unit of depth.
    across = ((np.arange(width) + 0.5) * 2 / width - 1) * np.tan(np.radians(FOV / 2))
    up = (height / width - (np.arange(height) + 0.5) * 2 / width) * np.tan(np.radians(FOV / 2))
    depth = EYE[2] - 0.2 * np.sin(4.0 * x * y)
    position = np.stack([EYE[0] + depth * across, EYE[1] + depth * up[:, None], EYE[2] - depth]).astype(np.float32)
    wave = [0.5 + 0.5 * np.sin((3 + k) * x + (5 - k) * y) for k in range(6)]
    return {
        "normal": normal,
        "position": position,
        "base_color": np.stack(wave[:3]),
        "metallic": wave[3][None],
        "roughness": (0.1 + 0.9 * wave[4])[None],
        "specular": wave[5][None],
    }


def lights(count: int) -> list[tuple[tuple[float, float, float], tuple[float, float, float]]]:
    """(position, intensity in W/sr) of each light, all in front of the surface."""
    return [
        (
            (float(3 * np.cos(2.4 * k)), float(3 * np.sin(2.4 * k)), 3.0 + 0.1 * k),
            (1.0 + 0.1 * k, 1.5 - 0.05 * k, 0.8 + 0.02 * k),
        )
        for k in range(count)
    ]


def shade(xp, p, count, *, rsqrt, rcp, select, dot, constant):
    """The same arithmetic for any array library: three colour arrays. ``p`` holds lists of component arrays."""

    def larger(a, b):
        return select(a > b, a, b)

    n = p["normal"]
    inv = rsqrt(dot(n, n))
    n = [c * inv for c in n]
    v = [constant(e) - c for e, c in zip(EYE, p["position"], strict=True)]
    inv = rsqrt(dot(v, v))
    v = [c * inv for c in v]
    n_dot_v = larger(dot(n, v), constant(1e-4))
    metallic, roughness, specular = p["metallic"][0], p["roughness"][0], p["specular"][0]
    alpha = larger(roughness * roughness, constant(1e-3))
    alpha2 = alpha * alpha
    f0 = [0.08 * specular + metallic * (c - 0.08 * specular) for c in p["base_color"]]
    f90 = select(50 * f0[1] < 1, 50 * f0[1], constant(1.0))
    diffuse = [c * (1 - metallic) * (1 / np.pi) for c in p["base_color"]]
    slope, offset = 2 * n_dot_v * (1 - alpha) + alpha, alpha * n_dot_v
    weight = alpha2 * (0.5 / np.pi)
    out = [None, None, None]
    for position, intensity in lights(count):
        d = [constant(a) - b for a, b in zip(position, p["position"], strict=True)]
        inv = rsqrt(dot(d, d))
        light = [c * inv for c in d]
        n_dot_l = larger(dot(n, light), constant(0.0))
        w = larger(1 + dot(v, light), constant(1e-8))
        inv_h = rsqrt(w + w)
        e = [(a + b) * inv_h - c for a, b, c in zip(v, light, n, strict=True)]
        q = dot(e, e)
        sin2 = q * (1 - 0.25 * q)
        bracket = sin2 * (1 - alpha2) + alpha2
        cosine = n_dot_l * (inv * inv)
        lobe = weight * cosine * rcp(bracket * bracket * (n_dot_l * slope + offset))
        x = 1 - w * inv_h
        x2 = x * x
        fresnel = x2 * x2 * x
        grey = f90 * (fresnel * lobe)
        rest = lobe - fresnel * lobe
        for k in range(3):
            term = (diffuse[k] * cosine + f0[k] * rest + grey) * constant(intensity[k])
            out[k] = term if out[k] is None else out[k] + term
    return out
