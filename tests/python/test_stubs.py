# SPDX-License-Identifier: Apache-2.0
"""The package is typed: the generated stubs are current, and a user's program is checked by them."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def test_stubs_are_current() -> None:
    done = subprocess.run(
        [sys.executable, ROOT / "tools" / "generate_stubs.py", "--check"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


_PROGRAM = """
import numpy as np
import relume

gbuffer = relume.GBuffer.read("shot.exr", part="A", channels={"normal": {"channel": "N", "space": "camera"}})
rig = relume.Rig.load("key.relume")
rig.light["key"].exposure = 1
result = relume.relight(gbuffer, rig, threads=2)
beauty = result["beauty"]
value = relume.shaders["ggx"].evaluate(n=[0, 0, 1], v=[0, 0, 1], l=[0, 0, 1], roughness=0.5)
value.specular.mean()
camera = gbuffer.camera
"""

_MISTAKES = {
    'relume.shaders["ggx"].evaluate(n=1, v=1, l=1, roughnes=0.5)': "roughnes",
    "camera.matrix": "None",
    "relume.relight(gbuffer, rig, thread=2)": "thread",
    "result.beauty": "beauty",
}


def test_a_users_program(tmp_path: Path) -> None:
    path = tmp_path / "program.py"
    path.write_text(_PROGRAM + "".join(f"{line}\n" for line in _MISTAKES))
    command = [
        sys.executable,
        "-m",
        "mypy",
        "--strict",
        "--no-error-summary",
        "--cache-dir",
        str(tmp_path / "cache"),
        str(path),
    ]
    done = subprocess.run(
        command,
        capture_output=True,
        text=True,
        check=False,
        cwd=tmp_path,
        env=os.environ | {"MYPYPATH": str(ROOT / "python")},
    )
    lines = [line for line in done.stdout.splitlines() if ": error:" in line]
    assert len(lines) == len(_MISTAKES), done.stdout + done.stderr
    for line, word in zip(lines, _MISTAKES.values(), strict=True):
        assert line.startswith((f"{path}:", "program.py:"))
        assert word in line
