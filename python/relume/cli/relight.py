# SPDX-License-Identifier: Apache-2.0
"""``relume relight``: a frame or a sequence, one bad frame at a time."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING

import click

from relume.cli import EXIT_FAILED, EXIT_INTERRUPTED, EXIT_OK
from relume.cli.options import RigFailure, gbuffer_options, load_rig, set_option

if TYPE_CHECKING:
    from relume.rig import Rig
    from relume.sequence import Frame


@click.command("relight")
@click.argument("source", required=False, metavar="[GBUFFER]")
@click.option("--rig", "rig_path", required=True, metavar="FILE", help="The rig, or the name of a built-in one.")
@click.option("-o", "--output", required=True, metavar="FILE", help="The EXR to write, with #### where GBUFFER has it.")
@click.option("--frames", metavar="RANGE", help="1001, 1001-1100, 1001-1100x2, or several with commas.")
@click.option(
    "--skip-existing",
    is_flag=True,
    help="Leave out frames whose output is whole, newer than its inputs, and made by the same rig.",
)
@click.option("--threads", type=click.IntRange(min=1), help="How many; all that the process may use when absent.")
@set_option
@gbuffer_options
@click.option(
    "--dask",
    metavar="SCHEDULER",
    help="Relight on a Dask cluster: tcp://host:8786, or local for processes on this machine.",
)
@click.option("--workers", type=click.IntRange(min=1), help="With --dask local: how many processes.")
@click.option("--retries", type=click.IntRange(min=0), default=2, show_default=True, help="With --dask: further tries.")
@click.option("--json", "as_json", is_flag=True, help="Events as JSON on standard output, one a line.")
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
    dask: str | None,
    workers: int | None,
    retries: int,
    as_json: bool,
    quiet: bool,
) -> int:
    """Relight GBUFFER (an EXR, or a sequence as shot.####.exr, shot.%04d.exr or shot.{frame}.exr).

    GBUFFER may be left out where the rig names it. Without --frames that of the rig is relit, else every frame of a
    sequence that is on disk.
    A frame that fails is named and the others go on; an output appears only when it is whole. After a stop or a kill
    the same command with --skip-existing goes on where it was.

    Exit codes: 0 all went well, 1 a frame failed, 2 the command line or the rig is wrong, 3 interrupted.
    """
    rig = load_rig(rig_path, settings, channels, part, view)
    frames_to_do = plan(source, rig, output, frames)
    from relume.cli.progress import follow
    from relume.cli.report import one_line
    from relume.sequence import MISFITS, relight_frames

    if workers is not None and dask != "local":
        raise click.UsageError("--workers goes with --dask local")
    interrupted = False
    with _stoppable(), follow(len(frames_to_do), quiet, as_json) as follower:
        try:
            if dask is not None:
                from relume.farm import dask as farm

                farm.relight_frames(
                    frames_to_do,
                    rig,
                    dask,
                    workers=workers,
                    threads=threads,
                    retries=retries,
                    skip_existing=skip_existing,
                    on_result=follower.result,
                )
            else:
                relight_frames(
                    frames_to_do,
                    rig,
                    threads=threads,
                    skip_existing=skip_existing,
                    on_progress=follower.progress,
                    on_result=follower.result,
                )
        except (KeyboardInterrupt, _Terminated) as stop:
            interrupted = True
            # With those that ended while the others were stopped.
            follower.results = getattr(stop, "results", follower.results)
        except MISFITS as error:
            raise RigFailure(one_line(error)) from error
    follower.summary(interrupted)
    if interrupted:
        return EXIT_INTERRUPTED
    return EXIT_FAILED if any(result.status == "failed" for result in follower.results) else EXIT_OK


def plan(source: str | None, rig: Rig, output: str, frames: str | None) -> list[Frame]:
    """The frames to do.

    Raises:
        click.UsageError: frames without a place for their number, outputs that would overwrite each other or an input.
        click.ClickException: nothing on disk matches, or there is no folder for the output.
    """
    from relume.errors import ArgumentError, Error
    from relume.frames import find_frames, is_pattern, parse_frames, resolve_frame
    from relume.gbuffer import main_file
    from relume.sequence import Frame, check_outputs

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
        jobs = [Frame(None, name, Path(output))]
    else:
        try:
            if frames is not None:
                numbers = parse_frames(frames)
            else:
                numbers = [rig._rig.frame] if rig._rig.frame is not None else find_frames(name)
        except Error as error:
            raise click.UsageError(str(error)) from None
        if not numbers:
            raise click.ClickException(f"{name}: no such files")
        if len(numbers) > 1 and not is_pattern(output):
            raise click.UsageError(f"{output}: all {len(numbers)} frames would go to this one file; write #### into it")
        jobs = [Frame(number, resolve_frame(name, number), Path(resolve_frame(output, number))) for number in numbers]

    try:
        check_outputs(jobs, rig)
    except ArgumentError as error:
        raise click.UsageError(str(error)) from None
    for folder in {job.output.parent for job in jobs}:
        if not folder.is_dir():
            raise click.ClickException(f"{folder}: no such folder; make it first")
    return jobs


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
