# SPDX-License-Identifier: Apache-2.0
"""Where things are in this checkout, and how its programs are run."""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

Words = Sequence[str | Path]

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build"
PYTHON = str(ROOT / ".venv" / "bin" / "python")


class StepError(Exception):
    """A step ended badly; the message says which, its output has been shown."""


def say(text: str) -> None:
    """One line about what is going on, on standard error: standard output belongs to the programs that are run."""
    print(f"dev: {text}", file=sys.stderr, flush=True)


def run(
    command: Words,
    *,
    cwd: Path = ROOT,
    env: Mapping[str, str] | None = None,
    what: str | None = None,
) -> None:
    """Run a command with its output shown on standard error.

    Raises:
        StepError: it could not be started or its exit code was not 0.
    """
    words = [str(word) for word in command]
    try:
        status = subprocess.run(words, cwd=cwd, env=env, stdout=sys.stderr, check=False).returncode
    except OSError as error:
        raise StepError(f"{words[0]}: {error.strerror}") from error
    if status != 0:
        raise StepError(f"{what or shlex.join(words)} failed (exit code {status})")


def output(command: Words, *, cwd: Path = ROOT, env: Mapping[str, str] | None = None) -> str:
    """Standard output of a command that must succeed.

    Raises:
        StepError: its exit code was not 0; what it wrote has been shown.
    """
    words = [str(word) for word in command]
    done = subprocess.run(words, cwd=cwd, env=env, text=True, capture_output=True, check=False)
    if done.returncode != 0:
        sys.stderr.write(done.stdout + done.stderr)
        raise StepError(f"{shlex.join(words)} failed (exit code {done.returncode})")
    return done.stdout


def replace_process(command: Words, env: Mapping[str, str]) -> int:
    """Become the command: signals, terminal and exit code are then its own."""
    words = [str(word) for word in command]
    sys.stdout.flush()
    sys.stderr.flush()
    os.execvpe(words[0], words, dict(env))


@contextmanager
def timed(title: str) -> Iterator[None]:
    """Announce a step, and say how long it took."""
    say(title)
    start = time.monotonic()
    yield
    say(f"{title}: {time.monotonic() - start:.1f} s")


def tracked(*patterns: str) -> list[str]:
    """Files of the checkout that match git pathspecs: committed ones and new ones that git does not ignore."""
    listing = output(["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard", "--", *patterns])
    return sorted({name for name in listing.split("\0") if name and (ROOT / name).is_file()})
