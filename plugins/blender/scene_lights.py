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


def _hidden_collections(layer: bpy.types.LayerCollection, hidden: bool = False) -> Iterator[bpy.types.Collection]:
    """The collections of a view layer that no render has; one that is hidden hides those inside."""
    hidden = hidden or layer.collection.hide_render
    if hidden:
        yield layer.collection
    for child in layer.children:
        yield from _hidden_collections(child, hidden)


def _matrix(thing: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> Matrix:
    """Where an object stands. Of one that viewports do not show Blender keeps no account: a parent is followed."""
    evaluated = thing.evaluated_get(depsgraph)
    if evaluated.is_evaluated or thing.constraints or thing.parent_type != "OBJECT":
        return evaluated.matrix_world
    if thing.parent is None:
        return thing.matrix_basis
    return _matrix(thing.parent, depsgraph) @ thing.matrix_parent_inverse @ thing.matrix_basis


def _is_moved(thing: bpy.types.Object | None) -> bool:
    """Whether constraints, keys or drivers say where an object stands, or one that it hangs on."""
    if thing is None:
        return False
    data = thing.animation_data
    return bool(thing.constraints or (data and (data.action or data.drivers))) or _is_moved(thing.parent)


def _is_portal(light: bpy.types.Light) -> bool:
    """Whether it only guides Cycles' samples to the world's light."""
    return light.type == "AREA" and light.cycles.is_portal


def _placed_lights(
    view_layer: bpy.types.ViewLayer, depsgraph: bpy.types.Depsgraph
) -> Iterator[tuple[bpy.types.Object, Matrix, str]]:
    """(evaluated object, matrix, name) of every light that a render would have."""
    hidden = set(_hidden_collections(view_layer.layer_collection))

    def is_rendered(thing: bpy.types.Object) -> bool:
        # Where a collection is instanced alone, no view layer has it.
        shown = (each for each in thing.users_collection if each not in hidden and not each.hide_render)
        return not thing.hide_render and next(shown, None) is not None

    for thing in view_layer.objects:
        if thing.type == "LIGHT" and is_rendered(thing) and not _is_portal(thing.data):
            yield thing.evaluated_get(depsgraph), _matrix(thing, depsgraph), thing.name
    counts: dict[str, int] = {}
    for instance in depsgraph.object_instances:
        if not instance.is_instance or instance.object.type != "LIGHT" or instance.object.original.hide_render:
            continue
        if is_rendered(instance.parent.original):
            name = instance.object.name
            counts[name] = counts.get(name, 0) + 1
            yield instance.object, instance.matrix_world.copy(), f"{instance.parent.name}/{name}/{counts[name]}"


def scene_lights(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> SceneLights:
    """The lights of the scene's view layer that the depsgraph is of, as they stand now."""
    result = SceneLights()
    for thing, matrix, name in _placed_lights(depsgraph.view_layer, depsgraph):
        try:
            light = rig_light(thing, matrix, name)
            if not thing.is_evaluated and _is_moved(thing):
                light.notes.append("viewports do not show it, so that what moves it is not followed")
            result.lights.append(light)
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
