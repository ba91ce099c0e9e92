# SPDX-License-Identifier: Apache-2.0
"""Wires a material's parameters to AOV Output nodes, beside the user's nodes and without touching one of them.

A linked input is linked to its AOV too. A constant is copied with its keys and drivers, and the copy knows where from:
refresh() brings it up to date when a slider or a key has moved. A Mix Shader becomes a Mix node for each
parameter. A group gets an output for each parameter that comes from inside. Every node made here carries a mark, and
its material the signature of what was read, so that a second pass changes nothing, and a later one rewires only what
has changed.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from .animation import copy_animation
from .surface import Blend, Group, Leaf, Number, Surface, read_material, source_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    import bpy

#: Custom property of nodes that are ours, and of materials and groups that hold such nodes.
MARK = "relume"
#: Custom property of our nodes: the sockets whose constants are copied, by the identifier of ours.
_COPIES = "relume_copies"

Kind = Literal["scalar", "color", "vector"]


class _Mix(NamedTuple):
    """How a parameter of a kind is blended and handed on."""

    data_type: str
    suffix: str
    socket_type: str


_KINDS: dict[str, _Mix] = {
    "scalar": _Mix("FLOAT", "Float", "NodeSocketFloat"),
    "color": _Mix("RGBA", "Color", "NodeSocketColor"),
    "vector": _Mix("VECTOR", "Vector", "NodeSocketVector"),
}

#: An output of a node, an unlinked input whose constant is followed, or a number.
Source = Any


@dataclass
class Wirer:
    """Wires materials to AOVs of these names and kinds; remembers what it has made of groups."""

    kinds: Mapping[str, Kind]
    #: What a parameter is that no BSDF of the material has.
    defaults: Mapping[str, Number]
    _groups: dict[tuple[str, str], dict[str, str]] = field(default_factory=dict)

    def wire(self, material: bpy.types.Material) -> tuple[bool, list[str]]:
        """Wire one material. Returns whether it had to change, and remarks on what is approximated.

        Raises:
            UnwiredError: its surface is none that relume has parameters for; it keeps its nodes.
        """
        reading = read_material(material)
        tree = material.node_tree
        taken = {node.aov_name for node in tree.nodes if node.bl_idname == "ShaderNodeOutputAOV" and MARK not in node}
        wanted = [name for name in self.kinds if name not in taken]
        remarks = [*reading.remarks]
        if len(reading.distributions) > 1:
            remarks.append("it mixes GGX and Multiscatter GGX: all of it is relit as GGX")
        remarks += [f"its own AOV '{name}' is kept" for name in sorted(taken & set(self.kinds))]
        signature = f"{signature_of(reading.surface)} {' '.join(wanted)}"
        if material.get(MARK) == _state(tree, signature):
            return refresh(tree), remarks
        clear(tree)
        builder = _Builder(self, tree)
        sources = builder.sources(reading.surface)
        sources["geometric_normal"] = builder.geometry.outputs["Normal"]
        for name in wanted:
            node = builder.node("ShaderNodeOutputAOV")
            node.aov_name = name
            socket = node.inputs["Value" if self.kinds[name] == "scalar" else "Color"]
            builder.connect(sources.get(name, self.defaults[name]), socket)
        builder.arrange()
        material[MARK] = _state(tree, signature)
        return True, remarks

    def exposed(self, surface: Group) -> tuple[dict[str, str], dict[str, Number]]:
        """Outputs of a group's node by parameter (their identifiers), made where they are not there yet; and numbers,
        which need no output."""
        tree = surface.node.node_tree
        numbers = dict(_numbers(surface.inner))
        key = (tree.name_full, surface.identifier)
        if key in self._groups:
            return self._groups[key], numbers
        signature = signature_of(surface.inner)
        known = json.loads(tree.get(MARK, "{}"))
        entry = known.get(surface.identifier)
        sockets = {item.identifier: item for item in tree.interface.items_tree if item.item_type == "SOCKET"}
        if entry is None or entry["signature"] != signature or not set(entry["sockets"].values()) <= set(sockets):
            for identifier in entry["sockets"].values() if entry else ():
                if identifier in sockets:
                    tree.interface.remove(sockets[identifier])
            clear(tree, surface.identifier)
            made = self._expose(surface, tree)
            known[surface.identifier] = {"signature": signature, "sockets": made}
            tree[MARK] = json.dumps(known)
        self._groups[key] = known[surface.identifier]["sockets"]
        return self._groups[key], numbers

    def _expose(self, surface: Group, tree: bpy.types.NodeTree) -> dict[str, str]:
        builder = _Builder(self, tree, surface.identifier)
        made: dict[str, str] = {}
        for name, source in builder.sources(surface.inner).items():
            if isinstance(source, (int, float, tuple)):
                continue
            item = tree.interface.new_socket(
                f"relume {name}", in_out="OUTPUT", socket_type=_KINDS[self.kinds[name]].socket_type
            )
            made[name] = item.identifier
            socket = next(each for each in surface.output.inputs if each.identifier == item.identifier)
            tree.links.new(source if source.is_output else builder.held(source), socket)
        builder.arrange()
        return made


def _numbers(surface: Surface) -> Iterator[tuple[str, Number]]:
    """Parameters of a surface that are the same number wherever it is seen."""
    if isinstance(surface, Leaf):
        yield from ((name, value) for name, value in surface.values.items() if isinstance(value, (int, float, tuple)))
    elif isinstance(surface, Group):
        yield from _numbers(surface.inner)
    else:
        first, second = dict(_numbers(surface.first)), dict(_numbers(surface.second))
        names = {name for side in (surface.first, surface.second) for name in parameters(side)}
        for name in names:
            a = first.get(name, second.get(name)) if name not in parameters(surface.first) else first.get(name)
            b = second.get(name, first.get(name)) if name not in parameters(surface.second) else second.get(name)
            if a is not None and a == b:
                yield name, a


def parameters(surface: Surface) -> set[str]:
    """What a surface says of itself."""
    if isinstance(surface, Leaf):
        return set(surface.values)
    if isinstance(surface, Group):
        return parameters(surface.inner)
    return parameters(surface.first) | parameters(surface.second)


def signature_of(surface: Surface) -> str:
    """What was read, in words that change whenever the wiring would."""
    if isinstance(surface, Leaf):
        parts = [f"{name}={_socket_text(value)}" for name, value in surface.values.items()]
        return f"{surface.node.name!r}({', '.join(parts)})"
    if isinstance(surface, Group):
        tree, place = surface.node.node_tree, surface.identifier
        return f"{surface.node.name!r}:{tree.name!r}.{place}[{signature_of(surface.inner)}]"
    sides = f"{signature_of(surface.first)}, {signature_of(surface.second)}"
    return f"mix({surface.factor.node.name!r}, {_socket_text(surface.factor)}, {sides})"


def _socket_text(value: bpy.types.NodeSocket | Number) -> str:
    if isinstance(value, (int, float, tuple)):
        return repr(value)
    source = source_of(value)
    return "constant" if source is None else f"{source.node.name!r}.{source.identifier}"


def _state(tree: bpy.types.NodeTree, signature: str) -> str:
    """The signature with what is there of it, so that a deleted node or link shows."""
    ours = [node for node in tree.nodes if MARK in node]
    links = sum(link.to_node in ours for link in tree.links)
    names = sorted(node.aov_name for node in ours if node.bl_idname == "ShaderNodeOutputAOV")
    return f"{signature} | {len(ours)} {links} {' '.join(names)}"


def clear(tree: bpy.types.NodeTree, part: str | None = None) -> None:
    """Take our nodes out of a tree; with `part`, those that serve this output of a group."""
    for node in [node for node in tree.nodes if MARK in node and part in (None, node[MARK])]:
        tree.nodes.remove(node)


def refresh(tree: bpy.types.NodeTree) -> bool:
    """Bring copied constants of a tree, and of the groups in it, and what animates them up to date. Returns whether one
    had changed."""
    changed = False
    for node in tree.nodes:
        if node.bl_idname == "ShaderNodeGroup" and node.node_tree is not None and MARK in node.node_tree:
            changed |= refresh(node.node_tree)
        for identifier, (name, place) in json.loads(node.get(_COPIES, "{}")).items():
            origin = tree.nodes.get(name)
            sockets = {socket.identifier: socket for socket in (*node.outputs, *node.inputs)}
            source = next((each for each in origin.inputs if each.identifier == place), None) if origin else None
            if source is None:
                continue
            if tree.animation_data is not None:
                changed |= copy_animation(source, sockets[identifier])
            if not _same(source.default_value, sockets[identifier].default_value):
                sockets[identifier].default_value = source.default_value
                changed = True
    return changed


def _same(first: Any, second: Any) -> bool:
    return tuple(first) == tuple(second) if hasattr(first, "__len__") else first == second


class _Builder:
    """Makes nodes in one tree."""

    def __init__(self, wirer: Wirer, tree: bpy.types.NodeTree, part: str = "") -> None:
        self._wirer, self._tree, self._part = wirer, tree, part
        self._made: list[bpy.types.Node] = []
        self._geometry: bpy.types.Node | None = None

    @property
    def geometry(self) -> bpy.types.Node:
        """The Geometry node, which has the smooth normal and Cycles' own tangent."""
        if self._geometry is None:
            self._geometry = self.node("ShaderNodeNewGeometry")
        return self._geometry

    def node(self, kind: str) -> bpy.types.Node:
        """A new node with our mark."""
        node = self._tree.nodes.new(kind)
        node[MARK] = self._part
        node.label, node.hide = "relume", True
        node.select = False
        self._made.append(node)
        return node

    def sources(self, surface: Surface) -> dict[str, Source]:
        """Where each parameter of a surface comes from, in this tree."""
        if isinstance(surface, Leaf):
            return {name: self._source(name, value) for name, value in surface.values.items()}
        if isinstance(surface, Group):
            identifiers, numbers = self._wirer.exposed(surface)
            outputs = {socket.identifier: socket for socket in surface.node.outputs}
            return numbers | {name: outputs[identifier] for name, identifier in identifiers.items()}
        first, second = self.sources(surface.first), self.sources(surface.second)
        result = second | first
        for name in first.keys() & second.keys():
            result[name] = self._mixed(name, surface, first[name], second[name])
        return result

    def _source(self, name: str, value: bpy.types.NodeSocket | Number) -> Source:
        if isinstance(value, (int, float, tuple)):
            return value
        output = source_of(value)
        if output is not None:
            return output
        # What Cycles takes for a tangent that nothing is linked to.
        return self.geometry.outputs["Tangent"] if name == "tangent" else value

    def _mixed(self, name: str, blend: Blend, first: Source, second: Source) -> Source:
        if isinstance(first, (int, float, tuple)) and first == second:
            return first
        kind = _KINDS[self._wirer.kinds[name]]
        node = self.node("ShaderNodeMix")
        node.data_type = kind.data_type
        node.clamp_factor = True
        inputs = {socket.identifier: socket for socket in node.inputs}
        factor = source_of(blend.factor)
        self.connect(blend.factor if factor is None else factor, inputs["Factor_Float"])
        self.connect(first, inputs[f"A_{kind.suffix}"])
        self.connect(second, inputs[f"B_{kind.suffix}"])
        return next(socket for socket in node.outputs if socket.identifier == f"Result_{kind.suffix}")

    def connect(self, source: Source, socket: bpy.types.NodeSocket) -> None:
        """Make an input what the source is, now and later."""
        if isinstance(source, (int, float)):
            socket.default_value = (source,) * 3 + (1,) if socket.type == "RGBA" else source
        elif isinstance(source, tuple):
            socket.default_value = (*source, 1.0) if socket.type == "RGBA" else source
        elif source.is_output:
            self._tree.links.new(source, socket)
        else:
            self._copy(source, socket)

    def held(self, source: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
        """A constant as the output of a node of ours."""
        node = self.node("ShaderNodeRGB" if source.type == "RGBA" else "ShaderNodeValue")
        self._copy(source, node.outputs[0])
        return node.outputs[0]

    def _copy(self, source: bpy.types.NodeSocket, socket: bpy.types.NodeSocket) -> None:
        """Have a socket of ours hold another's constant, now and after refresh()."""
        socket.default_value = source.default_value
        copy_animation(source, socket)
        copies = json.loads(socket.node.get(_COPIES, "{}"))
        copies[socket.identifier] = [source.node.name, source.identifier]
        socket.node[_COPIES] = json.dumps(copies)

    def arrange(self) -> None:
        """Put what was made below the user's nodes, in one frame."""
        if not self._made:
            return
        others = [node for node in self._tree.nodes if MARK not in node]
        left = min((node.location_absolute.x for node in others), default=0.0)
        below = min((node.location_absolute.y - node.height for node in others), default=0.0) - 300.0
        frame = self._tree.nodes.new("NodeFrame")
        frame[MARK] = self._part
        frame.label = "relume"
        frame.select = False
        for place, node in enumerate(self._made):
            node.parent = frame
            node.location = (left + 180.0 * (place // 12), below - 40.0 * (place % 12))
