# SPDX-License-Identifier: Apache-2.0
"""The numbers of a loaded rig, to the bit: Blender's properties are of single precision, its lights stand by matrices.

A light that was made of a rig's remembers the rig's keys, and what is read of it right after that. A key whose value is
still the same is given back as the rig had it, and a light that nobody has touched shades as it did.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import bpy

#: Custom property of the object.
_GIVEN = "relume_given"

#: Keys that Blender holds together: as one of them changes, none of them is the rig's.
_GROUPS = (
    ("position",),
    ("direction",),
    ("cone_angle",),
    ("blend",),
    ("attenuation",),
    ("exposure",),
    ("diffuse",),
    ("specular",),
    ("color", "irradiance", "power", "intensity"),
)


def _plain(keys: dict[str, Any]) -> dict[str, Any]:
    """As JSON gives it back."""
    return json.loads(json.dumps(keys))  # type: ignore[no-any-return]


def remember(thing: bpy.types.Object, given: dict[str, Any], read: dict[str, Any], moving: set[str]) -> None:
    """Note a rig's keys at the light that was made of them.

    Args:
        thing: the light.
        given: keys of the rig.
        read: what is read of the light now.
        moving: keys that are animated, which are always read.
    """
    groups = [group for group in _GROUPS if not moving.intersection(group)]
    noted = {key: given[key] for group in groups for key in group if key in given}
    thing[_GIVEN] = json.dumps({"groups": groups, "given": noted, "read": read})


def recalled(thing: bpy.types.Object, keys: dict[str, Any]) -> dict[str, Any]:
    """What is read of a light, with the rig's own numbers for what has not changed since it was loaded."""
    text = thing.original.get(_GIVEN)  # a property of the user's own is no reason to evaluate an object anew
    if text is None:
        return dict(keys)
    noted, now, result = json.loads(text), _plain(keys), dict(keys)
    for group in noted["groups"]:
        if any(now.get(key) != noted["read"].get(key) for key in group):
            continue
        for key in group:
            result.pop(key, None)
            if key in noted["given"]:
                result[key] = noted["given"][key]
    return result
