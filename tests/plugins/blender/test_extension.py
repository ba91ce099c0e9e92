# SPDX-License-Identifier: Apache-2.0
"""The extension as such: what it leaves behind, panels, properties, Cycles' textures, other libraries beside it."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import addon_utils
import bpy
import materials
import numpy as np
import pytest
import relume
from conftest import NAME
from pictures import render, write_multilayer


def traces() -> dict[str, Any]:
    """Everything of Blender that an add-on may leave something in."""
    handlers = {
        name: len(getattr(bpy.app.handlers, name))
        for name in dir(bpy.app.handlers)
        if isinstance(getattr(bpy.app.handlers, name), list)
    }
    kinds = (bpy.types.Operator, bpy.types.Panel, bpy.types.PropertyGroup, bpy.types.Menu)
    classes = {each.__name__ for kind in kinds for each in kind.__subclasses__() if each.is_registered}
    properties = {
        f"{kind.__name__}.{name}"
        for kind in (bpy.types.Scene, bpy.types.Light, bpy.types.Material, bpy.types.Image, bpy.types.WindowManager)
        for name in list(kind.bl_rna.properties.keys())
    }
    return {
        "handlers": handlers,
        "classes": {name for name in classes if "relume" in name.lower() or name == "Remark"},
        "properties": properties,
        "operators": set(dir(bpy.ops.relume)),
        "plugins": os.environ.get("OPENIMAGEIO_PLUGIN_PATH"),
    }


def test_unregister_leaves_nothing() -> None:
    there = traces()
    addon_utils.disable(NAME)
    gone = traces()
    addon_utils.enable(NAME)
    assert traces() == there
    assert gone["classes"] == set() and there["classes"]
    assert gone["operators"] == set() and there["operators"]
    assert there["properties"] - gone["properties"] == {"Scene.relume", "Light.relume"}
    assert gone["plugins"] is None
    ours = {"depsgraph_update_post", "frame_change_post", "load_post"}
    ours |= {"render_init", "render_cancel", "render_complete"}
    assert {name for name, count in there["handlers"].items() if count != gone["handlers"][name]} == ours


def test_properties_are_the_tables(module: Callable[[str], Any]) -> None:
    """Name, range, default and help of every property are those of the row that it is made from."""
    settings = bpy.context.scene.relume
    count = 0
    for model in relume.shaders:
        group = getattr(settings.shaders, model)
        for row in relume.shaders[model].parameters:
            if row.type == "table":
                continue
            made = group.bl_rna.properties[row.name]
            assert made.description == row.help.split("\n")[0].rstrip(".")
            if row.type == "scalar":
                assert made.default == pytest.approx(row.default)
                assert row.min == pytest.approx(made.hard_min) or not np.isfinite(row.min)
                assert row.max == pytest.approx(made.hard_max) or not np.isfinite(row.max)
            if row.type == "choice":
                assert [item.identifier for item in made.enum_items] == list(row.choices)
            count += 1
    assert count > 100
    assert {"mode", "aovs", "type", "compression", "metadata"} <= set(settings.output.bl_rna.properties.keys())
    light = bpy.data.lights.new("light", "SUN")
    assert {"diffuse", "specular"} <= set(light.relume.bl_rna.properties.keys())
    light.relume.diffuse = -5.0
    assert light.relume.diffuse == 0.0
    assert "transmission" not in light.relume.bl_rna.properties or module("properties").light_rows()


class _Layout:
    """Stands for a panel's layout: every property and operator that is drawn must be there."""

    def __init__(self) -> None:
        self.drawn: list[str] = []

    def row(self, **_: Any) -> _Layout:
        return self

    column = row

    def prop(self, owner: Any, name: str, **_: Any) -> None:
        assert name in owner.bl_rna.properties
        self.drawn.append(name)

    def operator(self, name: str, **_: Any) -> Any:
        category, _, word = name.partition(".")
        assert word in dir(getattr(bpy.ops, category))
        self.drawn.append(name)
        return type("Properties", (), {})()

    def label(self, **_: Any) -> None:
        pass


def test_panels_draw(module: Callable[[str], Any]) -> None:
    scene = bpy.context.scene
    scene.relume.source = "FILE"
    light = bpy.data.lights.new("light", "SUN")
    context = type("Context", (), {"scene": scene, "light": light})()
    drawn = []
    for panel in module("panels").CLASSES:
        layout = _Layout()
        panel.draw(type("Panel", (), {"layout": layout})(), context)
        assert layout.drawn, panel
        drawn += layout.drawn
    operators = {cls.bl_idname for cls in (*module("operators").CLASSES, *module("relight_range").CLASSES)}
    assert operators <= set(drawn)


def test_import_does_nothing() -> None:
    """Importing the add-on neither loads relume nor registers anything."""
    program = (
        f"import sys, importlib; before = set(sys.modules); m = importlib.import_module({Path(NAME).name!r});"
        "print(sorted(n for n in set(sys.modules) - before if n.split('.')[0] in ('relume', 'numpy', 'bpy')))"
    )
    home = Path(bpy.utils.user_resource("EXTENSIONS")) / "user_default"
    (home / "bl_ext").mkdir(exist_ok=True)
    program = program.replace(repr(Path(NAME).name), "'relume_addon'")
    link = home / "relume_addon"
    if not link.exists():
        link.symlink_to(home / "relume")
    try:
        done = subprocess.run([sys.executable, "-c", program], cwd=home, capture_output=True, text=True, check=True)
    finally:
        link.unlink()
        (home / "bl_ext").rmdir()
    assert done.stdout.strip() == "[]"


def test_libraries_beside_each_other(folder: Path) -> None:
    """Blender's OpenEXR, OpenColorIO and OpenImageIO and relume's own OpenEXR in turn, in one process."""
    scene = materials.build_kinds(32, 18)
    bpy.ops.relume.set_up_passes()
    assert np.lib.NumpyVersion(np.__version__) < "2.0.0"
    for number in range(3):
        gbuffer = render(scene, folder / f"{number}.exr")
        rig = relume.Rig.loads('version = 1\n[[light]]\ntype = "sun"\n')
        relume.relight_file(gbuffer, rig, folder / f"relit{number}.exr")
        image = bpy.data.images.load(str(folder / f"relit{number}.exr"))
        assert tuple(image.size) == (32, 18) and image.has_data is not None
        assert image.pixels[0] is not None
        settings = scene.render.image_settings
        if hasattr(settings, "media_type"):
            settings.media_type = "IMAGE"
        settings.file_format = "PNG"
        scene.view_settings.view_transform = ("AgX", "Filmic", "Standard")[number]
        image.save_render(str(folder / f"{number}.png"), scene=scene)
        assert (folder / f"{number}.png").stat().st_size > 100
        write_multilayer(scene)


def plugin_is_inside() -> bool:
    return (Path(relume.__file__).parent / "oiio" / "3.0" / "relume.imageio.so").exists()


def test_plugin_path(module: Callable[[str], Any]) -> None:
    """The variable names the plugin's folder while the add-on is on, beside what was there; nothing without plugin."""
    oiio = module("oiio")
    folder = oiio.plugin_folder()
    before = os.environ.pop("OPENIMAGEIO_PLUGIN_PATH", None)
    made = not folder.is_dir()
    if made:
        oiio.register()
        assert "OPENIMAGEIO_PLUGIN_PATH" not in os.environ
        folder.mkdir(parents=True)
    try:
        os.environ["OPENIMAGEIO_PLUGIN_PATH"] = "/other"
        oiio.register()
        oiio.register()
        assert os.environ["OPENIMAGEIO_PLUGIN_PATH"] == f"{folder}{os.pathsep}/other"
        oiio.unregister()
        assert os.environ.pop("OPENIMAGEIO_PLUGIN_PATH") == "/other"
    finally:
        if made:
            folder.rmdir()
            folder.parent.rmdir()
        if before is not None:
            os.environ["OPENIMAGEIO_PLUGIN_PATH"] = before


def test_cycles_takes_a_rig_as_a_texture(folder: Path) -> None:
    """An environment texture on a .relume file shows the relit picture."""
    assert plugin_is_inside(), "the wheel has no OpenImageIO plugin"
    scene = materials.build_kinds(64, 32)
    bpy.ops.relume.set_up_passes()
    gbuffer = render(scene, folder / "shot.exr")
    rig = relume.Rig.loads('version = 1\n[[light]]\ntype = "ambient"\n[gbuffer]\nfile = "shot.exr"\n')
    rig.save(folder / "scene.relume")
    expected = relume.relight(gbuffer, rig)["beauty"][..., :3].astype(np.float64)
    scene = materials.empty_scene(64, 32, samples=64)
    tree = scene.world.node_tree
    texture = tree.nodes.new("ShaderNodeTexEnvironment")
    texture.image = bpy.data.images.load(str(folder / "scene.relume"))
    background, output = tree.nodes.new("ShaderNodeBackground"), tree.nodes.new("ShaderNodeOutputWorld")
    tree.links.new(texture.outputs["Color"], background.inputs["Color"])
    tree.links.new(background.outputs[0], output.inputs["Surface"])
    camera = bpy.data.cameras.new("panorama")
    camera.type = "PANO"
    (camera if hasattr(camera, "panorama_type") else camera.cycles).panorama_type = "EQUIRECTANGULAR"
    scene.camera = bpy.data.objects.new("panorama", camera)
    scene.collection.objects.link(scene.camera)
    scene.camera.rotation_euler = (np.pi / 2, 0, -np.pi / 2)
    scene.render.filepath = str(folder / "panorama.exr")
    write_multilayer(scene)
    bpy.ops.render.render(write_still=True)
    image = relume.read_layer(folder / "panorama.exr", "ViewLayer.Combined")[..., :3]
    assert expected.max() > 0.1
    assert np.percentile(np.abs(image - expected), 95) <= 2e-3
