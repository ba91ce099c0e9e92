# SPDX-License-Identifier: Apache-2.0
"""The buttons: set up passes, relight, write a rig, load one. relight_range.py has the one for a frame range."""

# No `from __future__ import annotations`: Blender wants the annotations themselves.
import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import bpy
from bpy.props import BoolProperty, StringProperty
from bpy_extras.io_utils import ExportHelper, ImportHelper

from . import live

if TYPE_CHECKING:
    from .scene_rig import SceneRig

Result = set[str]


def attempted(operator: bpy.types.Operator, work: Callable[[], Any]) -> Any:
    """What `work` returns; what goes wrong with files and rigs is the operator's error, and None is returned."""
    from relume import Error

    from .frames import NoFrameError

    try:
        return work()
    except (Error, NoFrameError, OSError) as error:
        operator.report({"ERROR"}, str(error))
        return None


class RELUME_OT_set_up_passes(bpy.types.Operator):
    """Make the scene's renders relightable: passes, AOVs, and their wiring in every material"""

    bl_idname = "relume.set_up_passes"
    bl_label = "Set Up Passes"
    bl_options = {"REGISTER", "UNDO"}

    multilayer: BoolProperty(
        name="Multilayer EXR",
        description="Have renders written as multilayer EXR of 32 bits, which holds every pass",
        default=True,
    )

    def execute(self, context: bpy.types.Context) -> Result:
        """Set up; a scene that is set up stays as it is."""
        from .passes import set_up_passes, write_multilayer

        done = set_up_passes(context.scene)
        changes = done.changed + (write_multilayer(context.scene) if self.multilayer else 0)
        _list(context.scene.relume.unwired, done.unwired, done.remarks)
        for name, why in done.unwired:
            self.report({"WARNING"}, f"{name}: {why}")
        if context.scene.render.engine != "CYCLES":
            self.report({"WARNING"}, f"{context.scene.render.engine} is not Cycles: the relit picture will differ")
        self.report({"INFO"}, f"{done.wired} materials wired" if changes else "Everything is set up already")
        return {"FINISHED"} if changes else {"CANCELLED"}


def _list(remarks: Any, unwired: list[tuple[str, str]], notes: list[tuple[str, str]]) -> None:
    remarks.clear()
    for pairs, icon in ((unwired, "ERROR"), (notes, "INFO")):
        for name, text in pairs:
            remark = remarks.add()
            remark.name, remark.text, remark.icon = name, text, icon


class RELUME_OT_relight(bpy.types.Operator):
    """Relight the render by the scene's lights, into an image"""

    bl_idname = "relume.relight"
    bl_label = "Relight"
    bl_options = {"REGISTER"}

    def execute(self, context: bpy.types.Context) -> Result:
        """Load the render where it is new, relight it, show it."""
        from .picture import open_in_editor

        image = attempted(self, lambda: live.relight_scene(context.scene, context.evaluated_depsgraph_get()))
        if image is None:
            return {"CANCELLED"}
        open_in_editor(image)
        left_out = [each for each in context.scene.relume.remarks if each.icon == "ERROR"]
        for each in left_out:
            self.report({"WARNING"}, f"{each.name} is left out: {each.text}")
        self.report({"INFO"}, f"Relit in {context.scene.relume.seconds:.2f} s: image '{image.name}'")
        return {"FINISHED"}


def _from_rig(scene: bpy.types.Scene, source: Path, rig: Path) -> str:
    """The render's name in a rig: relative where the user has it relative to the .blend file."""
    given = scene.relume.filepath or scene.render.filepath
    return os.path.relpath(source, rig.parent) if given.startswith("//") else str(source)


def rig_of_scene(context: bpy.types.Context) -> "SceneRig":
    """The scene's rig, with keys for what moves over its frame range where the user wants them."""
    from .scene_rig import animated_rig, scene_rig

    scene = context.scene
    if scene.relume.keys_of_animation and scene.frame_end > scene.frame_start:
        frames = range(scene.frame_start, scene.frame_end + 1)
        return animated_rig(scene, context.evaluated_depsgraph_get, frames)
    return scene_rig(scene, context.evaluated_depsgraph_get())


class RELUME_OT_write_rig(bpy.types.Operator, ExportHelper):
    """Write the scene's lights and settings as a .relume file, for the command line and a farm"""

    bl_idname = "relume.write_rig"
    bl_label = "Write Rig"
    bl_options = {"REGISTER"}
    filename_ext = ".relume"

    filter_glob: StringProperty(default="*.relume", options={"HIDDEN"})

    def execute(self, context: bpy.types.Context) -> Result:
        """Write it."""
        from .scene_rig import source_file

        def write() -> "SceneRig":
            made = rig_of_scene(context)
            if not made.rig.gbuffer.file:
                made.rig.gbuffer.file = _from_rig(context.scene, source_file(context.scene), Path(self.filepath))
            made.rig.save(self.filepath)
            return made

        made = attempted(self, write)
        if made is None:
            return {"CANCELLED"}
        for name, why in made.lights.left_out:
            self.report({"WARNING"}, f"{name} is left out: {why}")
        self.report({"INFO"}, f"Wrote {self.filepath}")
        return {"FINISHED"}


class RELUME_OT_load_rig(bpy.types.Operator, ImportHelper):
    """Make lights of a .relume file's lights; what Blender has no light for stays in a text and joins the rig"""

    bl_idname = "relume.load_rig"
    bl_label = "Load Rig"
    bl_options = {"REGISTER", "UNDO"}
    filename_ext = ".relume"

    filter_glob: StringProperty(default="*.relume", options={"HIDDEN"})

    def execute(self, context: bpy.types.Context) -> Result:
        """Load it."""
        from .load_rig import load_rig

        loaded = attempted(self, lambda: load_rig(context.scene, Path(self.filepath)))
        if loaded is None:
            return {"CANCELLED"}
        for name, why in loaded.kept:
            self.report({"INFO"}, f"{name} stays in the text: {why}")
        self.report({"INFO"}, f"{len(loaded.made)} lights from {Path(self.filepath).name}")
        return {"FINISHED"}


CLASSES = (RELUME_OT_set_up_passes, RELUME_OT_relight, RELUME_OT_write_rig, RELUME_OT_load_rig)
