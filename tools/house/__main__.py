# SPDX-License-Identifier: Apache-2.0
"""Entry of ``./dev``: finds the command, runs it, turns a failed step into one line and an exit code."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable

from house import blender, build, checkout, fuzz, lint, pictures, proof


def relume(arguments: list[str]) -> int:
    """The command line of this checkout, in the caller's directory: relume ARGS..."""
    build.build("release")
    return checkout.replace_process([checkout.PYTHON, "-m", "relume.cli", *arguments], build.python_environment())


def python(arguments: list[str]) -> int:
    """Python with this checkout's package, in the caller's directory: python ARGS..."""
    build.build("release")
    return checkout.replace_process([checkout.PYTHON, *arguments], build.python_environment())


def build_presets(arguments: list[str]) -> int:
    """Build the release preset, or the presets that are named: build [PRESET...]"""
    for preset in arguments or ["release"]:
        build.build(preset)
    return 0


COMMANDS: dict[str, Callable[[list[str]], int]] = {
    "demo": pictures.demo,
    "test": proof.test,
    "build": build_presets,
    "bench": pictures.bench,
    "fuzz": fuzz.fuzz,
    "lint": lint.lint,
    "docs": pictures.docs,
    "truth": pictures.truth,
    "blender-extension": blender.extension,
    "blender-picture": blender.picture,
    "relume": relume,
    "python": python,
}


def usage() -> str:
    """The commands, each with the first line of its docstring."""
    lines = ["usage: ./dev COMMAND [ARGS...]", ""]
    width = max(map(len, COMMANDS))
    lines += [f"  {name:{width}} {(command.__doc__ or '').splitlines()[0]}" for name, command in COMMANDS.items()]
    return "\n".join(lines)


def main() -> int:
    """Run the command that the words after ./dev name; returns the exit code."""
    name, *arguments = sys.argv[1:] or ["help"]
    if name in ("help", "-h", "--help"):
        print(usage())
        return 0
    if name not in COMMANDS:
        print(f"dev: no command '{name}'\n\n{usage()}", file=sys.stderr)
        return 2
    try:
        return COMMANDS[name](arguments)
    except checkout.StepError as failure:
        print(f"dev: {failure}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 141


if __name__ == "__main__":
    sys.exit(main())
