# SPDX-License-Identifier: Apache-2.0
"""What leaves our binaries: nothing that could meet another copy of a library that we carry inside."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("RELUME_BUILD_DIR", ROOT / "build" / "release"))

# Names of ours, and what the compiler makes of our classes.
OURS = re.compile(r"^(relume_\w+|((typeinfo|typeinfo name|vtable|VTT|guard variable) for )?relume::.*)$")


def symbols(path: Path, *options: str) -> list[tuple[str, str]]:
    """Pairs (kind, demangled name) of the symbols that a binary defines."""
    listing = subprocess.run(
        ["nm", "--demangle", "--defined-only", *options, path], text=True, capture_output=True, check=True
    ).stdout
    rows = re.findall(r"^[0-9a-f]* +(\w) (.+)$", listing, re.MULTILINE)
    assert rows, f"{path} defines no symbol at all"
    return rows


def return_type_stripped(name: str) -> str:
    """`std::vector<int> relume::f<int>()` is `relume::f<int>()`: nm writes the return type of templates."""
    return name if OURS.match(name) else name[name.find(" relume::") + 1 :]


def test_library_exports_only_relume() -> None:
    names = [name for _, name in symbols(BUILD / "core" / "librelume.so", "--dynamic")]
    assert [name for name in names if not OURS.match(return_type_stripped(name))] == []
    assert any("relume::version" in name for name in names)


def test_python_module_exports_only_its_entry() -> None:
    (module,) = (BUILD / "python" / "relume").glob("_relume*.so")
    assert [name for _, name in symbols(module, "--dynamic")] == ["PyInit__relume"]


def isa_objects() -> list[Path]:
    found = [path for path in BUILD.rglob("*.o") if re.search(r"\.isa-(?!scalar)", str(path))]
    assert found, f"no object of a single instruction set under {BUILD}"
    return found


def test_isa_objects_export_their_kernel_alone() -> None:
    """An inline function that an AVX-512 object exports weakly could be the copy that runs on every CPU."""
    offenders = {}
    for path in isa_objects():
        exported = [name for kind, name in symbols(path) if kind.isupper() or kind in "uvw"]
        strangers = [name for name in exported if not name.startswith("relume_kernel_")]
        if strangers:
            offenders[path.name] = strangers
    assert offenders == {}


@pytest.mark.parametrize("library", ["exr_", "libdeflate", "ZSTD", "ojph", "Imath"])
def test_no_carried_library_shows(library: str) -> None:
    """The same again by name: a regular expression that accepts too much would not hide these."""
    (module,) = (BUILD / "python" / "relume").glob("_relume*.so")
    for binary in (BUILD / "core" / "librelume.so", module):
        shown = [name for _, name in symbols(binary, "--dynamic") if re.match(rf"(\w+::)*{library}", name)]
        assert shown == []
