# SPDX-License-Identifier: Apache-2.0
"""Images that are not EXR (PNG, JPEG, TIFF, …), one channel of a G-buffer each, by the package OpenImageIO."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import TYPE_CHECKING, Any

from relume import _relume
from relume.errors import FileError, FormatError, MissingPackageError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@functools.cache
def install_reader() -> None:
    """Let GBuffer.read() take such files; OpenImageIO is imported with the first of them."""
    _relume.set_image_reader(read_image)


def read_image(path: Path) -> tuple[NDArray[np.float32], list[str], int]:
    """Read one image as its file stores it.

    Returns:
        (H, W, C) float32, integers as 0..1, nothing decoded; the names of the channels, "Y" for grey; and the bits of
        the integers that the file holds (8, 16, …), 0 for floating point.

    Raises:
        FileError: it is missing.
        FormatError: it cannot be read.
        MissingPackageError: OpenImageIO is not installed.
    """
    if not path.exists():
        raise FileError(f"{path}: no such file")
    try:
        import OpenImageIO as oiio  # noqa: N813
    except ImportError as error:
        raise MissingPackageError(
            f"{path}: files that are not EXR are read by the package OpenImageIO, which is not there ({error}): "
            "pip install OpenImageIO"
        ) from None
    image: Any = oiio.ImageInput.open(str(path))
    if image is None:
        raise FormatError(f"{path}: cannot be read: {' '.join(str(oiio.geterror()).split())}")
    try:
        spec = image.spec()
        pixels = image.read_image(0, 0, 0, spec.nchannels, "float")
        if pixels is None:
            raise FormatError(f"{path}: cannot be read: {' '.join(str(image.geterror()).split())}")
        names = [str(name) for name in spec.channelnames]
        integer = str(spec.format).startswith("uint")
        bits = int(spec.get_int_attribute("oiio:BitsPerSample", 8 * spec.format.basesize())) if integer else 0
    finally:
        image.close()
    # 1, 2 and 4 bits a pixel are as coarse as 8, and coded like them.
    bits = 8 if 0 < bits < 8 else bits
    import numpy as np

    return np.asarray(pixels, np.float32).reshape(spec.height, spec.width, spec.nchannels), names, bits
