# SPDX-License-Identifier: Apache-2.0
"""Builds a scene of scene_data.py in Blender 3.4 or 5 through `bpy`: meshes, materials with AOVs, lights, cameras."""

from __future__ import annotations

import math
from typing import Any

import bpy
from mathutils import Matrix, Vector
from scene_data import DEFAULTS

BLENDER5 = bpy.app.version >= (5, 0, 0)
GENERATION = 5 if BLENDER5 else 3

# AOV and rig name -> input of the Principled BSDF node.
_INPUTS = {
    3: {"albedo": "Base Color", "metallic": "Metallic", "roughness": "Roughness", "specular": "Specular"},
    5: {
        "albedo": "Base Color",
        "metallic": "Metallic",
        "roughness": "Roughness",
        "ior": "IOR",
        "specular_ior_level": "Specular IOR Level",
        "specular_tint": "Specular Tint",
        "diffuse_roughness": "Diffuse Roughness",
        "coat_weight": "Coat Weight",
        "coat_roughness": "Coat Roughness",
        "coat_ior": "Coat IOR",
        "coat_tint": "Coat Tint",
        "sheen_weight": "Sheen Weight",
        "sheen_roughness": "Sheen Roughness",
        "sheen_tint": "Sheen Tint",
    },
}[GENERATION]
AOVS = (*_INPUTS, "geometric_normal")
# What scenes with "layers" have besides.
_LAYERS = {"anisotropic": ("Anisotropic", 0.0), "anisotropic_rotation": ("Anisotropic Rotation", 0.0)}
LAYER_AOVS = (*_LAYERS, "tangent")
SPECULAR = "specular_ior_level" if BLENDER5 else "specular"


def is_color(name: str) -> bool:
    return name in ("albedo", "geometric_normal", "tangent") or name.endswith("_tint")


def _waves(name: str, size: tuple[float, float]) -> Any:
    """A smooth upright sheet with folds; no primitive, and nowhere flat."""
    columns, rows = 240, 80
    vertices = []
    for j in range(rows + 1):
        for i in range(columns + 1):
            x, z = (i / columns - 0.5) * size[0], (j / rows - 0.5) * size[1]
            vertices.append((x, 0.16 * math.sin(1.9 * x) + 0.1 * math.sin(3.1 * z + 0.8 * x), z))
    faces = []
    for j in range(rows):
        for i in range(columns):
            k = j * (columns + 1) + i
            faces.append((k, k + 1, k + columns + 2, k + columns + 1))
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def _shape(spec: dict[str, Any]) -> Any:
    make, kind = bpy.ops.mesh, spec["shape"]
    if kind == "waves":
        return _waves(spec["name"], spec["size"])
    if kind == "plane":
        make.primitive_plane_add(size=spec["size"])
    elif kind == "cube":
        make.primitive_cube_add(size=spec["size"])
    elif kind == "sphere":
        make.primitive_uv_sphere_add(segments=192, ring_count=96, radius=spec["radius"])
    elif kind == "icosphere":
        make.primitive_ico_sphere_add(subdivisions=7, radius=spec["radius"])
    elif kind == "torus":
        make.primitive_torus_add(
            major_segments=192, minor_segments=96, major_radius=spec["radius"][0], minor_radius=spec["radius"][1]
        )
    elif kind == "cylinder":
        make.primitive_cylinder_add(vertices=24, radius=spec["radius"], depth=spec["depth"])
    elif kind == "cone":
        make.primitive_cone_add(vertices=20, radius1=spec["radius"], depth=spec["depth"])
    return bpy.context.object


def _add_object(spec: dict[str, Any], index: int) -> Any:
    thing = _shape(spec)
    thing.name = spec["name"]
    thing.location = spec["at"]
    thing.rotation_euler = [math.radians(angle) for angle in spec.get("turn", (0, 0, 0))]
    thing.pass_index = index
    smooth = spec["shape"] in ("sphere", "icosphere", "torus", "waves")
    thing.data.polygons.foreach_set("use_smooth", [smooth] * len(thing.data.polygons))
    thing.data.materials.clear()
    thing.data.materials.append(bpy.data.materials[spec["material"]])
    return thing


def _noise(tree: Any, scale: float, low: Any, high: Any, color: bool) -> Any:
    """Socket of a noise texture stretched to low..high."""
    where = tree.nodes.new("ShaderNodeTexCoord")
    noise = tree.nodes.new("ShaderNodeTexNoise")
    noise.inputs["Scale"].default_value = scale
    noise.inputs["Detail"].default_value = 2.0
    tree.links.new(where.outputs["Object"], noise.inputs["Vector"])
    stretch = tree.nodes.new("ShaderNodeMapRange")
    stretch.inputs["From Min"].default_value = 0.3
    stretch.inputs["From Max"].default_value = 0.7
    tree.links.new(noise.outputs[0], stretch.inputs["Value"])
    if color:
        mix = tree.nodes.new("ShaderNodeMix")
        mix.data_type = "RGBA"
        tree.links.new(stretch.outputs[0], mix.inputs[0])
        mix.inputs[6].default_value = (*low, 1)
        mix.inputs[7].default_value = (*high, 1)
        return mix.outputs[2]
    stretch.inputs["To Min"].default_value = low
    stretch.inputs["To Max"].default_value = high
    return stretch.outputs[0]


def _constant(tree: Any, value: Any, color: bool) -> Any:
    node = tree.nodes.new("ShaderNodeRGB" if color else "ShaderNodeValue")
    node.outputs[0].default_value = (*value, 1) if color else value
    return node.outputs[0]


def _mix(tree: Any, factor: Any, first: Any, second: Any) -> Any:
    mix = tree.nodes.new("ShaderNodeMix")
    mix.data_type = "RGBA"
    tree.links.new(factor, mix.inputs[0])
    tree.links.new(first, mix.inputs[6])
    tree.links.new(second, mix.inputs[7])
    return mix.outputs[2]


def _bump(tree: Any, spec: dict[str, float]) -> Any:
    bump = tree.nodes.new("ShaderNodeBump")
    bump.inputs["Strength"].default_value = spec["strength"]
    bump.inputs["Distance"].default_value = spec["distance"]
    tree.links.new(_noise(tree, spec["scale"], 0.0, 1.0, False), bump.inputs["Height"])
    return bump.outputs["Normal"]


def _lambert_ggx(tree: Any, values: dict[str, Any], specular: float) -> tuple[Any, list[Any]]:
    """Diffuse(albedo (1-metallic)) + Glossy GGX(lerp(0.08 specular, albedo, metallic)); no Fresnel anywhere."""
    diffuse = tree.nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Roughness"].default_value = 0.0
    glossy = tree.nodes.new("ShaderNodeBsdfAnisotropic" if BLENDER5 else "ShaderNodeBsdfGlossy")
    glossy.distribution = "GGX"
    black, grey = _constant(tree, (0, 0, 0), True), _constant(tree, (0.08 * specular,) * 3, True)
    tree.links.new(_mix(tree, values["metallic"], values["albedo"], black), diffuse.inputs["Color"])
    tree.links.new(_mix(tree, values["metallic"], grey, values["albedo"]), glossy.inputs["Color"])
    tree.links.new(values["roughness"], glossy.inputs["Roughness"])
    add = tree.nodes.new("ShaderNodeAddShader")
    tree.links.new(diffuse.outputs[0], add.inputs[0])
    tree.links.new(glossy.outputs[0], add.inputs[1])
    return add.outputs[0], [diffuse, glossy]


def _add_aov(tree: Any, name: str, value: Any) -> None:
    aov = tree.nodes.new("ShaderNodeOutputAOV")
    if hasattr(aov, "aov_name"):
        aov.aov_name = name
    else:
        aov.name = name  # Blender 3
    tree.links.new(value, aov.inputs["Color" if is_color(name) else "Value"])


def _add_layers(tree: Any, node: Any, spec: dict[str, Any]) -> None:
    """Emission, and anisotropy with its tangent."""
    for name, (socket, default) in _LAYERS.items():
        value = _constant(tree, spec.get(name, default), False)
        _add_aov(tree, name, value)
        tree.links.new(value, node.inputs[socket])
    if spec.get("tangent") == "radial":
        tangent = tree.nodes.new("ShaderNodeTangent")
        tangent.direction_type, tangent.axis = "RADIAL", "Z"
        tree.links.new(tangent.outputs[0], node.inputs["Tangent"])
        _add_aov(tree, "tangent", tangent.outputs[0])
    else:
        _add_aov(tree, "tangent", _constant(tree, (0, 0, 0), True))
    node.inputs["Emission Color"].default_value = (*spec.get("emission", (0, 0, 0)), 1)
    node.inputs["Emission Strength"].default_value = 1.0 if "emission" in spec else 0.0


def build_material(name: str, spec: dict[str, Any], index: int, variant: str, layers: bool = False) -> None:
    """(Re)build one material; variant is "principled" or "lambertggx"."""
    material = bpy.data.materials.get(name) or bpy.data.materials.new(name)
    material.use_nodes = True
    material.pass_index = index
    tree = material.node_tree
    tree.nodes.clear()
    full = DEFAULTS[GENERATION] | spec
    values = {}
    for key in _INPUTS:
        value, color = full[key], is_color(key)
        textured = isinstance(value, tuple) and value[0] == "noise"
        values[key] = _noise(tree, *value[1:], color) if textured else _constant(tree, value, color)
        _add_aov(tree, key, values[key])
    # The smooth normal before the bump, which no pass carries: Cycles' bump terminator depends on it.
    _add_aov(tree, "geometric_normal", tree.nodes.new("ShaderNodeNewGeometry").outputs["Normal"])
    if spec.get("bsdf") == "diffuse":
        node = tree.nodes.new("ShaderNodeBsdfDiffuse")
        node.inputs["Roughness"].default_value = 0.0
        tree.links.new(values["albedo"], node.inputs["Color"])
        surface, bumped = node.outputs[0], [node]
    elif variant == "lambertggx":
        surface, bumped = _lambert_ggx(tree, values, full[SPECULAR])
    else:
        node = tree.nodes.new("ShaderNodeBsdfPrincipled")
        node.distribution = "GGX"
        if layers:
            _add_layers(tree, node, spec)
        for key, socket in _INPUTS.items():
            tree.links.new(values[key], node.inputs[socket])
        surface, bumped = node.outputs[0], [node]
    if "bump" in spec:
        normal = _bump(tree, spec["bump"])
        for node in bumped:
            tree.links.new(normal, node.inputs["Normal"])
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(surface, output.inputs["Surface"])


def build_materials(scene: dict[str, Any], variant: str) -> None:
    for index, (name, spec) in enumerate(scene["materials"].items(), start=1):
        build_material(name, spec, index, variant, scene.get("layers", False))


def _look(at: Vector, to: Vector, roll: float) -> Matrix:
    turn = (to - at).to_track_quat("-Z", "Y").to_matrix().to_4x4()
    return Matrix.Translation(at) @ turn @ Matrix.Rotation(math.radians(roll), 4, "Z")


def _add_light(name: str, spec: dict[str, Any]) -> None:
    light = bpy.data.lights.new(name, spec["type"])
    light.energy = spec["energy"]
    light.color = spec["color"]
    if spec["type"] == "SUN":
        light.angle = 0.0
    else:
        light.shadow_soft_size = 0.0
    if spec["type"] == "SPOT":
        light.spot_size = math.radians(spec["cone"])
        light.spot_blend = spec["blend"]
    if BLENDER5:
        light.use_shadow = False
    else:
        light.cycles.cast_shadow = False
    thing = bpy.data.objects.new(name, light)
    at = Vector(spec.get("at", (0, 0, 8)))
    thing.matrix_world = _look(at, at + Vector(spec.get("to", (0, 0, -1))), 0.0)
    bpy.context.scene.collection.objects.link(thing)


def _add_camera(name: str, spec: dict[str, Any]) -> None:
    camera = bpy.data.cameras.new(name)
    camera.lens = spec["lens"]
    camera.sensor_width = 36.0
    camera.sensor_fit = "HORIZONTAL"
    camera.shift_x, camera.shift_y = spec.get("shift", (0.0, 0.0))
    thing = bpy.data.objects.new(f"camera_{name}", camera)
    thing.matrix_world = _look(Vector(spec["at"]), Vector(spec["look"]), spec["roll"])
    bpy.context.scene.collection.objects.link(thing)


def build(scene: dict[str, Any]) -> None:
    """Empty the file and build the scene with Principled materials. Nothing shadows, nothing bounces."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    build_materials(scene, "principled")
    for index, spec in enumerate(scene["objects"], start=1):
        thing = _add_object(spec, index)
        # Light shadows off is not enough: rays towards a light that was sampled by the BSDF would still be blocked.
        thing.visible_shadow = thing.visible_diffuse = thing.visible_glossy = False
        thing.visible_transmission = thing.visible_volume_scatter = False
    for name, spec in scene["lights"].items():
        _add_light(name, spec)
    for name, spec in scene["cameras"].items():
        _add_camera(name, spec)
    world = bpy.data.worlds.new("black")
    world.use_nodes = True
    world.node_tree.nodes.clear()
    bpy.context.scene.world = world
    bpy.context.view_layer.update()
