# SPDX-License-Identifier: Apache-2.0
"""The tables of blender_principled against the integrals they stand for, and against another integration of them."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "truth"))
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))

from generate_principled_tables import VisibleNormals
from principled5 import table
from truth_scenes import shared_data

ALBEDO, MEAN, RISE = table("kAlbedo", 32, 32), table("kMeanAlbedo", 32), table("kRise", 16, 16, 16)


def test_they_are_what_the_generator_integrates() -> None:
    random = np.random.default_rng(3)
    for mu, roughness in random.integers(0, 32, (40, 2)):
        assert ALBEDO[mu, roughness] == pytest.approx(VisibleNormals(mu / 31, roughness / 31).albedo(), abs=2e-6)
    for z, mu, roughness in random.integers(0, 16, (40, 3)):
        assert RISE[z, mu, roughness] == pytest.approx(VisibleNormals(mu / 15, roughness / 15).rise(z / 15), abs=2e-5)


def test_albedo_against_the_light_that_arrives() -> None:
    """Over directions to the light instead of facets: a sum over a fine grid, which rough lobes allow."""
    cosines, azimuths = (np.arange(1000) + 0.5) / 1000, (np.arange(720) + 0.5) / 720 * 2 * np.pi
    c, phi = np.meshgrid(cosines, azimuths, indexing="ij")
    sine = np.sqrt(1 - c**2)
    l = np.stack([sine * np.cos(phi), sine * np.sin(phi), c], axis=-1)  # noqa: E741
    for mu, roughness in ((31, 31), (20, 24), (9, 20), (31, 16), (4, 28)):
        alpha, cosine = (roughness / 31) ** 2, mu / 31
        v = np.array([np.sqrt(1 - cosine**2), 0, cosine])
        h = v + l
        h /= np.linalg.norm(h, axis=-1, keepdims=True)
        d = alpha**2 / (np.pi * (h[..., 2] ** 2 * (alpha**2 - 1) + 1) ** 2)
        at = [0.5 * (np.sqrt(1 + alpha**2 * (1 / x**2 - 1)) - 1) for x in (cosine, c)]
        albedo = np.sum(d / (1 + at[0] + at[1]) / (4 * cosine)) * 2 * np.pi / c.size
        assert ALBEDO[mu, roughness] == pytest.approx(albedo, abs=3e-4)


def test_mean_albedo_is_the_mean_of_the_albedos() -> None:
    mu = np.linspace(0, 1, 32)
    y = ALBEDO * mu[:, None]
    mean = (y[1:] + y[:-1]).sum(axis=0) * mu[1]  # the trapezoid's rule
    assert np.abs(mean - MEAN).max() < 2e-3


@pytest.mark.skipif(not (shared_data() / "blender5").exists(), reason="the larger test data (RELUME_TEST_DATA)")
def test_against_another_integration_and_the_measurement() -> None:
    folder = shared_data() / "blender5" / "tables"
    ggx, sheen = np.load(folder / "ggx_tables.npz"), np.load(folder / "sheen_ltc.npz")
    for own, other, median, p99 in (
        (ALBEDO, ggx["E"], 5e-5, 2e-3),
        (MEAN, ggx["E_avg"], 1e-4, 4e-3),
        (RISE, ggx["s_ior"], 1e-4, 2e-3),
    ):
        assert np.percentile(np.abs(own - other), 50) < median
        assert np.percentile(np.abs(own - other), 99) < p99
    for name in "ABR":
        np.testing.assert_allclose(table(f"kSheen{name}", 32, 32), sheen[name], rtol=1e-6, atol=1e-9)
