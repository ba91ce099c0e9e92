# SPDX-License-Identifier: Apache-2.0
"""Rigs written, loaded and relit by the command line's own code; the frame range, and how it is stopped."""

from __future__ import annotations

import importlib
import itertools
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import bpy
import materials
import numpy as np
import pytest
import relume
from pictures import pixels_of, render


@pytest.fixture
def scene(folder: Path) -> Iterator[Any]:
    """A scene of three frames in which a lamp moves and dims, rendered."""
    scene = materials.build_kinds(96, 54)
    scene.frame_start, scene.frame_end = 1, 3
    lamp = bpy.data.objects["lamp"]
    for frame, place, energy in ((1, -4.0, 900.0), (3, 4.0, 300.0)):
        lamp.location.x, lamp.data.energy = place, energy
        lamp.keyframe_insert("location", frame=frame)
        lamp.data.keyframe_insert("energy", frame=frame)
    bpy.ops.relume.set_up_passes()
    scene.render.filepath = str(folder / "shot.####.exr")
    scene.relume.output_path = str(folder / "relit" / "out.####.exr")
    scene.relume.output.type = "float"
    yield scene


def relit_pixels(path: Path) -> np.ndarray[Any, Any]:
    # A file of parts, Blender 5's default, is answered with parts, which have names; one of 4.5 is not.
    return relume.read_layer(path, "Combined" if bpy.app.version >= (5, 0, 0) else "beauty")[..., :3]


def test_range_is_each_frame_by_its_lights(scene: Any, folder: Path, module: Callable[[str], Any]) -> None:
    bpy.ops.render.render(animation=True)
    scene.frame_set(2)
    assert bpy.ops.relume.relight_range() == {"FINISHED"}
    assert scene.frame_current == 2
    for frame in (1, 2, 3):
        scene.frame_set(frame)
        rig = module("scene_rig").scene_rig(scene, bpy.context.evaluated_depsgraph_get()).rig
        expected = relume.relight(folder / f"shot.{frame:04}.exr", rig)["beauty"][..., :3]
        assert np.abs(relit_pixels(folder / "relit" / f"out.{frame:04}.exr") - expected).max() <= 1e-5
        assert expected.max() > 0.1


def test_written_rig_relights_on_its_own(scene: Any, folder: Path) -> None:
    """Without Blender: the file names the sequence and has keys for what moves."""
    bpy.ops.render.render(animation=True)
    path = folder / "scene.relume"
    assert bpy.ops.relume.write_rig(filepath=str(path)) == {"FINISHED"}
    rig = relume.Rig.load(path)
    assert isinstance(rig.light["lamp"].position, relume.Keys)
    assert isinstance(rig.light["lamp"].power, relume.Keys)
    assert Path(rig.gbuffer.file).name == "shot.####.exr"
    scene.frame_set(3)
    assert bpy.ops.relume.relight_range() == {"FINISHED"}
    relume.relight_file(relume.GBuffer.read(rig=rig, frame=3), rig.at(3), folder / "alone.exr")
    assert np.abs(relit_pixels(folder / "alone.exr") - relit_pixels(folder / "relit" / "out.0003.exr")).max() == 0
    scene.relume.keys_of_animation = False
    bpy.ops.relume.write_rig(filepath=str(path))
    assert relume.Rig.load(path).light["lamp"].position == pytest.approx((4.0, -6.0, 3.0))


def test_hidden_for_a_while(scene: Any, folder: Path) -> None:
    """A light that is not rendered in some frames has no color there."""
    spot = bpy.data.objects["spot"]
    for frame, hidden in ((1, False), (2, True), (3, False)):
        spot.hide_render = hidden
        spot.keyframe_insert("hide_render", frame=frame)
    bpy.ops.relume.write_rig(filepath=str(folder / "scene.relume"))
    rig = relume.Rig.load(folder / "scene.relume")
    assert rig.at(2).light["spot"].color == (0.0, 0.0, 0.0)
    assert min(rig.at(1).light["spot"].color) > 0 and rig.at(1).light["spot"].color == rig.at(3).light["spot"].color


def test_round_trip_of_a_rig(scene: Any, folder: Path, module: Callable[[str], Any]) -> None:
    """Lights of a rig become Blender's, which become the same lights of a rig; the rest stays in a text."""
    text = """version = 1
[[light]]
name = "key"
type = "sun"
direction = [0.3, 0.8, -0.5]
irradiance = [3.0, 2.0, 1.0]
color = [0.5, 1.0, 1.0]
exposure = 0.5
specular = 0.25
[[light]]
name = "bulb"
type = "point"
position = [1.0, -6.0, 2.0]
intensity = 40.0
[[light]]
name = "lamp shade"
type = "spot"
position = [0.0, -8.0, 1.0]
direction = [0.1, 1.0, -0.2]
power = 700.0
cone_angle = 40.0
blend = 0.3
attenuation = [0.04, 0.0, 1.0]
[[light]]
name = "fill"
type = "ambient"
irradiance = 0.1
[[light]]
name = "old"
type = "spot"
position = [0.0, -8.0, 1.0]
falloff = "blender3"
[output]
aovs = ["light:key"]
"""
    path = folder / "given.relume"
    path.write_text(text)
    for thing in [each for each in scene.objects if each.type == "LIGHT"]:
        bpy.data.objects.remove(thing)
    assert bpy.ops.relume.load_rig(filepath=str(path)) == {"FINISHED"}
    bpy.context.view_layer.update()
    assert {each.name for each in scene.objects if each.type == "LIGHT"} == {"key", "bulb", "lamp shade"}
    assert set(relume.Rig.loads(scene.relume.rig_extra.as_string()).light) == {"fill", "old"}
    gbuffer = render(scene, folder / "shot.exr")
    made = module("scene_rig").scene_rig(scene, bpy.context.evaluated_depsgraph_get()).rig
    given = relume.Rig.load(path)
    for use in made.shader:
        given.shader.add(use.use, **{name: getattr(use, name) for name in use._given()})
    assert set(made.light) == set(given.light)
    first, second = relume.relight(gbuffer, made), relume.relight(gbuffer, given)
    for name in ("beauty", "light:key"):
        scale = np.abs(second[name]).max()
        assert np.abs(first[name] - second[name]).max() <= 1e-5 * scale
        assert scale > 0.1


def test_a_broken_rig_changes_nothing(scene: Any, folder: Path) -> None:
    path = folder / "broken.relume"
    path.write_text('version = 1\n[[light]]\ntype = "sunn"\n')
    before = len(bpy.data.lights), len(bpy.data.collections), len(bpy.data.texts)
    with pytest.raises(RuntimeError, match="sunn"):
        bpy.ops.relume.load_rig(filepath=str(path))
    assert before == (len(bpy.data.lights), len(bpy.data.collections), len(bpy.data.texts))


def test_range_says_what_failed(scene: Any, folder: Path) -> None:
    scene.frame_end = 2
    bpy.ops.render.render(animation=True)
    (folder / "shot.0001.exr").write_bytes(b"no EXR")
    with pytest.raises(RuntimeError, match="frame 1"):
        bpy.ops.relume.relight_range()
    assert (folder / "relit" / "out.0002.exr").exists() and not (folder / "relit" / "out.0001.exr").exists()
    scene.relume.output_path = str(folder / "one.exr")
    with pytest.raises(RuntimeError, match="####"):
        bpy.ops.relume.relight_range()


def test_range_beside_the_users_work(scene: Any, folder: Path, module: Callable[[str], Any]) -> None:
    """The modal way, event by event; Blender without windows sends none, so they are made here."""
    bpy.ops.render.render(animation=True)
    calls: list[str] = []

    class Manager:
        def __getattr__(self, name: str) -> Any:
            return lambda *_args, **_keys: calls.append(name)

    context = SimpleNamespace(
        scene=scene,
        window=None,
        window_manager=Manager(),
        workspace=SimpleNamespace(status_text_set=lambda text: calls.append("status")),
        evaluated_depsgraph_get=bpy.context.evaluated_depsgraph_get,
    )
    cls = module("relight_range").RELUME_OT_relight_range
    reports: list[Any] = []
    operator = SimpleNamespace(report=lambda kind, text: reports.append((kind, text)), _work=None, _timer=None)
    operator._begin = lambda context: cls._begin(operator, context)
    operator._end = lambda work: cls._end(operator, work)
    assert cls.invoke(operator, context, None) == {"RUNNING_MODAL"}
    assert cls.modal(operator, context, SimpleNamespace(type="MOUSEMOVE")) == {"PASS_THROUGH"}
    result = {"RUNNING_MODAL"}
    while result == {"RUNNING_MODAL"}:
        time.sleep(0.02)
        result = cls.modal(operator, context, SimpleNamespace(type="TIMER"))
    assert result == {"FINISHED"}
    assert reports == [({"INFO"}, "3 of 3 frames relit")]
    assert {"progress_begin", "progress_update", "progress_end", "event_timer_add", "event_timer_remove"} <= set(calls)
    assert len(list((folder / "relit").iterdir())) == 3


def test_range_stops(scene: Any, folder: Path, module: Callable[[str], Any]) -> None:
    """As Esc does: the frames in flight end, nothing half-written stays."""
    render(scene, folder / "still.exr")
    frames_of = module("relight_range").frames_of
    scene.frame_end = 200
    for number in range(1, 201):
        (folder / f"shot.{number:04}.exr").symlink_to(folder / "still.exr")
    scene.render.filepath = str(folder / "shot.####.exr")
    rig = module("scene_rig").scene_rig(scene, bpy.context.evaluated_depsgraph_get()).rig
    work = module("relight_range").Work(frames_of(scene), rig)
    share, _ = work.news.get(timeout=30)
    assert 0 <= share < 1
    before = len(work.results)
    work.stop()
    work.wait()
    assert len(work.results) < before + 8
    done = [result for result in work.results if result.status == "done"]
    assert work.error is None and len(done) < 200
    files = sorted(path.name for path in (folder / "relit").iterdir())
    assert len(files) <= len(done) + 4 and all(name.endswith(".exr") for name in files)
    assert importlib.import_module("relume").ExrFile(folder / "relit" / files[0]).is_whole()


KEYED = """version = 1
[[light]]
name = "sun"
type = "sun"
direction = { keys = [[1, [0.3, 0.8, -0.5]], [9, [-0.6, 0.5, -0.2]]], interpolation = "smooth" }
irradiance = 2.0
exposure = { keys = [[2, -1.0], [6, 1.5], [10, 0.0]], interpolation = "smooth" }
[[light]]
name = "lamp"
type = "point"
position = { keys = [[1, [-4.0, -6.0, 3.0]], [9, [4.0, -5.0, 2.0]]] }
power = { keys = [[3, 200.0], [5, 900.0], [8, 300.0]], interpolation = "hold" }
color = [1.0, 0.5, 0.25]
[[light]]
name = "torch"
type = "spot"
position = [0.0, -8.0, 1.0]
direction = [0.1, 1.0, -0.2]
intensity = { keys = [[1, [50.0, 40.0, 30.0]], [9, [10.0, 40.0, 90.0]]] }
color = { keys = [[4, [1.0, 1.0, 1.0]], [9, [1.0, 0.2, 0.5]]] }
cone_angle = { keys = [[2, 20.0], [7, 60.0]] }
falloff = "smoothstep"
specular = { keys = [[1, 0.0], [9, 1.0]] }
[[light]]
name = "fill"
type = "ambient"
irradiance = { keys = [[1, 0.0], [9, 0.4]] }
[[shader]]
use = "blender_principled"
distribution = "ggx"
"""


def test_keys_of_a_rig_that_is_loaded(scene: Any, folder: Path, module: Callable[[str], Any]) -> None:
    """Lights keyed over frames are animated in Blender, and are written with keys again: each frame is the rig's."""
    for thing in [each for each in scene.objects if each.type == "LIGHT"]:
        bpy.data.objects.remove(thing)
    path = folder / "keyed.relume"
    path.write_text(KEYED)
    scene.frame_start, scene.frame_end = 1, 10
    scene.frame_set(4)
    assert bpy.ops.relume.load_rig(filepath=str(path)) == {"FINISHED"}
    assert {each.name for each in scene.objects if each.type == "LIGHT"} == {"sun", "lamp", "torch"}
    # A key of the rig that one property holds is one key of the property.
    curve = next(curve for curve in curves_of(bpy.data.objects["lamp"].data) if curve.data_path == "energy")
    assert [tuple(point.co) for point in curve.keyframe_points] == [(3, 200), (5, 900), (8, 300)]
    assert {point.interpolation for point in curve.keyframe_points} == {"CONSTANT"}

    render(scene, folder / "shot.exr")
    scene.relume.source, scene.relume.filepath = "FILE", str(folder / "shot.exr")
    assert bpy.ops.relume.write_rig(filepath=str(folder / "written.relume")) == {"FINISHED"}
    given, written = relume.Rig.load(path), relume.Rig.load(folder / "written.relume")
    pictures = []
    for frame in (1, 2, 4, 5, 7, 8, 10):
        scene.frame_set(frame)
        assert bpy.ops.relume.relight() == {"FINISHED"}
        image = pixels_of(bpy.data.images["Relit Scene"])
        expected = relume.relight(folder / "shot.exr", given.at(frame))["beauty"]
        assert np.abs(image - expected).max() <= 2e-5 * expected.max()
        of_written = relume.relight(folder / "shot.exr", written.at(frame))["beauty"]
        assert np.abs(of_written - expected).max() <= 2e-5 * expected.max()
        pictures.append(expected)
    assert min(np.abs(first - second).max() for first, second in itertools.pairwise(pictures)) > 0.01


def curves_of(owner: Any) -> list[Any]:
    data = owner.animation_data
    bags = [strip.channelbag(data.action_slot) for layer in data.action.layers for strip in layer.strips]
    return [curve for bag in bags if bag is not None for curve in bag.fcurves]


def test_a_loaded_light_that_is_animated(scene: Any, folder: Path) -> None:
    """The rig's own numbers hold as long as nothing moves: with keys in Blender they are keys of Blender's numbers."""
    path = folder / "given.relume"
    path.write_text(
        'version = 1\n[[light]]\nname = "bulb"\ntype = "point"\n'
        "position = [0.1, -6.1, 2.3]\nintensity = [40.1, 30.1, 20.1]\n"
    )
    assert bpy.ops.relume.load_rig(filepath=str(path)) == {"FINISHED"}
    scene.relume.filepath = str(folder / "shot.####.exr")
    bpy.ops.relume.write_rig(filepath=str(folder / "still.relume"))
    still = relume.Rig.load(folder / "still.relume").light["bulb"]
    assert (still.position, still.intensity) == ((0.1, -6.1, 2.3), (40.1, 30.1, 20.1))
    light = bpy.data.lights["bulb"]
    light.keyframe_insert("energy", frame=1)
    light.energy *= 2
    light.keyframe_insert("energy", frame=3)
    bpy.ops.relume.write_rig(filepath=str(folder / "moving.relume"))
    moving = relume.Rig.load(folder / "moving.relume")
    lights = [moving.at(frame).light["bulb"] for frame in (1, 3)]
    strengths = [np.array(light.color) * light.power for light in lights]
    np.testing.assert_allclose(strengths[0], 4 * np.pi * np.array([40.1, 30.1, 20.1]), rtol=1e-6)
    np.testing.assert_allclose(strengths[1], 2 * strengths[0], rtol=1e-6)
