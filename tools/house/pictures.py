# SPDX-License-Identifier: Apache-2.0
"""The commands that show something: the demo, the benchmarks, the comparison with renderers, the manual."""

from __future__ import annotations

from house import build
from house.checkout import PYTHON, ROOT, replace_process, run


def demo(arguments: list[str]) -> int:
    """Make the built-in scenes, relight them and write pictures of it: demo [ARGS of `relume demo`...]"""
    build.build("release")
    return replace_process([PYTHON, "-m", "relume.cli", "demo", *arguments], build.python_environment())


def bench(arguments: list[str]) -> int:
    """Measure speed and memory against the bars: bench [core|files|sequences|doors] [--repeats N]"""
    build.build("release")
    return replace_process([PYTHON, str(ROOT / "tests" / "bench" / "bench.py"), *arguments], build.python_environment())


def truth(arguments: list[str]) -> int:
    """Compare with renderers' own images; writes docs/truth.md and difference pictures"""
    build.build("release")
    return replace_process([PYTHON, str(ROOT / "tests" / "truth" / "run.py"), *arguments], build.python_environment())


def docs(arguments: list[str]) -> int:
    """Generate the parts of docs/ and the stubs that are made from the parameter tables"""
    build.build("release")
    for tool in ("generate_stubs.py", "generate_docs.py"):
        run([PYTHON, ROOT / "tools" / tool, *arguments], env=build.python_environment())
    return 0
