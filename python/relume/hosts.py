# SPDX-License-Identifier: Apache-2.0
"""The plugins for other programs that this package brings, and the programs' libraries on this machine."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

__all__ = ["OpenImageIO", "find_openimageio", "oiio_plugin", "oiio_release_in_use", "oiio_releases"]

_LIBRARY = "libOpenImageIO.so"


def oiio_plugin(release: str) -> Path | None:
    """The plugin for a release of OpenImageIO ("2.4", "3.0"), None where none was built for it.

    Its folder is what a host is told: ``OPENIMAGEIO_PLUGIN_PATH`` (3.0 and later) or ``OIIO_LIBRARY_PATH``.
    """
    file = Path(__file__).parent / "oiio" / release / "relume.imageio.so"
    return file if file.exists() else None


def oiio_releases() -> list[str]:
    """The releases that this package has a plugin for."""
    return sorted(file.parent.name for file in (Path(__file__).parent / "oiio").glob("*/relume.imageio.so"))


def oiio_release_in_use() -> str | None:
    """The release of the oiiotool that a shell would start; without one, of the system's library; None without either.

    Where PyPI's OpenImageIO is installed, PATH may hold its oiiotool (3.2) before the system's (2.4), and each wants a
    plugin of its own.
    """
    tool = shutil.which("oiiotool")
    if tool:
        said = subprocess.run([tool, "--version"], capture_output=True, text=True, check=False).stdout
        version = re.match(r"(\d+\.\d+)\.", said)
        if version:
            return version[1]
    return next((found.release for found in find_openimageio() if found.owner == "the system"), None)


@dataclass(frozen=True)
class OpenImageIO:
    """One OpenImageIO on this machine.

    Attributes:
        library: libOpenImageIO.so of some version.
        release: "2.4": what plugins are built for.
        owner: who brought it: "the system", "PyPI's OpenImageIO 3.2.2.0", "Blender (bpy 5.0.1)".
    """

    library: Path
    release: str
    owner: str

    def trouble(self) -> str | None:
        """Why the plugin for this release does not load into it, None when it does.

        It is tried in a process of its own, every symbol resolved. A release that there is no plugin for is no trouble.
        """
        plugin = oiio_plugin(self.release)
        if plugin is None:
            return None
        utilities = self.library.with_name(self.library.name.replace(_LIBRARY, "libOpenImageIO_Util.so"))
        code = (
            "import ctypes, os, sys\n"
            "for name in sys.argv[1:3]: ctypes.CDLL(name, ctypes.RTLD_GLOBAL)\n"
            "ctypes.CDLL(sys.argv[3], os.RTLD_NOW)\n"
        )
        done = subprocess.run(
            [sys.executable, "-c", code, utilities, self.library, plugin], capture_output=True, text=True, check=False
        )
        return None if done.returncode == 0 else (done.stderr.strip().splitlines() or ["it crashes"])[-1]


def find_openimageio() -> list[OpenImageIO]:
    """Every OpenImageIO that is found: the system's, those of Python packages, and that of the Blender on PATH."""
    found: dict[Path, OpenImageIO] = {}
    for library, owner in _candidates():
        real = library.resolve()
        version = re.search(r"\.so\.(\d+\.\d+)", library.name) or re.search(r"\.so\.(\d+\.\d+)", real.name)
        if version and real not in found:
            found[real] = OpenImageIO(library, version[1], owner)
    return list(found.values())


def _candidates() -> Iterator[tuple[Path, str]]:
    ldconfig = shutil.which("ldconfig") or shutil.which("ldconfig", path="/sbin:/usr/sbin")
    if ldconfig:
        listed = subprocess.run([ldconfig, "-p"], capture_output=True, text=True, check=False).stdout
        for line in listed.splitlines():
            if f"{_LIBRARY}." in line and "=>" in line:
                yield Path(line.split("=>")[1].strip()), "the system"
    for name, owner in (("OpenImageIO", "PyPI's OpenImageIO"), ("bpy", "Blender, PyPI's bpy")):
        try:
            distribution = metadata.distribution(name)
        except metadata.PackageNotFoundError:
            continue
        for folder in ("OpenImageIO/lib", "bpy/lib"):
            for library in Path(str(distribution.locate_file(folder))).glob(f"{_LIBRARY}.*"):
                yield library, f"{owner} {distribution.version}"
    blender = shutil.which("blender")
    if blender:
        for library in (Path(blender).resolve().parent / "lib").glob(f"{_LIBRARY}.*"):
            yield library, f"Blender ({blender})"
