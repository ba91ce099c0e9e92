# SPDX-License-Identifier: Apache-2.0
"""Relume relights rendered images from their G-buffers.

    import relume

    gbuffer = relume.GBuffer.read("shot.exr")
    rig = relume.Rig.load("key.relume")
    rig.light["key"].exposure = 1
    result = relume.relight(gbuffer, rig)
    result["beauty"]  # (height, width, 4) float32, scene-linear, premultiplied

Directions point away from the surface, except a light's ``direction``, which is where its light travels. Angles are in
degrees, lengths in the G-buffer's own unit, colours scene-linear in the working space. Arrays are (height, width) or
(height, width, components), row 0 at the top.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from relume._relume import (
        Camera,
        ChannelInfo,
        ExrFile,
        ExrPart,
        LightType,
        Parameter,
        PluginReport,
        Report,
        SceneInfo,
        active_isa,
        available_isas,
        openexr_build,
        plugin_reports,
        use_isa,
    )
    from relume.display import Display, to_display
    from relume.errors import (
        ArgumentError,
        Cancelled,
        ChannelError,
        Error,
        FileError,
        FormatError,
        MissingPackageError,
        ParameterError,
        PluginError,
        RigError,
        UnknownNameError,
    )
    from relume.gbuffer import GBuffer
    from relume.png import write_png
    from relume.relighting import Relit, relight, relight_file
    from relume.rig import FromChannel, Rig
    from relume.scenes import scenes, write_scene
    from relume.shading import Evaluation, Shader, light_types, shaders

    __version__: str

# Modules are imported when a name of theirs is first used: `relume --help` needs neither numpy nor the library.
_HOMES = {
    "_relume": (
        "Camera",
        "ChannelInfo",
        "ExrFile",
        "ExrPart",
        "LightType",
        "Parameter",
        "PluginReport",
        "Report",
        "SceneInfo",
        "active_isa",
        "available_isas",
        "openexr_build",
        "plugin_reports",
        "use_isa",
    ),
    "display": ("Display", "to_display"),
    "errors": (
        "ArgumentError",
        "Cancelled",
        "ChannelError",
        "Error",
        "FileError",
        "FormatError",
        "MissingPackageError",
        "ParameterError",
        "PluginError",
        "RigError",
        "UnknownNameError",
    ),
    "gbuffer": ("GBuffer",),
    "png": ("write_png",),
    "relighting": ("Relit", "relight", "relight_file"),
    "rig": ("FromChannel", "Rig"),
    "scenes": ("scenes", "write_scene"),
    "shading": ("Evaluation", "Shader", "light_types", "shaders"),
}
_HOME_OF = {name: module for module, names in _HOMES.items() for name in names}

__all__ = sorted([*_HOME_OF, "__version__"])


def __getattr__(name: str) -> object:
    import importlib

    if name == "__version__":
        from relume._relume import version

        value: object = version()
    elif name in _HOME_OF:
        value = getattr(importlib.import_module(f"relume.{_HOME_OF[name]}"), name)
    else:
        raise AttributeError(f"module 'relume' has no attribute '{name}'")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
