# SPDX-License-Identifier: Apache-2.0
"""Set up passes: what makes a scene's renders relightable, in one step that a second press leaves as it is."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from .surface import PRINCIPLED, UnwiredError
from .wiring import Kind, Wirer

if TYPE_CHECKING:
    from collections.abc import Iterator

    import bpy

    from .surface import Number

#: Passes of a view layer that relume reads. Emission as a pass is what the camera sees of it, behind coat and sheen.
PASSES = (
    "combined",
    "z",
    "normal",
    "position",
    "emit",
    "object_index",
    "material_index",
    "cryptomatte_object",
    "cryptomatte_material",
)

#: Parameters that come from the geometry and not from an input of the BSDF.
_GEOMETRY = ("tangent", "geometric_normal")

#: Compressions that change numbers: positions, normals, and the IDs of Cryptomatte, of which no bit may change.
LOSSY = ("PXR24", "B44", "B44A", "DWAA", "DWAB")

_SURFACES = {"MESH", "CURVE", "SURFACE", "META", "FONT", "CURVES"}


@dataclass
class SetUp:
    """What setting up did."""

    changed: int = 0
    wired: int = 0
    #: (material or object, why) of what shows wrong or black when it is relit.
    unwired: list[tuple[str, str]] = field(default_factory=list)
    #: (material, what is approximated).
    remarks: list[tuple[str, str]] = field(default_factory=list)


def aov_kinds() -> dict[str, Kind]:
    """Name of every AOV, which is the parameter's, and its kind, by relume's table of the model."""
    import relume

    rows = {row.name: row for row in relume.shaders["blender_principled"].parameters}
    kinds = {name: rows[name].type for name in PRINCIPLED}
    return kinds | dict.fromkeys(_GEOMETRY, "vector")


def aov_defaults() -> dict[str, Number]:
    """What a parameter is where no BSDF has it: relume's default; a tint that is not given is white."""
    import relume

    rows = {row.name: row.default for row in relume.shaders["blender_principled"].parameters}
    defaults = {name: rows.get(name, (0.0, 0.0, 0.0)) for name in aov_kinds()}
    return {
        name: (1.0, 1.0, 1.0) if isinstance(value, tuple) and min(value) < 0 else value
        for name, value in defaults.items()
    }


def set_up_passes(scene: bpy.types.Scene) -> SetUp:
    """Passes and AOVs of every view layer, and AOV outputs in every material."""
    result = SetUp()
    kinds = aov_kinds()
    for view_layer in scene.view_layers:
        for name in PASSES:
            result.changed += _assign(view_layer, f"use_pass_{name}", True)
        for name, kind in kinds.items():
            result.changed += _add_aov(view_layer, name, "VALUE" if kind == "scalar" else "COLOR", result)
    wirer = Wirer(kinds, aov_defaults())
    for material in _materials():
        try:
            if not material.is_editable:
                raise UnwiredError("it is linked from another file: make it local, or set up passes there")
            changed, remarks = wirer.wire(material)
        except UnwiredError as reason:
            result.unwired.append((material.name, str(reason)))
            continue
        result.wired += 1
        result.changed += changed
        result.remarks += [(material.name, remark) for remark in remarks]
    result.unwired += [(thing.name, f"{what} has no material; give it one") for thing, what in _bare_objects(scene)]
    for thing in scene.objects:
        if getattr(thing, "shadow_terminator_shading_offset", 0) > 0 and not thing.hide_render:
            result.remarks.append((thing.name, "its Shading Offset of the shadow terminator is not relit"))
    return result


def write_multilayer(scene: bpy.types.Scene) -> bool:
    """Have renders written as multilayer EXR of 32 bits, which holds every pass. Returns whether that is a change."""
    settings = scene.render.image_settings
    changed = hasattr(settings, "media_type") and _assign(settings, "media_type", "MULTI_LAYER_IMAGE")
    changed |= _assign(settings, "file_format", "OPEN_EXR_MULTILAYER")
    changed |= _assign(settings, "color_depth", "32")
    if settings.exr_codec in LOSSY:
        changed |= _assign(settings, "exr_codec", "ZIP")
    if refuses_parts(scene):
        changed |= _assign(settings, "use_exr_interleave", True)
    return changed


def refuses_parts(scene: bpy.types.Scene) -> bool:
    """Whether Blender cannot write one part per pass: 5.0 cannot where pixels are not square."""
    render = scene.render
    return hasattr(render.image_settings, "use_exr_interleave") and render.pixel_aspect_x != render.pixel_aspect_y


def _assign(owner: object, name: str, value: object) -> bool:
    if getattr(owner, name) == value:
        return False
    setattr(owner, name, value)
    return True


def _add_aov(view_layer: bpy.types.ViewLayer, name: str, kind: str, result: SetUp) -> bool:
    found = view_layer.aovs.get(name)
    if found is None:
        found = view_layer.aovs.add()
        found.name, found.type = name, kind
        return True
    if found.type != kind:
        result.unwired.append((view_layer.name, f"its AOV '{name}' is of type {found.type}; relume needs {kind}"))
    return False


def _materials() -> Iterator[bpy.types.Material]:
    import bpy

    return (material for material in bpy.data.materials if material.users and not material.is_grease_pencil)


def _bare_objects(scene: bpy.types.Scene) -> Iterator[tuple[bpy.types.Object, str]]:
    """Objects that render with no material of their own, and what of them does."""
    for thing in scene.objects:
        if thing.type not in _SURFACES or thing.hide_render:
            continue
        empty = {place for place, slot in enumerate(thing.material_slots) if slot.material is None}
        if len(empty) == len(thing.material_slots):
            yield thing, "the object"
        elif empty and (thing.type != "MESH" or empty & {face.material_index for face in thing.data.polygons}):
            yield thing, f"its material slot {min(empty) + 1}"
