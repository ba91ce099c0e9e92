# SPDX-License-Identifier: Apache-2.0
"""Frames as tasks of Dask.distributed. The workers read the G-buffers and write the pictures: only names travel."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from relume.errors import ArgumentError, Error, FileError, MissingPackageError
from relume.rig import Rig
from relume.sequence import MISFITS, Frame, FrameReport, FrameResult, Status, is_up_to_date, relight_frame

if TYPE_CHECKING:
    from distributed import Client

__all__ = ["relight_frames"]

#: Further tries of a frame whose files could not be read or written, which another machine may be able to.
RETRIES = 2


def _task(
    number: int | None, source: str, output: str, rig_text: str, threads: int | None, skip_existing: bool
) -> tuple[Status, float, FrameReport | None, Exception | None]:
    """One frame, on a worker. What may go better elsewhere is raised, so that Dask tries again; the rest comes back."""
    frame, rig = Frame(number, source, Path(output)), Rig.loads(rig_text)
    start = time.perf_counter()
    status: Status = "done"
    report = None
    try:
        if skip_existing and is_up_to_date(frame, rig):
            status = "skipped"
        else:
            report = relight_frame(frame, rig, threads)
    except (OSError, MemoryError):
        raise
    except Error as error:
        return "failed", time.perf_counter() - start, None, error
    return status, time.perf_counter() - start, report, None


def _local_workers(workers: int | None) -> int:
    return workers or max(1, (os.cpu_count() or 1) // 2)


@contextmanager
def _client(scheduler: str, workers: int | None, timeout: float) -> Iterator[Client]:
    try:
        from distributed import Client, LocalCluster
    except ImportError as error:
        raise MissingPackageError(
            f"frames on Dask need the package distributed ({error}): pip install 'relume[farm]'"
        ) from None
    if scheduler != "local":
        if workers is not None:
            raise ArgumentError("workers are counted for `local` alone; a scheduler has those that joined it")
        try:
            client = Client(scheduler, timeout=timeout)
        except (OSError, ValueError, TimeoutError) as error:
            raise FileError(f"{scheduler}: no Dask scheduler answers there: {error}") from None
        with client:
            yield client
        return
    with (
        LocalCluster(
            n_workers=_local_workers(workers), threads_per_worker=1, processes=True, dashboard_address=None
        ) as cluster,
        Client(cluster) as client,
    ):
        yield client


def relight_frames(
    frames: Sequence[Frame],
    rig: Rig,
    scheduler: str,
    *,
    workers: int | None = None,
    threads: int | None = None,
    retries: int = RETRIES,
    skip_existing: bool = False,
    timeout: float = 20,
    on_result: Callable[[FrameResult], object] | None = None,
) -> list[FrameResult]:
    """Relight frames on a Dask cluster. A worker that dies loses nothing: its frames are given to others.

    Args:
        frames: what to do; their paths must mean the same on every worker.
        rig: for all of them; the files that it names must be there for every worker.
        scheduler: its address ("tcp://host:8786"), or "local" for processes on this machine.
        workers: how many processes of "local"; half the CPUs when None.
        threads: of each frame; when None as many as the worker may use, for "local" its share of the CPUs.
        retries: further tries of a frame whose files could not be read or written.
        skip_existing: leave out frames whose output is up to date.
        timeout: seconds to wait for the scheduler.
        on_result: called in the calling thread when a frame has ended.

    Returns:
        One result for each frame, in the order of their ends.

    Raises:
        MissingPackageError: Dask is not installed.
        FileError: no scheduler answers.
        RigError, ParameterError: the rig fits no frame.
    """
    results: list[FrameResult] = []
    with _client(scheduler, workers, timeout) as client:
        from distributed import as_completed

        if threads is None and scheduler == "local":
            threads = max(1, (os.cpu_count() or 1) // _local_workers(workers))
        text = str(rig)
        futures: dict[Any, Frame] = {}
        for frame in frames:
            source, output = Path(frame.source).absolute(), frame.output.absolute()
            future = client.submit(
                _task, frame.number, str(source), str(output), text, threads, skip_existing, pure=False, retries=retries
            )
            futures[future] = frame
        try:
            for future in as_completed(list(futures)):
                result = _result(futures[future], future)
                results.append(result)
                if isinstance(result.error, MISFITS):
                    raise result.error
                if on_result is not None:
                    on_result(result)
        except BaseException as error:
            client.cancel(list(futures))
            error.results = results  # type: ignore[attr-defined]
            raise
    return results


def _result(frame: Frame, future: Any) -> FrameResult:
    if future.status == "finished":
        status, seconds, report, error = future.result()
        return FrameResult(frame, status, seconds, report, error)
    error = future.exception()
    if type(error).__name__ == "KilledWorker":
        error = FileError(f"{frame.source}: the workers that had this frame died, one after another: {error}")
    return FrameResult(frame, "failed", error=error)
