# SPDX-License-Identifier: Apache-2.0
"""A scene as a rig: its lights, the shading model with what the user set of it, [output], and more from a text."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import bpy

from .linking import pattern
from .properties import given, output_rows, shader_rows
from .scene_lights import SceneLights, scene_lights
from .surface import UnwiredError, read_material

if TYPE_CHECKING:
    from collections.abc import Callable

    import relume

    from .lights import RigLight

#: Custom property of a loaded rig's text: the names of all lights of the file.
ORDER = "relume_order"

#: Blender's word for how a BSDF's facets are distributed -> the model's option.
_DISTRIBUTIONS = {"GGX": "ggx", "MULTI_GGX": "multi_ggx"}


@dataclass
class SceneRig:
    """A rig, and what of the scene's lights is in it."""

    rig: relume.Rig
    lights: SceneLights


def distributions() -> dict[str, list[str]]:
    """Materials by the distribution of their facets, the more frequent one first."""
    found: dict[str, list[str]] = {"multi_ggx": [], "ggx": []}
    for material in bpy.data.materials:
        if not material.users or material.is_grease_pencil:
            continue
        try:
            of_material = read_material(material).distributions
        except UnwiredError:
            continue
        for word in sorted(of_material)[:1]:
            found[_DISTRIBUTIONS[word]].append(material.name)
    return dict(sorted(found.items(), key=lambda item: -len(item[1])))


def base_rig(scene: bpy.types.Scene) -> relume.Rig:
    """The rig without the scene's lights: from the text that the user has added, the model and [output]."""
    import relume

    settings = scene.relume
    text = settings.rig_extra
    rig = relume.Rig.loads(text.as_string(), f"Text '{text.name}'") if text is not None else relume.Rig()
    if not len(rig.shader):
        _add_shaders(
            rig, settings.shader, given(getattr(settings.shaders, settings.shader), shader_rows(settings.shader))
        )
    for name, value in given(settings.output, output_rows()).items():
        setattr(rig.output, name, value)
    if len(scene.view_layers) > 1 and rig.gbuffer.part is None:
        rig.gbuffer.part = bpy.context.view_layer.name
    return rig


def _add_shaders(rig: relume.Rig, model: str, keys: dict[str, Any]) -> None:
    """One [[shader]] for all, or one for each distribution of facets where the materials have both."""
    if model == "blender_principled" and "distribution" not in keys:
        (main, _), (other, names) = distributions().items()
        if names:
            rig.shader.add(model, cryptomatte=[pattern(name, "material") for name in names], distribution=other, **keys)
        keys = keys | {"distribution": main}
    rig.shader.add(model, **keys)


def add_lights(rig: relume.Rig, lights: list[RigLight], order: list[str]) -> None:
    """Add lights to a rig; those of its own with the same name give way.

    Args:
        rig: takes them.
        lights: of the scene.
        order: of a rig file's lights by name, which stand as they stood there (sums round by their order); the others
            follow.
    """
    all_of_them = {
        light.name: (light.type, {key: getattr(light, key) for key in light._given()}) for light in rig.light.values()
    }
    for light in lights:
        all_of_them.pop(rig_name(light.name), None)
        all_of_them[rig_name(light.name)] = (light.type, light.keys)
    for name in list(rig.light):
        del rig.light[name]
    places = {name: place for place, name in enumerate(order)}
    for name in sorted(all_of_them, key=lambda name: places.get(name, len(places))):
        kind, keys = all_of_them[name]
        rig.light.add(name, kind, **keys)


def order_of_lights(scene: bpy.types.Scene) -> list[str]:
    """Names of the lights of the rig file that was loaded, in its order."""
    text = scene.relume.rig_extra
    return list(text.get(ORDER, ())) if text is not None else []


def rig_name(name: str) -> str:
    """A name as a rig can have it: a key has no way to say both kinds of quotes."""
    return name.replace('"', "'") if '"' in name and "'" in name else name


def scene_rig(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> SceneRig:
    """The rig of a scene as it stands now."""
    lights = scene_lights(scene, depsgraph)
    rig = base_rig(scene)
    add_lights(rig, lights.lights, order_of_lights(scene))
    return SceneRig(rig, lights)


def animated_rig(scene: bpy.types.Scene, depsgraph_of: Callable[[], bpy.types.Depsgraph], frames: range) -> SceneRig:
    """The rig of a frame range: what changes over it is keyed. The scene is at its own frame again afterwards."""
    import relume

    before = scene.frame_current
    taken: list[tuple[int, SceneLights]] = []
    try:
        for frame in frames:
            scene.frame_set(frame)
            taken.append((frame, scene_lights(scene, depsgraph_of())))
    finally:
        scene.frame_set(before)
    names = dict.fromkeys(light.name for _, lights in taken for light in lights.lights)
    result = SceneLights(left_out=list(dict.fromkeys(pair for _, lights in taken for pair in lights.left_out)))
    for name in names:
        at = {frame: light for frame, lights in taken for light in lights.lights if light.name == name}
        first = next(iter(at.values()))
        if any(light.read != first.read for light in at.values()):
            # What a rig file said of it may be another set of keys, which hold in some frames alone.
            for light in at.values():
                light.keys = light.read
        defaults = {row.name: row.default for row in relume.light_types[first.type].parameters}
        for key in dict.fromkeys(key for light in at.values() for key in light.keys):
            values = [(frame, light.keys.get(key, defaults[key])) for frame, light in at.items()]
            if all(value == values[0][1] for _, value in values):
                continue
            if all(_is_number(value) for _, value in values):
                first.keys[key] = relume.Keys(tuple(values))
            else:
                first.notes.append(f"its {key} changes over the frames; the rig has that of the first")
        if len(at) < len(taken):  # a rig cannot switch a light on and off, but it can have no color
            color = first.keys["color"]
            of = dict(color.keys) if isinstance(color, relume.Keys) else dict.fromkeys(at, color)
            keys = tuple((frame, of.get(frame, (0.0, 0.0, 0.0))) for frame, _ in taken)
            first.keys["color"] = relume.Keys(keys, "hold")
        result.lights.append(first)
    rig = base_rig(scene)
    add_lights(rig, result.lights, order_of_lights(scene))
    return SceneRig(rig, result)


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) or (isinstance(value, tuple) and len(value) == 3)


def source_file(scene: bpy.types.Scene) -> Path:
    """The multilayer EXR on disk, #### for the frame: as the user says, else where the scene's renders go."""
    path = scene.relume.filepath
    if path:
        return Path(bpy.path.abspath(path))
    render = scene.render
    path = bpy.path.abspath(render.filepath)
    if "#" not in Path(path).name:
        path += "####"  # as Blender does
    return Path(path if not render.use_file_extension or path.endswith(".exr") else f"{path}.exr")
