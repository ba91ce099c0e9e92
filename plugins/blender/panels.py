# SPDX-License-Identifier: Apache-2.0
"""Panels: in the Render properties, in the Image Editor's sidebar, and in a light's properties."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import bpy

from .properties import GIVEN, light_rows, output_rows, shader_rows

if TYPE_CHECKING:
    from collections.abc import Iterable

    from relume import Parameter


def _draw_rows(layout: Any, group: bpy.types.PropertyGroup, rows: Iterable[Parameter]) -> None:
    """The properties of a table; those with a switch grey until it is on."""
    column = layout.column()
    for row in rows:
        if not hasattr(group, row.name):
            continue
        line = column.row(align=True)
        switch = GIVEN + row.name
        if hasattr(group, switch):
            line.prop(group, switch, text="")
            line = line.row()
            line.active = getattr(group, switch)
        line.prop(group, row.name)


def _draw_remarks(layout: Any, remarks: Iterable[Any]) -> None:
    column = layout.column(align=True)
    for each in remarks:
        column.label(text=f"{each.name}: {each.text}" if each.name else each.text, icon=each.icon)


def _draw_relight(layout: Any, settings: bpy.types.PropertyGroup) -> None:
    layout.prop(settings, "source")
    if settings.source == "FILE":
        layout.prop(settings, "filepath")
    row = layout.row(align=True)
    row.operator("relume.relight", icon="LIGHT")
    row.prop(settings, "live", toggle=True, icon="PLAY")
    if settings.seconds > 0:
        layout.label(text=f"{1000 * settings.seconds:.0f} ms")
    _draw_remarks(layout, settings.remarks)


class _RenderPanel:
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"


class RELUME_PT_render(_RenderPanel, bpy.types.Panel):
    """The buttons, in the order in which they are used."""

    bl_label = "Relume"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Set up, relight."""
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        settings = context.scene.relume
        self.layout.operator("relume.set_up_passes", icon="NODE_MATERIAL")
        _draw_remarks(self.layout, settings.unwired)
        _draw_relight(self.layout, settings)


class RELUME_PT_sequence(_RenderPanel, bpy.types.Panel):
    """The rig file and the frame range."""

    bl_label = "Rig and Sequence"
    bl_parent_id = "RELUME_PT_render"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Write, load, relight the range."""
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        settings = context.scene.relume
        self.layout.prop(settings, "rig_path")
        row = self.layout.row(align=True)
        row.operator("relume.write_rig", icon="EXPORT").filepath = bpy.path.abspath(settings.rig_path)
        row.operator("relume.load_rig", icon="IMPORT")
        self.layout.prop(settings, "rig_extra")
        self.layout.prop(settings, "keys_of_animation")
        self.layout.prop(settings, "filepath")
        self.layout.prop(settings, "output_path")
        self.layout.operator("relume.relight_range", icon="RENDER_ANIMATION")


class RELUME_PT_shader(_RenderPanel, bpy.types.Panel):
    """The shading model, and what of its parameters is not taken from the render."""

    bl_label = "Shading Model"
    bl_parent_id = "RELUME_PT_render"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Model and parameters, by relume's table."""
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        settings = context.scene.relume
        self.layout.prop(settings, "shader")
        _draw_rows(self.layout, getattr(settings.shaders, settings.shader), shader_rows(settings.shader))


class RELUME_PT_output(_RenderPanel, bpy.types.Panel):
    """[output] of the rig."""

    bl_label = "Output"
    bl_parent_id = "RELUME_PT_render"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Its rows, by relume's table."""
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        _draw_rows(self.layout, context.scene.relume.output, output_rows())


class RELUME_PT_image(bpy.types.Panel):
    """Beside the picture."""

    bl_label = "Relume"
    bl_space_type = "IMAGE_EDITOR"
    bl_region_type = "UI"
    bl_category = "Relume"

    def draw(self, context: bpy.types.Context) -> None:
        """Relight, live."""
        _draw_relight(self.layout, context.scene.relume)


class RELUME_PT_light(bpy.types.Panel):
    """What a rig says of a light and Blender does not."""

    bl_label = "Relume"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "data"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Of lights alone."""
        return context.light is not None

    def draw(self, context: bpy.types.Context) -> None:
        """Its rows, by relume's table."""
        self.layout.use_property_split = True
        _draw_rows(self.layout, context.light.relume, light_rows())


CLASSES = (
    RELUME_PT_render,
    RELUME_PT_sequence,
    RELUME_PT_shader,
    RELUME_PT_output,
    RELUME_PT_image,
    RELUME_PT_light,
)
