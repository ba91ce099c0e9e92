# SPDX-License-Identifier: Apache-2.0
"""The relit picture as an image datablock: for the Image Editor, and for the compositor's Image node."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy

if TYPE_CHECKING:
    from .frames import LoadedFrame

#: Custom property of the image of a scene.
_OF_SCENE = "relume_scene"


def picture_name(scene: bpy.types.Scene) -> str:
    """What the image of a scene is called."""
    return f"Relit {scene.name}"


def relit_image(scene: bpy.types.Scene, size: tuple[int, int]) -> bpy.types.Image:
    """The scene's relit image in this size, float and linear; made where there is none."""
    image = next((each for each in bpy.data.images if each.get(_OF_SCENE) == scene.name), None)
    if image is None:
        image = bpy.data.images.new(picture_name(scene), *size, alpha=True, float_buffer=True)
        image[_OF_SCENE] = scene.name
        image.alpha_mode = "PREMUL"
        image.use_view_as_render = True
    elif tuple(image.size) != size:
        image.scale(*size)
    return image


def show(scene: bpy.types.Scene, frame: LoadedFrame) -> bpy.types.Image:
    """Bring a relit frame into the scene's image; whatever shows the image is drawn again."""
    image = relit_image(scene, frame.size)
    image.pixels.foreach_set(frame.pixels.reshape(-1))
    image.update()
    image.update_tag()
    manager = bpy.context.window_manager
    for window in manager.windows if manager is not None else ():
        for area in window.screen.areas:
            if area.type == "IMAGE_EDITOR" and area.spaces.active.image == image:
                area.tag_redraw()
    return image


def open_in_editor(image: bpy.types.Image) -> None:
    """Show the image in the first Image Editor that shows nothing, a render, or a relit picture."""
    manager = bpy.context.window_manager
    for window in manager.windows if manager is not None else ():
        for area in window.screen.areas:
            space = area.spaces.active
            if area.type != "IMAGE_EDITOR":
                continue
            if space.image is None or space.image.type in ("RENDER_RESULT", "COMPOSITING") or _OF_SCENE in space.image:
                space.image = image
                return
