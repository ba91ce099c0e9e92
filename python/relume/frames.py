# SPDX-License-Identifier: Apache-2.0
"""File names of a sequence (``shot.####.exr``, ``shot.%04d.exr``, ``shot.{frame}.exr``) and ranges of frames."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from relume._relume import is_pattern, parse_frames, resolve_frame
from relume.errors import ArgumentError

__all__ = ["find_frames", "is_pattern", "parse_frames", "resolve_frame"]


def find_frames(pattern: str) -> list[int]:
    """Frames of a pattern that are on disk, in order. The place must be in the file's name, not in a folder's.

    Raises:
        ArgumentError: a folder's name has a place for the frame number.
    """
    path = Path(pattern)
    if resolve_frame(str(path.parent), 0) != str(path.parent):
        raise ArgumentError(f"{pattern}: the frame number is in a folder's name; say which frames (--frames)")
    # What stays the same in every frame's name, and between it digits.
    name = path.name
    fixed = re.split(r"#+|%\d*d|\{frame[^}]*\}", name)
    matcher = re.compile(r"(-?\d+)".join(re.escape(text) for text in fixed))

    def numbers() -> Iterator[int]:
        for entry in path.parent.iterdir():
            match = matcher.fullmatch(entry.name)
            # shot.01001.exr is no frame of shot.####.exr: 1001 has another name.
            if match and resolve_frame(name, int(match[1])) == entry.name:
                yield int(match[1])

    return sorted(numbers()) if path.parent.is_dir() else []
