# SPDX-License-Identifier: Apache-2.0
"""Keys of a rig's lights as keyframes.

Where a property of Blender is a key of the rig times a number, it gets the rig's own keys with their interpolation.
Where several keys are in it (a strength and a color), or turning is not linear (a direction), it gets one key for each
whole frame.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

    import bpy
    import relume
    from mathutils import Matrix
    from relume.rig import Light

    #: Type, properties and matrix of the light object that a rig's light becomes.
    Converted = tuple[str, dict[str, Any], Matrix]

#: The rig's interpolation -> Blender's.
_INTERPOLATIONS = {"linear": "LINEAR", "hold": "CONSTANT", "smooth": "BEZIER"}

#: Property -> the rig's keys that it comes from, and those of them of which it is a multiple.
_SOURCES: dict[str, tuple[set[str], set[str]]] = {
    "location": ({"position"}, {"position"}),
    "rotation_quaternion": ({"direction"}, set()),
    "energy": ({"power", "intensity", "irradiance", "color"}, {"power"}),
    "color": ({"intensity", "irradiance", "color"}, set()),
    "exposure": ({"exposure"}, {"exposure"}),
    "spot_size": ({"cone_angle"}, {"cone_angle"}),
    "spot_blend": ({"blend"}, {"blend"}),
    "angle": ({"angle"}, {"angle"}),
    "shadow_soft_size": ({"radius", "attenuation"}, set()),
    "diffuse": ({"diffuse"}, {"diffuse"}),
    "specular": ({"specular"}, {"specular"}),
}


@dataclass
class Track:
    """The keys of one property."""

    name: str
    interpolation: str
    #: (frame, value)
    points: list[tuple[float, Any]]


def keyed(light: Light) -> dict[str, relume.Keys]:
    """What of a light is keyed."""
    import relume

    given = {key: getattr(light, key) for key in light._given()}
    return {key: value for key, value in given.items() if isinstance(value, relume.Keys)}


def tracks(rig: relume.Rig, name: str, convert: Callable[[Light], Converted]) -> list[Track]:
    """Keys of each property of a light object.

    Args:
        rig: has the light.
        name: of the light.
        convert: what a light without keys becomes; what it raises for a frame comes out here.
    """
    keys, result = keyed(rig.light[name]), []

    def value(prop: str, frame: float) -> Any:
        _, settings, matrix = convert(rig.at(frame).light[name])
        if prop == "location":
            return tuple(matrix.translation)
        return tuple(matrix.to_quaternion()) if prop == "rotation_quaternion" else settings.get(prop)

    for prop, (sources, linear) in _SOURCES.items():
        moving = [key for key in keys if key in sources]
        if not moving:
            continue
        frames = sorted({float(frame) for key in moving for frame, _ in keys[key].keys})
        interpolation = keys[moving[0]].interpolation
        if len(moving) > 1 or not set(moving) <= linear:
            interpolation = "linear"
            frames = [float(frame) for frame in range(math.floor(frames[0]), math.ceil(frames[-1]) + 1)]
        points = [(frame, value(prop, frame)) for frame in frames]
        if points[0][1] is not None:  # a sun has no cone
            result.append(Track(prop, interpolation, points))
    return result


def _owner(thing: bpy.types.Object, name: str) -> Any:
    """Who has a property: the object, its light, or what relume adds to that."""
    return next(owner for owner in (thing.data.relume, thing.data, thing) if hasattr(owner, name))


def animate(thing: bpy.types.Object, made: list[Track], frame: int) -> None:
    """Give a light object its keyframes; it then is as it is at `frame`."""
    for track in made:
        owner = thing if track.name in ("location", "rotation_quaternion") else _owner(thing, track.name)
        if track.name == "rotation_quaternion":
            thing.rotation_mode = "QUATERNION"
        for at, value in track.points:
            setattr(owner, track.name, value)
            owner.keyframe_insert(track.name, frame=at)
        path = owner.path_from_id(track.name) if owner == getattr(thing.data, "relume", None) else track.name
        for curve in _curves(owner.id_data, path):
            _interpolate(curve, track.interpolation)
            index = curve.array_index
            now = curve.evaluate(frame)
            if hasattr(getattr(owner, track.name), "__len__"):
                getattr(owner, track.name)[index] = now
            else:
                setattr(owner, track.name, now)


def _curves(owner: bpy.types.ID, path: str) -> list[Any]:
    data = owner.animation_data
    bags = [strip.channelbag(data.action_slot) for layer in data.action.layers for strip in layer.strips]
    return [curve for bag in bags if bag is not None for curve in bag.fcurves if curve.data_path == path]


def _interpolate(curve: bpy.types.FCurve, interpolation: str) -> None:
    points = curve.keyframe_points
    for place, point in enumerate(points):
        point.interpolation = _INTERPOLATIONS[interpolation]
        if interpolation != "smooth":
            continue
        # With level handles a third of the way long, the curve is t²(3 − 2t).
        frame, value = point.co
        before = points[place - 1].co[0] if place > 0 else frame - 3
        after = points[place + 1].co[0] if place + 1 < len(points) else frame + 3
        point.handle_left_type = point.handle_right_type = "FREE"
        point.handle_left = frame - (frame - before) / 3, value
        point.handle_right = frame + (after - frame) / 3, value
    curve.update()
