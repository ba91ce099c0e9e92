# SPDX-License-Identifier: Apache-2.0
"""Blender properties: made from relume's own tables, with their ranges, units and help, and the few that are Blender's.

scene.relume          where the render is, what is shown, the rig beyond the lights
scene.relume.output   [output] of the rig
scene.relume.shaders  one group for each shading model: options, and parameters that replace the render's channels
light.relume          what a rig says of a light and Blender does not
"""

# No `from __future__ import annotations`: Blender wants the annotations themselves.
import math
from typing import TYPE_CHECKING, Any

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from . import live

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from relume import Parameter

#: Prefix of the switch that says whether a key is given at all.
GIVEN = "use_"
#: Keys of every light that Blender's own light has already.
_BLENDERS_OWN = {"color", "exposure", "enabled", "space", "include", "exclude", "transmission"}
#: What a rig and a G-buffer hold but no slider can.
_NO_SLIDER = {"table", "number_list", "text"}


def _finite(value: float, instead: float) -> float:
    return value if math.isfinite(value) else instead


def made_property(row: "Parameter", update: "Callable[..., None]") -> Any:
    """The Blender property of a row of a table; None for what has no widget."""
    text: dict[str, Any] = {
        "name": row.label or row.name.replace("_", " ").capitalize(),
        "description": row.help.split("\n")[0].rstrip("."),
        "update": update,
    }
    low, high = _finite(row.min, -1e30), _finite(row.max, 1e30)
    limits = {
        "min": low,
        "max": high,
        "soft_min": max(low, _finite(row.soft_min, low)),
        "soft_max": min(high, _finite(row.soft_max, high)),
    }
    if row.type == "scalar":
        return FloatProperty(default=low if row.default is None else row.default, **limits, **text)
    if row.type in ("color", "vector"):
        default = tuple(row.default or (0.0, 0.0, 0.0))
        if row.type == "color" and min(default) < 0:
            default = (1.0, 1.0, 1.0)  # a color that is below 0 where it is not given
            limits["min"] = limits["soft_min"] = 0.0
        return FloatVectorProperty(
            size=3, default=default, subtype="COLOR" if row.type == "color" else "XYZ", **limits, **text
        )
    if row.type == "boolean":
        return BoolProperty(default=bool(row.default), **text)
    if row.type == "integer":
        limits = {key: int(max(-(2**31), min(2**31 - 1, value))) for key, value in limits.items()}
        return IntProperty(default=int(row.default or 0), **limits, **text)
    if row.type == "choice":
        return EnumProperty(items=[(word, word, "") for word in row.choices], default=row.default, **text)
    if row.type == "text_list":
        text["description"] += " (separated by commas)"
        return StringProperty(default=", ".join(row.default or ()), **text)
    return None


def _group(name: str, rows: "Iterable[Parameter]", switches: bool) -> type[bpy.types.PropertyGroup]:
    """A property group of a table's rows; with `switches` each has one that says whether it is given."""
    annotations: dict[str, Any] = {}
    for row in rows:
        made = None if row.type in _NO_SLIDER else made_property(row, live.settings_changed)
        if made is None:
            continue
        annotations[row.name] = made
        if switches or row.default is None:
            annotations[GIVEN + row.name] = BoolProperty(
                name="Replace" if switches else "Give", description=row.help, update=live.settings_changed
            )
    return type(name, (bpy.types.PropertyGroup,), {"__annotations__": annotations})


def given(group: bpy.types.PropertyGroup, rows: "Iterable[Parameter]") -> dict[str, Any]:
    """Keys and values of a group that differ from the table's defaults, or whose switch is on; as a rig takes them."""
    result: dict[str, Any] = {}
    for row in rows:
        if not hasattr(group, row.name):
            continue
        value = getattr(group, row.name)
        if row.type == "text_list":
            value = [word.strip() for word in value.split(",") if word.strip()]
        elif row.type in ("color", "vector"):
            value = tuple(value)
        if hasattr(group, GIVEN + row.name):
            if getattr(group, GIVEN + row.name):
                result[row.name] = value
        elif value != row.default and not (row.type == "text_list" and not value):
            result[row.name] = value
    return result


class Remark(bpy.types.PropertyGroup):
    """One line of what was left out or is approximated: of a material, a light, a world."""

    name: StringProperty()
    text: StringProperty()
    icon: StringProperty(default="INFO")


class _SceneSettings:
    """The properties of scene.relume that are no row of a table."""

    source: EnumProperty(
        name="Render",
        description="Where the passes come from",
        items=[
            ("RENDER", "Render result", "The render that was just made in this Blender"),
            ("FILE", "EXR on disk", "A multilayer EXR; #### or the like stands for the frame number"),
        ],
        update=live.settings_changed,
    )
    filepath: StringProperty(
        name="EXR",
        description="Multilayer EXR with the passes; empty: the scene's output path. #### stands for the frame",
        subtype="FILE_PATH",
        update=live.settings_changed,
    )
    rig_path: StringProperty(
        name="Rig",
        description="The .relume file that is written or loaded",
        subtype="FILE_PATH",
        default="//scene.relume",
    )
    rig_extra: PointerProperty(
        type=bpy.types.Text,
        name="More of the rig",
        description="Text of a rig whose lights, shaders and settings join those of the scene",
        update=live.settings_changed,
    )
    output_path: StringProperty(
        name="Relit frames",
        description="Where the frame range is written; #### stands for the frame",
        subtype="FILE_PATH",
        default="//relit/relit.####.exr",
    )
    keys_of_animation: BoolProperty(
        name="Animation",
        description="Write what moves or changes over the frame range as keys of the rig",
        default=True,
    )
    live: BoolProperty(
        name="Live",
        description="Relight while lights move and change",
        update=live.live_switched,
    )
    shader: EnumProperty(
        name="Shading model",
        description="The model that shades the passes; Blender Principled is that of Cycles",
        items=lambda _self, _context: _MODELS,
        update=live.settings_changed,
    )
    seconds: FloatProperty(name="Seconds", description="Of the latest relight", options={"SKIP_SAVE"})


#: Items of the enum above; Blender wants to see the same strings again and again.
_MODELS: list[tuple[str, str, str]] = []
_classes: list[type] = []


def shader_rows(name: str) -> "tuple[Parameter, ...]":
    """The table of a shading model."""
    import relume

    return tuple(relume.shaders[name].parameters)


def output_rows() -> "tuple[Parameter, ...]":
    """The table of [output]."""
    from relume import Rig

    return Rig().output.parameters


def light_rows() -> "list[Parameter]":
    """What a rig knows of every light and a Blender light does not."""
    import relume

    tables = [relume.light_types[name].parameters for name in relume.light_types]
    common = set.intersection(*({row.name for row in table} for table in tables))
    return [row for row in tables[0] if row.name in common - _BLENDERS_OWN]


def register() -> None:
    """Make the classes from the tables, and hang them on scenes and lights."""
    import relume

    output = _group("RELUME_PG_output", output_rows(), False)
    light = _group("RELUME_PG_light", light_rows(), False)
    models = {name: _group(f"RELUME_PG_shader_{name}", shader_rows(name), True) for name in relume.shaders}
    _classes.extend([Remark, output, light, *models.values()])
    shaders = type(
        "RELUME_PG_shaders",
        (bpy.types.PropertyGroup,),
        {"__annotations__": {name: PointerProperty(type=group) for name, group in models.items()}},
    )
    scene = type(
        "RELUME_PG_scene",
        (bpy.types.PropertyGroup,),
        {
            "__annotations__": _SceneSettings.__annotations__
            | {
                "output": PointerProperty(type=output),
                "shaders": PointerProperty(type=shaders),
                "unwired": CollectionProperty(type=Remark),
                "remarks": CollectionProperty(type=Remark),
            }
        },
    )
    _classes.extend([shaders, scene])
    _MODELS[:] = [
        (name, relume.shaders[name].label, relume.shaders[name].help.split("\n")[0])
        for name in sorted(relume.shaders, key=lambda name: (name != "blender_principled", name))
    ]
    for each in _classes:
        bpy.utils.register_class(each)
    bpy.types.Scene.relume = PointerProperty(type=scene)
    bpy.types.Light.relume = PointerProperty(type=light)


def unregister() -> None:
    """Take them away again."""
    del bpy.types.Light.relume
    del bpy.types.Scene.relume
    for each in reversed(_classes):
        bpy.utils.unregister_class(each)
    _classes.clear()
