# SPDX-License-Identifier: Apache-2.0
"""Writing a file so that it is there whole or not at all."""

from __future__ import annotations

import os
import secrets
from pathlib import Path

from relume.errors import FileError


def write_atomically(path: Path, data: bytes) -> None:
    """Write under a temporary name in the same folder, then rename; what stood there survives a failure.

    Raises:
        FileError: the folder is missing or not writable, or the disk is full; the message names the file.
    """
    if not path.name:
        raise FileError(f"{path}: cannot be written: it names no file")
    temporary = path.with_name(f".{path.name}.{os.getpid()}.{secrets.token_hex(4)}.tmp")
    try:
        with temporary.open("xb") as file:
            file.write(data)
        temporary.replace(path)
    except BaseException as error:
        temporary.unlink(missing_ok=True)
        if isinstance(error, OSError):
            raise FileError(f"{path}: cannot be written: {error.strerror or error}") from None
        raise
