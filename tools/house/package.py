# SPDX-License-Identifier: Apache-2.0
"""The two ways in which others get Relume: find_package from an install tree, and the wheel."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from house import build
from house.checkout import BUILD, PYTHON, ROOT, StepError, output, run

_SCRATCH = BUILD / "package"


def out_of_tree() -> None:
    """Install the library, then build and run tests/package against that install tree alone."""
    release = build.build("release")
    prefix = _SCRATCH / "prefix"
    shutil.rmtree(_SCRATCH, ignore_errors=True)
    output(["cmake", "--install", release, "--prefix", prefix, "--component", "library"])
    scratch = _SCRATCH / "build"
    settings = ["-DCMAKE_BUILD_TYPE=Release", f"-DCMAKE_PREFIX_PATH={prefix}"]
    output(["cmake", "-S", ROOT / "tests" / "package", "-B", scratch, "-G", "Ninja", *settings])
    output(["cmake", "--build", scratch])
    output(["ctest", "--test-dir", str(scratch), "--output-on-failure"])


def make_wheel() -> Path:
    """Build the wheel, with the shared libraries that it needs beyond manylinux inside; returns its path."""
    raw, repaired = BUILD / "wheel" / "raw", BUILD / "wheel" / "repaired"
    for directory in (raw, repaired):
        shutil.rmtree(directory, ignore_errors=True)
    environment = dict(os.environ, PATH=f"{Path(PYTHON).parent}{os.pathsep}{os.environ['PATH']}")
    environment.pop("PYTHONPATH", None)
    # The release preset's compilers and flags: ccache then has every object of the wheel already.
    environment |= {"CC": "gcc", "CXX": "g++"}
    settings = ["--no-deps", "--no-build-isolation", "--config-settings=cmake.define.RELUME_WERROR=ON"]
    settings += ["--config-settings=cmake.define.RELUME_OIIO_RELEASES=ON"]
    settings += [f"--config-settings=build-dir={BUILD / 'wheel-cmake'}"]
    run(
        [PYTHON, "-m", "pip", "wheel", "-qq", *settings, "--wheel-dir", raw, "."],
        env=environment,
        what="building the wheel",
    )
    (wheel,) = raw.glob("*.whl")
    # The plugins run in hosts that have these.
    hosts = [f"--exclude={name}.so.*" for name in ("libOpenImageIO", "libOpenImageIO_Util")]
    output([PYTHON, "-m", "auditwheel", "repair", *hosts, "--wheel-dir", repaired, wheel], env=environment)
    (wheel,) = repaired.glob("*.whl")
    return wheel


def wheel() -> None:
    """Install the wheel into a clean environment beside PyPI's OpenEXR and OpenImageIO, and relight a scene there."""
    path = make_wheel()
    home = BUILD / "wheel" / "venv"
    constraints = ROOT / "tools" / "requirements.txt"
    stamp = home / "relume-stamp"
    wanted = hashlib.sha256(constraints.read_bytes() + (ROOT / "pyproject.toml").read_bytes()).hexdigest()
    python = home / "bin" / "python"
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    install: list[str | Path] = [
        python,
        "-m",
        "pip",
        "install",
        "--quiet",
        "--disable-pip-version-check",
        "-c",
        constraints,
    ]
    if not stamp.exists() or stamp.read_text() != wanted:
        output([sys.executable, "-m", "venv", "--clear", home])
        run([*install, path, "OpenEXR", "OpenImageIO"], env=environment)
        stamp.write_text(wanted)
    run([*install, "--no-deps", "--force-reinstall", path], env=environment)
    with tempfile.TemporaryDirectory() as elsewhere:
        done = subprocess.run(
            [python, ROOT / "tests" / "package" / "wheel_check.py"], cwd=elsewhere, env=environment, check=False
        )
    if done.returncode != 0:
        raise StepError(f"tests/package/wheel_check.py ended with exit code {done.returncode}")
