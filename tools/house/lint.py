# SPDX-License-Identifier: Apache-2.0
"""``./dev lint``: formatting, types and a small set of clang-tidy checks."""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from house import build
from house.checkout import BUILD, PYTHON, ROOT, StepError, run, say, timed, tracked

_CPP = ("*.h", "*.cpp", "*.inl")


def _ruff(arguments: list[str]) -> None:
    run([PYTHON, "-m", "ruff", *arguments], what=f"ruff {arguments[0]}")


def _tidy_key(source: Path, headers: bytes) -> str:
    return hashlib.sha256(headers + source.read_bytes()).hexdigest()


def _tidy() -> None:
    """clang-tidy on what has changed since it last passed here; a change to any header counts for every file."""
    directory = build.configure("release")
    commands = json.loads((directory / "compile_commands.json").read_text())
    known = {Path(entry["file"]) for entry in commands}
    digest = hashlib.sha256((ROOT / ".clang-tidy").read_bytes())
    for name in tracked("core/*.h", "plugins/*.h"):
        digest.update((ROOT / name).read_bytes())
    passed = BUILD / "clang-tidy"
    passed.mkdir(exist_ok=True)
    todo = {}
    for name in tracked("core/*.cpp"):
        key = _tidy_key(ROOT / name, digest.digest())
        if ROOT / name in known and not (passed / key).exists():
            todo[name] = key

    def check(name: str) -> tuple[str, subprocess.CompletedProcess[str]]:
        # The commands are GCC's: clang does not know all of its warnings.
        command = ["clang-tidy-14", "--quiet", "-p", str(directory), "--extra-arg=-Wno-unknown-warning-option"]
        command += ["--warnings-as-errors=*", str(ROOT / name)]
        return name, subprocess.run(command, capture_output=True, text=True, check=False)

    failed = []
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for name, done in pool.map(check, todo):
            if done.returncode == 0:
                (passed / todo[name]).touch()
            else:
                failed.append(name)
                sys.stderr.write(done.stdout)
    if failed:
        raise StepError(f"clang-tidy: {', '.join(failed)}")
    say(f"clang-tidy: {len(todo)} files looked at")


def lint(arguments: list[str]) -> int:
    """clang-format, ruff, mypy --strict and clang-tidy: lint [fix]; fix formats what can be formatted"""
    fix = arguments[:1] == ["fix"]
    cpp = tracked(*_CPP)
    if fix:
        run(["clang-format-14", "-i", *cpp])
        _ruff(["check", "--fix", "."])
        _ruff(["format", "."])
    steps = {
        "clang-format": lambda: run(["clang-format-14", "--dry-run", "-Werror", *cpp], what="clang-format"),
        "ruff check": lambda: _ruff(["check", "."]),
        "ruff format": lambda: _ruff(["format", "--check", "."]),
        "mypy": lambda: run([PYTHON, "-m", "mypy"], what="mypy --strict"),
        "clang-tidy": _tidy,
    }
    failures = []
    for title, step in steps.items():
        try:
            with timed(title):
                step()
        except StepError as failure:
            failures.append(str(failure))
    for text in failures:
        print(f"FAILED {text}", file=sys.stderr)
    return 1 if failures else 0
