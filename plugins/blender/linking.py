# SPDX-License-Identifier: Apache-2.0
"""Light linking: a light's receiver collection as the Cryptomatte names that a rig includes or excludes."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    import bpy

#: What a pattern of a rig takes for more than itself; in a name each may stand for any one character only.
_WILD = str.maketrans("*[", "??")


class LeftOutError(Exception):
    """A light that no rig can hold; the message is the reason."""


class Linking(NamedTuple):
    """Patterns of the objects that a light reaches; all of them where there are none."""

    include: tuple[str, ...] = ()
    exclude: tuple[str, ...] = ()


def pattern(name: str) -> str:
    """The pattern that matches an object's or a material's name."""
    return name.translate(_WILD)


def light_linking(light: bpy.types.Object) -> Linking:
    """The objects that a light reaches, by its receiver collection.

    As in Cycles: where something is included, that alone is lit; what is excluded is not, whatever includes it.

    Raises:
        LeftOutError: it reaches nothing.
    """
    collection = light.light_linking.receiver_collection
    if collection is None:
        return Linking()
    names: dict[str, list[str]] = {"INCLUDE": [], "EXCLUDE": []}
    for child, entry in zip(collection.children, collection.collection_children, strict=True):
        names[entry.light_linking.link_state] += [thing.name for thing in child.all_objects]
    for thing, entry in zip(collection.objects, collection.collection_objects, strict=True):
        names[entry.light_linking.link_state].append(thing.name)
    excluded = sorted(set(names["EXCLUDE"]))
    included = sorted(set(names["INCLUDE"]) - set(excluded))
    if names["INCLUDE"] and not included:
        raise LeftOutError("its light linking excludes all that it includes")
    return Linking(tuple(map(pattern, included)), tuple(map(pattern, excluded)))
