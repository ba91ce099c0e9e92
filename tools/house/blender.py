# SPDX-License-Identifier: Apache-2.0
"""The Blender extension: built with the wheel inside, and tested in Blender itself (PyPI's module bpy)."""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import sys
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from house import package
from house.checkout import BUILD, PYTHON, ROOT, StepError, output, run, say

#: Blender as a module: today's, whose validator is used, and the long-term one. 370 MB each, fetched once.
VERSIONS = ("5.0.1", "4.5.15")

_HOME = BUILD / "blender"
_SOURCE = ROOT / "plugins" / "blender"
_TESTS = ROOT / "tests" / "plugins" / "blender"


def _clean_environment() -> dict[str, str]:
    return {key: value for key, value in os.environ.items() if key not in ("PYTHONPATH", "BLENDER_USER_RESOURCES")}


def blender_python(version: str) -> Path:
    """Python of an environment that has this Blender and pytest; made where there is none.

    Raises:
        StepError: pip could not fetch it.
    """
    home = _HOME / f"venv-{version}"
    python = home / "bin" / "python"
    wanted = [f"bpy=={version}", "numpy<2", *_pinned("pytest")]
    stamp = home / "relume-stamp"
    text = hashlib.sha256("\n".join(wanted).encode()).hexdigest()
    if not stamp.exists() or stamp.read_text() != text:
        say(f"fetching Blender {version} as a Python module (370 MB)")
        output([sys.executable, "-m", "venv", "--clear", home])
        run(
            [python, "-m", "pip", "install", "-qq", "--disable-pip-version-check", *wanted],
            env=_clean_environment(),
            what=f"fetching bpy {version} from the package index",
        )
        stamp.write_text(text)
    return python


def _pinned(name: str) -> list[str]:
    """The line of tools/requirements.txt that pins a package."""
    lines = (ROOT / "tools" / "requirements.txt").read_text().splitlines()
    return [line for line in lines if re.match(rf"{name}\b", line)] or [name]


def _stage(wheel: Path) -> Path:
    """What goes into the extension: the add-on, its manifest with version and wheel, the license, the wheel."""
    staged = _HOME / "relume"
    shutil.rmtree(staged, ignore_errors=True)
    (staged / "wheels").mkdir(parents=True)
    for source in sorted(_SOURCE.glob("*.py")):
        shutil.copy2(source, staged)
    shutil.copy2(ROOT / "LICENSE", staged)
    shutil.copy2(wheel, staged / "wheels")
    version = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    manifest = (_SOURCE / "blender_manifest.toml").read_text()
    for key, value in (("version", f'"{version}"'), ("wheels", f'["./wheels/{wheel.name}"]')):
        manifest, count = re.subn(rf"(?m)^{key} = .*$", f"{key} = {value}", manifest)
        if count != 1:
            raise StepError(f"plugins/blender/blender_manifest.toml has {count} lines '{key} = …'; one is wanted")
    (staged / "blender_manifest.toml").write_text(manifest)
    return staged


def build_extension() -> Path:
    """Build the extension with the wheel inside, and have Blender's own tool validate it; returns its path."""
    python = blender_python(VERSIONS[0])
    staged = _stage(package.make_wheel())
    (tool,) = python.parents[1].glob("lib/python*/site-packages/bpy/*/scripts/addons_core/bl_pkg/cli/blender_ext.py")
    for stale in _HOME.glob("relume-*.zip"):
        stale.unlink()
    output([python, tool, "build", "--source-dir", staged, "--output-dir", _HOME])
    (archive,) = _HOME.glob("relume-*.zip")
    output([python, tool, "validate", archive])
    return archive


def extension(arguments: list[str]) -> int:
    """The Blender extension, built and validated: its path on standard output"""
    print(build_extension())
    return 0


def picture(arguments: list[str]) -> int:
    """Make docs/images/blender.png in Blender: Cycles' render of a scene and relume's"""
    archive, resources = build_extension(), _HOME / "user-picture"
    shutil.rmtree(resources, ignore_errors=True)
    resources.mkdir(parents=True)
    environment = _clean_environment() | {"BLENDER_USER_RESOURCES": str(resources)}
    program = ROOT / "tools" / "make_blender_picture.py"
    run([blender_python(VERSIONS[0]), program, archive, ROOT / "docs" / "images" / "blender.png"], env=environment)
    return 0


@dataclass(frozen=True)
class TestRun:
    """pytest in one Blender."""

    title: str
    command: list[str | Path]
    environment: dict[str, str]
    report: Path


def test_runs(archive: Path) -> Iterator[TestRun]:
    """The tests in each Blender. A folder of its own stands for the user's settings, and takes what is installed."""
    for version in VERSIONS:
        resources = _HOME / f"user-{version}"
        shutil.rmtree(resources, ignore_errors=True)
        resources.mkdir(parents=True)
        report = _HOME / f"pytest-{version}.xml"
        report.unlink(missing_ok=True)
        environment = _clean_environment()
        environment |= {"BLENDER_USER_RESOURCES": str(resources), "RELUME_BLENDER_EXTENSION": str(archive)}
        # The other doors: a Python that has click and OpenImageIO, and a host of OpenFX nodes.
        environment["RELUME_PYTHON"] = PYTHON
        environment["RELUME_OFX_RENDER"] = str(BUILD / "release" / "tests" / "plugins" / "relume_ofx_render")
        command: list[str | Path] = [blender_python(version), "-m", "pytest", "-q", "-p", "no:cacheprovider"]
        yield TestRun(f"tests in Blender {version}", [*command, f"--junitxml={report}", _TESTS], environment, report)
