# SPDX-License-Identifier: Apache-2.0
"""Renders the truth scenes: G-buffers, the renderer's own images under known lights, and a JSON with all the numbers.

    nice blender -b --factory-startup -P tests/truth/make_scenes.py -- OUTPUT_FOLDER  # Blender 3.4 (apt): orrery
    nice python tests/truth/make_scenes.py OUTPUT_FOLDER                     # bpy 5.0.1 (PyPI): atelier, vitrine

Each Blender makes the scenes of its own generation. The files that a clone holds (tests/data/blender3 and blender5)
came from exactly these commands; two threads need about a minute each.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parent))

import bpy
import scene_builder
from scene_data import DEFAULTS, SCENES

FILTERS = {"point": 0.01, "aa": 1.5}


def _setup(render: dict[str, Any], camera: dict[str, Any]) -> None:
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.threads_mode = "FIXED"
    scene.render.threads = 2
    scene.render.resolution_x, scene.render.resolution_y = camera["size"]
    scene.render.resolution_percentage = 100
    scene.render.pixel_aspect_x = max(1.0, camera.get("pixel_aspect", 1.0))
    scene.render.pixel_aspect_y = scene.render.pixel_aspect_x / camera.get("pixel_aspect", 1.0)
    scene.render.film_transparent = render["film_transparent"]
    scene.render.use_persistent_data = False
    scene.view_settings.view_transform = "Raw"
    scene.display_settings.display_device = "sRGB"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples = render["samples"]
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.pixel_filter_type = "BLACKMAN_HARRIS"
    cycles.filter_width = FILTERS[render["filter"]]
    cycles.max_bounces = 0
    cycles.light_sampling_threshold = 0.0
    cycles.blur_glossy = 0.0
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    if hasattr(cycles, "use_light_tree"):
        cycles.use_light_tree = False


def _passes(levels: int, layers: bool) -> None:
    layer = bpy.context.view_layer
    layer.use_pass_z = layer.use_pass_normal = layer.use_pass_position = True
    layer.use_pass_diffuse_color = True
    layer.use_pass_object_index = layer.use_pass_material_index = True
    layer.use_pass_cryptomatte_object = layer.use_pass_cryptomatte_material = True
    layer.pass_cryptomatte_depth = levels
    layer.use_pass_emit = layers
    for name in (*scene_builder.AOVS, *(scene_builder.LAYER_AOVS if layers else ())):
        aov = layer.aovs.add()
        aov.name = name
        aov.type = "COLOR" if scene_builder.is_color(name) else "VALUE"


def _enable(lights: list[str]) -> None:
    for thing in bpy.data.objects:
        if thing.type == "LIGHT":
            thing.hide_render = thing.name not in lights


def _write(path: Path, multilayer: bool, depth: str) -> None:
    scene = bpy.context.scene
    settings = scene.render.image_settings
    if scene_builder.BLENDER5:
        settings.media_type = "MULTI_LAYER_IMAGE" if multilayer else "IMAGE"
    settings.file_format = "OPEN_EXR_MULTILAYER" if multilayer else "OPEN_EXR"
    settings.color_mode = "RGBA" if multilayer else "RGB"
    settings.color_depth = depth
    settings.exr_codec = "ZIP"
    if scene_builder.BLENDER5:
        # One part per pass is Blender 5's default, but it fails with a pixel aspect (the parts disagree on it).
        settings.use_exr_interleave = not multilayer or scene.render.pixel_aspect_x != scene.render.pixel_aspect_y
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)


def _matrix(matrix: Any) -> list[list[float]]:
    return [list(row) for row in matrix]


def _describe(name: str, scene: dict[str, Any]) -> dict[str, Any]:
    """What a rig and a reference need, with the numbers that Blender holds in single precision."""
    cameras, lights = {}, {}
    for key, spec in scene["cameras"].items():
        thing = bpy.data.objects[f"camera_{key}"]
        cameras[key] = {
            "matrix_world": _matrix(thing.matrix_world),
            "lens_mm": thing.data.lens,
            "sensor_width_mm": thing.data.sensor_width,
            "shift": [thing.data.shift_x, thing.data.shift_y],
            "pixel_aspect": spec.get("pixel_aspect", 1.0),
            "resolution": list(spec["size"]),
        }
    for key in scene["lights"]:
        thing = bpy.data.objects[key]
        axis = thing.matrix_world.to_3x3() @ scene_builder.Vector((0, 0, -1))
        lights[key] = {
            "type": thing.data.type,
            "energy": thing.data.energy,
            "color": list(thing.data.color),
            "location": list(thing.matrix_world.translation),
            "direction": list(axis.normalized()),
        }
        if thing.data.type == "SPOT":
            lights[key] |= {"spot_size_rad": thing.data.spot_size, "spot_blend": thing.data.spot_blend}
    defaults = DEFAULTS[scene["generation"]]
    return {
        "scene": name,
        "blender": bpy.app.version_string,
        "generation": scene["generation"],
        "cameras": cameras,
        "lights": lights,
        "materials": {
            key: {"pass_index": index, "bsdf": "principled"} | defaults | spec
            for index, (key, spec) in enumerate(scene["materials"].items(), start=1)
        },
        "objects": {
            spec["name"]: {"pass_index": index, "material": spec["material"]}
            for index, spec in enumerate(scene["objects"], start=1)
        },
        "gbuffers": [],
        "images": [],
    }


def _plan(scene: dict[str, Any]) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """G-buffers and images to render: which camera, filter, light and material variant.

    One light at a time: with several, Cycles picks one per sample at random, and the sum of the single images is
    cleaner than any affordable image of all.
    """
    filters = scene.get("filters", tuple(FILTERS))
    gbuffers = [
        {"camera": "main", "filter": "point", "samples": 4, "film_transparent": False, "cryptomatte_levels": 2},
        {"camera": "main", "filter": "aa", "samples": 64, "film_transparent": True, "cryptomatte_levels": 4},
        {"camera": "shift", "filter": "point", "samples": 4, "film_transparent": False, "cryptomatte_levels": 2},
    ]
    views = [("main", "point", 4, light) for light in scene["lights"]] + [("main", "aa", 256, "sun")]
    views += [("shift", "point", 4, light) for light in scene["lights"]]
    images = [
        {"camera": camera, "filter": kind, "samples": samples, "light": light, "variant": variant}
        for variant in scene.get("variants", ("principled", "lambertggx"))
        for camera, kind, samples, light in views
    ]

    def wanted(each: dict[str, Any]) -> bool:
        return each["camera"] in scene["cameras"] and each["filter"] in filters

    return list(filter(wanted, gbuffers)), list(filter(wanted, images))


def make(name: str, scene: dict[str, Any], folder: Path) -> None:
    """One scene with all its files."""
    depth, layers = scene.get("depth", "16"), scene.get("layers", False)
    scene_builder.build(scene)
    facts = _describe(name, scene)
    gbuffers, images = _plan(scene)
    for image in images:
        scene_builder.build_materials(scene, image["variant"])
        _setup(image | {"film_transparent": False}, scene["cameras"][image["camera"]])
        bpy.context.scene.camera = bpy.data.objects[f"camera_{image['camera']}"]
        _enable([image["light"]])
        image["file"] = f"{name}_{image['camera']}_{image['filter']}_{image['light']}_{image['variant']}.exr"
        _write(folder / image["file"], False, depth)
        facts["images"].append(image)
    scene_builder.build_materials(scene, "principled")
    _enable(list(scene["lights"]))
    _passes(2, layers)
    for gbuffer in gbuffers:
        _setup(gbuffer, scene["cameras"][gbuffer["camera"]])
        bpy.context.view_layer.pass_cryptomatte_depth = gbuffer["cryptomatte_levels"]
        bpy.context.scene.camera = bpy.data.objects[f"camera_{gbuffer['camera']}"]
        gbuffer["file"] = f"{name}_{gbuffer['camera']}_{gbuffer['filter']}_gbuffer.exr"
        _write(folder / gbuffer["file"], True, depth)
        facts["gbuffers"].append(gbuffer)
    (folder / f"{name}.json").write_text(json.dumps(facts, indent=1) + "\n", encoding="utf-8")


def main(folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for name, scene in SCENES.items():
        if scene["generation"] == scene_builder.GENERATION:
            make(name, scene, folder)


if __name__ == "__main__":
    main(Path(sys.argv[-1]).resolve())
