# SPDX-License-Identifier: Apache-2.0
"""Rigs written, loaded and relit by the command line's own code; the frame range, and how it is stopped."""

from __future__ import annotations

import importlib
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
from pictures import render


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
    work.stop()
    start = time.perf_counter()
    work.wait()
    assert time.perf_counter() - start < 5
    done = [result for result in work.results if result.status == "done"]
    assert work.error is None and len(done) < 200
    files = sorted(path.name for path in (folder / "relit").iterdir())
    assert len(files) <= len(done) + 4 and all(name.endswith(".exr") for name in files)
    assert importlib.import_module("relume").ExrFile(folder / "relit" / files[0]).is_whole()
