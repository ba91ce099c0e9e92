# SPDX-License-Identifier: Apache-2.0
"""Materials at the ends of what a Principled BSDF takes, and lit from the side: the relit picture is Cycles'."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import bpy
import materials
import numpy as np
import pytest
from pictures import Array, direct_light, interior, pixels_of, relative_errors, render

Make = Callable[[Any], Any]


def _linked(tree: Any, node: Any, values: dict[str, Any]) -> Any:
    """Numbers that no slider takes come by a link."""
    for name, value in values.items():
        if isinstance(value, tuple):
            source = tree.nodes.new("ShaderNodeCombineXYZ")
            for place, each in enumerate(value):
                source.inputs[place].default_value = each
        else:
            source = tree.nodes.new("ShaderNodeValue")
            source.outputs[0].default_value = value
        tree.links.new(source.outputs[0], node.inputs[name])
    return node


def _bumped(tree: Any, node: Any, strength: float) -> Any:
    """Facets that turn to a light which the surface itself is turned away from."""
    bump = tree.nodes.new("ShaderNodeBump")
    bump.inputs["Strength"].default_value, bump.inputs["Distance"].default_value = strength, 0.1
    where, noise = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeTexNoise")
    noise.inputs["Scale"].default_value = 3.0
    tree.links.new(where.outputs["Object"], noise.inputs["Vector"])
    tree.links.new(noise.outputs[0], bump.inputs["Height"])
    tree.links.new(bump.outputs[0], node.inputs["Normal"])
    return node


def _brown(tree: Any, distribution: str = "GGX", **inputs: Any) -> Any:
    return materials._principled(tree, distribution, **{"Base_Color": (0.5, 0.3, 0.2), "Roughness": 0.4} | inputs)


def _gold(tree: Any, distribution: str = "GGX", **inputs: Any) -> Any:
    return _brown(tree, distribution, Base_Color=(0.9, 0.7, 0.4), Metallic=1.0, **inputs)


STRETCHED = {"Roughness": 0.95, "Anisotropic": 0.9}
KINDS: dict[str, Make] = {
    # alpha along the tangent would pass 1
    "stretched": lambda tree: _brown(tree, **STRETCHED),
    "stretched, compensated": lambda tree: _brown(tree, "MULTI_GGX", **STRETCHED),
    "stretched metal, compensated": lambda tree: _gold(tree, "MULTI_GGX", **STRETCHED),
    "coat and sheen above 1 on a bump": lambda tree: _linked(
        tree,
        _bumped(tree, _brown(tree, Coat_Roughness=0.3, Sheen_Tint=(0.3, 0.2, 0.5), Coat_Tint=(0.9, 0.6, 0.05)), 0.2),
        {"Coat Weight": 1.5, "Sheen Weight": 1.3},
    ),
    "a coat over a bump that reflects nothing": lambda tree: _bumped(
        tree, _brown(tree, Specular_IOR_Level=0.0, Coat_Weight=0.8, Coat_Roughness=0.3), 0.3
    ),
    "reflects more than all": lambda tree: _brown(tree, IOR=10.0, Specular_IOR_Level=1.0),
    "a tint below 0": lambda tree: _linked(tree, _brown(tree), {"Specular Tint": (-0.5, 0.2, 0.8)}),
    "steep bump": lambda tree: _bumped(tree, _brown(tree, Roughness=0.6, IOR=2.0), 0.6),
    "steep bump on metal": lambda tree: _bumped(tree, _gold(tree, Roughness=0.8), 1.0),
    # An object and a material of one name: what is said of the material is not said of the object.
    "multi": lambda tree: _gold(tree, "MULTI_GGX", Roughness=0.8),
    "namesake": lambda tree: _gold(tree, Roughness=0.8),
}


@pytest.fixture(scope="module")
def relit(tmp_path_factory: pytest.TempPathFactory) -> tuple[Array, Array, Array]:
    """(relit by the button, Cycles' direct light, material indices)."""
    folder = tmp_path_factory.mktemp("awkward")
    scene = materials.empty_scene(320, 130)
    for place, (name, make) in enumerate(KINDS.items()):
        material, tree, output = materials._new(name)
        materials._surface(tree, output, make(tree))
        material.pass_index = place + 1
        bpy.ops.mesh.primitive_uv_sphere_add(segments=192, ring_count=96, radius=0.95)
        thing = bpy.context.object
        thing.name = "multi" if name == "namesake" else f"ball {name}"
        thing.location = (2.0 * (place % 6) - 5.0, 0.0, 1.0 - 2.0 * (place // 6))
        bpy.ops.object.shade_smooth()
        thing.data.materials.append(material)
        materials.unshadowed(thing)
    materials.add_camera(20.0, 55.0)
    materials.add_light("side", "SUN", (-8, -1.5, 2), (0, 0, 0), energy=3.0)
    materials.add_light("lamp", "POINT", (6, -3, 3), (0, 0, 0), energy=900.0)
    bpy.context.view_layer.update()
    bpy.ops.relume.set_up_passes()
    gbuffer = render(scene, folder / "awkward.exr")
    scene.relume.source, scene.relume.filepath = "FILE", str(folder / "awkward.exr")
    assert bpy.ops.relume.relight() == {"FINISHED"}
    image = pixels_of(bpy.data.images["Relit Scene"])[..., :3]
    return image, direct_light(scene, folder), gbuffer["material_id"]


@pytest.mark.parametrize("kind", KINDS)
def test_material_is_cycles(kind: str, relit: tuple[Array, Array, Array]) -> None:
    image, truth, ids = relit
    where = interior(ids == list(KINDS).index(kind) + 1)
    errors = relative_errors(image, truth, where)
    assert errors.size > 800
    print(f"{kind}: median {np.median(errors):.1e}, p99 {np.percentile(errors, 99):.1e}")
    assert np.median(errors) <= 8e-4
    assert np.percentile(errors, 99) <= 3e-3
    # What Cycles leaves black has no relative error. A facet's own plane is a degree off the smooth normal.
    dark = where & (truth.min(axis=-1) <= 1e-3)
    assert np.percentile(np.abs(image - truth)[dark].max(axis=-1), 95, method="higher") <= 1e-3 if dark.any() else True
