# SPDX-License-Identifier: Apache-2.0
"""Relight the frame range: the EXRs on disk, in a thread of its own, with progress; Esc stops it."""

# No `from __future__ import annotations`: Blender wants the annotations themselves.
import queue
import threading
from pathlib import Path
from typing import TYPE_CHECKING, Any

import bpy

from .operators import Result, attempted, rig_of_scene
from .scene_rig import source_file

if TYPE_CHECKING:
    import relume
    from relume.sequence import Frame, FrameResult

    from .scene_rig import SceneRig


class _Stopped(BaseException):
    """Raised in a progress call: the user wants no more."""


class Work:
    """Frames being relit in a thread. ``news`` are (share done, text); the last has a share of 1."""

    def __init__(self, frames: "list[Frame]", rig: "relume.Rig") -> None:
        self.total = len(frames)
        self.news: queue.Queue[tuple[float, str]] = queue.Queue()
        self.results: list[FrameResult] = []
        self.error: BaseException | None = None
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, args=(frames, rig), name="relume-range", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Have the frames in flight stopped within a fraction of a second."""
        self._stop.set()

    @property
    def is_running(self) -> bool:
        """Whether there is more to come."""
        return self._thread.is_alive()

    def wait(self) -> None:
        """Until the last frame."""
        self._thread.join()

    def _run(self, frames: "list[Frame]", rig: "relume.Rig") -> None:
        from relume.sequence import relight_frames

        shares: dict[Frame, float] = {}

        def progress(frame: "Frame", share: float) -> None:
            if self._stop.is_set():
                raise _Stopped
            shares[frame] = share
            self.news.put((sum(shares.values()) / self.total, frame.title))

        def result(done: "FrameResult") -> None:
            self.results.append(done)
            progress(done.frame, 1.0)

        try:
            relight_frames(frames, rig, on_progress=progress, on_result=result)
        except _Stopped:
            pass
        except BaseException as error:
            self.error = error


def frames_of(scene: bpy.types.Scene) -> "list[Frame]":
    """The frames of the scene's range: what is read and what is written.

    Raises:
        relume.ArgumentError: a range of one name: there is no place for the frame's number in it.
    """
    import relume
    from relume.frames import is_pattern, resolve_frame
    from relume.sequence import Frame

    source, output = str(source_file(scene)), bpy.path.abspath(scene.relume.output_path)
    if not output:
        raise relume.ArgumentError("no output: say where the frames go, as //relit/shot.####.exr")
    for path in (source, output):
        if scene.frame_end > scene.frame_start and not is_pattern(path):
            raise relume.ArgumentError(f"{path}: the name of a sequence needs #### where the frame's number stands")
    Path(output).parent.mkdir(parents=True, exist_ok=True)
    numbers = range(scene.frame_start, scene.frame_end + 1, scene.frame_step)
    return [Frame(number, resolve_frame(source, number), Path(resolve_frame(output, number))) for number in numbers]


class RELUME_OT_relight_range(bpy.types.Operator):
    """Relight the scene's frame range from the EXRs on disk into EXRs; Esc stops it"""

    bl_idname = "relume.relight_range"
    bl_label = "Relight Frame Range"
    bl_options = {"REGISTER"}

    _work: "Work | None" = None
    _timer: Any = None

    def _begin(self, context: bpy.types.Context) -> "Work | None":
        from relume.sequence import check_outputs

        def plan() -> "tuple[list[Frame], SceneRig]":
            frames, rig = frames_of(context.scene), rig_of_scene(context)
            check_outputs(frames, rig.rig)
            return frames, rig

        made = attempted(self, plan)
        if made is None:
            return None
        frames, rig = made
        for name, why in rig.lights.left_out:
            self.report({"WARNING"}, f"{name} is left out: {why}")
        return Work(frames, rig.rig)

    def execute(self, context: bpy.types.Context) -> Result:
        """Relight, and come back when it is done (scripts, and Blender without windows)."""
        work = self._begin(context)
        if work is None:
            return {"CANCELLED"}
        work.wait()
        return self._end(work)

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> Result:
        """Relight beside the user's work."""
        self._work = self._begin(context)
        if self._work is None:
            return {"CANCELLED"}
        manager = context.window_manager
        manager.progress_begin(0, 100)
        self._timer = manager.event_timer_add(0.1, window=context.window)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> Result:
        """Show how far it is; Esc stops it."""
        work = self._work
        assert work is not None
        if event.type == "ESC":
            work.stop()
            return {"RUNNING_MODAL"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        while not work.news.empty():
            share, text = work.news.get()
            context.window_manager.progress_update(100 * share)
            context.workspace.status_text_set(f"Relighting {text}: {100 * share:.0f} %. Esc stops it")
        if work.is_running:
            return {"RUNNING_MODAL"}
        context.window_manager.progress_end()
        context.window_manager.event_timer_remove(self._timer)
        context.workspace.status_text_set(None)
        return self._end(work)

    def cancel(self, context: bpy.types.Context) -> None:
        """Blender is closing."""
        if self._work is not None:
            self._work.stop()

    def _end(self, work: "Work") -> Result:
        failed = [result for result in work.results if result.status == "failed"]
        for result in failed:
            self.report({"ERROR"}, f"{result.frame.title}: {result.error}")
        if work.error is not None:
            self.report({"ERROR"}, str(work.error))
        done = sum(result.status == "done" for result in work.results)
        self.report({"INFO"}, f"{done} of {work.total} frames relit")
        return {"FINISHED"} if done == work.total else {"CANCELLED"}


CLASSES = (RELUME_OT_relight_range,)
