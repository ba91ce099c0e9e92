# SPDX-License-Identifier: Apache-2.0
"""Set up passes: thirteen kinds of material, rendered and relit; undo, a second press, and what cannot be wired."""

from __future__ import annotations

import json
from collections.abc import Callable
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
    bpy.data.materials["metal"].node_tree.nodes["Principled BSDF"].inputs["Roughness"].keyframe_insert("default_value")
    bpy.ops.relume.set_up_passes()
    lines = {(each.name, each.icon): each.text for each in scene.relume.unwired}
    assert "Glass" in lines["glass", "ERROR"]
    assert "no Material Output" in lines["empty", "ERROR"]
    assert "no material" in lines["bare", "ERROR"]
    assert "Transmission" in lines["linked", "INFO"]
    assert "Roughness" in lines["metal", "INFO"] and "animated" in lines["metal", "INFO"]
    assert len(lines) == 5


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
