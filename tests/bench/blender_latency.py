# SPDX-License-Identifier: Apache-2.0
"""From a light to pixels in Blender: run by bench_doors.py in the Python of the module bpy, with the extension.

A frame of 1920×1080, spheres of thirteen kinds of material that use all layers of the Principled BSDF, four lights.
What is measured ends when the relit picture is in the image datablock. Prints JSON.
"""

from __future__ import annotations

import importlib
import json
import sys
import time
from collections.abc import Callable
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "plugins" / "blender"))

import materials  # the tests' scene

SIZE = (1920, 1080)


def need_scene(folder: Path) -> bpy.types.Scene:
    """The scene, rendered; made by the first run."""
    blend, exr = folder / "latency.blend", folder / "latency.exr"
    if blend.exists() and exr.exists():
        bpy.ops.wm.open_mainfile(filepath=str(blend))
        return bpy.context.scene
    scene = materials.build_kinds(*SIZE)
    materials.add_light("rim", "POINT", (-4, -5, 3), (0, 0, 0), energy=500.0)
    bpy.ops.relume.set_up_passes()
    from pictures import render  # knows relume, which the extension brings

    render(scene, exr)
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))
    return scene


class Steps:
    """Milliseconds of each step, one list a step."""

    def __init__(self) -> None:
        self.times: dict[str, list[float]] = {}

    def measure(self, name: str, work: Callable[[], object]) -> object:
        start = time.perf_counter()
        result = work()
        self.times.setdefault(name, []).append(1e3 * (time.perf_counter() - start))
        return result


def main() -> None:
    archive, folder, repeats = Path(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3])
    bpy.ops.extensions.package_install_files(filepath=str(archive), repo="user_default")
    live, scene_lights, picture = (
        importlib.import_module(f"bl_ext.user_default.relume.{name}") for name in ("live", "scene_lights", "picture")
    )
    scene = need_scene(folder)
    scene.relume.source, scene.relume.filepath = "FILE", str(folder / "latency.exr")
    lamp = bpy.data.objects["lamp"]
    steps = Steps()

    def change(place: int) -> None:
        lamp.location.x += 0.1 if place % 2 else -0.1
        lamp.data.energy *= 1.01

    def update() -> None:
        bpy.context.view_layer.update()

    # As it runs: Blender without windows relights in the handler, before update() returns.
    scene.relume.live = True
    for place in range(repeats + 2):
        change(place)
        steps.measure("whole frame", update)
    frame = live.loaded_frame()
    lines = [(each.name, each.text) for each in scene.relume.remarks]
    live._state.busy = True  # the steps by hand from here on
    for place in range(repeats + 2):
        change(place)
        start = time.perf_counter()
        update()
        live.relight_scene(scene, bpy.context.evaluated_depsgraph_get(), 2)
        steps.times.setdefault("proxy", []).append(1e3 * (time.perf_counter() - start))
    for place in range(repeats + 2):
        change(place)
        steps.measure("depsgraph", update)
        graph = bpy.context.evaluated_depsgraph_get()
        lights = steps.measure("scene_lights()", lambda graph=graph: scene_lights.scene_lights(scene, graph).lights)
        start = time.perf_counter()
        report = frame.relight(scene, lights)
        spent = time.perf_counter() - start
        steps.times.setdefault("core", []).append(1e3 * report.seconds)
        steps.times.setdefault("rig and call", []).append(1e3 * (spent - report.seconds))
        image = picture.relit_image(scene, frame.size)
        flat = frame.pixels.reshape(-1)
        steps.measure("foreach_set", lambda image=image, flat=flat: image.pixels.foreach_set(flat))
        steps.measure("image.update()", image.update)
    print(
        json.dumps(
            {
                "blender": bpy.app.version_string,
                "remarks": lines,
                "times": {name: values[2:] for name, values in steps.times.items()},
            }
        )
    )


if __name__ == "__main__":
    main()
