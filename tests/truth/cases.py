# SPDX-License-Identifier: Apache-2.0
"""One comparison: a rig is written, the real command line relights the G-buffer, the result is measured."""

from __future__ import annotations

import functools
import subprocess
import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import reference
from exr_files import Surface, read_channels, read_rgb
from measure import Comparison, Edges, Errors, compare, compare_edges, relative_to
from rigs import EXACT, MODELS, rig

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from numpy.typing import NDArray
    from truth_scenes import Scene

    Array = NDArray[np.float64]


def _reference_model(case: Case) -> reference.Model | None:
    if case.model == "cook_torrance":
        return "lambertggx"
    if case.model != "blender_principled":
        return None
    if case.scene.generation == 3:
        return "blender3"
    return "blender5_multi_ggx" if case.variant == "multiggx" else "blender5"


@dataclass(frozen=True)
class Case:
    """Which image is compared: a scene's camera and filter, the lights (several: the sum of their images), a model."""

    scene: Scene
    camera: str
    kind: str
    lights: tuple[str, ...]
    variant: str
    model: str

    @property
    def name(self) -> str:
        return "-".join([self.scene.name, self.camera, self.kind, "+".join(self.lights), self.variant, self.model])

    @property
    def exact(self) -> bool:
        """The model is the renderer's own, so the bars hold."""
        return self.model in EXACT

    @property
    def every_material(self) -> bool:
        """The model is the renderer's to the last material, those with bump too, and each has to meet the bar."""
        return self.model == "blender_principled" and self.scene.generation == 5 and len(self.lights) == 1


@dataclass(frozen=True)
class Result:
    """Relume against the renderer; against the double-precision reference; the reference against the renderer."""

    case: Case
    image: Array
    truth: Array
    surface: Surface
    renderer: Comparison
    edges: Edges | None
    double: Errors | None
    floor: Comparison | None


def cases(scene: Scene, *, exact_only: bool = False) -> Iterable[Case]:
    """Everything that can be compared in a scene: each light alone, and all of them."""
    views = dict.fromkeys((camera, kind, variant) for camera, kind, _, variant in scene.images)
    for camera, kind, variant in views:
        lights = scene.lights_of(camera, kind, variant)
        sets = [(light,) for light in lights] + ([tuple(lights)] if len(lights) > 1 else [])
        for model in MODELS[scene.generation, variant]:
            if model in EXACT or not (exact_only or kind == "aa"):
                yield from (Case(scene, camera, kind, chosen, variant, model) for chosen in sets)


def relight(gbuffer: Path, rig_text: str, folder: Path, name: str) -> Array:
    """Run `relume relight`; RGB of its output, (H, W, 3)."""
    rig_file, output = folder / f"{name}.relume", folder / f"{name}.exr"
    rig_file.write_text(rig_text, encoding="utf-8")
    command = [sys.executable, "-m", "relume.cli", "relight", str(gbuffer), "--rig", str(rig_file), "-o", str(output)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(command)}\nended with {done.returncode}\n{done.stdout}{done.stderr}")
    channels = read_channels(output)
    prefix = "" if "R" in channels else "Combined."
    return np.stack([channels[prefix + name] for name in "RGB"], axis=-1)


@functools.lru_cache(maxsize=2)
def _surface(path: Path) -> Surface:
    return Surface.read(path)


def _reference(case: Case, surface: Surface) -> tuple[Array | None, Array]:
    """The double-precision image, None where the reference lacks the model; and the least N·L of all lights."""
    scene = case.scene
    model = _reference_model(case)
    seen = surface.uncovered() if case.kind == "aa" else surface
    total, least = np.zeros(surface.normal.shape), np.full(surface.depth.shape, np.inf)
    for name in case.lights:
        image, lit = reference.shade(
            seen,
            np.asarray(scene.eyes[case.camera]),
            scene.lights[name],
            model or "lambert",
            generation=scene.generation,
            lambert_ids=scene.lambert_ids,
            bump_ids=scene.bump_ids,
        )
        total += image
        least = np.minimum(least, lit)
    if scene.emits and case.variant != "lambertggx" and seen.emission is not None:
        total += seen.emission
    if case.kind == "aa":
        total *= surface.coverage[..., None]
    return (total if model else None), least


def _truth(case: Case) -> Array:
    """The sum of the lights' images, emission, which each of them holds, counted once."""
    scene = case.scene
    files = [scene.images[case.camera, case.kind, light, case.variant] for light in case.lights]
    total: Array = np.sum([read_rgb(file) for file in files], axis=0)
    emission = _surface(scene.gbuffers[case.camera, case.kind]).emission
    if scene.emits and case.variant != "lambertggx" and emission is not None:
        total -= (len(files) - 1) * emission
    return total


def measure_reference(case: Case) -> Comparison:
    """The double-precision reference against the renderer: what no shader can do better from these files."""
    surface = _surface(case.scene.gbuffers[case.camera, case.kind])
    double, least = _reference(case, surface)
    if double is None:
        raise ValueError(f"{case.name}: the reference has no such model")
    return compare(double, _truth(case), surface, least, case.scene.materials, case.scene.generation)


def run(case: Case, folder: Path) -> Result:
    """Relight and measure. Errors: RuntimeError with the command line's own words when it fails."""
    scene = case.scene
    gbuffer = scene.gbuffers[case.camera, case.kind]
    image = relight(gbuffer, rig(scene, case.lights, case.model, case.variant), folder, case.name)
    truth, surface = _truth(case), _surface(gbuffer)
    double, least = _reference(case, surface)
    return Result(
        case=case,
        image=image,
        truth=truth,
        surface=surface,
        renderer=compare(image, truth, surface, least, scene.materials, scene.generation),
        edges=compare_edges(image, truth, surface) if case.kind == "aa" else None,
        double=None if double is None else relative_to(image, double, surface, least, scene.bump_ids),
        floor=None if double is None else measure_reference(case),
    )
