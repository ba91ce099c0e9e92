# SPDX-License-Identifier: Apache-2.0
"""clang-tidy on the sources of core, remembering what it passed."""

from __future__ import annotations

import functools
import hashlib
import json
import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from house import build
from house.checkout import ROOT, StepError, say, tracked

_INCLUDE_FOLDERS = (ROOT / "core" / "include", ROOT / "core", ROOT / "plugins")


@functools.cache
def _includes(file: Path) -> tuple[Path, ...]:
    """Headers of ours that a file names itself."""
    found = []
    for name in re.findall(r'^\s*#\s*include\s*"([^"]+)"', file.read_text(encoding="utf-8"), re.MULTILINE):
        for folder in (file.parent, *_INCLUDE_FOLDERS):
            if (folder / name).is_file():
                found.append((folder / name).resolve())
                break
    return tuple(found)


def _key(source: Path, settings: bytes) -> str:
    """Hash of everything of ours that clang-tidy sees of a source: itself, its headers, the checks."""
    seen = {source}
    waiting = [source]
    while waiting:
        for header in _includes(waiting.pop()):
            if header not in seen:
                seen.add(header)
                waiting.append(header)
    digest = hashlib.sha256(settings)
    for file in sorted(seen):
        digest.update(f"{file.relative_to(ROOT)}\0".encode() + file.read_bytes())
    return digest.hexdigest()


def tidy() -> None:
    """Look at what has changed since it last passed, in any clone on this machine.

    Raises:
        StepError: there is something to mend; it has been shown.
    """
    directory = build.configure("release")
    commands = json.loads((directory / "compile_commands.json").read_text())
    known = {Path(entry["file"]) for entry in commands}
    settings = (ROOT / ".clang-tidy").read_bytes()
    # Beside ccache, and for the same reason: a fresh clone has nothing new to look at.
    passed = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "relume-clang-tidy"
    passed.mkdir(parents=True, exist_ok=True)
    keys = {name: _key(ROOT / name, settings) for name in tracked("core/*.cpp") if ROOT / name in known}
    todo = [name for name, key in keys.items() if not (passed / key).exists()]

    def check(name: str) -> tuple[str, subprocess.CompletedProcess[str]]:
        # The commands are GCC's: clang does not know all of its warnings.
        command = ["clang-tidy-14", "--quiet", "-p", str(directory), "--extra-arg=-Wno-unknown-warning-option"]
        # GCC's --param is none of clang's.
        command.append("--extra-arg=-Wno-unused-command-line-argument")
        command += ["--warnings-as-errors=*", str(ROOT / name)]
        return name, subprocess.run(command, capture_output=True, text=True, check=False)

    failed = []
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for name, done in pool.map(check, todo):
            if done.returncode == 0:
                (passed / keys[name]).touch()
            else:
                failed.append(name)
                sys.stderr.write(done.stdout)
    if failed:
        raise StepError(f"clang-tidy: {', '.join(failed)}")
    say(f"clang-tidy: {len(todo)} of {len(keys)} files looked at")
