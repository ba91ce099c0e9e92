# SPDX-License-Identifier: Apache-2.0
"""Thirteen kinds of material as artists build them, each on a sphere of its own; no AOV in any of them."""

from __future__ import annotations

import math
from typing import Any

import bpy
from mathutils import Matrix, Vector


def use_nodes(owner: Any) -> None:
    """A material or world of Blender 4.5 has nodes when told so; later ones always have."""
    if bpy.app.version < (5, 0, 0):
        owner.use_nodes = True


def _new(name: str) -> tuple[Any, Any, Any]:
    """An empty material, its tree and its output."""
    material = bpy.data.materials.new(name)
    use_nodes(material)
    tree = material.node_tree
    tree.nodes.clear()
    return material, tree, tree.nodes.new("ShaderNodeOutputMaterial")


def _principled(tree: Any, distribution: str = "GGX", **inputs: Any) -> Any:
    node = tree.nodes.new("ShaderNodeBsdfPrincipled")
    node.distribution = distribution
    for name, value in inputs.items():
        socket = node.inputs[name.replace("_", " ")]
        if hasattr(value, "is_output"):
            tree.links.new(value, socket)
        else:
            socket.default_value = (*value, 1.0) if isinstance(value, tuple) else value
    return node


def _noise(tree: Any, scale: float = 3.0) -> Any:
    where = tree.nodes.new("ShaderNodeTexCoord")
    noise = tree.nodes.new("ShaderNodeTexNoise")
    noise.inputs["Scale"].default_value = scale
    tree.links.new(where.outputs["Object"], noise.inputs["Vector"])
    return noise


def _mask(tree: Any) -> Any:
    """0 or 1: an upper and a lower half."""
    where = tree.nodes.new("ShaderNodeTexCoord")
    split = tree.nodes.new("ShaderNodeSeparateXYZ")
    step = tree.nodes.new("ShaderNodeMath")
    step.operation = "GREATER_THAN"
    step.inputs[1].default_value = 0.1
    tree.links.new(where.outputs["Object"], split.inputs[0])
    tree.links.new(split.outputs["Z"], step.inputs[0])
    return step.outputs[0]


def _surface(tree: Any, output: Any, shader: Any) -> None:
    tree.links.new(shader.outputs[0], output.inputs["Surface"])


def plain() -> None:
    _, tree, output = _new("plain")
    node = _principled(tree, Base_Color=(0.6, 0.2, 0.1), Roughness=0.35, IOR=1.6, Specular_Tint=(0.9, 0.7, 1.0))
    _surface(tree, output, node)


def linked() -> None:
    _, tree, output = _new("linked")
    noise = _noise(tree)
    rough = tree.nodes.new("ShaderNodeMapRange")
    rough.inputs["To Min"].default_value, rough.inputs["To Max"].default_value = 0.3, 0.7
    tree.links.new(noise.outputs[0], rough.inputs["Value"])
    reroute = tree.nodes.new("NodeReroute")
    tree.links.new(rough.outputs[0], reroute.inputs[0])
    node = _principled(tree, Base_Color=noise.outputs["Color"], Roughness=reroute.outputs[0], Diffuse_Roughness=0.6)
    _surface(tree, output, node)


def metal() -> None:
    _, tree, output = _new("metal")
    node = _principled(tree, Base_Color=(0.9, 0.6, 0.3), Metallic=1.0, Roughness=0.3, Specular_Tint=(0.8, 0.9, 1.0))
    _surface(tree, output, node)


def brushed() -> None:
    _, tree, output = _new("brushed")
    tangent = tree.nodes.new("ShaderNodeTangent")
    tangent.axis = "X"
    node = _principled(tree, Base_Color=(0.8, 0.5, 0.4), Metallic=1.0, Roughness=0.4, Anisotropic=0.6)
    node.inputs["Anisotropic Rotation"].default_value = 0.1
    tree.links.new(tangent.outputs[0], node.inputs["Tangent"])
    _surface(tree, output, node)


def brushed_plain_tangent() -> None:
    _, tree, output = _new("brushed_plain_tangent")
    node = _principled(tree, Base_Color=(0.2, 0.5, 0.7), Roughness=0.35, Anisotropic=0.7)
    _surface(tree, output, node)


def lacquer() -> None:
    _, tree, output = _new("lacquer")
    bump = tree.nodes.new("ShaderNodeBump")
    bump.inputs["Strength"].default_value, bump.inputs["Distance"].default_value = 0.3, 0.05
    tree.links.new(_noise(tree, 2.0).outputs[0], bump.inputs["Height"])
    node = _principled(tree, Base_Color=(0.1, 0.3, 0.6), Roughness=0.5, Coat_Weight=0.8, Coat_Roughness=0.2)
    node.inputs["Coat Tint"].default_value = (0.9, 0.7, 0.5, 1.0)
    tree.links.new(bump.outputs[0], node.inputs["Normal"])
    _surface(tree, output, node)


def velvet() -> None:
    _, tree, output = _new("velvet")
    node = _principled(tree, "MULTI_GGX", Base_Color=(0.2, 0.05, 0.3), Sheen_Weight=0.7, Sheen_Roughness=0.4)
    node.inputs["Sheen Tint"].default_value = (0.9, 0.8, 1.0, 1.0)
    _surface(tree, output, node)


def group_of(name: str) -> Any:
    """A node group with a Principled BSDF inside: one input linked, one constant."""
    tree = bpy.data.node_groups.get(name)
    if tree is not None:
        return tree
    tree = bpy.data.node_groups.new(name, "ShaderNodeTree")
    tree.interface.new_socket("Paint", in_out="INPUT", socket_type="NodeSocketColor")
    tree.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
    inside, outside = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    node = _principled(tree, Base_Color=inside.outputs["Paint"], Roughness=0.45, Coat_Weight=0.5)
    tree.links.new(node.outputs[0], outside.inputs["Shader"])
    return tree


def grouped() -> None:
    _, tree, output = _new("grouped")
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree = group_of("car paint")
    node.inputs["Paint"].default_value = (0.7, 0.1, 0.1, 1.0)
    _surface(tree, output, node)


def mixed() -> None:
    _, tree, output = _new("mixed")
    first = tree.nodes.new("ShaderNodeGroup")
    first.node_tree = group_of("car paint")
    tree.links.new(_noise(tree).outputs["Color"], first.inputs["Paint"])
    second = _principled(tree, Base_Color=(0.9, 0.9, 0.5), Metallic=1.0, Roughness=0.3)
    mix = tree.nodes.new("ShaderNodeMixShader")
    tree.links.new(_mask(tree), mix.inputs[0])
    tree.links.new(first.outputs[0], mix.inputs[1])
    tree.links.new(second.outputs[0], mix.inputs[2])
    _surface(tree, output, mix)


def two_paints() -> None:
    """A mix by a factor that is no mask: of two paints the same in all but their color, it is their mean."""
    _, tree, output = _new("two_paints")
    mix = tree.nodes.new("ShaderNodeMixShader")
    mix.inputs[0].default_value = 0.3
    for place, color in ((1, (0.8, 0.1, 0.1)), (2, (0.1, 0.7, 0.3))):
        tree.links.new(_principled(tree, Base_Color=color, Roughness=0.6).outputs[0], mix.inputs[place])
    _surface(tree, output, mix)


def glowing() -> None:
    _, tree, output = _new("glowing")
    node = _principled(tree, Base_Color=(0.3, 0.3, 0.3), Emission_Color=(0.1, 0.3, 0.9), Emission_Strength=0.2)
    emission = tree.nodes.new("ShaderNodeEmission")
    emission.inputs["Color"].default_value = (0.4, 0.2, 0.0, 1.0)
    emission.inputs["Strength"].default_value = 0.3
    add = tree.nodes.new("ShaderNodeAddShader")
    tree.links.new(node.outputs[0], add.inputs[0])
    tree.links.new(emission.outputs[0], add.inputs[1])
    _surface(tree, output, add)


def clay() -> None:
    """Several outputs: the one for Cycles counts."""
    _, tree, output = _new("clay")
    output.target = "CYCLES"
    node = tree.nodes.new("ShaderNodeBsdfDiffuse")
    node.inputs["Color"].default_value = (0.6, 0.5, 0.4, 1.0)
    node.inputs["Roughness"].default_value = 0.5
    _surface(tree, output, node)
    other = tree.nodes.new("ShaderNodeOutputMaterial")
    other.target = "EEVEE"
    _surface(tree, other, _principled(tree, Base_Color=(0.0, 1.0, 0.0)))
    other.is_active_output = True


def steel() -> None:
    _, tree, output = _new("steel")
    node = tree.nodes.new("ShaderNodeBsdfMetallic")
    node.fresnel_type, node.distribution = "F82", "GGX"
    node.inputs["Base Color"].default_value = (0.5, 0.55, 0.6, 1.0)
    node.inputs["Edge Tint"].default_value = (0.7, 0.8, 0.9, 1.0)
    node.inputs["Roughness"].default_value = 0.35
    _surface(tree, output, node)


KINDS = (
    plain,
    linked,
    metal,
    brushed,
    brushed_plain_tangent,
    lacquer,
    velvet,
    grouped,
    mixed,
    two_paints,
    glowing,
    clay,
    steel,
)


def glass() -> None:
    """One that relume has no parameters for."""
    _, tree, output = _new("glass")
    _surface(tree, output, tree.nodes.new("ShaderNodeBsdfGlass"))


def add_light(name: str, kind: str, at: tuple[float, float, float], to: tuple[float, float, float], **keys: Any) -> Any:
    """A light that casts no shadow and has no size, unless `keys` say otherwise."""
    light = bpy.data.lights.new(name, kind)
    light.use_shadow = False
    if kind == "SUN":
        light.angle = 0.0
    else:
        light.shadow_soft_size = 0.0
    for key, value in keys.items():
        setattr(light, key, value)
    thing = bpy.data.objects.new(name, light)
    turn = (Vector(to) - Vector(at)).to_track_quat("-Z", "Y").to_matrix().to_4x4()
    thing.matrix_world = Matrix.Translation(at) @ turn
    bpy.context.scene.collection.objects.link(thing)
    return thing


def add_camera(distance: float, lens: float) -> None:
    camera = bpy.data.cameras.new("camera")
    camera.lens = lens
    thing = bpy.data.objects.new("camera", camera)
    thing.matrix_world = Matrix.Translation((0, -distance, 0)) @ Matrix.Rotation(math.radians(90), 4, "X")
    bpy.context.scene.collection.objects.link(thing)
    bpy.context.scene.camera = thing


def empty_scene(width: int, height: int, samples: int = 1) -> Any:
    """An empty scene for Cycles: pixel-centre samples, direct light alone, a black world."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = samples
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.use_denoising = False
    scene.cycles.max_bounces = 0
    scene.cycles.light_sampling_threshold = 0.0
    scene.cycles.blur_glossy = 0.0
    scene.cycles.sample_clamp_direct = scene.cycles.sample_clamp_indirect = 0.0
    scene.cycles.filter_width = 0.01
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.resolution_percentage = 100
    scene.world = bpy.data.worlds.new("black")
    use_nodes(scene.world)
    scene.world.node_tree.nodes.clear()
    return scene


def unshadowed(thing: Any) -> None:
    thing.visible_shadow = thing.visible_diffuse = thing.visible_glossy = thing.visible_transmission = False


def build_kinds(width: int = 320, height: int = 180) -> Any:
    """Spheres in rows, one of each kind, under a sun, a point and a spot light. Nothing shadows, nothing bounces."""
    scene = empty_scene(width, height)
    for place, make in enumerate(KINDS):
        make()
        bpy.ops.mesh.primitive_uv_sphere_add(segments=96, ring_count=48, radius=0.95)
        thing = bpy.context.object
        thing.name = f"ball {make.__name__}"
        thing.location = (2.0 * (place % 5) - 4.0, 0.0, 2.0 - 2.0 * (place // 5))
        bpy.ops.object.shade_smooth()
        thing.data.materials.append(bpy.data.materials[make.__name__])
        bpy.data.materials[make.__name__].pass_index = place + 1
        unshadowed(thing)
    add_camera(20.0, 62.0)
    add_light("sun", "SUN", (-3, -5, 4), (0, 0, 0), energy=2.0, color=(1.0, 0.9, 0.8))
    add_light("lamp", "POINT", (4, -6, 3), (0, 0, 0), energy=900.0, exposure=-0.5)
    add_light(
        "spot", "SPOT", (-2, -9, -1), (-1, 0, 0), energy=2500.0, spot_size=1.0, spot_blend=0.6,
        use_temperature=True, temperature=4000.0,
    )  # fmt: skip
    bpy.context.view_layer.update()
    return scene
