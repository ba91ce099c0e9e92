# SPDX-License-Identifier: Apache-2.0
"""Light linking: a light's receiver collection as the Cryptomatte names that a rig includes or excludes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple

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


def pattern(name: str, kind: Literal["object", "material"]) -> str:
    """The pattern that matches an object's or a material's name, and not that of a namesake of the other kind."""
    return f"{kind}:{name.translate(_WILD)}"


def _names(thing: bpy.types.Object) -> list[str]:
    """What Cryptomatte calls it: an instance of a collection goes by the names of what is in there."""
    inside = thing.instance_collection if thing.instance_type == "COLLECTION" else None
    return [thing.name] if inside is None else [name for each in inside.all_objects for name in _names(each)]


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
        names[entry.light_linking.link_state] += [name for thing in child.all_objects for name in _names(thing)]
    for thing, entry in zip(collection.objects, collection.collection_objects, strict=True):
        names[entry.light_linking.link_state] += _names(thing)
    excluded = sorted(set(names["EXCLUDE"]))
    included = sorted(set(names["INCLUDE"]) - set(excluded))
    if names["INCLUDE"] and not included:
        raise LeftOutError("its light linking excludes all that it includes")
    return Linking(*(tuple(pattern(name, "object") for name in names) for names in (included, excluded)))
