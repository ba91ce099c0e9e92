# SPDX-License-Identifier: Apache-2.0
"""Writing PNG files, with zlib alone."""

from __future__ import annotations

import os
import struct
import zlib
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from relume.errors import ArgumentError
from relume.files import write_atomically

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["write_png"]

# PNG specification, third edition, 11.2.1: colour types by the number of components.
_COLOR_TYPES = {1: 0, 2: 4, 3: 2, 4: 6}


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def write_png(path: str | os.PathLike[str], image: NDArray[Any], *, srgb: bool = True) -> None:
    """Write an 8- or 16-bit PNG; it appears when it is whole.

    Args:
        path: the file.
        image: uint8 or uint16, (H, W) grey, (H, W, 2) grey with alpha, (H, W, 3) RGB or (H, W, 4) RGBA. Alpha is
            straight.
        srgb: say in the file that the values are sRGB.

    Raises:
        ArgumentError: an array of another dtype or shape.
        FileError: the file cannot be written.
    """
    pixels = image[..., np.newaxis] if image.ndim == 2 else image
    if pixels.ndim != 3 or pixels.shape[2] not in _COLOR_TYPES or 0 in pixels.shape:
        raise ArgumentError(f"a PNG is (H, W) or (H, W, 1…4), not {image.shape}")
    if pixels.dtype not in (np.uint8, np.uint16):
        raise ArgumentError(f"a PNG holds uint8 or uint16, not {image.dtype}")
    height, width, components = pixels.shape
    depth = pixels.dtype.itemsize
    rows = np.ascontiguousarray(pixels, dtype=pixels.dtype.newbyteorder(">")).view(np.uint8).reshape(height, -1)
    # Filter 2, "up": the difference to the row above; smooth pictures pack well with it.
    filtered = np.empty((height, rows.shape[1] + 1), np.uint8)
    filtered[:, 0] = 2
    filtered[0, 1:] = rows[0]
    np.subtract(rows[1:], rows[:-1], out=filtered[1:, 1:])
    header = struct.pack(">IIBBBBB", width, height, 8 * depth, _COLOR_TYPES[components], 0, 0, 0)
    chunks = [b"\x89PNG\r\n\x1a\n", _chunk(b"IHDR", header)]
    if srgb:
        chunks.append(_chunk(b"sRGB", b"\x00"))
    chunks += [_chunk(b"IDAT", zlib.compress(filtered.tobytes(), 6)), _chunk(b"IEND", b"")]
    write_atomically(Path(path), b"".join(chunks))
