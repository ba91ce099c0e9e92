# SPDX-License-Identifier: Apache-2.0
"""``relume relight``: a frame or a sequence, one bad frame at a time."""

from __future__ import annotations

import signal
import sys
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Protocol

import click

from relume.cli import EXIT_FAILED, EXIT_INTERRUPTED, EXIT_OK
from relume.cli.options import RigFailure, gbuffer_options, load_rig, set_option

if TYPE_CHECKING:
    from relume._relume import Report
    from relume.rig import Rig


@dataclass
class Job:
    """One frame: what is read, what is written. ``frame`` is None for a single file."""

    frame: int | None
    source: str
    output: Path

    @property
    def title(self) -> str:
        """What messages call it."""
        return self.source if self.frame is None else f"frame {self.frame}"


@dataclass
class Tally:
    """What became of the frames."""

    done: int = 0
    skipped: int = 0
    failed: list[Job] = field(default_factory=list)
    warnings: Counter[str] = field(default_factory=Counter)
    interrupted: bool = False


@click.command("relight")
@click.argument("source", required=False, metavar="[GBUFFER]")
@click.option("--rig", "rig_path", required=True, metavar="FILE", help="The rig, or the name of a built-in one.")
@click.option("-o", "--output", required=True, metavar="FILE", help="The EXR to write, with #### where GBUFFER has it.")
@click.option("--frames", metavar="RANGE", help="1001, 1001-1100, 1001-1100x2, or several with commas.")
@click.option("--skip-existing", is_flag=True, help="Leave out frames whose output is there.")
@click.option("--threads", type=click.IntRange(min=1), help="How many; all that the process may use when absent.")
@set_option
@gbuffer_options
@click.option("-q", "--quiet", is_flag=True, help="Only errors and warnings.")
def command(
    source: str | None,
    rig_path: str,
    output: str,
    frames: str | None,
    skip_existing: bool,
    threads: int | None,
    settings: tuple[str, ...],
    channels: tuple[str, ...],
    part: str | None,
    view: str | None,
    quiet: bool,
) -> int:
    """Relight GBUFFER (an EXR, or a sequence as shot.####.exr, shot.%04d.exr or shot.{frame}.exr).

    GBUFFER may be left out where the rig names it. Without --frames every frame of a sequence that is on disk is relit.
    A frame that fails is named and the others go on; an output appears only when it is whole.

    Exit codes: 0 all went well, 1 a frame failed, 2 the command line or the rig is wrong, 3 interrupted.
    """
    rig = load_rig(rig_path, settings, channels, part, view)
    jobs = plan(source, rig, output, frames)
    tally = Tally()
    with _stoppable(), _display(len(jobs), quiet) as display:
        run(jobs, rig, threads, skip_existing, tally, display)
    return _summary(jobs, tally, quiet, display.seconds)


def plan(source: str | None, rig: Rig, output: str, frames: str | None) -> list[Job]:
    """The frames to do.

    Raises:
        click.UsageError: frames without a place for their number, outputs that would overwrite each other or an input.
        click.ClickException: nothing on disk matches, or there is no folder for the output.
    """
    from relume.errors import Error
    from relume.frames import find_frames, is_pattern, parse_frames, resolve_frame
    from relume.gbuffer import main_file

    try:
        name = main_file(source, rig)
    except Error as error:
        raise click.UsageError(str(error)) from None
    if Path(output).suffix.lower() != ".exr":
        raise click.UsageError(f"{output}: relight writes EXR; `relume png` makes a PNG of it")

    sequence = is_pattern(name) and (frames is not None or not Path(name).exists())
    if frames is not None and not sequence:
        raise click.UsageError(f"--frames needs a sequence, as shot.####.exr; {name} is one file")
    if not sequence:
        jobs = [Job(None, name, Path(output))]
    else:
        try:
            numbers = parse_frames(frames) if frames is not None else find_frames(name)
        except Error as error:
            raise click.UsageError(str(error)) from None
        if not numbers:
            raise click.ClickException(f"{name}: no such files")
        if len(numbers) > 1 and not is_pattern(output):
            raise click.UsageError(f"{output}: all {len(numbers)} frames would go to this one file; write #### into it")
        jobs = [Job(number, resolve_frame(name, number), Path(resolve_frame(output, number))) for number in numbers]

    outputs = {job.output.resolve(): job for job in jobs}
    if len(outputs) < len(jobs):
        raise click.UsageError(f"{output}: several frames would go to the same file")
    inputs = {Path(job.source).resolve() for job in jobs}
    for job in jobs:
        for further in rig._rig.channel_sources().values():
            if further and Path(further).suffix:
                inputs.add(Path(resolve_frame(further, job.frame) if job.frame is not None else further).resolve())
    for path in inputs:
        if path in outputs:
            raise click.UsageError(f"{outputs[path].output}: the output would overwrite an input")
    for folder in {job.output.parent for job in jobs}:
        if not folder.is_dir():
            raise click.ClickException(f"{folder}: no such folder; make it first")
    return jobs


def run(jobs: list[Job], rig: Rig, threads: int | None, skip_existing: bool, tally: Tally, display: Display) -> None:
    """Relight every job; failures are told and counted.

    Raises:
        RigFailure: the rig does not fit any frame.
    """
    from relume.cli.report import one_line
    from relume.errors import ParameterError, RigError
    from relume.gbuffer import GBuffer
    from relume.relighting import relight_file

    for job in jobs:
        if skip_existing and job.output.exists():
            tally.skipped += 1
            display.next(job, None)
            continue
        try:
            gbuffer = GBuffer.read(job.source, rig=rig, frame=job.frame)
            report = relight_file(gbuffer, rig, job.output, threads, display.progress)
        except (KeyboardInterrupt, _Terminated):
            tally.interrupted = True
            return
        except (RigError, ParameterError) as error:
            raise RigFailure(one_line(error)) from error
        except Exception as error:
            tally.failed.append(job)
            text = one_line(error)
            named = text if job.source in text or str(job.output) in text else f"{job.source}: {text}"
            display.message(f"relume: {named}" if job.frame is None else f"relume: {job.title}: {named}")
            display.next(job, None)
            continue
        tally.done += 1
        for warning in _warnings(report):
            if not tally.warnings[warning]:
                display.message(f"relume: {job.title}: {warning}")
            tally.warnings[warning] += 1
        display.next(job, report)


def _warnings(report: Report) -> Iterator[str]:
    for channel, count in report.nonfinite.items():
        yield f"{count} pixel{'s' if count > 1 else ''} with NaN or infinity in {channel}, left black"
    yield from report.warnings


class _Terminated(BaseException):
    """A SIGTERM: what a farm sends before it kills."""


@contextmanager
def _stoppable() -> Iterator[None]:
    def terminate(number: int, frame: FrameType | None) -> None:
        raise _Terminated

    before = signal.signal(signal.SIGTERM, terminate)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


class Display(Protocol):
    """Where progress is shown."""

    seconds: float

    def progress(self, share: float) -> None:
        """Share of the current frame that is done."""

    def next(self, job: Job, report: Report | None) -> None:
        """The frame is done, or is not to be done."""

    def message(self, text: str) -> None:
        """A line that stays."""


class _Lines:
    """For logs: a line a frame."""

    def __init__(self, total: int, quiet: bool) -> None:
        self.seconds = 0.0
        self._total = total
        self._count = 0
        self._quiet = quiet

    def progress(self, share: float) -> None:
        pass

    def next(self, job: Job, report: Report | None) -> None:
        self._count += 1
        if report is not None:
            self.seconds += report.seconds
            if not self._quiet:
                self.message(f"[{self._count}/{self._total}] {job.output}  {report.seconds:.2f} s")

    def message(self, text: str) -> None:
        click.echo(text, err=True)


@contextmanager
def _display(total: int, quiet: bool) -> Iterator[Display]:
    if quiet or not sys.stderr.isatty():
        yield _Lines(total, quiet)
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    console = Console(stderr=True, highlight=False, soft_wrap=True)
    text = TextColumn("{task.description}")
    with Progress(
        text, BarColumn(), TextColumn("{task.percentage:>3.0f}%"), TimeRemainingColumn(), console=console
    ) as bar:
        task = bar.add_task("relighting", total=total)
        count = 0

        class Bar:
            seconds = 0.0

            def progress(self, share: float) -> None:
                bar.update(task, completed=count + share)

            def next(self, job: Job, report: Report | None) -> None:
                nonlocal count
                count += 1
                self.seconds += report.seconds if report is not None else 0.0
                bar.update(task, completed=count, description=f"{count}/{total}")

            def message(self, text: str) -> None:
                bar.console.print(text, markup=False)

        yield Bar()


def _summary(jobs: list[Job], tally: Tally, quiet: bool, seconds: float) -> int:
    words = [f"{tally.done} of {len(jobs)} frames relit" if len(jobs) > 1 else f"{jobs[0].output} written"]
    if tally.done and len(jobs) > 1:
        words.append(f"{seconds / tally.done:.2f} s each")
    if tally.skipped:
        words.append(f"{tally.skipped} there already")
    if tally.failed and len(jobs) > 1:
        words.append(f"{len(tally.failed)} failed: {', '.join(str(job.frame) for job in tally.failed)}")
    if tally.interrupted:
        words.append("interrupted")
    repeated = [f"{text} ({count} frames)" for text, count in tally.warnings.items() if count > 1]
    if not quiet:
        for text in repeated:
            click.echo(f"relume: {text}", err=True)
        if tally.done or tally.skipped or len(jobs) > 1:
            click.echo(f"relume: {', '.join(words if tally.done or len(jobs) > 1 else words[1:])}", err=True)
    if tally.interrupted:
        if quiet or not (tally.done or len(jobs) > 1):
            click.echo("relume: interrupted", err=True)
        return EXIT_INTERRUPTED
    return EXIT_FAILED if tally.failed else EXIT_OK
