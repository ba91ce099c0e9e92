# SPDX-License-Identifier: Apache-2.0
"""How a sequence is followed: a bar on a terminal, lines in a log, JSON for programs, and the table at the end."""

from __future__ import annotations

import json
import sys
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import click

from relume.cli.report import one_line, printable

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import Progress, TaskID

    from relume.sequence import Frame, FrameReport, FrameResult

#: Seconds between two JSON lines of progress.
_JSON_INTERVAL = 1.0


class Follower:
    """Counts what became of the frames, and tells it. Results and progress come in one thread."""

    def __init__(self, total: int, quiet: bool, as_json: bool) -> None:
        self.results: list[FrameResult] = []
        self._total = total
        self._quiet = quiet
        self._json = as_json
        self._shares: dict[Frame, float] = {}
        self._warned: Counter[str] = Counter()
        self._noted: set[str] = set()
        self._start = time.perf_counter()
        self._next_line = _JSON_INTERVAL
        self._emit("start", frames=total)

    @property
    def seconds(self) -> float:
        """Wall seconds since the start."""
        return time.perf_counter() - self._start

    @property
    def share(self) -> float:
        """Frames that have ended and parts of those in flight."""
        return len(self.results) + sum(self._shares.values())

    @property
    def rate(self) -> float:
        """Frames a second, those left out not counted."""
        skipped = sum(result.status == "skipped" for result in self.results)
        return (self.share - skipped) / self.seconds if self.seconds > 0 else 0.0

    @property
    def seconds_left(self) -> float | None:
        """As the frames so far went; None before anything is known."""
        return (self._total - self.share) / self.rate if self.rate > 0 else None

    def progress(self, frame: Frame, share: float) -> None:
        """That share of the frame is done."""
        self._shares[frame] = share
        if self.seconds >= self._next_line:
            self._next_line = self.seconds + _JSON_INTERVAL
            left = self.seconds_left
            self._emit(
                "progress",
                done=len(self.results),
                frames=self._total,
                share=round(self.share / self._total, 4),
                frames_per_second=round(self.rate, 3),
                seconds_left=None if left is None else round(left, 1),
            )

    def result(self, result: FrameResult) -> None:
        """A frame has ended."""
        self._shares.pop(result.frame, None)
        self.results.append(result)
        frame, report = result.frame, result.report
        warnings = list(_warnings(report)) if report is not None else []
        fields: dict[str, Any] = {"frame": frame.number, "source": frame.source, "output": str(frame.output)}
        fields |= {"status": result.status, "seconds": round(result.seconds, 4)}
        if report is not None:
            fields |= {"shaded": report.shaded, "background": report.background, "nonfinite": report.nonfinite}
            fields["warnings"] = report.warnings
            fields["notes"] = report.notes
        if result.error is not None:
            fields["error"] = one_line(result.error)
            self.message(f"relume: {_named(result)}")
        self._emit("frame", **fields)
        for warning in warnings:
            if not self._warned[warning]:
                self.message(f"relume: {frame.title}: {warning}")
            self._warned[warning] += 1
        for note in report.notes if report is not None and not self._quiet else ():
            if note not in self._noted:
                self.message(f"relume: {note}")
            self._noted.add(note)
        self.step(result)

    def step(self, result: FrameResult) -> None:
        """A line a frame, for logs."""
        if self._quiet or result.status not in ("done", "skipped"):
            return
        what = f"{result.seconds:.2f} s" if result.status == "done" else "there already"
        self.message(f"[{len(self.results)}/{self._total}] {result.frame.output}  {what}")

    def message(self, text: str) -> None:
        """A line that stays."""
        click.echo(printable(text), err=True)

    def summary(self, interrupted: bool) -> None:
        """What became of the frames."""
        by_status = {s: [r for r in self.results if r.status == s] for s in ("done", "skipped", "failed", "cancelled")}
        done, failed = by_status["done"], by_status["failed"]
        self._emit(
            "summary",
            frames=self._total,
            done=len(done),
            skipped=len(by_status["skipped"]),
            failed=[r.frame.number for r in failed] if self._total > 1 else len(failed),
            interrupted=interrupted,
            seconds=round(self.seconds, 3),
            frames_per_second=round(len(done) / self.seconds, 3) if self.seconds > 0 else 0,
        )
        if self._quiet:
            if interrupted:
                self.message("relume: interrupted")
            return
        for text, count in self._warned.items():
            if count > 1:
                self.message(f"relume: {text} ({count} frames)")
        if self._total == 1:
            if done:
                self.message(f"relume: {done[0].frame.output} written")
            elif by_status["skipped"]:
                self.message(f"relume: {by_status['skipped'][0].frame.output} there already")
            if interrupted:
                self.message("relume: interrupted")
            return
        self._table(by_status, interrupted)
        words = [f"{len(done)} of {self._total} frames relit"]
        if done:
            words.append(f"{self.seconds / len(done):.2f} s each")
        if by_status["skipped"]:
            words.append(f"{len(by_status['skipped'])} there already")
        if failed:
            words.append(f"{len(failed)} failed: {_ranges([r.frame.number for r in failed])}")
        if interrupted:
            words.append("interrupted")
        self.message(f"relume: {', '.join(words)}")

    def _table(self, by_status: dict[str, list[FrameResult]], interrupted: bool) -> None:
        from rich.table import Table

        table = Table(box=None, pad_edge=False, header_style="bold")
        for header in ("status", "frames", "which"):
            table.add_column(header, justify="right" if header == "frames" else "left", overflow="fold")
        left = self._total - len(self.results)
        for label, results in (
            ("relit", by_status["done"]),
            ("there already", by_status["skipped"]),
            ("failed", by_status["failed"]),
            ("stopped", by_status["cancelled"]),
        ):
            if results:
                table.add_row(label, str(len(results)), _ranges([r.frame.number for r in results]))
        if left:
            table.add_row("not begun", str(left), "")
        _console().print(table)

    def _emit(self, event: str, **fields: object) -> None:
        if self._json:
            click.echo(json.dumps({"event": event} | fields))
            sys.stdout.flush()


class _Bar(Follower):
    """A bar on a terminal."""

    def __init__(self, total: int, as_json: bool, bar: Progress, task: TaskID) -> None:
        super().__init__(total, quiet=False, as_json=as_json)
        self._bar, self._task = bar, task

    def _show(self) -> None:
        left = self.seconds_left
        minutes = f"{int(left) // 60}:{int(left) % 60:02} left" if left is not None else ""
        failed = sum(result.status == "failed" for result in self.results)
        words = [f"{len(self.results)}/{self._total}", f"{self.rate:.1f} frames/s", minutes]
        if failed:
            words.append(f"{failed} failed")
        self._bar.update(self._task, completed=self.share, description="  ".join(filter(None, words)))

    def progress(self, frame: Frame, share: float) -> None:
        super().progress(frame, share)
        self._show()

    def step(self, result: FrameResult) -> None:
        self._show()

    def message(self, text: str) -> None:
        self._bar.console.print(printable(text), markup=False)


@contextmanager
def follow(total: int, quiet: bool, as_json: bool) -> Iterator[Follower]:
    """The follower that fits standard error."""
    if quiet or not sys.stderr.isatty():
        yield Follower(total, quiet, as_json)
        return
    from rich.progress import BarColumn, Progress, TextColumn

    columns = (BarColumn(), TextColumn("{task.percentage:>3.0f}%"), TextColumn("{task.description}"))
    with Progress(*columns, console=_console()) as bar:
        yield _Bar(total, as_json, bar, bar.add_task("relighting", total=total))


def _console() -> Console:
    from rich.console import Console

    return Console(stderr=True, highlight=False, soft_wrap=True)


def _named(result: FrameResult) -> str:
    """What went wrong, with the file and the frame."""
    assert result.error is not None
    text, frame = one_line(result.error), result.frame
    source, output = printable(frame.source), printable(frame.output)
    named = text if source in text or output in text else f"{source}: {text}"
    return named if frame.number is None else f"{frame.title}: {named}"


def _warnings(report: FrameReport) -> Iterator[str]:
    for channel, count in report.nonfinite.items():
        yield f"{count} pixel{'s' if count > 1 else ''} with NaN or infinity in {channel}, left black"
    yield from report.warnings


def _ranges(numbers: list[int | None]) -> str:
    """Frame numbers as --frames takes them: 1001-1003, 1007."""
    runs: list[list[int]] = []
    for number in sorted(n for n in numbers if n is not None):
        if runs and number == runs[-1][1] + 1:
            runs[-1][1] = number
        else:
            runs.append([number, number])
    return ", ".join(str(a) if a == b else f"{a}-{b}" for a, b in runs)
