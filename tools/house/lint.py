# SPDX-License-Identifier: Apache-2.0
"""``./dev lint``: formatting, types and a small set of clang-tidy checks."""

from __future__ import annotations

import sys

from house import tidy
from house.checkout import PYTHON, StepError, run, timed, tracked

_CPP = ("*.h", "*.cpp", "*.inl")


def _ruff(arguments: list[str]) -> None:
    run([PYTHON, "-m", "ruff", *arguments], what=f"ruff {arguments[0]}")


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
        "clang-tidy": tidy.tidy,
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
