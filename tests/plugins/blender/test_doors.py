# SPDX-License-Identifier: Apache-2.0
"""The same pixels through every door: a G-buffer and a rig give, bit for bit, the same in the command line, Python,
OpenImageIO, OpenFX and Blender."""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy
import materials
import numpy as np
import pytest
import relume
from pictures import pixels_of, render

DATA = Path(__file__).resolve().parents[2] / "data"

#: Suns, points and spots with numbers that single precision does not hold, among lights that Blender has none for.
LIGHTS = """
[[light]]
name = "sky"
type = "sky"
up = [0, 0, 1]
sky_color = [0.05, 0.063, 0.088]

[[light]]
name = "key"
type = "sun"
direction = [0.371, 0.799, -0.463]
irradiance = [2.1, 1.9, 1.7]
exposure = 0.3

[[light]]
name = "gilt alone"
type = "point"
position = [-1.0, -4.0, 4.0]
power = 300.0
include = ["Ball_gilt", "Ball_*k"]

[[light]]
name = "bulb"
type = "point"
position = [-2.7, -3.1, 3.3]
power = 417.3
color = [1.0, 0.7, 0.31]
attenuation = [0.013, 0.0, 1.0]

[[light]]
name = "lamp shade"
type = "spot"
position = [3.3, -4.1, 5.7]
direction = [-0.41, 0.57, -0.83]
intensity = [57.1, 61.3, 70.7]
cone_angle = 41.7
blend = 0.37
falloff = "smoothstep"
specular = 0.7
"""

#: Facets of both kinds, by Cryptomatte, which share pixels where the frame is antialiased.
SHADERS = """
[[shader]]
use = "blender_principled"
cryptomatte = ["g*", "varnish"]
distribution = "ggx"

[[shader]]
use = "blender_principled"
distribution = "multi_ggx"
"""


def command(*words: str | Path) -> None:
    """The command line of the package that Blender has, by a Python that has click."""
    environment = os.environ | {"PYTHONPATH": str(Path(relume.__file__).parents[1])}
    done = subprocess.run(
        [os.environ["RELUME_PYTHON"], "-m", "relume.cli", *map(str, words)],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr


def beauty(path: Path) -> np.ndarray[Any, Any]:
    """(H, W, 4) of a relit EXR; a file of parts is answered with parts."""
    names = relume.ExrFile(path).parts[0].name
    return relume.read_layer(path, "Combined" if names else "")


def openimageio(rig: Path) -> np.ndarray[Any, Any]:
    """(H, W, 4): what a program sees that opens the rig by PyPI's OpenImageIO, in a process of its own."""
    plugin = Path(relume.__file__).parent / "oiio" / "3.2" / "relume.imageio.so"
    assert plugin.exists()
    code = "import sys, numpy, OpenImageIO as oiio\nimage = oiio.ImageBuf(sys.argv[1])\n"
    code += "assert not image.has_error, image.geterror()\nassert image.spec().format == oiio.FLOAT\n"
    code += "numpy.save(sys.argv[2], image.get_pixels(oiio.FLOAT))\n"
    environment = os.environ | {"OPENIMAGEIO_PLUGIN_PATH": str(plugin.parent)}
    words = [os.environ["RELUME_PYTHON"], "-c", code, str(rig), str(rig.with_suffix(".npy"))]
    done = subprocess.run(words, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return np.load(rig.with_suffix(".npy"))


def openfx(rig: Path, context: str) -> np.ndarray[Any, Any]:
    """(H, W, 4): what the node gives a host in this context; the rig names the file."""
    raw = rig.with_suffix(".raw")
    words = [os.environ["RELUME_OFX_RENDER"], str(rig), "-", str(raw), context]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    return np.fromfile(raw, np.float32).reshape(told["height"], told["width"], 4)


def same_bits(first: np.ndarray[Any, Any], second: np.ndarray[Any, Any]) -> bool:
    assert first.dtype == second.dtype == np.float32
    return np.array_equal(np.ascontiguousarray(first).view(np.uint32), np.ascontiguousarray(second).view(np.uint32))


def built_in(folder: Path) -> Path:
    command("scene", "sdf", "--size", "256x144", "--samples", 4, "-o", folder / "sdf.exr")
    return folder / "sdf.exr"


def of_blender(name: str) -> Callable[[Path], Path]:
    return lambda _folder: DATA / "blender5" / name


@pytest.mark.parametrize(
    "make, text",
    [
        (built_in, str(relume.Rig.builtin("sdf"))),
        (of_blender("atelier_main_aa_gbuffer.exr"), f"version = 1\n{LIGHTS}{SHADERS}"),
        (of_blender("vitrine_main_point_gbuffer.exr"), f"version = 1\n{LIGHTS}{SHADERS}"),
        (of_blender("atelier_shift_point_gbuffer.exr"), f'version = 1\n{LIGHTS}[output]\nmode = "add"\n{SHADERS}'),
    ],
    ids=["sdf", "antialiased", "all layers", "added to the beauty"],
)
def test_five_doors(make: Callable[[Path], Path], text: str, folder: Path) -> None:
    gbuffer, rig = make(folder), folder / "given.relume"
    whole = relume.Rig.loads(text)
    whole.gbuffer.file, whole.output.type = str(gbuffer), "float"
    whole.save(rig)
    command("relight", "--rig", rig, "-o", folder / "relit.exr")
    of_command = beauty(folder / "relit.exr")
    assert same_bits(relume.relight(gbuffer, rig)["beauty"], of_command)
    assert same_bits(openimageio(rig), of_command)
    for context in ("generator", "filter", "general"):
        assert same_bits(openfx(rig, context), of_command), context

    scene = materials.empty_scene(32, 18)
    assert bpy.ops.relume.load_rig(filepath=str(rig)) == {"FINISHED"}
    scene.relume.source, scene.relume.filepath = "FILE", str(gbuffer)
    assert bpy.ops.relume.relight() == {"FINISHED"}
    image = bpy.data.images["Relit Scene"]
    assert same_bits(pixels_of(image), of_command)
    assert np.isfinite(of_command).all() and np.percentile(of_command[..., :3], 90) > 0.05

    # A second time, by what is kept of the file, and after a light was elsewhere meanwhile.
    light = next(thing for thing in scene.objects if thing.type == "LIGHT")
    place, energy = light.rotation_euler.copy(), light.data.energy
    light.rotation_euler, light.data.energy = (0.3, 0.2, 0.1), 2 * energy
    bpy.ops.relume.relight()
    assert not same_bits(pixels_of(image), of_command)
    light.rotation_euler, light.data.energy = place, energy
    bpy.ops.relume.relight()
    assert same_bits(pixels_of(image), of_command)


def test_a_scene_of_blenders_own(folder: Path) -> None:
    """The scene's lights and materials: what the rig that is written gives outside, with light linking and both kinds
    of facets."""
    scene = materials.build_kinds(160, 90)
    scene.cycles.samples, scene.cycles.filter_width, scene.render.film_transparent = 8, 1.5, True
    bpy.ops.relume.set_up_passes()
    receivers = bpy.data.collections.new("receivers")
    for thing in [each for each in scene.objects if each.type == "MESH"][:4]:
        receivers.objects.link(thing)
    bpy.data.objects["lamp"].light_linking.receiver_collection = receivers
    render(scene, folder / "shot.exr")
    scene.relume.source, scene.relume.filepath = "FILE", str(folder / "shot.exr")
    scene.relume.output.type = "float"
    assert bpy.ops.relume.relight() == {"FINISHED"}
    assert bpy.ops.relume.write_rig(filepath=str(folder / "scene.relume")) == {"FINISHED"}
    command("relight", "--rig", folder / "scene.relume", "-o", folder / "relit.exr")
    of_command = beauty(folder / "relit.exr")
    assert same_bits(pixels_of(bpy.data.images["Relit Scene"]), of_command)
    assert same_bits(relume.relight(folder / "shot.exr", folder / "scene.relume")["beauty"], of_command)
    rig = relume.Rig.load(folder / "scene.relume")
    assert rig.light["lamp"].include and {use.distribution for use in rig.shader} == {"ggx", "multi_ggx"}
