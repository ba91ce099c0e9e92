# SPDX-License-Identifier: Apache-2.0
"""A Blender light as a light of a rig: the same irradiance at every point, as Cycles defines it.

    sun     E = strength · color, along the object's −Z
    point   E = power · color / (4π d²); with soft falloff and a radius r / (4π (d² + r²))
    area    radiance L = power · color / (π A) on the side of −Z, A the light's area
    spot    point's, times smoothstep((c − cos(size/2)) / ((1 − cos(size/2)) · blend)), c the cosine from −Z

Each is multiplied by 2^exposure, by the color of its temperature, and by the Emission node of its node tree where that
holds constants. What a rig cannot say, and what the core does not shade yet, is left out with a reason.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from .linking import LeftOutError, light_linking
from .loaded_keys import recalled
from .surface import source_of

if TYPE_CHECKING:
    import bpy
    from mathutils import Matrix

#: Blender's type -> the rig's. A lamp's area is a type of its own in a rig, by its shape.
_TYPES = {"SUN": "sun", "POINT": "point", "SPOT": "spot"}
#: Shape of an area light -> the rig's type.
_SHAPES = {"SQUARE": "rect", "RECTANGLE": "rect", "DISK": "disk"}


@dataclass
class RigLight:
    """A light of a rig before there is a rig: name, type, and its keys as the rig file has them."""

    name: str
    type: str
    keys: dict[str, Any]
    #: What is approximated, in words for the user.
    notes: list[str] = field(default_factory=list)
    #: Its keys by Blender's numbers alone: the same ones in every frame.
    read: dict[str, Any] = field(default_factory=dict)


def _factors(light: bpy.types.Light) -> tuple[float, float, float]:
    """Color times temperature times what its nodes multiply: everything but energy and exposure."""
    color = tuple(light.color)
    if light.use_temperature:
        color = tuple(a * b for a, b in zip(color, light.temperature_color, strict=True))
    if light.use_nodes and light.node_tree is not None:
        color = tuple(a * b for a, b in zip(color, _emission(light.node_tree), strict=True))
    return color  # type: ignore[return-value]


def _emission(tree: bpy.types.NodeTree) -> tuple[float, ...]:
    """What a light's nodes multiply its strength by."""
    output = tree.get_output_node("CYCLES")
    if output is None:
        raise LeftOutError("its nodes emit nothing")
    source = source_of(output.inputs["Surface"])
    if source is None:
        raise LeftOutError("its nodes emit nothing")
    node = source.node
    if node.bl_idname != "ShaderNodeEmission":
        raise LeftOutError(f"its nodes end in '{node.bl_label}'; relume reads an Emission node with constants")
    if any(source_of(node.inputs[name]) is not None for name in ("Color", "Strength")):
        raise LeftOutError("its Emission node is driven by other nodes; relume reads constants")
    strength = node.inputs["Strength"].default_value
    return tuple(channel * strength for channel in node.inputs["Color"].default_value[:3])


def _unit(vector: Any) -> tuple[float, float, float]:
    return tuple(vector.normalized())


def _point_keys(light: bpy.types.Light, matrix: Matrix, notes: list[str]) -> dict[str, Any]:
    power, radius = light.energy, light.shadow_soft_size
    if not light.normalize:
        # Cycles then takes the energy for each unit of a sphere's area, and 4 for one without any.
        power *= 4 * math.pi * radius * radius if radius > 0 else 4.0
    keys: dict[str, Any] = {"position": tuple(matrix.translation), "power": power}
    if radius > 0:
        notes.append(f"its radius of {radius:.3g} widens no highlight and softens no edge")
        if light.use_soft_falloff:
            # A disk that faces what it lights: irradiance 1/(d² + r²). A sphere of even radiance has exactly 1/d².
            keys["attenuation"] = [radius * radius, 0.0, 1.0]
    return keys


def _spot_keys(light: bpy.types.Light, matrix: Matrix, notes: list[str]) -> dict[str, Any]:
    scale = matrix.to_scale()
    if max(scale) - min(scale) > 1e-4 * max(map(abs, scale)):
        notes.append("its cone is stretched by its scale; the rig's is round")
    return _point_keys(light, matrix, notes) | {
        "direction": _unit(-matrix.col[2].to_3d()),
        "cone_angle": min(math.degrees(light.spot_size), 180.0),  # single precision's π is more than 180°
        "blend": light.spot_blend,
        "falloff": "smoothstep",
    }


def _sun_keys(light: bpy.types.Light, matrix: Matrix, notes: list[str]) -> dict[str, Any]:
    strength = light.energy
    if not light.normalize and light.angle > 0:
        strength *= math.pi * math.sin(light.angle / 2) ** 2
    if light.angle > math.radians(1):
        notes.append(f"shaded without its angle of {math.degrees(light.angle):.3g}°")
    return {"direction": _unit(-matrix.col[2].to_3d()), "irradiance": strength}


def area_keys(light: bpy.types.Light, matrix: Matrix, notes: list[str]) -> dict[str, Any]:
    """Keys of an area light, by its shape.

    Raises:
        LeftOutError: an ellipse, which no rig has, or a beam.
    """
    if light.shape not in _SHAPES:
        raise LeftOutError(f"an area light of shape {light.shape.lower()}; a rig has rectangles and disks")
    if light.spread < math.pi - 1e-3:
        raise LeftOutError(f"an area light with a spread of {math.degrees(light.spread):.3g}°; a rig has 180°")
    scale = [abs(factor) for factor in matrix.to_scale()]
    size = (light.size * scale[0], (light.size_y if light.shape == "RECTANGLE" else light.size) * scale[1])
    area = size[0] * size[1] * (1.0 if _SHAPES[light.shape] == "rect" else math.pi / 4)
    if area <= 0:
        raise LeftOutError("an area light without area")
    keys: dict[str, Any] = {
        "position": tuple(matrix.translation),
        "direction": _unit(-matrix.col[2].to_3d()),
        "radiance": light.energy / math.pi / (area if light.normalize else 1.0),
    }
    if _SHAPES[light.shape] == "rect":
        return keys | {"up": _unit(matrix.col[1].to_3d()), "size": list(size)}
    if abs(size[0] - size[1]) > 1e-4 * size[0]:
        raise LeftOutError("a disk that its scale makes an ellipse; a rig's is round")
    return keys | {"radius": size[0] / 2}


_KEYS = {"SUN": _sun_keys, "POINT": _point_keys, "SPOT": _spot_keys, "AREA": area_keys}


def _type_of(light: bpy.types.Light, keys: dict[str, Any]) -> str:
    """The rig's type of a light.

    Raises:
        LeftOutError: the core does not shade it yet.
    """
    import relume

    name = _TYPES.get(light.type) or _SHAPES[light.shape]
    known = {row.name for row in relume.light_types[name].parameters} if name in relume.light_types else set()
    if not set(keys) <= known:
        raise LeftOutError(f"a light of type {light.type.lower()}; relume does not shade these yet")
    return name


def rig_light(thing: bpy.types.Object, matrix: Matrix, name: str) -> RigLight:
    """A light object as a light of a rig.

    Args:
        thing: the object, evaluated.
        matrix: where it stands; an instance stands elsewhere than its object.
        name: what the rig calls it.

    Raises:
        LeftOutError: a rig cannot hold it, or the core does not shade its type yet.
    """
    light = thing.data
    notes: list[str] = []
    color = _factors(light)
    if min(color) < 0 or light.energy < 0:
        raise LeftOutError("it takes light away (a negative color or power)")
    keys = _KEYS[light.type](light, matrix, notes)
    name_of_type = _type_of(light, keys)
    keys["color"] = color
    keys["exposure"] = light.exposure
    for key, seen in (("diffuse", thing.visible_diffuse), ("specular", thing.visible_glossy)):
        share = getattr(light.relume, key, 1.0) if hasattr(light, "relume") else 1.0
        if not seen or share != 1:
            keys[key] = share if seen else 0.0
    linking = light_linking(thing)
    if linking.include:
        keys["include"] = list(linking.include)
    if linking.exclude:
        keys["exclude"] = list(linking.exclude)
    return RigLight(name, name_of_type, recalled(thing, keys), notes, keys)
