# SPDX-License-Identifier: Apache-2.0
"""Figures of merit between a relit image and the renderer's."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from exr_files import Surface
    from numpy.typing import NDArray
    from truth_scenes import Material

    Array = NDArray[np.float64]
    Mask = NDArray[np.bool_]

# Issue: within these over interior pixels; half floats in the files alone cost 2e-4 in the median.
MEDIAN_BAR, P99_BAR = 5e-4, 3e-3
# Each material on its own, bump-mapped ones too, where the model knows all that the renderer knew: their half floats
# differ.
MATERIAL_MEDIAN_BAR = 8e-4
# An antialiased silhouette, absolute; what is left is that one normal stands for all of a pixel's samples.
EDGE_BAR = 3e-3
# Below this length a normal is a mean of several: the root mean square error there.
MIXED_LENGTH = 0.999


@dataclass(frozen=True)
class Errors:
    """Relative errors over `count` pixels."""

    count: int
    median: float
    p90: float
    p99: float
    worst: float

    @classmethod
    def of(cls, errors: Array) -> Errors | None:
        if errors.size < 20:
            return None  # too few for a 99th percentile to mean anything
        return cls(errors.size, *np.percentile(errors, [50, 90, 99]).tolist(), float(errors.max()))

    def within_bars(self, median: float = MEDIAN_BAR) -> bool:
        return self.median <= median and self.p99 <= P99_BAR


@dataclass(frozen=True)
class Comparison:
    """Relative errors of one image: pooled over the plain materials, and by material."""

    plain: Errors | None
    by_material: dict[str, Errors]

    def beyond_bars(self) -> dict[str, Errors]:
        """Materials that miss their own bar."""
        return {name: e for name, e in self.by_material.items() if not e.within_bars(MATERIAL_MEDIAN_BAR)}


def relative_error(image: Array, truth: Array, generation: int) -> tuple[Array, Mask]:
    """Relative error (H, W) and where it is defined (truth > 1e-3).

    Blender 3: green; Blender 5: the worst of R, G, B; as the figures that the bars were taken from.
    """
    channels = [1] if generation == 3 else [0, 1, 2]
    bright = truth[..., channels].min(axis=-1) > 1e-3
    error = np.abs(image - truth)[..., channels] / np.where(bright[..., None], truth[..., channels], 1.0)
    # A NaN must fail every bar rather than vanish from a percentile.
    return np.nan_to_num(error.max(axis=-1), nan=np.inf), bright


def compare(
    image: Array, truth: Array, surface: Surface, lit: Array, materials: tuple[Material, ...], generation: int
) -> Comparison:
    """Over interior pixels with N·L > 0.05 (`lit` holds N·L, the least of all lights) and truth > 1e-3."""
    error, bright = relative_error(image, truth, generation)
    mask = surface.interior() & (lit > 0.05) & bright
    plain = np.isin(surface.material_id, [each.index for each in materials if each.kind == "plain"])
    by_material = {each.name: Errors.of(error[mask & (surface.material_id == each.index)]) for each in materials}
    return Comparison(Errors.of(error[mask & plain]), {name: errors for name, errors in by_material.items() if errors})


@dataclass(frozen=True)
class Edges:
    """Silhouettes of an antialiased image against the background: absolute errors, the worst of R, G, B.

    A firefly is brighter than the brightest truth of its 3×3 neighbourhood by a quarter and 0.02, a dark fringe darker
    than the darkest by the same. `fireflies` and `fringes` are counted at partly covered pixels and their neighbours,
    unless two objects meet there,
    `inner_fireflies` at borders of one object with another and at creases, where one mean normal stands for two
    surfaces; `worst` is the largest excess there, `mixed` the root mean square error where the normal is such a mean.
    """

    count: int
    median: float
    p99: float
    fireflies: int
    fringes: int
    inner_fireflies: int
    worst: float
    mixed: float


def _local(values: NDArray[np.generic], reduce: np.ufunc) -> NDArray[np.generic]:
    """Least or greatest of the 3×3 neighbourhood."""
    result = values
    for j in (-1, 0, 1):
        for i in (-1, 0, 1):
            result = reduce(result, np.roll(values, (j, i), axis=(0, 1)))
    return result


def compare_edges(image: Array, truth: Array, surface: Surface) -> Edges:
    """Figures of an antialiased comparison."""
    error = np.nan_to_num(np.abs(image - truth).max(axis=-1), nan=np.inf)
    edge = error[surface.silhouette()]
    covered = surface.coverage > 0.001
    near = _local(covered & (surface.coverage < 0.999), np.maximum) & covered & ~surface.border()
    above = np.nan_to_num((image - 1.25 * _local(truth, np.maximum) - 0.02).max(axis=-1), nan=np.inf)
    below = np.nan_to_num((0.75 * _local(truth, np.minimum) - 0.02 - image).max(axis=-1), nan=np.inf)
    inner = covered & ~near
    length = np.linalg.norm(surface.normal, axis=-1) / np.where(covered, surface.coverage, 1.0)
    mixed = (image - truth)[covered & (length < MIXED_LENGTH)]
    return Edges(
        count=edge.size,
        median=float(np.median(edge)),
        p99=float(np.percentile(edge, 99)),
        fireflies=int((near & (above > 0)).sum()),
        fringes=int((near & (below > 0)).sum()),
        inner_fireflies=int((inner & (above > 0)).sum()),
        worst=max(0.0, float(above[inner].max())),
        mixed=float(np.sqrt(np.nan_to_num(mixed**2, nan=np.inf).mean())),
    )


def relative_to(image: Array, double: Array, surface: Surface, lit: Array, bump_ids: tuple[int, ...]) -> Errors | None:
    """Relume against the double-precision reference: lit interior pixels, the worst channel over the brightest.

    Every material but the bump-mapped ones, for which the reference knows more than relume is told.
    """
    bright = double.max(axis=-1) > 1e-4
    mask = surface.interior() & (lit > 0.01) & bright & ~np.isin(surface.material_id, bump_ids)
    scale = double.max(axis=-1, keepdims=True)
    error = np.abs(image - double) / np.where(bright[..., None], scale, 1.0)
    return Errors.of(np.nan_to_num(error.max(axis=-1), nan=np.inf)[mask])
