# SPDX-License-Identifier: Apache-2.0
"""The built-in scenes, written as G-buffer EXRs in Blender's channel names."""

from __future__ import annotations

import os
from pathlib import Path

from relume import _relume
from relume._relume import SceneInfo

__all__ = ["scenes", "write_scene"]


def scenes() -> dict[str, SceneInfo]:
    """The built-in scenes by name, each with its help and its own size."""
    return {info.name: info for info in _relume.scenes()}


def write_scene(
    name: str,
    path: str | os.PathLike[str],
    *,
    width: int | None = None,
    height: int | None = None,
    samples: int | None = None,
    paths: int | None = None,
    bounces: int = 8,
    time: float = 0.0,
    opaque: bool = False,
    seed: int = 0,
    threads: int | None = None,
) -> None:
    """Render a built-in scene into a G-buffer EXR.

    Args:
        name: "sdf" or "cornell".
        path: the EXR to write: one part, float32.
        width: pixels; the scene's own when None.
        height: pixels; the scene's own when None.
        samples: camera rays per pixel; the scene's own number when None.
        paths: light paths per camera ray (cornell); 0 leaves the beauty out.
        bounces: of a light path (cornell); 1 is direct light alone.
        time: seconds: the camera of sdf goes round.
        opaque: the beauty has the sky behind it and alpha 1, else alpha is coverage.
        seed: of the light paths.
        threads: how many; as many as the process may use when None.

    Raises:
        ParameterError: no such scene.
        ArgumentError: a number out of its range.
        FileError: the file cannot be written.
    """
    _relume.write_scene(
        name,
        Path(path),
        width=width or 0,
        height=height or 0,
        samples=samples or 0,
        paths=-1 if paths is None else paths,
        bounces=bounces,
        time=time,
        opaque=opaque,
        seed=seed,
        threads=threads or 0,
    )
