# SPDX-License-Identifier: Apache-2.0
"""How commands speak: errors as one line, tables on a terminal or in a pipe."""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING

from relume.cli import EXIT_FAILED, EXIT_INTERRUPTED, EXIT_USAGE
from relume.errors import ArgumentError, Cancelled, Error, ParameterError, RigError

if TYPE_CHECKING:
    from rich.console import Console

# Wide enough that no table wraps in a file or a pipe.
_PIPE_WIDTH = 200


def one_line(error: BaseException) -> str:
    """What went wrong, without a traceback (RELUME_DEBUG=1 shows it)."""
    if isinstance(error, Error):
        return printable(" ".join(str(error).split()))
    if isinstance(error, MemoryError):
        return "out of memory"
    if isinstance(error, OSError):
        name = f"{printable(error.filename)}: " if error.filename else ""
        return f"{name}{error.strerror or error}"
    return f"internal error, please report it (RELUME_DEBUG=1 shows more): {type(error).__name__}: {error}"


def printable(text: object) -> str:
    """The text on one line without control characters; what a file's name has that is not UTF-8 is read as Latin-1."""
    from relume import _relume

    return _relume.printable(os.fsencode(str(text)))


def exit_code_of(error: BaseException) -> int:
    """Rigs and arguments are wrong everywhere, files only here."""
    if isinstance(error, (RigError, ParameterError, ArgumentError)):
        return EXIT_USAGE
    return EXIT_INTERRUPTED if isinstance(error, Cancelled) else EXIT_FAILED


def console() -> Console:
    """Standard output for tables; as wide as they need when it is no terminal."""
    from rich.console import Console

    class Quiet(Console):
        def on_broken_pipe(self) -> None:
            # Not exit code 1, as rich has it: who reads no further has seen enough.
            raise BrokenPipeError

    return Quiet(highlight=False, width=None if sys.stdout.isatty() else _PIPE_WIDTH)
