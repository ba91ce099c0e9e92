# SPDX-License-Identifier: Apache-2.0
"""Tells the running Blender's OpenImageIO of relume's plugin, so that Cycles takes a .relume file as a texture."""

from __future__ import annotations

import os
from pathlib import Path

_VARIABLE = "OPENIMAGEIO_PLUGIN_PATH"


def plugin_folder() -> Path:
    """Where the package has the plugin for the OpenImageIO that Blender 4.5 and 5.0 hold."""
    import relume

    return Path(relume.__file__).parent / "oiio" / "3.0"


def register() -> None:
    """Add the folder to what OpenImageIO searches when it first meets a format that it does not know."""
    folder = plugin_folder()
    if folder.is_dir():
        _set([str(folder), *(name for name in _folders() if name != str(folder))])


def unregister() -> None:
    """Take it off again."""
    _set([name for name in _folders() if name != str(plugin_folder())])


def _folders() -> list[str]:
    return [name for name in os.environ.get(_VARIABLE, "").split(os.pathsep) if name]


def _set(folders: list[str]) -> None:
    if folders:
        os.environ[_VARIABLE] = os.pathsep.join(folders)
    else:
        os.environ.pop(_VARIABLE, None)
