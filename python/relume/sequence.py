# SPDX-License-Identifier: Apache-2.0
"""Relighting many frames: several in flight, so that no CPU waits for a frame's ends; each frame fails alone."""

from __future__ import annotations

import queue
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from relume._relume import ExrFile
from relume.errors import ArgumentError, Error, ParameterError, RigError
from relume.gbuffer import GBuffer
from relume.relighting import relight_file

if TYPE_CHECKING:
    from relume._relume import Report
    from relume.rig import Rig

__all__ = [
    "Frame",
    "FrameReport",
    "FrameResult",
    "Status",
    "check_outputs",
    "inputs_of",
    "is_up_to_date",
    "relight_frame",
    "relight_frames",
]

Status = Literal["done", "skipped", "failed", "cancelled"]

#: What is wrong with the rig is so for every frame.
MISFITS = (RigError, ParameterError)

#: While one frame's threads run out of rows, is renamed, and the next one's header is read, another is shaded.
FRAMES_IN_FLIGHT = 2


@dataclass(frozen=True)
class Frame:
    """What is read and what is written. ``number`` is None for a single file."""

    number: int | None
    source: str
    output: Path

    @property
    def title(self) -> str:
        """What messages call it."""
        return self.source if self.number is None else f"frame {self.number}"


@dataclass(frozen=True)
class FrameReport:
    """What happened to the pixels of a frame, as plain data."""

    pixels: int
    shaded: int
    background: int
    #: Pixels with NaN or infinity, by channel; they are left black.
    nonfinite: dict[str, int]
    warnings: list[str]
    #: What was decided where the rig left it open.
    notes: list[str] = field(default_factory=list)

    @staticmethod
    def of(report: Report) -> FrameReport:
        """Of the core's report."""
        return FrameReport(
            report.pixels,
            report.shaded,
            report.background,
            dict(report.nonfinite),
            list(report.warnings),
            list(report.notes),
        )


@dataclass(frozen=True)
class FrameResult:
    """What became of a frame."""

    frame: Frame
    status: Status
    #: Wall seconds from the opening of the G-buffer to the output under its name.
    seconds: float = 0.0
    report: FrameReport | None = None
    #: Why it failed.
    error: BaseException | None = None


def inputs_of(frame: Frame, rig: Rig) -> list[Path]:
    """The files that the frame is made of: the G-buffer, and those that the rig takes channels and tables from."""
    named = rig._rig if frame.number is None else rig._rig.of_frame(frame.number)
    return [Path(frame.source), *(path for path in named.input_files() if str(path) != named.gbuffer_file)]


def check_outputs(frames: Sequence[Frame], rig: Rig) -> None:
    """See that no frame is written over another, or over what one is made of.

    Raises:
        ArgumentError: one would be.
    """
    outputs: dict[Path, Path] = {}
    for frame in frames:
        if outputs.setdefault(frame.output.resolve(), frame.output) is not frame.output:
            raise ArgumentError(f"{frame.output}: several frames would go to the same file")
    for frame in frames:
        for path in inputs_of(frame, rig):
            if path.resolve() in outputs:
                raise ArgumentError(f"{outputs[path.resolve()]}: the output would overwrite an input")


def _rig_of(frame: Frame, rig: Rig) -> Rig:
    return rig if frame.number is None else rig.at(frame.number)


def is_up_to_date(frame: Frame, rig: Rig) -> bool:
    """Whether the output is whole, newer than what it is made of, and made by this rig (as far as it says by which)."""
    rig = _rig_of(frame, rig)
    try:
        written = frame.output.stat().st_mtime_ns
        if any(path.stat().st_mtime_ns > written for path in inputs_of(frame, rig) if path.exists()):
            return False
        file = ExrFile(frame.output)
        made_by = file.parts[0].attributes.get("relume/rig")
        return file.is_whole() and (made_by is None or made_by == rig._rig.to_toml())
    except (OSError, Error):
        return False


def relight_frame(
    frame: Frame, rig: Rig, threads: int | None = None, progress: Callable[[float], object] | None = None
) -> FrameReport:
    """Relight one frame into its file, by the rig of that frame. Raises what reading, shading and writing raise."""
    rig = _rig_of(frame, rig)
    gbuffer = GBuffer.read(frame.source, rig=rig, frame=frame.number, threads=threads)
    return FrameReport.of(relight_file(gbuffer, rig, frame.output, threads, progress))


class _Stop(BaseException):
    """Ends a frame from its progress call."""


def relight_frames(
    frames: Sequence[Frame],
    rig: Rig,
    *,
    threads: int | None = None,
    in_flight: int = FRAMES_IN_FLIGHT,
    skip_existing: bool = False,
    on_progress: Callable[[Frame, float], object] | None = None,
    on_result: Callable[[FrameResult], object] | None = None,
) -> list[FrameResult]:
    """Relight frames in order, a few at once. Callbacks come in the calling thread.

    Args:
        frames: what to do.
        rig: for all of them.
        threads: of each frame; as many as the process may use when None.
        in_flight: frames worked on at once.
        skip_existing: leave out frames whose output is up to date.
        on_progress: called a few times a second with a frame and the share of it that is done, 0…1.
        on_result: called when a frame has ended, in whatever way.

    Returns:
        One result for each frame that was begun, in the order of their ends. After an exception in a callback or
        Ctrl-C the frames in flight are stopped within a fraction of a second and count as cancelled; that exception
        carries the results so far as its attribute ``results``.

    Raises:
        RigError, ParameterError: the rig fits no frame; nothing more is begun.
    """
    events: queue.Queue[tuple[Frame, float] | FrameResult] = queue.Queue()
    stop = threading.Event()

    def work(frame: Frame) -> None:
        if stop.is_set():
            return
        start = time.perf_counter()

        def progress(share: float) -> None:
            if stop.is_set():
                raise _Stop
            events.put((frame, share))

        def result(status: Status, report: FrameReport | None = None, error: BaseException | None = None) -> None:
            events.put(FrameResult(frame, status, time.perf_counter() - start, report, error))

        try:
            if skip_existing and is_up_to_date(frame, rig):
                result("skipped")
            else:
                result("done", relight_frame(frame, rig, threads, progress))
        except _Stop:
            result("cancelled")
        except BaseException as error:
            if isinstance(error, MISFITS):
                stop.set()
            result("failed", error=error)

    results: list[FrameResult] = []
    with ThreadPoolExecutor(max(1, min(in_flight, len(frames))), "relume-frame") as pool:
        pending = [pool.submit(work, frame) for frame in frames]
        try:
            while not stop.is_set() and len(results) < len(frames):
                _take(events, results, on_progress, on_result, 0.1)
        except BaseException as error:
            stop.set()
            error.results = results  # type: ignore[attr-defined]
            raise
        finally:
            for future in pending:
                future.cancel()
            pool.shutdown(wait=True)
            while not events.empty():
                _take(events, results, None, on_result, 0)
    for result in results:
        if isinstance(result.error, MISFITS):
            raise result.error
    return results


def _take(
    events: queue.Queue[tuple[Frame, float] | FrameResult],
    results: list[FrameResult],
    on_progress: Callable[[Frame, float], object] | None,
    on_result: Callable[[FrameResult], object] | None,
    seconds: float,
) -> None:
    """Hand out one event, or wait for that long."""
    try:
        event = events.get(timeout=seconds) if seconds > 0 else events.get_nowait()
    except queue.Empty:
        return
    if isinstance(event, FrameResult):
        results.append(event)
        if on_result is not None and not isinstance(event.error, MISFITS):
            on_result(event)
    elif on_progress is not None:
        on_progress(*event)
