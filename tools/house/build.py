# SPDX-License-Identifier: Apache-2.0
"""Builds a preset where something changed, once at a time."""

from __future__ import annotations

import fcntl
import hashlib
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from house.checkout import BUILD, ROOT, StepError, run, say

# CMake does not notice by itself when one of these changes.
_CONFIGURED_BY = ("CMakePresets.json", "tools/openexr-source.txt", "tools/requirements.txt")


@contextmanager
def _locked(directory: Path) -> Iterator[None]:
    directory.mkdir(parents=True, exist_ok=True)
    with (directory / ".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def _configuration() -> str:
    digest = hashlib.sha256(str(ROOT).encode())
    for name in _CONFIGURED_BY:
        digest.update((ROOT / name).read_bytes())
    return digest.hexdigest()


def configure(preset: str) -> Path:
    """Configure a preset unless that was done and nothing has changed since; returns its build directory."""
    directory = BUILD / preset
    stamp = directory / ".configured"
    wanted = _configuration()
    if not (directory / "build.ninja").exists() or not stamp.exists() or stamp.read_text() != wanted:
        say(f"configuring {preset}")
        run(["cmake", "--preset", preset, "-Wno-dev", "--log-level=WARNING", "--no-warn-unused-cli"])
        stamp.write_text(wanted)
    return directory


def _ninja(directory: Path, title: str, targets: tuple[str, ...]) -> None:
    """Run ninja, silent when there is nothing to do; progress on one line of a terminal, elsewhere only trouble."""
    command = ["ninja", "-C", str(directory), *targets]
    announced = False
    terminal = sys.stderr.isatty()
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
        assert process.stdout is not None
        for line in process.stdout:
            step = re.match(r"\[(\d+/\d+)\] (.*)", line)
            if step and "Re-checking globbed" not in line:
                if not announced:
                    say(title)
                    announced = True
                if terminal:
                    print(f"\r\033[K[{step[1]}] {step[2][-90:]}", end="", file=sys.stderr, flush=True)
            elif not step and not line.startswith("ninja: "):
                print(line, end="", file=sys.stderr, flush=True)
    if terminal and announced:
        print("\r\033[K", end="", file=sys.stderr, flush=True)
    if process.returncode != 0:
        raise StepError(f"{title} failed (ninja's exit code {process.returncode})")


def build(preset: str, *targets: str) -> Path:
    """Build a preset (or only the named targets of it); silent when there is nothing to do. Returns the directory.

    Raises:
        StepError: it does not configure or compile.
    """
    with _locked(BUILD / preset):
        directory = configure(preset)
        _ninja(directory, f"building {preset}", targets)
    return directory


def python_environment() -> dict[str, str]:
    """The environment in which ``import relume`` finds this checkout's package, built."""
    environment = dict(os.environ)
    environment["PYTHONPATH"] = str(BUILD / "release" / "python")
    environment["PATH"] = f"{ROOT / '.venv' / 'bin'}{os.pathsep}{environment['PATH']}"
    environment.setdefault("RELUME_TEST_DATA", str(ROOT.parent / "shared" / "data"))
    return environment
