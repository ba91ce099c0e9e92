# SPDX-License-Identifier: Apache-2.0
"""Reads a material's nodes: what relume's parameters are, as sockets, along every path to the surface.

The result is a tree. A leaf is one BSDF with the sockets that its parameters come from; a blend is a Mix Shader; a
group is a node group that the shader comes out of. Nothing is changed here: wiring.py makes nodes of it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from .animation import is_animated

if TYPE_CHECKING:
    from collections.abc import Callable

    import bpy

Number = float | tuple[float, float, float]

#: Parameter of blender_principled -> input of the Principled BSDF. What the model reads and no input gives (tangent,
#: geometric_normal) is wired beside it; emission comes from Cycles' own pass, which has it as the camera sees it.
PRINCIPLED = {
    "base_color": "Base Color",
    "metallic": "Metallic",
    "roughness": "Roughness",
    "ior": "IOR",
    "specular": "Specular IOR Level",
    "specular_tint": "Specular Tint",
    "diffuse_roughness": "Diffuse Roughness",
    "anisotropic": "Anisotropic",
    "anisotropic_rotation": "Anisotropic Rotation",
    "coat_weight": "Coat Weight",
    "coat_roughness": "Coat Roughness",
    "coat_ior": "Coat IOR",
    "coat_tint": "Coat Tint",
    "sheen_weight": "Sheen Weight",
    "sheen_roughness": "Sheen Roughness",
    "sheen_tint": "Sheen Tint",
}

#: Inputs of the Principled BSDF that the model has no layer for, and what happens instead.
_NO_LAYER = {
    "Transmission Weight": "what it transmits is not relit",
    "Subsurface Weight": "its subsurface is relit as a plain diffuse surface",
    "Thin Film Thickness": "its thin film is left out",
}

#: Shaders one behind the other; Python's own limit is not much further.
_DEEPEST = 100

#: A surface that reflects nothing; what is missing is as the other side of a blend has it.
_BLACK: dict[str, Number] = {
    "base_color": (0.0, 0.0, 0.0),
    "specular": 0.0,
    "coat_weight": 0.0,
    "sheen_weight": 0.0,
}


class UnwiredError(Exception):
    """A material whose surface relume's parameters cannot say; the message is the reason."""


@dataclass
class Leaf:
    """One BSDF: by parameter the socket that has it (linked or not), or a number."""

    node: bpy.types.Node
    values: dict[str, bpy.types.NodeSocket | Number]


@dataclass
class Blend:
    """A Mix Shader: `first` where the factor is 0, `second` where it is 1."""

    factor: bpy.types.NodeSocket
    first: Surface
    second: Surface


@dataclass
class Group:
    """A node group that the surface comes out of: by the socket of this identifier."""

    node: bpy.types.Node
    output: bpy.types.Node
    identifier: str
    inner: Surface


Surface = Leaf | Blend | Group


@dataclass
class Reading:
    """A material's surface, what is approximated, and which distribution of facets its BSDFs have."""

    surface: Surface
    remarks: list[str] = field(default_factory=list)
    distributions: set[str] = field(default_factory=set)
    #: Nodes between the output and what is being read.
    depth: int = 0


def source_of(socket: bpy.types.NodeSocket) -> bpy.types.NodeSocket | None:
    """The output that feeds an input, past reroutes and muted nodes; None where it holds a constant."""
    for _ in range(1000):  # a muted loop has no end
        links = [link for link in socket.links if link.is_valid and not link.is_muted]
        if not links:
            return None
        node, output = links[0].from_node, links[0].from_socket
        if node.bl_idname == "NodeReroute":
            socket = node.inputs[0]
        elif node.mute:
            passed = [link.from_socket for link in node.internal_links if link.to_socket == output]
            if not passed:
                return None
            socket = passed[0]
        else:
            return output
    return None


def has_nodes(owner: bpy.types.Material | bpy.types.World) -> bool:
    """Whether nodes say what it looks like; since Blender 5 they always do, and asking is deprecated."""
    import bpy

    return owner.node_tree is not None and (bpy.app.version >= (5, 0, 0) or owner.use_nodes)


def read_material(material: bpy.types.Material) -> Reading:
    """The surface of a material, by its output for Cycles.

    Raises:
        UnwiredError: its surface is not one that relume has parameters for.
    """
    if not has_nodes(material):
        raise UnwiredError("it has no nodes")
    output = material.node_tree.get_output_node("CYCLES")
    if output is None:
        raise UnwiredError("it has no Material Output for Cycles")
    reading = Reading(Leaf(output, {}))
    surface = _surface(output.inputs["Surface"], reading)
    if surface is None:
        raise UnwiredError("nothing is linked to its Surface")
    reading.surface = surface
    return reading


def _surface(socket: bpy.types.NodeSocket, reading: Reading) -> Surface | None:
    """The surface that feeds an input; None where nothing does, or where it is only transparent."""
    output = source_of(socket)
    if output is None:
        return None
    node = output.node
    read = _READERS.get(node.bl_idname)
    if read is None:
        raise UnwiredError(f"its node '{node.name}' ({node.bl_label}) is none that relume has parameters for")
    if reading.depth == _DEEPEST:
        raise UnwiredError(f"more than {_DEEPEST} shaders are mixed one after the other")
    reading.depth += 1
    try:
        return read(node, output, reading)
    finally:
        reading.depth -= 1


def _number(socket: bpy.types.NodeSocket) -> float | None:
    """What a socket holds; None where it is linked."""
    return None if source_of(socket) is not None else socket.default_value


def _principled(node: bpy.types.Node, _output: bpy.types.NodeSocket, reading: Reading) -> Surface:
    for name, remark in _NO_LAYER.items():
        if _number(node.inputs[name]) != 0:
            reading.remarks.append(f"{name} of '{node.name}': {remark}")
    if _number(node.inputs["Alpha"]) != 1:
        reading.remarks.append(f"Alpha of '{node.name}': what stands behind it is not relit")
    if source_of(node.inputs["Coat Normal"]) is not None:
        reading.remarks.append(f"Coat Normal of '{node.name}': its coat lies on the smooth surface")
    reading.distributions.add(node.distribution)
    values: dict[str, Any] = {name: node.inputs[socket] for name, socket in PRINCIPLED.items()}
    values["tangent"] = node.inputs["Tangent"]
    return Leaf(node, values)


def _diffuse(node: bpy.types.Node, _output: bpy.types.NodeSocket, _reading: Reading) -> Surface:
    values = _BLACK | {"metallic": 0.0}
    return Leaf(node, values | {"base_color": node.inputs["Color"], "diffuse_roughness": node.inputs["Roughness"]})


def _metallic(node: bpy.types.Node, _output: bpy.types.NodeSocket, reading: Reading) -> Surface:
    if node.fresnel_type != "F82":
        raise UnwiredError(f"its node '{node.name}' has physical conductors; relume reads F82 Tint")
    reading.distributions.add(node.distribution)
    values: dict[str, Any] = _BLACK | {"metallic": 1.0, "tangent": node.inputs["Tangent"]}
    sockets = {"base_color": "Base Color", "specular_tint": "Edge Tint", "roughness": "Roughness"}
    sockets |= {"anisotropic": "Anisotropy", "anisotropic_rotation": "Rotation"}
    return Leaf(node, values | {name: node.inputs[socket] for name, socket in sockets.items()})


def _sheen(node: bpy.types.Node, _output: bpy.types.NodeSocket, _reading: Reading) -> Surface:
    if node.distribution != "MICROFIBER":
        raise UnwiredError(f"its node '{node.name}' is Ashikhmin's sheen; relume has microfibers")
    values = _BLACK | {"metallic": 0.0, "sheen_weight": 1.0}
    return Leaf(node, values | {"sheen_tint": node.inputs["Color"], "sheen_roughness": node.inputs["Roughness"]})


def _emission(node: bpy.types.Node, _output: bpy.types.NodeSocket, _reading: Reading) -> Surface:
    return Leaf(node, dict(_BLACK))


def _transparent(node: bpy.types.Node, _output: bpy.types.NodeSocket, reading: Reading) -> None:
    reading.remarks.append(f"'{node.name}': what stands behind it is not relit")


def _mix(node: bpy.types.Node, _output: bpy.types.NodeSocket, reading: Reading) -> Surface | None:
    first, second = (_surface(node.inputs[place], reading) for place in (1, 2))
    if first is None or second is None:
        return first or second
    factor = _number(node.inputs[0])
    if factor in (0, 1) and not is_animated(node.inputs[0]):
        return second if factor else first
    return Blend(node.inputs[0], first, second)


def _add(node: bpy.types.Node, _output: bpy.types.NodeSocket, reading: Reading) -> Surface | None:
    sides = [side for side in (_surface(socket, reading) for socket in node.inputs[:2]) if side is not None]
    lit = [side for side in sides if not (isinstance(side, Leaf) and side.values == _BLACK)]
    if len(lit) > 1:
        raise UnwiredError(f"its node '{node.name}' adds two surfaces; relume's parameters are of one")
    return (lit or sides or [None])[0]


def _group(node: bpy.types.Node, output: bpy.types.NodeSocket, reading: Reading) -> Surface | None:
    tree = node.node_tree
    if tree is None:
        raise UnwiredError(f"its group node '{node.name}' has lost its group")
    if not tree.is_editable:
        raise UnwiredError(f"its group '{tree.name}' is linked from another file: make it local")
    inside = next((n for n in tree.nodes if n.bl_idname == "NodeGroupOutput" and n.is_active_output), None)
    if inside is None:
        return None
    socket = next(each for each in inside.inputs if each.identifier == output.identifier)
    source = source_of(socket)
    if source is not None and source.node.bl_idname == "NodeGroupInput":
        raise UnwiredError(f"its group '{tree.name}' passes a shader through: take the group apart")
    inner = _surface(socket, reading)
    return None if inner is None else Group(node, inside, output.identifier, inner)


_READERS: dict[str, Callable[..., Surface | None]] = {
    "ShaderNodeBsdfPrincipled": _principled,
    "ShaderNodeBsdfDiffuse": _diffuse,
    "ShaderNodeBsdfMetallic": _metallic,
    "ShaderNodeBsdfSheen": _sheen,
    "ShaderNodeEmission": _emission,
    "ShaderNodeBsdfTransparent": _transparent,
    "ShaderNodeMixShader": _mix,
    "ShaderNodeAddShader": _add,
    "ShaderNodeGroup": _group,
}
