# SPDX-License-Identifier: Apache-2.0
"""The relit picture: of the render just made and of files, live, with proxies, in the compositor."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import bpy
import materials
import numpy as np
import pytest
import relume
from pictures import pixels_of, render

IMAGE = "Relit Scene"


@pytest.fixture
def scene(folder: Path) -> Iterator[Any]:
    """A small scene of every kind of material, set up."""
    scene = materials.build_kinds(160, 90)
    bpy.ops.relume.set_up_passes()
    scene.render.filepath = str(folder / "shot.####.exr")
    yield scene
    scene.relume.live = False


def picture() -> np.ndarray[Any, Any]:
    return pixels_of(bpy.data.images[IMAGE])


def agree(image: np.ndarray[Any, Any], expected: np.ndarray[Any, Any]) -> bool:
    """The same bits."""
    return np.array_equal(np.ascontiguousarray(image).view(np.uint32), expected.view(np.uint32))


def nearly(image: np.ndarray[Any, Any], expected: np.ndarray[Any, Any]) -> bool:
    """The same but for a camera that is recovered from other pixels of the positions: a render that is not written yet
    has other chunks than its file."""
    return bool((np.abs(image - expected) <= 2e-5 * (1 + np.abs(expected))).all())


def by_file(scene: Any, path: Path, module: Callable[[str], Any]) -> np.ndarray[Any, Any]:
    """The same by relume alone, from the file, by the rig that would be written."""
    made = module("scene_rig").scene_rig(scene, bpy.context.evaluated_depsgraph_get())
    return relume.relight(path, made.rig)["beauty"]


def test_the_render_just_made(scene: Any, folder: Path, module: Callable[[str], Any]) -> None:
    render(scene, folder / "shot.exr")
    settings = scene.render.image_settings
    settings.color_depth = "16"
    assert bpy.ops.relume.relight() == {"FINISHED"}
    assert settings.color_depth == "16"
    assert nearly(picture(), by_file(scene, folder / "shot.exr", module))
    bpy.data.objects["lamp"].data.energy = 0.0
    bpy.ops.render.render()
    bpy.ops.relume.relight()
    assert nearly(picture(), by_file(scene, folder / "shot.exr", module))


def test_antialiased_with_a_transparent_film(scene: Any, folder: Path, module: Callable[[str], Any]) -> None:
    scene.cycles.samples, scene.cycles.filter_width, scene.render.film_transparent = 16, 1.5, True
    render(scene, folder / "shot.exr")
    assert bpy.ops.relume.relight() == {"FINISHED"}
    file, image = by_file(scene, folder / "shot.exr", module), picture()
    assert ((image[..., 3] > 0.01) & (image[..., 3] < 0.99)).sum() > 500
    assert np.percentile(np.abs(image - file), 99) <= 2e-5
    scene.relume.source, scene.relume.filepath = "FILE", str(folder / "shot.exr")
    assert bpy.ops.relume.relight() == {"FINISHED"}
    assert agree(picture(), file)


def test_live(scene: Any, folder: Path, module: Callable[[str], Any]) -> None:
    """Whatever changes of a light is in the picture at once."""
    path = folder / "shot.exr"
    render(scene, path)
    scene.relume.source, scene.relume.filepath = "FILE", str(path)
    scene.relume.live = True
    lamp, spot = bpy.data.objects["lamp"], bpy.data.objects["spot"]

    def check() -> None:
        before = picture()
        bpy.context.view_layer.update()
        after = picture()
        assert np.abs(after - before).max() > 1e-3
        assert agree(after, by_file(scene, path, module))

    lamp.location.x -= 2
    check()
    lamp.data.exposure = 1.5
    check()
    spot.data.temperature = 9000.0
    check()
    spot.data.spot_size = 0.3
    check()
    lamp.hide_render = True
    check()
    scene.relume.live = False
    frozen = picture()
    spot.data.energy = 1.0
    bpy.context.view_layer.update()
    assert (picture() == frozen).all()


def test_live_is_quiet_while_rendering(
    scene: Any, folder: Path, module: Callable[[str], Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """An animation that is rendered with the switch on relights no frame on the way: once at most, when it is over."""
    render(scene, folder / "shot.exr")
    scene.relume.source, scene.relume.filepath = "FILE", str(folder / "shot.exr")
    scene.relume.live = True
    lamp = bpy.data.objects["lamp"]
    for frame, place in ((1, -4.0), (4, 1.0)):
        lamp.location.x = place
        lamp.keyframe_insert("location", frame=frame)
    bpy.context.view_layer.update()
    live, calls = module("live"), []
    relight_scene = live.relight_scene
    monkeypatch.setattr(live, "relight_scene", lambda *args: (calls.append(args), relight_scene(*args)))
    scene.frame_start, scene.frame_end = 1, 4
    scene.render.filepath = str(folder / "other.####.exr")
    bpy.ops.render.render(animation=True)
    assert len(calls) <= 1
    scene.frame_set(3)
    assert len(calls) >= 1
    assert agree(picture(), by_file(scene, folder / "shot.exr", module))


def test_live_settings(scene: Any, folder: Path, module: Callable[[str], Any]) -> None:
    """What is set of the model replaces the render's channels; more of a rig joins by a text."""
    path = folder / "shot.exr"
    render(scene, path)
    scene.relume.source, scene.relume.filepath = "FILE", str(path)
    scene.relume.live = True
    first = picture()
    scene.relume.shaders.blender_principled.roughness = 0.9
    scene.relume.shaders.blender_principled.use_roughness = True
    rough = picture()
    assert np.abs(rough - first).max() > 1e-2
    assert agree(rough, by_file(scene, path, module))
    text = bpy.data.texts.new("more")
    text.write('version = 1\n[[light]]\nname = "fill"\ntype = "ambient"\nirradiance = 0.5\n')
    scene.relume.rig_extra = text
    assert np.abs(picture() - rough).max() > 1e-2
    assert agree(picture(), by_file(scene, path, module))
    scene.relume.shader = "lambert"
    assert agree(picture(), by_file(scene, path, module))


def test_no_lights_and_no_render(scene: Any, folder: Path) -> None:
    with pytest.raises(RuntimeError, match=r"missing\.exr"):
        scene.relume.source, scene.relume.filepath = "FILE", str(folder / "missing.exr")
        bpy.ops.relume.relight()
    render(scene, folder / "shot.exr")
    for thing in [each for each in scene.objects if each.type == "LIGHT"]:
        bpy.data.objects.remove(thing)
    scene.relume.filepath = str(folder / "shot.exr")
    assert bpy.ops.relume.relight() == {"FINISHED"}
    gbuffer = relume.GBuffer.read(folder / "shot.exr")
    assert np.abs(picture()[..., :3] - gbuffer["emission"]).max() <= 1e-6


def test_a_render_without_passes_says_so(folder: Path) -> None:
    scene = materials.build_kinds(32, 18)
    bpy.ops.render.render()
    with pytest.raises(RuntimeError, match="normal"):
        bpy.ops.relume.relight()
    assert scene is not None


def test_a_proxy_is_every_second_pixel(scene: Any, folder: Path, module: Callable[[str], Any]) -> None:
    scene.render.resolution_x, scene.render.resolution_y = 161, 91
    gbuffer = render(scene, folder / "shot.exr")
    rig = module("scene_rig").base_rig(scene)
    frame = module("frames").LoadedFrame(gbuffer, rig)
    lights = module("scene_lights").scene_lights(scene, bpy.context.evaluated_depsgraph_get()).lights
    frame.relight(scene, lights)
    whole = frame.pixels[::-1].copy()
    frame.relight(scene, lights, 2)
    proxy = frame.pixels[::-1]
    assert (proxy[::2, ::2] == whole[::2, ::2]).all()
    assert (proxy[1::2] == proxy[:-1:2]).all() and (proxy[:, 1::2] == proxy[:, :-1:2]).all()


def test_compositor_takes_the_image(scene: Any, folder: Path) -> None:
    """The picture goes through an Image node: rendered through the compositor it is what the datablock holds."""
    render(scene, folder / "shot.exr")
    bpy.ops.relume.relight()
    expected = picture()
    if bpy.app.version >= (5, 0, 0):
        tree = bpy.data.node_groups.new("compositing", "CompositorNodeTree")
        scene.compositing_node_group = tree
        tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
        output = tree.nodes.new("NodeGroupOutput")
    else:
        scene.use_nodes = True
        tree = scene.node_tree
        tree.nodes.clear()
        output = tree.nodes.new("CompositorNodeComposite")
    node = tree.nodes.new("CompositorNodeImage")
    node.image = bpy.data.images[IMAGE]
    tree.links.new(node.outputs["Image"], output.inputs[0])
    scene.render.use_compositing = True
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):
        settings.media_type = "IMAGE"
    settings.file_format, settings.color_depth, settings.color_mode = "OPEN_EXR", "32", "RGB"
    scene.render.filepath = str(folder / "composite.exr")
    bpy.ops.render.render(write_still=True)
    green = relume.read_layer(folder / "composite.exr", "")
    assert np.abs(green[..., 1] - expected[..., 1]).max() <= 1e-5


def test_a_light_that_moves_reads_nothing(scene: Any, folder: Path, module: Callable[[str], Any]) -> None:
    """What makes it quick (tests/bench has the times): the file, which is emptied here, is read once."""
    path = folder / "shot.exr"
    render(scene, path)
    content, status = path.read_bytes(), path.stat()
    scene.relume.source, scene.relume.filepath = "FILE", str(path)
    scene.relume.live = True
    path.write_bytes(bytes(len(content)))
    os.utime(path, ns=(status.st_atime_ns, status.st_mtime_ns))
    pictures = []
    for step in (1, 2, 1):
        bpy.data.objects["lamp"].location.x -= 1
        bpy.data.objects["spot"].data.energy *= 1.5
        bpy.context.view_layer.update()
        module("live").relight_scene(scene, bpy.context.evaluated_depsgraph_get(), step)
        pictures.append(picture())
    scene.relume.live = False
    path.write_bytes(content)
    assert agree(pictures[2], by_file(scene, path, module))
    assert (pictures[1][1::2] == pictures[1][::2]).all() and pictures[1].max() > 0.1


def test_the_temporary_file_goes(scene: Any, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The render that was just made is in a file as long as it is relit, and no longer."""
    place = folder / "temporary"
    place.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(place))
    bpy.ops.render.render()
    scene.relume.live = True
    assert len(list(place.iterdir())) == 1
    bpy.ops.render.render()
    bpy.ops.relume.relight()
    assert len(list(place.iterdir())) == 1
    scene.relume.live = False
    assert list(place.iterdir()) == []
