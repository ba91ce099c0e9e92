# SPDX-License-Identifier: Apache-2.0
"""What the tests of the Python package share: small scenes, EXRs of any content, the command line."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
import pytest
import relume

# Who starts the tests in the background has them, and the programs that they start, ignore ctrl-C.
signal.signal(signal.SIGINT, signal.default_int_handler)

KEY = """
version = 1
[[light]]
name = "key"
type = "sun"
direction = [0.3, -0.8, -0.5]
irradiance = 3.0
"""

#: Channels of a flat surface that looks at +Z: all that a relight needs.
Channels = dict[str, np.ndarray]


def flat_channels(height: int = 4, width: int = 6) -> Channels:
    """A G-buffer in plain names, float32: normal N.XYZ, base colour, roughness, position P.XYZ."""
    zero, one = np.zeros((height, width), np.float32), np.ones((height, width), np.float32)
    rows, columns = np.mgrid[0:height, 0:width].astype(np.float32)
    return {
        "N.X": zero,
        "N.Y": zero,
        "N.Z": one,
        "albedo.R": 0.5 * one,
        "albedo.G": 0.25 * one,
        "albedo.B": 0.125 * one,
        "roughness": 0.4 * one,
        "P.X": columns,
        "P.Y": -rows,
        "P.Z": zero,
    }


def write_exr(path: Path, channels: Mapping[str, np.ndarray], **header: Any) -> Path:
    """Write an EXR by PyPI's OpenEXR, another implementation than ours."""
    settings = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage} | header
    with OpenEXR.File(settings, {name: np.ascontiguousarray(array) for name, array in channels.items()}) as file:
        file.write(str(path))
    return path


def read_exr(path: Path) -> dict[str, np.ndarray]:
    """All channels of the first part, by PyPI's OpenEXR."""
    with OpenEXR.File(str(path), separate_channels=True) as file:
        return {name: np.array(channel.pixels) for name, channel in file.channels().items()}


@dataclass
class Ran:
    """How a run of the command line ended."""

    code: int
    out: str
    err: str


Runner = Callable[..., Ran]


def run_relume(*arguments: object, **settings: Any) -> Ran:
    """Run `relume` as a program of its own."""
    command = [sys.executable, "-m", "relume.cli", *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False, **settings)
    return Ran(done.returncode, done.stdout, done.stderr)


# A process's peak counts what its parent held when it was forked: a small parent between.
_WATCHED = """
import os, sys
child = os.spawnv(os.P_NOWAIT, sys.argv[1], sys.argv[1:])
_, status, usage = os.wait4(child, 0)
print(usage.ru_maxrss)
sys.exit(os.waitstatus_to_exitcode(status))
"""


def run_for_memory(*arguments: object) -> tuple[Ran, int]:
    """`relume` as a program of its own, and its peak resident set in bytes."""
    command = [sys.executable, "-c", _WATCHED, sys.executable, "-m", "relume.cli", *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    *out, peak = done.stdout.splitlines()
    return Ran(done.returncode, "\n".join(out), done.stderr), 1024 * int(peak)


def cpu_seconds(process: int) -> float:
    """What a process has used of the CPUs, which says how long it worked however busy the machine is."""
    after_name = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(after_name[11]) + int(after_name[12])) / os.sysconf("SC_CLK_TCK")


@pytest.fixture(scope="session")
def sdf(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The built-in scene sdf, small."""
    path = tmp_path_factory.mktemp("scene") / "sdf.exr"
    relume.write_scene("sdf", path, width=96, height=54, samples=1)
    return path


@pytest.fixture
def flat(tmp_path: Path) -> Path:
    """A flat surface as an EXR."""
    return write_exr(tmp_path / "flat.exr", flat_channels())


@pytest.fixture
def rig(tmp_path: Path) -> Path:
    """A rig with one sun."""
    path = tmp_path / "key.relume"
    path.write_text(KEY)
    return path
