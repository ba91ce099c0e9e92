# SPDX-License-Identifier: Apache-2.0
"""Rigs that say to relume what the renderer was told: Blender's lamps, and the model that answers a variant."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence

    from truth_scenes import Scene

# Material variant -> models that are compared with it. The first must meet the bars; the others are reported.
MODELS = {
    (3, "principled"): ("blender_principled", "principled", "default_lit"),
    (3, "lambertggx"): ("cook_torrance",),
    (5, "principled"): ("blender_principled", "principled", "default_lit"),
    (5, "multiggx"): ("blender_principled",),
    (5, "lambertggx"): ("cook_torrance",),
}
EXACT = {"blender_principled", "cook_torrance"}


def _numbers(values: Sequence[float]) -> str:
    return "[" + ", ".join(repr(float(value)) for value in values) + "]"


def light_section(name: str, light: dict[str, Any], generation: int) -> str:
    """One [[light]] of a lamp as Blender describes it (energy in W or W/m², cone in radians)."""
    lines = [
        "[[light]]",
        f'name = "{name}"',
        f'type = "{light["type"].lower()}"',
        f"color = {_numbers(light['color'])}",
    ]
    if light["type"] == "SUN":
        lines += [f"direction = {_numbers(light['direction'])}", f"irradiance = {light['energy']!r}"]
    else:
        lines += [f"position = {_numbers(light['location'])}", f"power = {light['energy']!r}"]
    if light["type"] == "SPOT":
        falloff = "blender3" if generation == 3 else "smoothstep"
        lines += [
            f"direction = {_numbers(light['direction'])}",
            f"cone_angle = {math.degrees(light['spot_size_rad'])!r}",
            f"blend = {light['spot_blend']!r}",
            f'falloff = "{falloff}"',
        ]
    return "\n".join(lines) + "\n"


def shader_sections(scene: Scene, model: str, variant: str) -> str:
    """[[shader]] sections: plain Lambert for the Diffuse BSDFs where the model is to be exact, then the model."""
    sections = []
    if model in EXACT and scene.lambert_ids:
        sections.append(f'[[shader]]\nmaterial_id = {list(scene.lambert_ids)}\nuse = "lambert"\nemission = 0.0\n')
    main = f'[[shader]]\nuse = "{model}"\n'
    # The lambertggx images have no emission. blender_principled's generation is left to the G-buffer.
    if variant == "lambertggx" or not scene.emits:
        main += "emission = 0.0\n"
    if variant == "multiggx":
        main += 'distribution = "multi_ggx"\n'
    if model == "cook_torrance":
        masking = "smith_separable" if scene.generation == 3 else "smith_correlated"
        main += f'distribution = "ggx"\nmasking = "{masking}"\nfresnel = "none"\n'
    return "\n".join([*sections, main])


def rig(scene: Scene, lights: Sequence[str], model: str, variant: str) -> str:
    """The rig's text."""
    parts = ["version = 1\n"]
    parts += [light_section(name, scene.lights[name], scene.generation) for name in lights]
    parts += [shader_sections(scene, model, variant), '[output]\ntype = "float"\n']
    return "\n".join(parts)


def committed(scene: Scene) -> tuple[Path, str]:
    """The rig that lies beside this file for a reader to try, and its text: all lights, the renderer's own model."""
    model = MODELS[scene.generation, "principled"][0]
    gbuffer = scene.gbuffers["main", "point"]
    file = f"../data/{gbuffer.parent.name}/{gbuffer.name}"
    text = rig(scene, list(scene.lights), model, "principled")
    comment = f"# {scene.name} under its three lamps, as Blender {scene.generation} lit it. Made by rigs.py.\n"
    return Path(__file__).parent / f"{scene.name}.relume", comment + text.replace(
        "version = 1\n", f'version = 1\n\n[gbuffer]\nfile = "{file}"\n', 1
    )
