# SPDX-License-Identifier: Apache-2.0
"""Pictures of a comparison: the renderer, relume, and where they differ."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import OpenImageIO
from measure import P99_BAR, relative_error

if TYPE_CHECKING:
    from pathlib import Path

    from cases import Result
    from numpy.typing import NDArray


def _display(image: NDArray[np.float64], white: float) -> NDArray[np.float64]:
    return np.clip(np.nan_to_num(image) / white, 0, 1) ** (1 / 2.2)


def _heat(error: NDArray[np.float64]) -> NDArray[np.float64]:
    """Black at 0, blue at a tenth of the bar, white at the bar, red above it."""
    share = np.clip(error / P99_BAR, 0, None)
    low = np.clip(share * 10, 0, 1)
    high = np.clip((share - 0.1) / 0.9, 0, 1)
    heat = np.stack([high, high, low], axis=-1)
    return np.where((share > 1)[..., None], np.array([0.9, 0.1, 0.05]), heat)


def picture(result: Result) -> NDArray[np.uint8]:
    """Renderer, relume, relative error side by side, (H, 3W, 3) bytes; errors in interior pixels alone."""
    error, bright = relative_error(result.image, result.truth, result.case.scene.generation)
    error = np.where(bright & result.surface.interior(), error, 0.0)
    white = max(float(np.percentile(result.truth, 99.0)), 1e-3)
    row = [_display(result.truth, white), _display(result.image, white), _heat(error)]
    return np.rint(np.concatenate(row, axis=1) * 255).astype(np.uint8)


def write_png(path: Path, pixels: NDArray[np.uint8]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    height, width, channels = pixels.shape
    output = OpenImageIO.ImageOutput.create(str(path))
    if output is None:
        raise OSError(f"{path}: {OpenImageIO.geterror()}")
    if not (
        output.open(str(path), OpenImageIO.ImageSpec(width, height, channels, "uint8")) and output.write_image(pixels)
    ):
        raise OSError(f"{path}: {output.geterror()}")
    output.close()
