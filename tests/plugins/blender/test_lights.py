# SPDX-License-Identifier: Apache-2.0
"""Each type of light, and each of its settings, against Cycles on a Lambert plane."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
import relume
from materials import empty_scene, use_nodes
from mathutils import Matrix
from pictures import relative_errors, render, write_multilayer

POINT = {"shadow_soft_size": 0.0, "energy": 60.0}
SPOT = POINT | {"spot_size": 1.2, "spot_blend": 0.4}

CASES: dict[str, tuple[str, dict[str, Any]]] = {
    "sun": ("SUN", {"energy": 3.0, "angle": 0.0}),
    "sun warm and brighter": ("SUN", {"angle": 0.0, "exposure": 1.5, "use_temperature": True, "temperature": 3200.0}),
    "sun of an angle": ("SUN", {"energy": 3.0, "angle": 0.1}),
    "sun not normalized": ("SUN", {"energy": 300.0, "angle": 0.1, "normalize": False}),
    "sun not normalized, no angle": ("SUN", {"energy": 3.0, "angle": 0.0, "normalize": False}),
    "point": ("POINT", POINT),
    "point dimmer": ("POINT", POINT | {"exposure": -1.0}),
    "point not normalized": ("POINT", POINT | {"normalize": False}),
    "point of a radius": ("POINT", POINT | {"shadow_soft_size": 0.2}),
    "sphere": ("POINT", POINT | {"shadow_soft_size": 0.2, "use_soft_falloff": False}),
    "sphere not normalized": (
        "POINT",
        POINT | {"shadow_soft_size": 0.2, "use_soft_falloff": False, "normalize": False},
    ),
    "spot": ("SPOT", SPOT),
    "spot with a hard edge": ("SPOT", SPOT | {"spot_blend": 0.0}),
    "spot of a half space": ("SPOT", SPOT | {"spot_size": math.pi}),
    "spot all soft and cold": ("SPOT", SPOT | {"spot_blend": 1.0, "use_temperature": True, "temperature": 9000.0}),
}


def lambert_plane() -> Any:
    """A grey Lambert plane, looked at at a slant."""
    scene = empty_scene(96, 64, samples=64)
    material = bpy.data.materials.new("grey")
    use_nodes(material)
    tree = material.node_tree
    tree.nodes.clear()
    diffuse, output = tree.nodes.new("ShaderNodeBsdfDiffuse"), tree.nodes.new("ShaderNodeOutputMaterial")
    diffuse.inputs["Color"].default_value = (0.8, 0.8, 0.8, 1.0)
    tree.links.new(diffuse.outputs[0], output.inputs["Surface"])
    bpy.ops.mesh.primitive_plane_add(size=8)
    bpy.context.object.name = "plane"
    bpy.context.object.data.materials.append(material)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.matrix_world = Matrix.Translation((0, -1, 6)) @ Matrix.Rotation(math.radians(10), 4, "X")
    scene.collection.objects.link(camera)
    scene.camera = camera
    layer = scene.view_layers[0]
    layer.use_pass_normal = layer.use_pass_position = layer.use_pass_z = layer.use_pass_cryptomatte_object = True
    write_multilayer(scene)
    return scene


def add(scene: Any, kind: str, settings: dict[str, Any], name: str = "light") -> Any:
    light = bpy.data.lights.new(name, kind)
    light.color, light.use_shadow = (1.0, 0.6, 0.3), False
    for key, value in settings.items():
        setattr(light, key, value)
    thing = bpy.data.objects.new(name, light)
    thing.matrix_world = (
        Matrix.Translation((0.5, 0.3, 2.5)) @ Matrix.Rotation(0.5, 4, "X") @ Matrix.Rotation(0.2, 4, "Y")
    )
    scene.collection.objects.link(thing)
    bpy.context.view_layer.update()
    return thing


def relit(scene: Any, gbuffer: relume.GBuffer, module: Callable[[str], Any]) -> np.ndarray[Any, Any]:
    """The scene's lights by the extension, on a Lambert surface of the plane's color."""
    rig = relume.Rig()
    lights = module("scene_lights").scene_lights(scene, bpy.context.evaluated_depsgraph_get())
    assert not lights.left_out
    module("scene_rig").add_lights(rig, lights.lights, [])
    rig.shader.add("lambert", base_color=(0.8, 0.8, 0.8))
    return relume.relight(gbuffer, rig)["beauty"][..., :3]


@pytest.mark.parametrize("case", CASES)
def test_light_is_cycles(case: str, module: Callable[[str], Any], folder: Path) -> None:
    scene = lambert_plane()
    add(scene, *CASES[case])
    gbuffer = render(scene, folder / "plane.exr")
    truth = gbuffer["beauty"][..., :3]
    # Where a cone fades out, the 0.01 pixels by which Position is off centre are a thousandth of what is left.
    errors = relative_errors(relit(scene, gbuffer, module), truth, truth[..., 0] > 0.25 * truth[..., 0].max())
    assert errors.size > 500
    assert np.median(errors) <= 2e-4
    assert np.percentile(errors, 99) <= 1e-3


def test_nodes_of_a_light(module: Callable[[str], Any], folder: Path) -> None:
    scene = lambert_plane()
    light = add(scene, "POINT", POINT).data
    light.use_nodes = True
    emission = next(node for node in light.node_tree.nodes if node.bl_idname == "ShaderNodeEmission")
    emission.inputs["Strength"].default_value = 2.5
    emission.inputs["Color"].default_value = (0.2, 0.9, 0.4, 1.0)
    gbuffer = render(scene, folder / "plane.exr")
    errors = relative_errors(relit(scene, gbuffer, module), gbuffer["beauty"][..., :3], np.bool_(True))
    assert np.percentile(errors, 99) <= 1e-3


def test_nodes_of_a_light_past_reroutes(module: Callable[[str], Any], folder: Path) -> None:
    scene = lambert_plane()
    light = add(scene, "POINT", POINT).data
    light.use_nodes = True
    tree = light.node_tree
    emission = next(node for node in tree.nodes if node.bl_idname == "ShaderNodeEmission")
    emission.inputs["Strength"].default_value = 2.5
    reroute = tree.nodes.new("NodeReroute")
    tree.links.new(emission.outputs[0], reroute.inputs[0])
    tree.links.new(reroute.outputs[0], tree.get_output_node("CYCLES").inputs["Surface"])
    gbuffer = render(scene, folder / "plane.exr")
    errors = relative_errors(relit(scene, gbuffer, module), gbuffer["beauty"][..., :3], np.bool_(True))
    assert errors.size > 500 and np.percentile(errors, 99) <= 1e-3
    emission.mute = True
    assert render(scene, folder / "plane.exr")["beauty"][..., :3].max() == 0
    lights = module("scene_lights").scene_lights(scene, bpy.context.evaluated_depsgraph_get())
    assert lights.lights == [] and lights.left_out == [("light", "its nodes emit nothing")]


def test_lights_that_viewports_or_renders_do_not_show(module: Callable[[str], Any], folder: Path) -> None:
    """A collection that renders hide hides those inside; what viewports hide is rendered, where its parent has it."""
    scene = lambert_plane()
    outer, inner = (bpy.data.collections.new(name) for name in ("outer", "inner"))
    scene.collection.children.link(outer)
    outer.children.link(inner)
    sun = add(scene, "SUN", {"energy": 5.0, "angle": 0.0}, "inside")
    scene.collection.objects.unlink(sun)
    inner.objects.link(sun)
    outer.hide_render = True
    lamp, empty = add(scene, "POINT", POINT, "lamp"), bpy.data.objects.new("empty", None)
    scene.collection.objects.link(empty)
    lamp.parent = empty
    lamp.hide_viewport = True
    bpy.context.view_layer.update()
    empty.location, lamp.location = (0.7, -0.4, 0.3), (0.2, 0.5, 2.0)
    bpy.context.view_layer.update()
    gbuffer = render(scene, folder / "plane.exr")
    errors = relative_errors(relit(scene, gbuffer, module), gbuffer["beauty"][..., :3], np.bool_(True))
    assert errors.size > 500 and np.percentile(errors, 99) <= 1e-3
    lights = module("scene_lights").scene_lights(scene, bpy.context.evaluated_depsgraph_get())
    assert lights.notes == []
    empty.constraints.new("COPY_LOCATION")
    lights = module("scene_lights").scene_lights(scene, bpy.context.evaluated_depsgraph_get())
    assert [name for name, note in lights.notes if "not followed" in note] == ["lamp"]


def test_instances_and_hidden_lights(module: Callable[[str], Any], folder: Path) -> None:
    """A collection that is instanced twice lights twice, each where it stands; a hidden light does not."""
    scene = lambert_plane()
    collection = bpy.data.collections.new("lamps")
    lamp = add(scene, "POINT", POINT)
    scene.collection.objects.unlink(lamp)
    collection.objects.link(lamp)
    for place in (-1.0, 1.5):
        empty = bpy.data.objects.new("empty", None)
        empty.instance_type, empty.instance_collection = "COLLECTION", collection
        empty.location = (place, 0.4, 0.5)
        scene.collection.objects.link(empty)
    add(scene, "SUN", {"energy": 5.0}, "hidden").hide_render = True
    bpy.context.view_layer.update()
    lights = module("scene_lights").scene_lights(scene, bpy.context.evaluated_depsgraph_get())
    assert [light.type for light in lights.lights] == ["point", "point"]
    assert len({light.name for light in lights.lights}) == 2
    scene.cycles.samples = 4096  # Cycles takes one of the two for each sample
    gbuffer = render(scene, folder / "plane.exr")
    errors = relative_errors(relit(scene, gbuffer, module), gbuffer["beauty"][..., :3], np.bool_(True))
    assert np.median(errors) <= 2e-2


def test_film_exposure(module: Callable[[str], Any], folder: Path) -> None:
    """Cycles' film makes every light brighter, and what glows, which the Emission pass has already."""
    scene = lambert_plane()
    scene.cycles.film_exposure = 3.0
    add(scene, "SUN", {"energy": 2.0, "angle": 0.0, "exposure": 0.5})
    gbuffer = render(scene, folder / "plane.exr")
    errors = relative_errors(relit(scene, gbuffer, module), gbuffer["beauty"][..., :3], np.bool_(True))
    assert np.percentile(errors, 99) <= 1e-5


AREAS: dict[str, dict[str, Any]] = {
    "square": {"shape": "SQUARE", "size": 0.8},
    "rectangle": {"shape": "RECTANGLE", "size": 0.9, "size_y": 0.4},
    "disk": {"shape": "DISK", "size": 0.7},
    "not normalized": {"shape": "RECTANGLE", "size": 0.9, "size_y": 0.4, "normalize": False},
}


@pytest.mark.parametrize("case", AREAS)
def test_area_lights_radiance(case: str, module: Callable[[str], Any], folder: Path) -> None:
    """What an area light becomes when relume shades such lights, by quadrature over its surface, against Cycles."""
    scene = lambert_plane()
    scene.cycles.samples = 1024
    thing = add(scene, "AREA", AREAS[case] | {"energy": 40.0})
    thing.scale = (1.3, 1.3, 1.0)
    bpy.context.view_layer.update()
    gbuffer = render(scene, folder / "plane.exr")
    keys = module("lights").area_keys(thing.data, thing.matrix_world, [])
    side = (np.arange(24) + 0.5) / 24 - 0.5
    u, v = (each.ravel() for each in np.meshgrid(side, side))
    axis = np.array(keys["direction"])
    up = np.array(keys.get("up", (0, 1, 0))) - axis * np.dot(axis, keys.get("up", (0, 1, 0)))
    up /= np.linalg.norm(up)
    size = keys["size"] if "size" in keys else [2 * keys["radius"]] * 2
    inside = np.hypot(u, v) < 0.5 if "radius" in keys else np.full(u.shape, True)
    points = np.array(keys["position"]) + np.outer(u * size[0], np.cross(axis, up)) + np.outer(v * size[1], up)
    area = size[0] * size[1] * (np.pi / 4 if "radius" in keys else 1.0)
    to = points[inside][None] - gbuffer["position"].reshape(-1, 1, 3).astype(np.float64)
    square = (to**2).sum(axis=-1)
    cosines = np.clip(to[..., 2], 0, None) * np.clip(-(to @ axis), 0, None)
    irradiance = keys["radiance"] * area * (cosines / square**2).mean(axis=-1)
    expected = 0.8 / np.pi * irradiance.reshape(gbuffer.shape)[..., None] * np.array(thing.data.color)
    errors = relative_errors(gbuffer["beauty"][..., :3], expected, np.bool_(True))
    assert np.median(errors) <= 5e-3  # noise of the render
    ratio = gbuffer["beauty"][..., 0].astype(np.float64).sum() / expected[..., 0].sum()
    assert ratio == pytest.approx(1, abs=1e-3)


@pytest.mark.parametrize("state", ["INCLUDE", "EXCLUDE"])
def test_light_linking(state: str, module: Callable[[str], Any], folder: Path) -> None:
    """Of two planes one is lit, as in Cycles: by the rig on the file, and by the arrays of the live picture."""
    scene = lambert_plane()
    plane = bpy.context.scene.objects["plane"]
    other = plane.copy()
    other.name, other.location = "other", (4.0, 0.0, 0.0)
    scene.collection.objects.link(other)
    plane.location = (-4.0, 0.0, 0.0)
    receivers = bpy.data.collections.new("receivers")
    receivers.objects.link(other)
    light = add(scene, "SUN", {"energy": 3.0, "angle": 0.0})
    light.light_linking.receiver_collection = receivers
    receivers.collection_objects[0].light_linking.link_state = state
    bpy.context.view_layer.update()
    gbuffer = render(scene, folder / "plane.exr")
    truth = gbuffer["beauty"][..., :3]
    lit = truth.max(axis=-1) > 1e-3
    assert 1000 < lit.sum() < lit.size - 1000
    image = relit(scene, gbuffer, module)
    assert (image[~lit] == 0).all()
    assert np.percentile(relative_errors(image, truth, lit), 99) <= 1e-3
    rig = relume.Rig()
    rig.shader.add("lambert", base_color=(0.8, 0.8, 0.8))
    frame = module("frames").LoadedFrame(gbuffer, rig)
    frame.relight(scene, module("scene_lights").scene_lights(scene, bpy.context.evaluated_depsgraph_get()).lights)
    assert np.abs(frame.pixels[::-1, :, :3] - image).max() <= 1e-6


def test_light_linking_by_instance_and_namesake(module: Callable[[str], Any], folder: Path) -> None:
    """What is linked may be the instance of a collection; a material that is called as an object is, is not meant."""
    scene = lambert_plane()
    plane = scene.objects["plane"]
    plane.location = (-4.0, 0.0, 0.0)
    other = plane.copy()
    other.name, other.location = "other", (0.0, 0.0, 0.0)
    collection = bpy.data.collections.new("copies")
    collection.objects.link(other)
    empty = bpy.data.objects.new("instance", None)
    empty.instance_type, empty.instance_collection, empty.location = "COLLECTION", collection, (4.0, 0.0, 0.0)
    scene.collection.objects.link(empty)
    plane.data.materials[0].name = "other"  # which both planes have
    scene.view_layers[0].use_pass_cryptomatte_material = True
    receivers = bpy.data.collections.new("receivers")
    receivers.objects.link(empty)
    add(scene, "SUN", {"energy": 3.0, "angle": 0.0}).light_linking.receiver_collection = receivers
    bpy.context.view_layer.update()
    gbuffer = render(scene, folder / "plane.exr")
    truth, image = gbuffer["beauty"][..., :3], relit(scene, gbuffer, module)
    lit = truth.max(axis=-1) > 1e-3
    assert 1000 < lit.sum() < lit.size - 1000
    assert (image[~lit] == 0).all()
    assert np.percentile(relative_errors(image, truth, lit), 99) <= 1e-3


def test_left_out_by_name(module: Callable[[str], Any]) -> None:
    scene = lambert_plane()
    add(scene, "AREA", {}, "softbox")
    add(scene, "POINT", POINT | {"energy": -5.0}, "thief")
    textured = add(scene, "POINT", POINT, "gobo").data
    textured.use_nodes = True
    tree = textured.node_tree
    emission = next(node for node in tree.nodes if node.bl_idname == "ShaderNodeEmission")
    tree.links.new(tree.nodes.new("ShaderNodeTexNoise").outputs["Color"], emission.inputs["Color"])
    sky = scene.world.node_tree
    sky.links.new(
        sky.nodes.new("ShaderNodeBackground").outputs[0], sky.nodes.new("ShaderNodeOutputWorld").inputs["Surface"]
    )
    lights = module("scene_lights").scene_lights(scene, bpy.context.evaluated_depsgraph_get())
    assert {name for name, _ in lights.left_out} == {"softbox", "thief", "gobo", "black"}
    reasons = dict(lights.left_out)
    assert "area" in reasons["softbox"] and "world" in reasons["black"] and "constants" in reasons["gobo"]
    assert lights.lights == []
