# SPDX-License-Identifier: Apache-2.0
"""docs/images/blender.png: Cycles' render of a scene, relume's by the same lights, and by others that were moved.

Run by ./dev blender-picture in the Python of the module bpy, with the extension's archive and the PNG to write. What
the extension does is done through its buttons.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix, Vector

SIZE = (480, 270)


def material(name: str, distribution: str = "GGX", **inputs: Any) -> Any:
    """A Principled BSDF with these inputs."""
    made = bpy.data.materials.new(name)
    if bpy.app.version < (5, 0, 0):
        made.use_nodes = True
    node = made.node_tree.nodes["Principled BSDF"]
    node.distribution = distribution
    for key, value in inputs.items():
        socket = node.inputs[key.replace("_", " ")]
        socket.default_value = (*value, 1.0) if isinstance(value, tuple) else value
    return made


def textured(made: Any, name: str, scale: float, low: tuple[float, ...], high: tuple[float, ...]) -> None:
    """A noise between two colors for an input."""
    tree = made.node_tree
    where, noise, mix = (
        tree.nodes.new(kind) for kind in ("ShaderNodeTexCoord", "ShaderNodeTexNoise", "ShaderNodeMixRGB")
    )
    noise.inputs["Scale"].default_value = scale
    mix.inputs[1].default_value, mix.inputs[2].default_value = (*low, 1.0), (*high, 1.0)
    tree.links.new(where.outputs["Object"], noise.inputs["Vector"])
    tree.links.new(noise.outputs[0], mix.inputs[0])
    tree.links.new(mix.outputs[0], tree.nodes["Principled BSDF"].inputs[name])


def thing(add: str, made: Any, at: tuple[float, float, float], turn: float = 0.0, **keys: Any) -> Any:
    """A mesh with a material, smooth."""
    getattr(bpy.ops.mesh, f"primitive_{add}_add")(location=at, rotation=(0, 0, turn), **keys)
    result = bpy.context.object
    result.data.materials.append(made)
    if add != "plane":
        bpy.ops.object.shade_smooth()
    return result


def aimed(place: tuple[float, float, float], target: tuple[float, float, float]) -> Matrix:
    """A matrix that looks from a place to another."""
    direction = Vector(target) - Vector(place)
    return Matrix.Translation(place) @ direction.to_track_quat("-Z", "Y").to_matrix().to_4x4()


def light(kind: str, place: tuple[float, float, float], energy: float, color: tuple[float, float, float]) -> Any:
    """A light that looks at the middle."""
    made = bpy.data.objects.new(kind.lower(), bpy.data.lights.new(kind.lower(), kind))
    made.matrix_world = aimed(place, (0, 0, 0.8))
    made.data.energy, made.data.color = energy, color
    bpy.context.scene.collection.objects.link(made)
    return made


def build() -> Any:
    """The scene, for Cycles."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.device = "CYCLES", "CPU"
    scene.cycles.samples, scene.cycles.use_denoising = 256, False
    scene.cycles.caustics_reflective = False
    scene.render.resolution_x, scene.render.resolution_y = SIZE

    floor = material("floor", Roughness=0.35)
    textured(floor, "Base Color", 1.3, (0.30, 0.19, 0.11), (0.14, 0.09, 0.06))
    thing("plane", floor, (0, 0, 0), size=60)
    wall = thing("plane", material("wall", Base_Color=(0.35, 0.33, 0.30), Roughness=0.8), (0, 5, 0), size=60)
    wall.rotation_euler.x = math.pi / 2
    paint = material("paint", Base_Color=(0.55, 0.02, 0.02), Roughness=0.45, Coat_Weight=1.0, Coat_Roughness=0.05)
    monkey = thing("monkey", paint, (0, 0, 1.03), 0.3, size=2.0)
    monkey.modifiers.new("smooth", "SUBSURF").render_levels = 3
    gold = material("gold", "MULTI_GGX", Base_Color=(0.95, 0.62, 0.22), Metallic=1.0, Roughness=0.28)
    thing("uv_sphere", gold, (-2.35, 0.5, 0.8), radius=0.8, segments=96, ring_count=48)
    cloth = material("cloth", Base_Color=(0.03, 0.10, 0.16), Roughness=0.8, Sheen_Weight=1.0, Sheen_Roughness=0.35)
    thing("torus", cloth, (2.3, 0.3, 0.42), major_radius=0.75, minor_radius=0.42, major_segments=96, minor_segments=48)
    glaze = material("glaze", Roughness=0.12)
    textured(glaze, "Base Color", 4.0, (0.02, 0.25, 0.22), (0.75, 0.85, 0.70))
    thing("uv_sphere", glaze, (-1.05, -1.75, 0.45), radius=0.45, segments=96, ring_count=48)
    steel = material("steel", Base_Color=(0.6, 0.62, 0.65), Metallic=1.0, Roughness=0.3, Anisotropic=0.8)
    thing("cylinder", steel, (1.35, -1.8, 0.35), radius=0.4, depth=0.7, vertices=128)

    light("SUN", (-4, -3, 5), 2.2, (1.0, 0.93, 0.85))
    light("POINT", (-3.2, -4.2, 3.6), 700.0, (1.0, 0.88, 0.72))
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.lens = 46
    camera.matrix_world = aimed((0.2, -8.2, 2.7), (0, 0, 0.72))
    scene.collection.objects.link(camera)
    scene.camera = camera
    return scene


def picture(image: Any) -> np.ndarray[Any, Any]:
    """(H, W, 4), bottom row first."""
    pixels = np.empty((SIZE[1], SIZE[0], 4), np.float32)
    image.pixels.foreach_get(pixels.reshape(-1))
    return pixels


def relit() -> np.ndarray[Any, Any]:
    """What the button Relight makes of the scene's lights as they are."""
    bpy.context.view_layer.update()
    bpy.ops.relume.relight()
    return picture(bpy.data.images["Relit Scene"])


def main() -> None:
    """Render, relight, move the lights, relight, and write the three side by side."""
    archive, target = (str(Path(word).resolve()) for word in sys.argv[1:3])
    bpy.ops.extensions.package_install_files(filepath=archive, repo="user_default")
    scene = build()
    bpy.ops.relume.set_up_passes()
    folder = Path(bpy.app.tempdir)
    scene.render.filepath = str(folder / "shot.####.exr")
    scene.frame_start = scene.frame_end = 1
    bpy.ops.render.render(animation=True)
    scene.relume.source = "FILE"
    import relume

    combined = relume.GBuffer.read(folder / "shot.0001.exr")["beauty"][::-1]
    by_cycles = np.concatenate([combined, np.ones((*combined.shape[:2], 1), np.float32)], axis=2)
    as_rendered = relit()

    sun, lamp = bpy.data.objects["sun"], bpy.data.objects["point"]
    sun.matrix_world = aimed((5, -2, 2.2), (0, 0, 0.8))
    sun.data.energy, sun.data.color = 1.8, (0.45, 0.6, 1.0)
    lamp.matrix_world = aimed((3.4, -3.2, 1.6), (0, 0, 0.8))
    lamp.data.energy, lamp.data.color = 450.0, (1.0, 0.35, 0.12)
    spot = light("SPOT", (-4.5, -2.5, 4.0), 4000.0, (0.55, 0.25, 1.0))
    spot.data.spot_size, spot.data.spot_blend = math.radians(42), 0.6
    moved = relit()

    row = np.concatenate([by_cycles, as_rendered, moved], axis=1)
    image = bpy.data.images.new("row", row.shape[1], row.shape[0], float_buffer=True)
    image.pixels.foreach_set(row.reshape(-1))
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):
        settings.media_type = "IMAGE"
    settings.file_format, settings.color_mode, settings.color_depth, settings.compression = "PNG", "RGB", "8", 100
    image.save_render(target, scene=scene)


if __name__ == "__main__":
    main()
