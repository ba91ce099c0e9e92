# SPDX-License-Identifier: Apache-2.0
"""Truth files read with PyPI's OpenEXR, not with relume: what the proof stands on must not come from what it proves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import OpenEXR

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from numpy.typing import NDArray

    Array = NDArray[np.float64]

# What each quantity is called: Blender 3's and Blender 5's names for the passes, then the AOVs of the truth scenes.
_NAMES: dict[str, tuple[str, ...]] = {
    "normal": ("Normal.X", "Normal.Y", "Normal.Z"),
    "position": ("Position.X", "Position.Y", "Position.Z"),
    "albedo": ("albedo.R", "albedo.G", "albedo.B"),
    "coverage": ("albedo.A",),
    "smooth": ("geometric_normal.R", "geometric_normal.G", "geometric_normal.B"),
    "depth": ("Depth.Z",),
    "roughness": ("roughness.X",),
    "metallic": ("metallic.X",),
    "specular": ("specular.X", "specular_ior_level.X"),
    "emission": ("Emission.R", "Emission.G", "Emission.B"),
    "object_id": ("IndexOB.X", "Object Index.X"),
    "material_id": ("IndexMA.X", "Material Index.X"),
}

# Inputs of Blender 5's Principled BSDF alone, by the names of their AOVs.
_PRINCIPLED5: dict[str, tuple[str, ...]] = {
    name: tuple(f"{name}.{c}" for c in components)
    for components, names in (
        ("RGB", "specular_tint coat_tint sheen_tint tangent"),
        (
            "X",
            "ior diffuse_roughness anisotropic anisotropic_rotation coat_weight coat_roughness coat_ior sheen_weight "
            "sheen_roughness",
        ),
    )
    for name in names.split()
}


def read_channels(path: Path) -> dict[str, Array]:
    """Every channel of every part by its name without the layer prefix, (H, W) float64."""
    channels: dict[str, Array] = {}
    with OpenEXR.File(str(path), separate_channels=True) as file:
        for part in file.parts:
            for name, channel in part.channels.items():
                channels[name.removeprefix("ViewLayer.")] = np.asarray(channel.pixels, dtype=np.float64)
    return channels


def read_rgb(path: Path) -> Array:
    """R, G, B as (H, W, 3) float64."""
    channels = read_channels(path)
    return np.stack([channels[name] for name in "RGB"], axis=-1)


@dataclass(frozen=True)
class Surface:
    """A G-buffer as stored: vectors (H, W, 3), scalars (H, W), float64; IDs rounded to integers."""

    normal: Array
    position: Array
    albedo: Array
    coverage: Array
    depth: Array
    roughness: Array
    metallic: Array
    specular: Array
    smooth: Array | None  # the normal before the bump, where an AOV holds it
    emission: Array | None  # Cycles' pass: what is seen of it
    principled5: dict[str, Array]  # what else Blender 5's Principled BSDF takes, as far as AOVs hold it
    object_id: NDArray[np.int64]
    material_id: NDArray[np.int64]

    @classmethod
    def read(cls, path: Path) -> Surface:
        channels = read_channels(path)

        def take(name: str) -> Array | None:
            found = [channels[candidate] for candidate in _NAMES[name] if candidate in channels]
            if not found:
                if name in ("smooth", "emission"):
                    return None
                raise ValueError(f"{path}: none of the channels {', '.join(_NAMES[name])}")
            return np.stack(found, axis=-1) if len(found) == 3 else found[0]

        ids = {name: np.rint(take(name)).astype(np.int64) for name in ("object_id", "material_id")}
        more = {
            name: np.stack([channels[each] for each in wanted], axis=-1) if len(wanted) == 3 else channels[wanted[0]]
            for name, wanted in _PRINCIPLED5.items()
            if wanted[0] in channels
        }
        return cls(**{name: take(name) for name in _NAMES if name not in ids}, principled5=more, **ids)

    def uncovered(self) -> Surface:
        """Averaged channels divided by coverage and the normal made unit: for antialiased G-buffers."""
        coverage = np.where(self.coverage > 0, self.coverage, 1.0)
        length = np.linalg.norm(self.normal, axis=-1, keepdims=True)
        return Surface(
            normal=self.normal / np.where(length > 0, length, 1.0),
            position=self.position,
            albedo=self.albedo / coverage[..., None],
            coverage=self.coverage,
            depth=self.depth,
            roughness=self.roughness / coverage,
            metallic=self.metallic / coverage,
            specular=self.specular / coverage,
            smooth=None if self.smooth is None else self.smooth / coverage[..., None],
            emission=None if self.emission is None else self.emission / coverage[..., None],
            principled5={
                name: value / (coverage if value.ndim == 2 else coverage[..., None])
                for name, value in self.principled5.items()
            },
            object_id=self.object_id,
            material_id=self.material_id,
        )

    def interior(self) -> NDArray[np.bool_]:
        """Pixels that are one surface: the 3×3 neighbourhood is one fully covered object without a step in depth, and
        the stored normal, a mean over the pixel, is unit (the samples saw no crease). The frame's border is out.
        """
        inside = (self.coverage >= 0.999) & (self.object_id > 0)
        inside &= np.linalg.norm(self.normal, axis=-1) > 1 - 1e-5
        for j, i in _neighbours():
            inside &= _shifted(self.object_id, j, i) == self.object_id
            inside &= np.abs(_shifted(self.depth, j, i) - self.depth) <= 0.1 * self.depth
        return inside & self._framed()

    def silhouette(self) -> NDArray[np.bool_]:
        """Partly covered pixels of an antialiased G-buffer that hold one object in front of the background."""
        one = (self.coverage > 0.001) & (self.coverage < 0.999)
        for j, i in _neighbours():
            other = _shifted(self.object_id, j, i)
            one &= (other == self.object_id) | (other == 0) | (self.object_id == 0)
        return one & self._framed()

    def border(self) -> NDArray[np.bool_]:
        """Pixels whose 3×3 neighbourhood shows two objects."""
        here = self.object_id
        others = [_shifted(here, j, i) for j, i in _neighbours()]
        least = np.min([np.where(each > 0, each, np.iinfo(np.int64).max) for each in [here, *others]], axis=0)
        return np.max([here, *others], axis=0) > least

    def _framed(self) -> NDArray[np.bool_]:
        framed = np.zeros(self.depth.shape, dtype=bool)
        framed[1:-1, 1:-1] = True
        return framed


def _neighbours() -> Iterable[tuple[int, int]]:
    return ((j, i) for j in (-1, 0, 1) for i in (-1, 0, 1) if (j, i) != (0, 0))


def _shifted(array: NDArray[np.generic], j: int, i: int) -> NDArray[np.generic]:
    return np.roll(array, (j, i), axis=(0, 1))
