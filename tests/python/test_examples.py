# SPDX-License-Identifier: Apache-2.0
"""The example scripts run, and say that they are right."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

SCRIPTS = sorted((Path(__file__).resolve().parents[2] / "examples").glob("*.py"))
ARGUMENTS = {"turntable": ["{gbuffer}", "2"]}


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_example(script: Path, tmp_path: Path, sdf: Path) -> None:
    arguments = [word.format(gbuffer=sdf) for word in ARGUMENTS.get(script.stem, [])]
    done = subprocess.run(
        [sys.executable, script, *arguments], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip()
