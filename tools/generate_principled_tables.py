# SPDX-License-Identifier: Apache-2.0
"""Writes the tables that ``blender_principled`` of generation 5 looks things up in, as C++ headers beside the shader.

    tools/generate_principled_tables.py [--sheen FILE.npz] [--check GGX.npz]

GGX's are integrated here, in double precision. Sheen's cannot be: they are the measured coefficients of a linearly
transformed cosine per view cosine and roughness (arrays A, B, R of 32 x 32); without ``--sheen`` that header stays as
it is. ``--check`` compares what was integrated with another integration's s_ior, E and E_avg and writes nothing.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    Array = NDArray[np.float64]

FOLDER = Path(__file__).resolve().parents[1] / "plugins" / "shaders" / "blender_principled"
ALBEDO_NODES, RISE_NODES = 32, 16

# A cosine or a roughness of 0 has no lobe: the first node stands for these.
LEAST_COSINE, LEAST_ROUGHNESS = 1e-4, 1e-2


def fresnel(cosine: Array, eta: float) -> Array:
    """Unpolarised reflectance of a dielectric from outside (Walter 2007, eq. 22)."""
    g = np.sqrt(eta**2 - 1 + cosine**2)
    a = (g - cosine) / (g + cosine)
    b = (cosine * (g + cosine) - 1) / (cosine * (g - cosine) + 1)
    return 0.5 * a**2 * (1 + b**2)


def smith_lambda(alpha2: float, cosine: Array | float) -> Array | float:
    """Smith's lambda of GGX (Heitz 2014, eq. 72)."""
    return 0.5 * (np.sqrt(1 + alpha2 * (1 / np.square(cosine) - 1)) - 1)


def mirrored(mu: float, alpha: float, theta: Array, phi: Array) -> tuple[Array, Array]:
    """V.H and N.L of the visible normals of GGX seen at cosine mu (Heitz 2018): (sin theta)^2 and phi are uniform."""
    sine = np.sqrt(1 - mu**2)
    length = np.hypot(alpha * sine, mu)
    x, z = alpha * sine / length, mu / length  # the view in the space where the surface is a hemisphere
    t1, t2 = np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi)
    warp = 0.5 * (1 + z)
    t2 = (1 - warp) * np.sqrt(np.maximum(1 - t1**2, 0)) + warp * t2
    t3 = np.sqrt(np.maximum(1 - t1**2 - t2**2, 0))
    hx, hy, hz = alpha * (t3 * x - t2 * z), alpha * t1, np.maximum(t2 * x + t3 * z, 0)
    length = np.sqrt(hx**2 + hy**2 + hz**2)
    v_dot_h = np.maximum(sine * hx + mu * hz, 0) / length
    return v_dot_h, 2 * v_dot_h * hz / length - mu


class VisibleNormals:
    """Quadrature over the visible normals that mirror the view above the horizon: Gauss along theta up to there."""

    def __init__(self, mu: float, roughness: float, phis: int = 192, thetas: int = 64) -> None:
        self.mu = max(mu, LEAST_COSINE)
        self.alpha = max(roughness, LEAST_ROUGHNESS) ** 2
        phi = np.pi * ((np.arange(phis) + 0.5) / phis - 0.5)  # the other half is the same
        low, high = np.zeros(phis), np.full(phis, np.pi / 2)
        everything = mirrored(self.mu, self.alpha, high, phi)[1] > 0
        for _ in range(48):
            middle = 0.5 * (low + high)
            above = mirrored(self.mu, self.alpha, middle, phi)[1] > 0
            low, high = np.where(above, middle, low), np.where(above, high, middle)
        end = np.where(everything, np.pi / 2, low)
        x, w = np.polynomial.legendre.leggauss(thetas)
        theta = end[:, None] * (x + 1) / 2
        self.weight = w * end[:, None] * np.sin(theta) * np.cos(theta) / phis
        self.v_dot_h, n_dot_l = mirrored(self.mu, self.alpha, theta, phi[:, None])
        self.n_dot_l = np.maximum(n_dot_l, 1e-12)

    def albedo(self) -> float:
        """Of the lobe with F = 1, height-correlated: the mean of G2/G1."""
        a2 = self.alpha**2
        at_v = smith_lambda(a2, self.mu)
        return float(np.sum(self.weight * (1 + at_v) / (1 + at_v + smith_lambda(a2, self.n_dot_l))))

    def rise(self, z: float) -> float:
        """Mean of (F - R0)/(1 - R0), not below 0, for z = ((eta - 1)/(eta + 1))^0.5."""
        r0 = z**4
        if not 0 < r0 < 1:
            return 0.0
        eta = (1 + z**2) / (1 - z**2)
        return float(np.sum(self.weight * np.maximum(fresnel(self.v_dot_h, eta) - r0, 0) / (1 - r0)))


def albedos() -> tuple[Array, Array]:
    """E[cosine, roughness] and its mean 2 * integral of E * mu over mu, [roughness]."""
    nodes = np.linspace(0, 1, ALBEDO_NODES)
    x, w = np.polynomial.legendre.leggauss(48)
    table = np.array([[VisibleNormals(mu, r).albedo() for r in nodes] for mu in nodes])
    mean = [
        sum(w[k] * (x[k] + 1) / 2 * VisibleNormals((x[k] + 1) / 2, r, 96, 48).albedo() for k in range(len(x)))
        for r in nodes
    ]
    return table, np.array(mean)


def rises() -> Array:
    """s[z, cosine, roughness]."""
    nodes = np.linspace(0, 1, RISE_NODES)
    normals = [[VisibleNormals(mu, r, 256, 96) for r in nodes] for mu in nodes]
    return np.array([[[at.rise(z) for at in row] for row in normals] for z in nodes])


def array(name: str, comment: str, values: Array) -> Iterable[str]:
    """Lines of a constant of C++."""
    yield f"/// {comment}"
    yield f"constexpr float {name}[{values.size}] = {{"
    flat = [f"{value:.7g}" for value in np.where(np.abs(values) < 1e-12, 0, values).ravel()]
    flat = [text + ("f" if "." in text or "e" in text else ".f") for text in flat]
    line = "   "
    for text in flat:
        if len(line) + len(text) + 2 > 120:
            yield line
            line = "   "
        line += f" {text},"
    yield line
    yield "};"


def header(path: Path, comment: str, arrays: Iterable[Iterable[str]]) -> None:
    """Write one."""
    lines = [
        "// SPDX-License-Identifier: Apache-2.0",
        "#pragma once",
        "",
        f"// {comment}",
        "// Made by tools/generate_principled_tables.py: change that.",
        "// Internal linkage, for an object of one instruction set exports nothing.",
        "",
        "// clang-format off",
        "namespace relume::shaders::table {",
        "",
    ]
    for each in arrays:
        lines += [*each, ""]
    lines += ["}  // namespace relume::shaders::table", "// clang-format on", ""]
    path.write_text("\n".join(lines), encoding="utf-8")


def check(path: str) -> None:
    """Print how far another integration is from this one."""
    other = np.load(path)
    table, mean = albedos()
    for name, own, given in (
        ("E", table, other["E"]),
        ("E_avg", mean, other["E_avg"]),
        ("s_ior", rises(), other["s_ior"]),
    ):
        error = np.percentile(np.abs(own - given), [50, 99, 100])
        print(f"{name}: absolute difference median {error[0]:.1e}, p99 {error[1]:.1e}, worst {error[2]:.1e}")


def main() -> None:
    """Integrate, then write or compare."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sheen", metavar="FILE.npz", help="measured coefficients A, B, R")
    parser.add_argument("--check", metavar="GGX.npz", help="compare with s_ior, E, E_avg of another integration")
    arguments = parser.parse_args()
    if arguments.check:
        check(arguments.check)
        return
    table, mean = albedos()
    header(
        FOLDER / "ggx_tables.h",
        "Albedos of GGX lobes under height-correlated Smith masking, alpha = roughness².",
        [
            array(
                "kAlbedo",
                f"Of a lobe with F = 1: [cosine of the view][roughness], {ALBEDO_NODES} nodes each from 0 to 1.",
                table,
            ),
            array("kMeanAlbedo", "2·∫kAlbedo·µ dµ: [roughness].", mean),
            array(
                "kRise",
                "Mean over the visible normals of (F − R0)/(1 − R0), 0 below the horizon: [√((eta−1)/(eta+1))][cosine]"
                f"[roughness], {RISE_NODES} nodes each.",
                rises(),
            ),
        ],
    )
    if arguments.sheen:
        sheen = np.load(arguments.sheen)
        header(
            FOLDER / "sheen_tables.h",
            "Microfiber sheen as a linearly transformed cosine (Zeltner, Burley, Chiang 2022), measured.",
            [
                array(f"kSheen{name}", f"{meaning}: [cosine of the view][roughness], 32 nodes each.", sheen[name])
                for name, meaning in (("A", "Its transform's stretch"), ("B", "Its shear"), ("R", "Its albedo"))
            ],
        )


if __name__ == "__main__":
    main()
