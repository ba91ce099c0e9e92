# SPDX-License-Identifier: Apache-2.0
"""Animated sockets: keys and drivers of one socket of a node tree copied to another.

Copied and not driven by the original: a driver between two sockets would make the tree depend on itself.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterator

    import bpy

#: What a key has beside its place, in an order in which Blender takes it: a handle's type before the handle.
_NUMBERS = ("co", "handle_left", "handle_right", "amplitude", "back", "period")
_WORDS = ("interpolation", "easing", "handle_left_type", "handle_right_type")
_OF_CURVE = ("extrapolation", "mute", "auto_smoothing")


def _path(socket: bpy.types.NodeSocket) -> str:
    return str(socket.path_from_id("default_value"))


def _curve_lists(tree: bpy.types.NodeTree) -> Iterator[Any]:
    """Lists of curves that animate a tree: those of its action, and of the strips of its NLA tracks."""
    data = tree.animation_data
    if data is None:
        return
    holders = [(data.action, data.action_slot)]
    holders += [(strip.action, strip.action_slot) for track in data.nla_tracks for strip in track.strips]
    seen = []
    for action, slot in holders:
        if action is None or slot is None or (action, slot) in seen:
            continue
        seen.append((action, slot))
        for layer in action.layers:
            for strip in layer.strips:
                bag = strip.channelbag(slot)
                if bag is not None:
                    yield bag.fcurves


def _curves(tree: bpy.types.NodeTree, path: str) -> Iterator[tuple[Any, Any]]:
    """(list, curve) of what animates a property."""
    for curves in _curve_lists(tree):
        yield from [(curves, curve) for curve in curves if curve.data_path == path]


def _drivers(tree: bpy.types.NodeTree, path: str) -> list[Any]:
    data = tree.animation_data
    return [] if data is None else [driver for driver in data.drivers if driver.data_path == path]


def is_animated(socket: bpy.types.NodeSocket) -> bool:
    """Whether keys or a driver say what a socket holds."""
    tree, path = socket.id_data, _path(socket)
    return bool(_drivers(tree, path)) or next(_curves(tree, path), None) is not None


def copy_animation(source: bpy.types.NodeSocket, socket: bpy.types.NodeSocket) -> bool:
    """Have a socket animated as another of its tree is; or not, where that is not. Returns whether it had to change."""
    tree, path, ours = source.id_data, _path(source), _path(socket)
    if _state(tree, path) == _state(tree, ours):
        return False
    forget(socket)
    for curves, curve in _curves(tree, path):
        _copy_curve(curve, curves.new(ours, index=curve.array_index))
    for driver in _drivers(tree, path):
        copy = tree.animation_data.drivers.from_existing(src_driver=driver)
        copy.data_path = ours
    return True


def forget(socket: bpy.types.NodeSocket) -> None:
    """Take a socket's keys and drivers away."""
    tree, path = socket.id_data, _path(socket)
    for curves, curve in list(_curves(tree, path)):
        curves.remove(curve)
    for driver in _drivers(tree, path):
        tree.animation_data.drivers.remove(driver)


def _copy_curve(curve: bpy.types.FCurve, copy: bpy.types.FCurve) -> None:
    points, made = curve.keyframe_points, copy.keyframe_points
    made.add(len(points))
    for source, target in zip(points, made, strict=True):
        for name in (*_WORDS, *_NUMBERS):
            setattr(target, name, getattr(source, name))
    for name in _OF_CURVE:
        setattr(copy, name, getattr(curve, name))
    for modifier in curve.modifiers:
        added = copy.modifiers.new(modifier.type)
        for row in modifier.bl_rna.properties:
            if not row.is_readonly and row.identifier != "name":
                setattr(added, row.identifier, getattr(modifier, row.identifier))
    copy.update()


def _point(point: bpy.types.Keyframe) -> list[Any]:
    """A key; handles that Blender computes are left out."""
    automatic = {
        f"handle_{side}"
        for side in ("left", "right")
        if getattr(point, f"handle_{side}_type") not in ("FREE", "ALIGNED")
    }
    return [_plain(getattr(point, name)) for name in (*_WORDS, *_NUMBERS) if name not in automatic]


def _plain(value: Any) -> Any:
    return [_plain(each) for each in value] if hasattr(value, "__len__") and not isinstance(value, str) else value


def _settings(owner: Any) -> list[Any]:
    rows = [row for row in owner.bl_rna.properties if row.type in ("BOOLEAN", "INT", "FLOAT", "STRING", "ENUM")]
    return [(row.identifier, _plain(getattr(owner, row.identifier))) for row in rows]


def _state(tree: bpy.types.NodeTree, path: str) -> str:
    """Everything that says how a property moves, as text."""
    curves = [
        [curve.array_index, [getattr(curve, name) for name in _OF_CURVE]]
        + [_point(point) for point in curve.keyframe_points]
        + [_settings(modifier) for modifier in curve.modifiers]
        for _, curve in _curves(tree, path)
    ]
    drivers = [
        [curve.array_index, curve.driver.type, curve.driver.expression, curve.driver.use_self]
        + [
            [variable.name, variable.type] + [[str(target.id), *_settings(target)] for target in variable.targets]
            for variable in curve.driver.variables
        ]
        for curve in _drivers(tree, path)
    ]
    return json.dumps([curves, drivers], default=str)
