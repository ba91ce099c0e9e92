# SPDX-License-Identifier: Apache-2.0
"""Relume in Blender: sets a scene's passes up, and relights its renders by its own lights, while they move."""

from __future__ import annotations


def _check_package() -> None:
    """Blender looks at the wheel's name alone: what is inside may still be of another Python or platform.

    Raises:
        ImportError: the package relume does not load here.
    """
    import sys

    import bpy

    try:
        from relume import _relume  # noqa: F401  (the package itself loads it when it is needed)
    except ImportError as error:
        python = ".".join(map(str, sys.version_info[:2]))
        raise ImportError(
            f"Relume: the package in this extension does not load in Blender {bpy.app.version_string} with Python "
            f"{python} on {sys.platform}: {error}. Install the extension that was built for it"
        ) from None


def register() -> None:
    """Classes, properties, handlers, and the plugin for Cycles' textures."""
    _check_package()

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
