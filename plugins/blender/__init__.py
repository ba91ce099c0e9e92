# SPDX-License-Identifier: Apache-2.0
"""Relume in Blender: sets a scene's passes up, and relights its renders by its own lights, while they move."""

from __future__ import annotations


def register() -> None:
    """Classes, properties, handlers, and the plugin for Cycles' textures."""
    import bpy

    from . import live, oiio, operators, panels, properties, relight_range

    properties.register()
    for each in (*operators.CLASSES, *relight_range.CLASSES, *panels.CLASSES):
        bpy.utils.register_class(each)
    live.register()
    oiio.register()


def unregister() -> None:
    """Everything away again; nothing stays behind."""
    import bpy

    from . import live, oiio, operators, panels, properties, relight_range

    oiio.unregister()
    live.unregister()
    for each in reversed((*operators.CLASSES, *relight_range.CLASSES, *panels.CLASSES)):
        bpy.utils.unregister_class(each)
    properties.unregister()
