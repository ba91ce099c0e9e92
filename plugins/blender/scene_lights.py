# SPDX-License-Identifier: Apache-2.0
"""The lights of a scene, those of instances too, as lights of a rig; and what is left out, by name, with the reason."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from .lights import RigLight, rig_light
from .linking import LeftOutError
from .surface import has_nodes

if TYPE_CHECKING:
    from collections.abc import Iterator

    import bpy
    from mathutils import Matrix


@dataclass
class SceneLights:
    """What a rig takes of a scene's lights."""

    lights: list[RigLight] = field(default_factory=list)
    #: (name, why) of what no rig has yet.
    left_out: list[tuple[str, str]] = field(default_factory=list)

    @property
    def notes(self) -> list[tuple[str, str]]:
        """(name, what is approximated)."""
        return [(light.name, note) for light in self.lights for note in light.notes]


def _is_rendered(thing: bpy.types.Object) -> bool:
    return not thing.hide_render and any(not collection.hide_render for collection in thing.users_collection)


def _is_portal(light: bpy.types.Light) -> bool:
    """Whether it only guides Cycles' samples to the world's light."""
    return light.type == "AREA" and light.cycles.is_portal


def _placed_lights(
    view_layer: bpy.types.ViewLayer, depsgraph: bpy.types.Depsgraph
) -> Iterator[tuple[bpy.types.Object, Matrix, str]]:
    """(evaluated object, matrix, name) of every light that a render would have."""
    for thing in view_layer.objects:
        if thing.type == "LIGHT" and _is_rendered(thing) and not _is_portal(thing.data):
            evaluated = thing.evaluated_get(depsgraph)
            yield evaluated, evaluated.matrix_world, thing.name
    counts: dict[str, int] = {}
    for instance in depsgraph.object_instances:
        if instance.is_instance and instance.object.type == "LIGHT" and _is_rendered(instance.parent.original):
            name = instance.object.name
            counts[name] = counts.get(name, 0) + 1
            yield instance.object, instance.matrix_world.copy(), f"{instance.parent.name}/{name}/{counts[name]}"


def scene_lights(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> SceneLights:
    """The lights of the scene's view layer that the depsgraph is of, as they stand now."""
    result = SceneLights()
    for thing, matrix, name in _placed_lights(depsgraph.view_layer, depsgraph):
        try:
            result.lights.append(rig_light(thing, matrix, name))
        except LeftOutError as error:
            result.left_out.append((name, str(error)))
    exposure = _film_exposure(scene)
    for light in result.lights:
        for keys in (light.keys, light.read):
            keys["exposure"] = keys.get("exposure", 0.0) + exposure
    reason = _world_light(scene.world)
    if reason:
        result.left_out.append((scene.world.name, reason))
    return result


def _film_exposure(scene: bpy.types.Scene) -> float:
    """Stops by which Cycles' film makes every light brighter."""
    return math.log2(scene.cycles.film_exposure) if scene.render.engine == "CYCLES" else 0.0


def _world_light(world: bpy.types.World | None) -> str:
    """Why the world's light is left out; empty where it is black."""
    if world is None:
        return ""
    if not has_nodes(world):
        lit = max(world.color) > 0
    else:
        output = world.node_tree.get_output_node("CYCLES")
        if output is None or not output.inputs["Surface"].is_linked:
            return ""
        node = output.inputs["Surface"].links[0].from_node
        lit = node.bl_idname != "ShaderNodeBackground" or not _is_black(node)
    return "the world's light; relume does not shade these yet" if lit else ""


def _is_black(background: bpy.types.Node) -> bool:
    color, strength = background.inputs["Color"], background.inputs["Strength"]
    return (not color.is_linked and max(color.default_value[:3]) <= 0) or (
        not strength.is_linked and strength.default_value <= 0
    )
