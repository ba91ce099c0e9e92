# SPDX-License-Identifier: Apache-2.0
"""Adds files of the compressions that OpenEXR 3.1 lacks: `python make_exr_new.py`, with PyPI's OpenEXR 3.5."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenEXR

FOLDER = Path(__file__).parent
DATA = ((-5, -3), (20, 33))  # inclusive, as in make_exr.cpp
DISPLAY = ((0, 0), (31, 23))


def pattern(channel: int, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """pattern_value of tests/cpp/exr_pattern.h."""
    return (((x >> 1) * 8 + (y >> 1) * 16 + channel * 32) & 1023) / 16.0 - 20.0


def main() -> None:
    """Write scanline_htj2k256.exr, scanline_htj2k32.exr and scanline_zstd.exr."""
    (x0, y0), (x1, y1) = DATA
    y, x = np.mgrid[y0 : y1 + 1, x0 : x1 + 1]
    index = 3_000_000_000 + (x >> 2) + 100 * (y >> 2)
    channels = {
        "B": pattern(0, x, y).astype(np.float16),
        "G": pattern(1, x, y).astype(np.float16),
        "ID": (index + 2).astype(np.uint32),
        "R": pattern(3, x, y).astype(np.float16),
        "Z": pattern(4, x, y).astype(np.float32),
    }
    for name in ("htj2k256", "htj2k32", "zstd"):
        header = {
            "compression": getattr(OpenEXR, f"{name.upper()}_COMPRESSION"),
            "type": OpenEXR.scanlineimage,
            "dataWindow": tuple(np.array(corner, np.int32) for corner in DATA),
            "displayWindow": tuple(np.array(corner, np.int32) for corner in DISPLAY),
        }
        with OpenEXR.File(header, channels) as file:
            file.write(str(FOLDER / f"scanline_{name}.exr"))


if __name__ == "__main__":
    main()
