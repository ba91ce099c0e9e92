# SPDX-License-Identifier: Apache-2.0
"""A rig's lights as lights of the scene: what lights.py does, backwards. The rest of the rig stays in a text."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import bpy
from mathutils import Matrix, Vector

from .load_keys import Track, animate, keyed, tracks
from .loaded_keys import remember
from .scene_rig import ORDER

if TYPE_CHECKING:
    from pathlib import Path

    import relume
    from relume.rig import Light

_TYPES = {"sun": "SUN", "point": "POINT", "spot": "SPOT"}


@dataclass
class LoadedRig:
    """What became of a rig."""

    made: list[bpy.types.Object] = field(default_factory=list)
    #: (light, why) of what stays in the text.
    kept: list[tuple[str, str]] = field(default_factory=list)


class _StaysError(Exception):
    """A light that Blender has no light for; the message is the reason."""


def load_rig(scene: bpy.types.Scene, path: Path) -> LoadedRig:
    """Make light objects of a rig's lights, in a collection of the file's name.

    Raises:
        relume.Error: the file is no rig; the scene is as before.
    """
    import relume

    rig = relume.Rig.load(path)
    rest, result = rig.copy(), LoadedRig()
    settings: list[tuple[str, str, dict[str, Any], Matrix, list[Track]]] = []
    now = rig.at(scene.frame_current)
    for name in rig.light:
        try:
            settings.append((name, *_blender_light(now.light[name]), tracks(rig, name, _blender_light)))
            del rest.light[name]
        except _StaysError as reason:
            result.kept.append((name, str(reason)))
    collection = bpy.data.collections.new(path.stem)
    scene.collection.children.link(collection)
    for name, kind, keys, matrix, moving in settings:
        light = bpy.data.lights.new(name, kind)
        for key, value in keys.items():
            owner = light.relume if hasattr(light.relume, key) else light
            setattr(owner, key, value)
        thing = bpy.data.objects.new(name, light)
        thing.hide_render = not rig.light[name].enabled
        thing.matrix_world = matrix
        collection.objects.link(thing)
        animate(thing, moving, scene.frame_current)
        result.made.append(thing)
    _remember({name: thing for (name, *_), thing in zip(settings, result.made, strict=True)}, rig)
    _keep(scene, path, rest, list(rig.light))
    return result


def _remember(made: dict[str, bpy.types.Object], rig: relume.Rig) -> None:
    """Have lights that nobody touches shade by the rig's own numbers."""
    from .lights import rig_light

    bpy.context.view_layer.update()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    for name, thing in made.items():
        evaluated = thing.evaluated_get(depsgraph)
        light = rig.light[name]
        given = {key: getattr(light, key) for key in light._given()}
        remember(thing, given, rig_light(evaluated, evaluated.matrix_world, name).keys, set(keyed(light)))


def _keep(scene: bpy.types.Scene, path: Path, rest: relume.Rig, order: list[str]) -> None:
    """The rig without what became lights, as a text that joins the scene's rig."""
    rest.gbuffer.file = None
    text = bpy.data.texts.new(path.name)
    text.write(str(rest))
    text[ORDER] = order
    scene.relume.rig_extra = text


def _blender_light(light: Light) -> tuple[str, dict[str, Any], Matrix]:
    """Type, properties and matrix of the light object."""
    if light.type not in _TYPES:
        raise _StaysError(f"Blender has no light like '{light.type}'")
    if light.space == "camera":
        raise _StaysError("it stands in the camera's space")
    values = {row.name: getattr(light, row.name) for row in light.parameters}
    if values["include"] or values["exclude"]:
        raise _StaysError("its light linking is by Cryptomatte patterns")
    if values["transmission"] != 1:
        raise _StaysError("it has a share of transmission of its own")
    keys: dict[str, Any] = {key: values[key] for key in ("exposure", "diffuse", "specular")}
    matrix = Matrix()
    if "direction" in values:
        matrix = Vector(values["direction"]).to_track_quat("-Z", "Y").to_matrix().to_4x4()
    if light.type == "sun":
        strength, keys["angle"] = values["irradiance"], math.radians(values["angle"])
    else:
        strength = _power(values)
        matrix = Matrix.Translation(values["position"]) @ matrix
        keys["shadow_soft_size"], keys["use_soft_falloff"] = _radius(values), bool(values["attenuation"])
    if light.type == "spot":
        if values["falloff"] != "smoothstep":
            raise _StaysError(f"this Blender's spot lights have no falloff '{values['falloff']}'")
        keys["spot_size"], keys["spot_blend"] = math.radians(values["cone_angle"]), values["blend"]
    # Blender has one number for the strength, and a color.
    color = [a * b for a, b in zip(values["color"], strength, strict=True)]
    keys["energy"] = max(color) or 0.0
    keys["color"] = [channel / keys["energy"] for channel in color] if keys["energy"] else (1.0, 1.0, 1.0)
    return _TYPES[light.type], keys, matrix


def _power(values: dict[str, Any]) -> tuple[float, ...]:
    power = values["power"]
    if power is None:
        return tuple(4 * math.pi * channel for channel in values["intensity"])
    return tuple(power) if isinstance(power, tuple) else (power,) * 3


def _radius(values: dict[str, Any]) -> float:
    attenuation = values["attenuation"]
    if not attenuation:
        return float(values["radius"])
    constant, linear, square = attenuation
    if linear != 0 or square != 1:
        raise _StaysError("its attenuation is not one of a lamp")
    return math.sqrt(constant)
