# SPDX-License-Identifier: Apache-2.0
"""What goes wrong is said in the panel or the report, Blender stays up, and next time the pixels are right."""

from __future__ import annotations

import os
import resource
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import bpy
import materials
import numpy as np
import pytest
import relume
from pictures import pixels_of, render


@pytest.fixture
def scene(folder: Path) -> Iterator[Any]:
    """A small scene, set up and rendered, whose EXR is the one to relight."""
    scene = materials.build_kinds(96, 54)
    bpy.ops.relume.set_up_passes()
    render(scene, folder / "shot.exr")
    scene.relume.source, scene.relume.filepath = "FILE", str(folder / "shot.exr")
    yield scene
    scene.relume.live = False


def said(scene: Any) -> str:
    """What the panel lists as wrong."""
    return " ".join(each.text for each in scene.relume.remarks if each.icon == "ERROR")


def move_lamp() -> None:
    """A change that live follows at once."""
    bpy.data.objects["lamp"].location.x += 0.5
    bpy.context.view_layer.update()


def is_right(scene: Any, module: Callable[[str], Any], gbuffer: Path) -> bool:
    """Whether the scene's picture has the bits of a relight from the file."""
    rig = module("scene_rig").scene_rig(scene, bpy.context.evaluated_depsgraph_get()).rig
    expected = relume.relight(gbuffer, rig.at(scene.frame_current))["beauty"]
    image = pixels_of(bpy.data.images[f"Relit {scene.name}"])
    return expected.max() > 0.1 and image.tobytes() == expected.tobytes()


def test_nothing_is_rendered() -> None:
    scene = materials.build_kinds(32, 18)
    with pytest.raises(RuntimeError, match=r"no render yet: render the frame \(F12\)"):
        bpy.ops.relume.relight()
    scene.relume.live = True
    assert "no render yet" in said(scene)
    bpy.ops.relume.set_up_passes()
    bpy.ops.render.render()
    move_lamp()
    assert said(scene) == "" and bpy.data.images["Relit Scene"].size[:] == (32, 18)
    scene.relume.live = False


def test_a_file_that_is_missing(scene: Any, folder: Path, module: Callable[[str], Any]) -> None:
    scene.relume.live = True
    assert is_right(scene, module, folder / "shot.exr")
    (folder / "shot.exr").rename(folder / "away.exr")
    move_lamp()
    assert str(folder / "shot.exr") in said(scene)
    (folder / "away.exr").rename(folder / "shot.exr")
    move_lamp()
    assert said(scene) == "" and is_right(scene, module, folder / "shot.exr")


def test_a_rig_with_an_error(scene: Any, folder: Path, module: Callable[[str], Any]) -> None:
    """Of a file and of the text that joins the scene's rig: with line and column, and what was meant."""
    path = folder / "broken.relume"
    path.write_text('version = 1\n[[light]]\ntype = "sunn"\n')
    with pytest.raises(RuntimeError, match=r"broken\.relume:3:1; did you mean 'sun'"):
        bpy.ops.relume.load_rig(filepath=str(path))
    text = bpy.data.texts.new("more")
    text.write('version = 1\n[[light]]\nname = "fill"\ntype = "ambient"\niradiance = 0.5\n')
    scene.relume.rig_extra = text
    scene.relume.live = True
    assert "Text 'more':5:1; did you mean 'irradiance'" in said(scene)
    with pytest.raises(RuntimeError, match="Text 'more':5:1"):
        bpy.ops.relume.write_rig(filepath=str(folder / "written.relume"))
    text.from_string(text.as_string().replace("iradiance", "irradiance"))
    move_lamp()
    assert said(scene) == "" and is_right(scene, module, folder / "shot.exr")
    before = pixels_of(bpy.data.images["Relit Scene"])[..., :3].mean()
    text.from_string(text.as_string().replace("0.5", "0.9"))
    assert bpy.ops.relume.relight() == {"FINISHED"}
    assert pixels_of(bpy.data.images["Relit Scene"])[..., :3].mean() > before + 0.01


def test_a_light_for_which_a_channel_is_missing(folder: Path, module: Callable[[str], Any]) -> None:
    scene = materials.build_kinds(96, 54)
    bpy.ops.relume.set_up_passes()
    view_layer = bpy.context.view_layer
    view_layer.use_pass_position = view_layer.use_pass_z = False
    render(scene, folder / "shot.exr")
    scene.relume.source, scene.relume.filepath = "FILE", str(folder / "shot.exr")
    with pytest.raises(RuntimeError, match="'lamp' is a point light and needs positions"):
        bpy.ops.relume.relight()
    for name in ("lamp", "spot"):
        bpy.data.objects[name].hide_render = True
    assert bpy.ops.relume.relight() == {"FINISHED"}
    assert is_right(scene, module, folder / "shot.exr")


def test_a_file_that_changes_while_live(scene: Any, folder: Path, module: Callable[[str], Any]) -> None:
    """Rendered again, half written, and whole again."""
    path = folder / "shot.exr"
    scene.relume.live = True
    assert is_right(scene, module, path)
    camera = scene.camera
    camera.location.x += 1.5
    scene.relume.live = False
    render(scene, path)
    scene.relume.live = True
    move_lamp()
    assert is_right(scene, module, path)
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 3])
    move_lamp()
    assert str(path) in said(scene)
    path.write_bytes(whole)
    move_lamp()
    assert said(scene) == "" and is_right(scene, module, path)
    # In place, under the reader's hands, and of another size.
    scene.render.resolution_x = 64
    scene.relume.live = False
    render(scene, folder / "smaller.exr")
    scene.relume.live = True
    move_lamp()
    shutil.copyfile(folder / "smaller.exr", path)
    move_lamp()
    assert said(scene) == "" and is_right(scene, module, path)
    assert bpy.data.images["Relit Scene"].size[0] == 64


def test_two_scenes_in_turn(scene: Any, folder: Path, module: Callable[[str], Any]) -> None:
    other = scene.copy()
    other.name = "Other"
    other.relume.filepath = str(folder / "other.exr")
    bpy.data.objects["spot"].data.energy *= 0.5
    scene.render.resolution_x = 80
    render(scene, folder / "other.exr")
    for _ in range(2):
        for each, name, width in ((scene, "shot.exr", 96), (other, "other.exr", 80)):
            with bpy.context.temp_override(scene=each, view_layer=each.view_layers[0]):
                assert bpy.ops.relume.relight() == {"FINISHED"}
                assert is_right(each, module, folder / name)
            assert bpy.data.images[f"Relit {each.name}"].size[0] == width


def test_two_frames_in_turn(scene: Any, folder: Path, module: Callable[[str], Any]) -> None:
    """The frame goes to and fro, live: each time that frame's file and that frame's lights."""
    lamp = bpy.data.objects["lamp"]
    for frame in (1, 2):
        scene.frame_set(frame)
        lamp.location.x = 4.0 - 6.0 * (frame - 1)
        lamp.keyframe_insert("location", frame=frame)
        scene.camera.location.x = 0.7 * frame
        render(scene, folder / f"frame.{frame:04}.exr")
    scene.relume.filepath = str(folder / "frame.####.exr")
    scene.relume.live = True
    for frame in (1, 2, 1, 2):
        scene.frame_set(frame)
        assert is_right(scene, module, folder / f"frame.{frame:04}.exr")
    scene.frame_set(3)
    assert "frame.0003.exr" in said(scene)
    scene.frame_set(1)
    assert said(scene) == "" and is_right(scene, module, folder / "frame.0001.exr")


def no_files_above(size: int) -> Callable[[], None]:
    """As a disk that is full. Returns what takes the limit off again."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    return lambda: resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_no_space_for_a_range(scene: Any, folder: Path) -> None:
    scene.frame_start, scene.frame_end = 1, 2
    for frame in (1, 2):
        shutil.copyfile(folder / "shot.exr", folder / f"shot.{frame:04}.exr")
    scene.relume.filepath = str(folder / "shot.####.exr")
    scene.relume.output_path = str(folder / "relit" / "out.####.exr")
    scene.relume.output.type = "float"
    free = no_files_above(4096)
    try:
        with pytest.raises(RuntimeError, match=r"frame 1: .*out\.0001\.exr.*[Ff]ile too large"):
            bpy.ops.relume.relight_range()
    finally:
        free()
    assert list((folder / "relit").iterdir()) == []
    assert bpy.ops.relume.relight_range() == {"FINISHED"}
    assert all(relume.ExrFile(path).is_whole() for path in (folder / "relit").iterdir())
    assert len(list((folder / "relit").iterdir())) == 2


def test_a_range_never_goes_over_its_renders(scene: Any, folder: Path) -> None:
    scene.frame_start, scene.frame_end = 1, 2
    for frame in (1, 2):
        shutil.copyfile(folder / "shot.exr", folder / f"shot.{frame:04}.exr")
    before = (folder / "shot.0001.exr").read_bytes()
    scene.relume.filepath = scene.relume.output_path = str(folder / "shot.####.exr")
    with pytest.raises(RuntimeError, match=r"shot\.0001\.exr: the output would overwrite an input"):
        bpy.ops.relume.relight_range()
    assert (folder / "shot.0001.exr").read_bytes() == before
    scene.relume.output_path = ""
    with pytest.raises(RuntimeError, match="no output: say where"):
        bpy.ops.relume.relight_range()


def test_a_rig_without_a_name(scene: Any, folder: Path) -> None:
    with pytest.raises(RuntimeError, match="it names no file"):
        bpy.ops.relume.write_rig(filepath="")


def test_no_space_for_the_render(scene: Any) -> None:
    """The render that was just made goes through a temporary file."""
    scene.relume.source = "RENDER"
    for size in (0, 300_000):  # when the file is made, and while it is written
        free = no_files_above(size)
        try:
            with pytest.raises(RuntimeError, match="free space"):
                bpy.ops.relume.relight()
        finally:
            free()
    assert bpy.ops.relume.relight() == {"FINISHED"}
    assert np.isfinite(pixels_of(bpy.data.images["Relit Scene"])).all()


def elsewhere(folder: Path, program: str, **variables: str) -> subprocess.CompletedProcess[str]:
    """A program in a Blender of its own, whose user has nothing yet."""
    resources = folder / "user"
    shutil.rmtree(resources, ignore_errors=True)
    resources.mkdir()
    environment = os.environ | {"BLENDER_USER_RESOURCES": str(resources)} | variables
    command = [sys.executable, "-c", program]
    return subprocess.run(command, env=environment, capture_output=True, text=True, check=False)


def renamed(archive: Path, target: Path, old: str, new: str) -> None:
    """A ZIP file with the names in it changed."""
    with zipfile.ZipFile(archive) as source, zipfile.ZipFile(target, "w") as changed:
        for entry in source.infolist():
            content = source.read(entry)
            if entry.filename.endswith(".toml"):
                content = content.replace(old.encode(), new.encode())
            changed.writestr(entry.filename.replace(old, new), content)


def with_wheel(archive: Path, folder: Path, change: Callable[[Path, Path], None]) -> Path:
    """The extension with its wheel changed."""
    target = folder / "changed.zip"
    with zipfile.ZipFile(archive) as source, zipfile.ZipFile(target, "w") as changed:
        for entry in source.infolist():
            content = source.read(entry)
            if entry.filename.endswith(".whl"):
                (folder / "old.whl").write_bytes(content)
                change(folder / "old.whl", folder / "new.whl")
                content = (folder / "new.whl").read_bytes()
            changed.writestr(entry.filename, content)
    return target


@pytest.mark.parametrize("inside", [False, True], ids=["by its name", "by what is in it"])
def test_a_wheel_of_another_python(inside: bool, folder: Path) -> None:
    """As after an update of Blender: Blender's own word where the wheel's name tells, else the extension's."""
    archive, other = Path(os.environ["RELUME_BLENDER_EXTENSION"]), folder / "other.zip"
    if inside:
        other = with_wheel(archive, folder, lambda old, new: renamed(old, new, "cpython-311", "cpython-39"))
    else:
        renamed(archive, other, "cp311", "cp39")
    program = f"""
import bpy
try:
    bpy.ops.extensions.package_install_files(filepath={str(other)!r}, repo="user_default")
    bpy.ops.preferences.addon_enable(module="bl_ext.user_default.relume")
except RuntimeError as error:
    print("SAID", error)
print("registered", hasattr(bpy.types.Scene, "relume"), len(bpy.app.handlers.load_post))
bpy.ops.wm.read_homefile(use_factory_startup=True)
print("up", len(bpy.data.objects))
"""
    done = elsewhere(folder, program)
    everything = done.stdout + done.stderr
    assert done.returncode == 0 and "up 3" in done.stdout, everything
    assert "registered False" in done.stdout
    if inside:
        assert "Relume: the package in this extension does not load in Blender" in everything, everything
        assert "with Python 3.11" in everything and "Install the extension that was built for it" in everything
    else:
        assert "(3.11)" in everything and "compatible with (3.9)" in everything, everything


def test_textures_with_a_cache_of_nothing(folder: Path) -> None:
    """RELUME_CACHE_MB=0: the plugin keeps no frame, and renders the same picture each time."""
    test = Path(__file__).with_name("test_extension.py")
    program = f"""
import pytest, sys
sys.exit(pytest.main(["-q", "-p", "no:cacheprovider", {str(test)!r}, "-k", "rig_as_a_texture"]))
"""
    done = elsewhere(folder, program, RELUME_CACHE_MB="0")
    assert done.returncode == 0 and "1 passed" in done.stdout, done.stdout + done.stderr
