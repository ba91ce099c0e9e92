# SPDX-License-Identifier: Apache-2.0
"""Live: a light that moves or changes has the picture relit, as often as there is time for it.

Handlers only note what has changed; the work is done from a timer, so that ten changes between two redraws cost one
relight. Where a whole frame takes too long to follow a hand, every second pixel of every second row is shaded while
something moves, and the whole frame as soon as nothing has moved for a moment. Without an event loop (``blender -b``,
the module bpy) it is done at once.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import bpy
from bpy.app.handlers import persistent

if TYPE_CHECKING:
    from .frames import LoadedFrame


#: A frame that takes longer is shaded by a quarter of its pixels while something moves.
_SECONDS_TO_FOLLOW = 0.09
#: With nothing moving for so long, the whole frame is shaded.
_SECONDS_OF_REST = 0.2


class _State:
    """The frame in memory, and what is out of date."""

    frame: LoadedFrame | None = None
    #: What the frame was loaded from: scene, the rig's text, and file with its time or render count.
    origin: tuple[object, ...] = ()
    #: Renders made so far, so that a new one is noticed.
    renders = 0
    #: The rig beyond the lights has changed: shaders, [output], the file.
    rig_is_stale = True
    busy = False
    #: Cycles is at work: its frames are none that the user has gone to.
    rendering = False
    #: What a relight of the whole frame took last.
    seconds = 0.0


_state = _State()


def _origin(scene: bpy.types.Scene) -> tuple[object, ...]:
    from .frames import newest
    from .scene_rig import source_file

    text = scene.relume.rig_extra
    who = scene.name, text.as_string() if text is not None else ""
    if scene.relume.source == "RENDER":
        return *who, "render", _state.renders
    return *who, *newest(source_file(scene), scene.frame_current)


def relight_scene(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph, step: int = 1) -> bpy.types.Image:
    """Relight the scene's render by its lights as they are; what is loaded already is not loaded again.

    With a step of 2 every second pixel of every second row is shaded.

    Raises:
        NoFrameError: there is no render to relight.
        relume.Error: it has no normals, or the rig does not fit it.
    """
    from .frames import LoadedFrame
    from .picture import show
    from .scene_lights import scene_lights
    from .scene_rig import base_rig, source_file

    start = time.perf_counter()
    origin = _origin(scene)
    loads = _state.frame is None or _state.origin != origin or _state.rig_is_stale
    if _state.frame is None or loads:
        rig = base_rig(scene)
        _state.frame = None  # two frames need not be in memory
        if scene.relume.source == "RENDER":
            _state.frame = LoadedFrame.rendered(scene, rig)
        else:
            _state.frame = LoadedFrame.read(source_file(scene), rig, scene.frame_current)
        _state.origin, _state.rig_is_stale = origin, False
        step = 1  # a whole relight reads the file, and what it asked for is kept
    lights = scene_lights(scene, depsgraph)
    report = _state.frame.relight(scene, lights.lights, step)
    image = show(scene, _state.frame)
    _say(scene, lights.left_out, [*lights.notes, *(("", text) for text in (*_state.frame.notes, *report.warnings))])
    scene.relume.seconds = time.perf_counter() - start
    if step == 1 and not loads:
        _state.seconds = scene.relume.seconds
    return image


def _say(scene: bpy.types.Scene, left_out: list[tuple[str, str]], notes: list[tuple[str, str]]) -> None:
    """List what is left out and what is approximated, where that has changed."""
    lines = [(name, text, "ERROR") for name, text in left_out] + [(name, text, "INFO") for name, text in notes]
    remarks = scene.relume.remarks
    if [(each.name, each.text, each.icon) for each in remarks] == lines:
        return
    remarks.clear()
    for name, text, icon in lines:
        remark = remarks.add()
        remark.name, remark.text, remark.icon = name, text, icon


def loaded_frame() -> LoadedFrame | None:
    """The frame in memory."""
    return _state.frame


def forget() -> None:
    """Free the frame in memory."""
    _state.frame, _state.origin, _state.rig_is_stale = None, (), True


def settings_changed(_owner: object, context: bpy.types.Context) -> None:
    """A setting of the rig has changed (the update callback of properties)."""
    _state.rig_is_stale = True
    if context.scene is not None and context.scene.relume.live:
        request()


def live_switched(settings: bpy.types.PropertyGroup, _context: bpy.types.Context) -> None:
    """The switch itself (an update callback). Off, it frees the frame."""
    if settings.live:
        request()
    else:
        forget()


def request() -> None:
    """Relight soon: once, however often this is called before it happens."""
    if bpy.app.background:
        _tick()
    elif not bpy.app.timers.is_registered(_tick_moving):
        bpy.app.timers.register(_tick_moving, first_interval=0.0)


def _tick_moving() -> None:
    """Relight as fast as a hand moves."""
    slow = _state.seconds > _SECONDS_TO_FOLLOW and _state.frame is not None
    _tick(2 if slow else 1)
    if bpy.app.timers.is_registered(_tick):
        bpy.app.timers.unregister(_tick)
    if slow:
        bpy.app.timers.register(_tick, first_interval=_SECONDS_OF_REST)


def _tick(step: int = 1) -> None:
    scene = bpy.context.scene
    if _state.busy or scene is None or not scene.relume.live:
        return
    _state.busy = True  # what is written here is itself a change
    try:
        relight_scene(scene, bpy.context.evaluated_depsgraph_get(), step)
    except Exception as error:
        from relume import Error

        from .frames import NoFrameError

        if not isinstance(error, (Error, NoFrameError)):
            raise
        _say(scene, [("", str(error))], [])
    finally:
        _state.busy = False


def _concerns_lights(updated: bpy.types.ID) -> bool:
    if isinstance(updated, bpy.types.Object):
        return updated.type == "LIGHT" or updated.is_instancer
    return isinstance(updated, (bpy.types.Light, bpy.types.World, bpy.types.Collection))


@persistent
def _depsgraph_updated(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    if _state.busy or _state.rendering or depsgraph.mode != "VIEWPORT":
        return
    ids = [update.id for update in depsgraph.updates]
    if any(isinstance(each, bpy.types.Action) for each in ids):
        _refresh_materials(list(bpy.data.materials))  # keys of one of them may have moved
    else:
        _refresh_materials([each.original for each in ids if isinstance(each, bpy.types.Material)])
    if scene.relume.live and any(_concerns_lights(each) for each in ids):
        request()


def _refresh_materials(materials: list[bpy.types.Material]) -> None:
    """A slider or a key of a wired material has moved: its AOVs follow."""
    from .wiring import MARK, refresh

    _state.busy = True
    try:
        for material in materials:
            if MARK in material and material.node_tree is not None and material.is_editable:
                refresh(material.node_tree)
    finally:
        _state.busy = False


@persistent
def _frame_changed(scene: bpy.types.Scene, _depsgraph: bpy.types.Depsgraph) -> None:
    if scene.relume.live and not _state.rendering:
        request()


@persistent
def _render_begins(_scene: bpy.types.Scene, _unused: object = None) -> None:
    _state.rendering = True


@persistent
def _render_cancelled(_scene: bpy.types.Scene, _unused: object = None) -> None:
    _state.rendering = False
    _state.renders += 1


@persistent
def _rendered(_scene: bpy.types.Scene, _unused: object = None) -> None:
    _state.rendering = False
    _state.renders += 1
    scene = bpy.context.scene
    # A farm that renders a file which was saved with the switch on wants no relit picture.
    if scene is not None and scene.relume.live and not bpy.app.background:
        request()


@persistent
def _file_loaded(_path: object, _unused: object = None) -> None:
    forget()


_HANDLERS = {
    "depsgraph_update_post": _depsgraph_updated,
    "frame_change_post": _frame_changed,
    "render_init": _render_begins,
    "render_cancel": _render_cancelled,
    "render_complete": _rendered,
    "load_post": _file_loaded,
}


def register() -> None:
    """Hang the handlers in."""
    for name, handler in _HANDLERS.items():
        getattr(bpy.app.handlers, name).append(handler)


def unregister() -> None:
    """Take handlers and timer away, and free the frame."""
    for name, handler in _HANDLERS.items():
        getattr(bpy.app.handlers, name).remove(handler)
    for timer in (_tick_moving, _tick):
        if bpy.app.timers.is_registered(timer):
            bpy.app.timers.unregister(timer)
    forget()
