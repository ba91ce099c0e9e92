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
    from relume._relume import Camera as Camera
    from relume._relume import ChannelInfo as ChannelInfo
    from relume._relume import ExrFile as ExrFile
    from relume._relume import ExrPart as ExrPart
    from relume._relume import LightType as LightType
    from relume._relume import Parameter as Parameter
    from relume._relume import PluginReport as PluginReport
    from relume._relume import Report as Report
    from relume._relume import SceneInfo as SceneInfo
    from relume._relume import active_isa as active_isa
    from relume._relume import available_isas as available_isas
    from relume._relume import openexr_build as openexr_build
    from relume._relume import plugin_reports as plugin_reports
    from relume._relume import use_isa as use_isa
    from relume.builtin_scenes import scenes as scenes
    from relume.builtin_scenes import write_scene as write_scene
    from relume.display import Display as Display
    from relume.display import quantized as quantized
    from relume.display import to_display as to_display
    from relume.errors import ArgumentError as ArgumentError
    from relume.errors import Cancelled as Cancelled
    from relume.errors import ChannelError as ChannelError
    from relume.errors import Error as Error
    from relume.errors import FileError as FileError
    from relume.errors import FormatError as FormatError
    from relume.errors import MissingPackageError as MissingPackageError
    from relume.errors import ParameterError as ParameterError
    from relume.errors import PluginError as PluginError
    from relume.errors import RigError as RigError
    from relume.errors import UnknownNameError as UnknownNameError
    from relume.gbuffer import GBuffer as GBuffer
    from relume.layers import read_layer as read_layer
    from relume.png import write_png as write_png
    from relume.relighting import Relit as Relit
    from relume.relighting import relight as relight
    from relume.relighting import relight_file as relight_file
    from relume.rig import FromChannel as FromChannel
    from relume.rig import Keys as Keys
    from relume.rig import Rig as Rig
    from relume.shading import Evaluation as Evaluation
    from relume.shading import Shader as Shader
    from relume.shading import light_types as light_types
    from relume.shading import shaders as shaders

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
    "display": ("Display", "quantized", "to_display"),
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
    "layers": ("read_layer",),
    "png": ("write_png",),
    "relighting": ("Relit", "relight", "relight_file"),
    "rig": ("FromChannel", "Keys", "Rig"),
    "builtin_scenes": ("scenes", "write_scene"),
    "shading": ("Evaluation", "Shader", "light_types", "shaders"),
}
_HOME_OF = {name: module for module, names in _HOMES.items() for name in names}

__all__ = [*sorted(_HOME_OF), "__version__"]


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
