# SPDX-License-Identifier: Apache-2.0
"""Set up passes: thirteen kinds of material, rendered and relit; undo, a second press, and what cannot be wired."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy
import materials
import numpy as np
import pytest
import relume
from pictures import Array, direct_light, interior, pixels_of, relative_errors, render

#: As tests/truth has them for Blender 5's Principled.
MEDIAN_BAR, P99_BAR = 8e-4, 3e-3


def described(scene: Any) -> str:
    """Everything that setting up may touch, as text: two scenes with the same are the same."""

    def sockets(node: Any) -> list[Any]:
        return [
            [
                each.identifier,
                list(each.default_value) if hasattr(each.default_value, "__len__") else each.default_value,
            ]
            for each in node.inputs
            if hasattr(each, "default_value") and not isinstance(each.default_value, str)
        ]

    def tree(nodes: Any) -> Any:
        if nodes is None:
            return None
        links = [
            [x.from_node.name, x.from_socket.identifier, x.to_node.name, x.to_socket.identifier] for x in nodes.links
        ]
        interface = [item.name for item in nodes.interface.items_tree]
        return [[[n.name, n.bl_idname, list(n.location), sockets(n)] for n in nodes.nodes], sorted(links), interface]

    layers = [
        {key: getattr(layer, key) for key in list(layer.bl_rna.properties.keys()) if key.startswith("use_pass")}
        | {"aovs": [(aov.name, aov.type) for aov in layer.aovs]}
        for layer in scene.view_layers
    ]
    settings = scene.render.image_settings
    return json.dumps(
        {
            "layers": layers,
            "image": [settings.file_format, settings.color_depth],
            "materials": {each.name: [tree(each.node_tree), dict(each.items())] for each in bpy.data.materials},
            "groups": {each.name: [tree(each), dict(each.items())] for each in bpy.data.node_groups},
        },
        indent=1,
    )


@pytest.fixture(scope="module")
def relit(tmp_path_factory: pytest.TempPathFactory) -> tuple[Array, Array, Array]:
    """(relit by the button, Cycles' direct light, material indices) of the scene of many kinds of material."""
    folder = tmp_path_factory.mktemp("kinds")
    scene = materials.build_kinds()
    assert bpy.ops.relume.set_up_passes() == {"FINISHED"}
    gbuffer = render(scene, folder / "kinds.exr")
    scene.relume.source, scene.relume.filepath = "FILE", str(folder / "kinds.exr")
    assert bpy.ops.relume.relight() == {"FINISHED"}
    image = pixels_of(bpy.data.images["Relit Scene"])[..., :3]
    return image, direct_light(scene, folder), gbuffer["material_id"]


@pytest.mark.parametrize("kind", [make.__name__ for make in materials.KINDS])
def test_material_is_cycles(kind: str, relit: tuple[Array, Array, Array]) -> None:
    image, truth, ids = relit
    index = [make.__name__ for make in materials.KINDS].index(kind) + 1
    errors = relative_errors(image, truth, interior(ids == index))
    assert errors.size > 1500
    print(f"{kind}: median {np.median(errors):.1e}, p99 {np.percentile(errors, 99):.1e}")
    assert np.median(errors) <= MEDIAN_BAR
    assert np.percentile(errors, 99) <= P99_BAR


def test_undo_and_second_press() -> None:
    scene = materials.build_kinds(32, 18)
    bpy.ops.ed.undo_push(message="built")
    before = described(bpy.context.scene)
    assert bpy.ops.relume.set_up_passes("EXEC_DEFAULT", True) == {"FINISHED"}
    after = described(bpy.context.scene)
    assert after != before
    assert bpy.ops.relume.set_up_passes("EXEC_DEFAULT", True) == {"CANCELLED"}
    assert described(bpy.context.scene) == after
    assert bpy.ops.ed.undo() == {"FINISHED"}
    assert described(bpy.context.scene) == before
    assert scene is not None


def test_user_nodes_are_untouched() -> None:
    """Every node and link that was there is there, with its values."""
    scene = materials.build_kinds(32, 18)
    before = json.loads(described(scene))["materials"]
    bpy.ops.relume.set_up_passes()
    after = json.loads(described(scene))["materials"]
    for name, ((nodes, links, _), _) in before.items():
        assert nodes and [node for node in after[name][0][0] if node in nodes] == nodes
        assert all(link in after[name][0][1] for link in links)


def test_a_changed_material_is_wired_anew() -> None:
    materials.build_kinds(32, 18)
    bpy.ops.relume.set_up_passes()
    tree = bpy.data.materials["plain"].node_tree
    count = len(tree.nodes)
    principled = next(node for node in tree.nodes if node.bl_idname == "ShaderNodeBsdfPrincipled")
    value = tree.nodes.new("ShaderNodeValue")
    tree.links.new(value.outputs[0], principled.inputs["Roughness"])
    assert bpy.ops.relume.set_up_passes() == {"FINISHED"}
    assert len(tree.nodes) == count + 1
    (aov,) = (node for node in tree.nodes if getattr(node, "aov_name", "") == "roughness")
    assert aov.inputs["Value"].links[0].from_node == value
    tree.nodes.remove(aov)
    assert bpy.ops.relume.set_up_passes() == {"FINISHED"}
    assert len(tree.nodes) == count + 1


def test_sliders_move_the_aovs() -> None:
    """A constant is followed, in the material and in a group that others use too, without a second press."""
    materials.build_kinds(32, 18)
    bpy.ops.relume.set_up_passes()
    bpy.context.view_layer.update()
    tree = bpy.data.materials["plain"].node_tree
    next(n for n in tree.nodes if n.bl_idname == "ShaderNodeBsdfPrincipled").inputs["Roughness"].default_value = 0.77
    bpy.context.view_layer.update()
    (aov,) = (node for node in tree.nodes if getattr(node, "aov_name", "") == "roughness")
    assert aov.inputs["Value"].default_value == pytest.approx(0.77)
    group = bpy.data.node_groups["car paint"]
    next(n for n in group.nodes if n.bl_idname == "ShaderNodeBsdfPrincipled").inputs["Coat Weight"].default_value = 0.1
    bpy.context.view_layer.update()
    held = [n.outputs[0].default_value for n in group.nodes if n.bl_idname == "ShaderNodeValue"]
    assert any(value == pytest.approx(0.1) for value in held)


def aov(name: str, parameter: str) -> Any:
    """The socket of an AOV that has no link."""
    nodes = bpy.data.materials[name].node_tree.nodes
    node = next(each for each in nodes if getattr(each, "aov_name", "") == parameter)
    return node.inputs["Color" if parameter.endswith(("color", "tint")) else "Value"]


def values_over(frames: range, *sockets: Any) -> list[list[Any]]:
    """What sockets hold in each frame, in the evaluated material."""
    result = []
    for frame in frames:
        bpy.context.scene.frame_set(frame)
        graph = bpy.context.evaluated_depsgraph_get()
        row = []
        for socket in sockets:
            tree = socket.id_data
            material = next(each for each in bpy.data.materials if each.node_tree == tree)
            value = material.evaluated_get(graph).node_tree.path_resolve(socket.path_from_id("default_value"))
            row.append(tuple(value) if hasattr(value, "__len__") else value)
        result.append(row)
    return result


def test_animated_constants(folder: Path) -> None:
    """Keys, their modifiers and drivers move the AOVs too; so do keys that are set or moved later."""
    scene = materials.build_kinds(64, 36)
    metal, plain, sheen = (
        bpy.data.materials[name].node_tree.nodes["Principled BSDF"].inputs for name in ("metal", "plain", "velvet")
    )
    for frame, value in ((1, 0.1), (5, 0.9), (9, 0.3)):
        metal["Roughness"].default_value = value
        metal["Roughness"].keyframe_insert("default_value", frame=frame)
    for frame, color in ((1, (1, 0, 0, 1)), (9, (0, 0.5, 1, 1))):
        plain["Base Color"].default_value = color
        plain["Base Color"].keyframe_insert("default_value", frame=frame)
    driver = sheen["Sheen Weight"].driver_add("default_value").driver
    driver.expression = "frame / 20"
    scene.frame_set(1)
    bpy.ops.relume.set_up_passes()
    assert not [each for each in scene.relume.unwired if "animated" in each.text]
    assert bpy.ops.relume.set_up_passes() == {"CANCELLED"}
    pairs = [
        (metal["Roughness"], aov("metal", "roughness")),
        (plain["Base Color"], aov("plain", "base_color")),
        (sheen["Sheen Weight"], aov("velvet", "sheen_weight")),
    ]
    for own, copied in pairs:
        values = values_over(range(1, 11), own, copied)
        assert [first for first, _ in values] == [second for _, second in values]
        assert len({first for first, _ in values}) > 8

    # A key that moves, one that is new, keys that go: the AOVs follow.
    scene.frame_set(3)
    metal["Roughness"].default_value = 0.05
    metal["Roughness"].keyframe_insert("default_value", frame=3)
    plain["Roughness"].default_value = 0.6
    plain["Roughness"].keyframe_insert("default_value", frame=2)
    plain["Roughness"].default_value = 0.2
    plain["Roughness"].keyframe_insert("default_value", frame=8)
    plain["Base Color"].keyframe_delete("default_value", frame=9)
    sheen["Sheen Weight"].driver_remove("default_value")
    sheen["Sheen Weight"].default_value = 0.75
    bpy.context.view_layer.update()
    for own, copied in [*pairs, (plain["Roughness"], aov("plain", "roughness"))]:
        values = values_over(range(1, 11), own, copied)
        assert [first for first, _ in values] == [second for _, second in values]
    assert values_over(range(3, 4), metal["Roughness"])[0][0] == pytest.approx(0.05)
    assert values_over(range(9, 10), aov("velvet", "sheen_weight"))[0][0] == 0.75

    # And so in a render.
    scene.frame_set(8)
    gbuffer = render(scene, folder / "frame.exr")
    plainly = gbuffer["roughness"][gbuffer["material_id"] == bpy.data.materials["plain"].pass_index]
    assert np.abs(plainly - 0.2).max() < 1e-6


def test_what_cannot_be_wired_is_listed() -> None:
    scene = materials.build_kinds(32, 18)
    materials.glass()
    empty = bpy.data.materials.new("empty")
    materials.use_nodes(empty)
    empty.node_tree.nodes.clear()
    for name in ("glass", "empty"):
        bpy.data.materials[name].use_fake_user = True
    bpy.ops.mesh.primitive_cube_add()
    bpy.context.object.name = "bare"
    through = bpy.data.materials["linked"].node_tree
    node = next(n for n in through.nodes if n.bl_idname == "ShaderNodeBsdfPrincipled")
    node.inputs["Transmission Weight"].default_value = 0.5
    bpy.ops.relume.set_up_passes()
    lines = {(each.name, each.icon): each.text for each in scene.relume.unwired}
    assert "Glass" in lines["glass", "ERROR"]
    assert "no Material Output" in lines["empty", "ERROR"]
    assert "no material" in lines["bare", "ERROR"]
    assert "Transmission" in lines["linked", "INFO"]
    assert len(lines) == 4


def test_what_is_approximated_is_listed() -> None:
    """Both distributions in one material, a slot without a material, a shading offset: none of it in silence."""
    scene = materials.build_kinds(32, 18)
    tree = bpy.data.materials["two_paints"].node_tree
    next(n for n in tree.nodes if n.bl_idname == "ShaderNodeBsdfPrincipled").distribution = "MULTI_GGX"
    ball = scene.objects["ball plain"]
    ball.data.materials.append(None)
    bpy.ops.relume.set_up_passes()
    assert [(each.name, each.icon) for each in scene.relume.unwired] == [("two_paints", "INFO")]
    assert "mixes GGX and Multiscatter GGX" in scene.relume.unwired[0].text
    ball.data.polygons[0].material_index = 1  # until here the slot was nobody's
    scene.objects["ball metal"].shadow_terminator_shading_offset = 0.2
    bpy.ops.relume.set_up_passes()
    lines = {each.name: each.text for each in scene.relume.unwired}
    assert "slot 2 has no material" in lines["ball plain"]
    assert "Shading Offset" in lines["ball metal"]


def test_files_are_written_without_loss(folder: Path) -> None:
    """A compression that changes numbers gives way. Pixels that are not square are no obstacle: to the file, and to the
    render that was just made."""
    scene = materials.build_kinds(160, 90)
    settings = scene.render.image_settings
    bpy.ops.relume.set_up_passes()
    settings.exr_codec, scene.render.pixel_aspect_x = "DWAA", 1.6
    assert bpy.ops.relume.set_up_passes() == {"FINISHED"}
    assert settings.exr_codec == "ZIP"
    assert bpy.ops.relume.set_up_passes() == {"CANCELLED"}
    gbuffer = render(scene, folder / "wide.exr")
    assert not gbuffer.notes
    images = []
    for source in ("RENDER", "FILE"):
        scene.relume.source, scene.relume.filepath = source, str(folder / "wide.exr")
        assert bpy.ops.relume.relight() == {"FINISHED"}
        images.append(pixels_of(bpy.data.images["Relit Scene"])[..., :3])
    assert np.abs(images[0] - images[1]).max() <= 2e-5
    errors = relative_errors(images[1], direct_light(scene, folder), interior(gbuffer["material_id"] > 0))
    assert errors.size > 2000 and np.percentile(errors, 99) <= P99_BAR


def test_a_long_chain_of_mixes_is_listed() -> None:
    scene = materials.build_kinds(32, 18)
    tree = bpy.data.materials["plain"].node_tree
    output = tree.get_output_node("CYCLES").inputs["Surface"]
    for _ in range(500):
        mix = tree.nodes.new("ShaderNodeMixShader")
        tree.links.new(output.links[0].from_socket, mix.inputs[1])
        tree.links.new(mix.outputs[0], output)
    bpy.ops.relume.set_up_passes()
    assert [each.text for each in scene.relume.unwired if each.name == "plain"] == [
        "more than 100 shaders are mixed one after the other"
    ]


def test_the_users_own_aov_is_kept() -> None:
    scene = materials.build_kinds(32, 18)
    tree = bpy.data.materials["plain"].node_tree
    own = tree.nodes.new("ShaderNodeOutputAOV")
    own.aov_name = "roughness"
    bpy.ops.relume.set_up_passes()
    assert [node for node in tree.nodes if getattr(node, "aov_name", "") == "roughness"] == [own]
    assert [each.name for each in scene.relume.unwired if "its own AOV" in each.text] == ["plain"]


def test_every_parameter_that_is_read_has_an_aov(module: Callable[[str], Any]) -> None:
    """The table of the model is the measure: generation 5's parameters, but for emission, which is a pass."""
    rows = relume.shaders["blender_principled"].parameters
    generation3 = {"sheen", "clearcoat", "clearcoat_roughness"}
    read = {row.name for row in rows if row.type in ("scalar", "color", "vector")} - generation3 - {"emission"}
    assert set(module("passes").aov_kinds()) == read | {"tangent"}
