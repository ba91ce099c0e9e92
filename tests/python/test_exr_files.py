# SPDX-License-Identifier: Apache-2.0
"""The EXR reader against the OpenEXR library: every compression, type and layout, smooth pixels and noise.

Noise does not compress, so that its chunks are stored raw. The files are written, and read for comparison, by PyPI's
OpenEXR, whose release is not the core's.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from relume import _relume

COMPRESSIONS = [
    name
    for name in ("NO", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24", "B44", "B44A", "DWAA", "DWAB", "HTJ2K256", "HTJ2K32")
    if hasattr(OpenEXR, f"{name}_COMPRESSION")
]
WIDTH, HEIGHT = 77, 91  # no multiple of any chunk or tile


def channels(noise: bool, compressible: bool, seed: int) -> dict[str, np.ndarray]:
    """Channels of each type. Noise is of random bits, but for one of the exponent, so that all values are finite."""
    random = np.random.default_rng(seed)
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH]
    result: dict[str, np.ndarray] = {}
    for k, (name, dtype) in enumerate((("a", np.float16), ("B", np.float32), ("c", np.uint32), ("D", np.float16))):
        bits = np.uint16 if dtype == np.float16 else np.uint32
        if noise and compressible:
            value = random.standard_normal((HEIGHT, WIDTH)) * 10.0 ** random.integers(-3, 4, (HEIGHT, WIDTH))
            result[name] = np.abs(value).astype(dtype)
        elif noise:
            kept = {np.float16: 0xBFFF, np.float32: 0xBFFFFFFF, np.uint32: 0xFFFFFFFF}[dtype]
            raw = random.integers(0, 2**32, (HEIGHT, WIDTH), np.uint32).astype(bits) & bits(kept)
            result[name] = raw.view(dtype)
        else:
            result[name] = np.floor((x * (k + 1) + y * 3) / 7).astype(dtype)
    return result


@pytest.mark.parametrize("layout", ["scanline", "tiled"])
@pytest.mark.parametrize("parts", [1, 3])
@pytest.mark.parametrize("noise", [False, True])
@pytest.mark.parametrize("compression", COMPRESSIONS)
def test_against_the_library(tmp_path: Path, compression: str, noise: bool, parts: int, layout: str) -> None:
    path = tmp_path / "file.exr"
    dct = compression.startswith("DWA")
    header = {"compression": getattr(OpenEXR, f"{compression}_COMPRESSION"), "type": OpenEXR.scanlineimage}
    if layout == "tiled":
        header |= {"type": OpenEXR.tiledimage, "tiles": OpenEXR.TileDescription()}
        header["tiles"].xSize, header["tiles"].ySize = 32, 24
    made = [OpenEXR.Part(dict(header), channels(noise, dct, k), f"part{k}") for k in range(parts)]
    OpenEXR.File(made).write(str(path))

    ours = _relume.ExrFile(path)
    assert len(ours.parts) == parts
    with OpenEXR.File(str(path), separate_channels=True) as theirs:
        for k, part in enumerate(theirs.parts):
            assert ours.parts[k].tiled == (layout == "tiled")
            for name, channel in part.channels.items():
                read = ours.read_uint32 if channel.pixels.dtype == np.uint32 else ours.read
                pixels = read(k, [name])[..., 0]
                # Lossy DCT sums in another order, then rounds to half.
                tolerance = 2**-9 if dct else 0
                np.testing.assert_allclose(pixels, channel.pixels.astype(pixels.dtype), rtol=tolerance, atol=tolerance)
