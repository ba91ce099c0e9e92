# SPDX-License-Identifier: Apache-2.0
"""Renders of a scene, and pictures compared: errors by pixel, interiors, an image datablock's pixels."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy
import numpy as np
import relume

Array = np.ndarray[Any, Any]


def write_multilayer(scene: Any) -> None:
    """32-bit multilayer EXR, without the extension's help."""
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):
        settings.media_type = "MULTI_LAYER_IMAGE"
    settings.file_format, settings.color_depth = "OPEN_EXR_MULTILAYER", "32"


def render(scene: Any, path: Path) -> relume.GBuffer:
    """Render the frame into a file, and read that."""
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    return relume.GBuffer.read(path)


def direct_light(scene: Any, folder: Path) -> Array:
    """Cycles' own picture: each light's alone, summed, what glows counted once. One light at a time, since Cycles takes
    one of several for each sample."""
    lights = [thing for thing in scene.objects if thing.type == "LIGHT" and not thing.hide_render]
    total, emission = 0.0, None
    for light in lights:
        for other in lights:
            other.hide_render = other is not light
        gbuffer = render(scene, folder / f"{light.name}.exr")
        total = total + gbuffer["beauty"][..., :3]
        emission = gbuffer["emission"]
    for light in lights:
        light.hide_render = False
    return total - (len(lights) - 1) * emission


def pixels_of(image: Any) -> Array:
    """(H, W, 4), row 0 at the top."""
    width, height = image.size
    flat = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(flat)
    return flat.reshape(height, width, 4)[::-1]


def interior(mask: Array) -> Array:
    """Pixels all of whose neighbours are in the mask too."""
    inner = mask.copy()
    for rows in (-1, 0, 1):
        for columns in (-1, 0, 1):
            inner &= np.roll(mask, (rows, columns), (0, 1))
    return inner


def relative_errors(image: Array, truth: Array, where: Array) -> Array:
    """The worst of R, G, B where the truth is more than 1e-3; NaN counts as infinite."""
    where = where & (truth.min(axis=-1) > 1e-3)
    error = (np.abs(image - truth)[where] / truth[where]).max(axis=-1)
    return np.nan_to_num(error, nan=np.inf)
