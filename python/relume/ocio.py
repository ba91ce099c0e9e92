# SPDX-License-Identifier: Apache-2.0
"""Display transforms by the package opencolorio, with the user's config ($OCIO, a file) or the built-in one."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from relume import _relume
from relume.errors import FileError, MissingPackageError, UnknownNameError

if TYPE_CHECKING:
    from numpy.typing import NDArray

# What the package brings itself.
_BUILTIN_CONFIG = "ocio://default"


def _require(name: str, kind: str, names: list[str]) -> None:
    if name not in names:
        near = _relume.nearest_name(name, names)
        hint = f"did you mean '{near}'?" if near else f"there are {', '.join(names)}"
        raise UnknownNameError(f"OpenColorIO: no {kind} '{name}'; {hint}")


def _load(path: str | None) -> Any:
    try:
        import PyOpenColorIO as ocio  # type: ignore[import-untyped]  # noqa: N813
    except ImportError as error:
        raise MissingPackageError(
            f"display transforms by OpenColorIO need the package opencolorio ({error}): pip install opencolorio"
        ) from None
    source = path or os.environ.get("OCIO") or _BUILTIN_CONFIG
    try:
        return ocio.Config.CreateFromFile(source)
    except Exception as error:  # ocio.Exception is no subclass of anything better
        raise FileError(f"OpenColorIO config {source}: {' '.join(str(error).split())}") from None


def _source_space(config: Any, wanted: str) -> str:
    """The config's name or alias of a space; ours carry "_scene" at the Color Interop Forum."""
    for name in (wanted, f"{wanted}_scene"):
        if config.getColorSpace(name) is not None:
            return name
    _require(wanted, "colour space", [str(name) for name in config.getColorSpaceNames()])
    return wanted


def display_transform(
    space: str, display: str | None = None, view: str | None = None, config: str | None = None
) -> Callable[[NDArray[Any]], NDArray[np.float32]]:
    """A function from scene-linear (…, 3) to display-coded (…, 3) float32.

    Args:
        space: what the colours are in: a space, alias or role of the config, or one of relume's names.
        display: of the config; its default when None.
        view: of the display; its default when None.
        config: a file, or "ocio://…"; $OCIO, else the built-in one, when None.

    Raises:
        MissingPackageError: opencolorio is not installed.
        FileError: the config cannot be read.
        UnknownNameError: no such display, view or space; the message has the nearest name.
    """
    loaded = _load(config)
    import PyOpenColorIO as ocio  # noqa: N813

    displays = [str(name) for name in loaded.getDisplays()]
    chosen = display or str(loaded.getDefaultDisplay())
    _require(chosen, "display", displays)
    views = [str(name) for name in loaded.getViews(chosen)]
    seen = view or str(loaded.getDefaultView(chosen))
    _require(seen, f"view of '{chosen}'", views)
    source = _source_space(loaded, space)
    processor = loaded.getProcessor(source, chosen, seen, ocio.TRANSFORM_DIR_FORWARD).getDefaultCPUProcessor()

    def apply(colors: NDArray[Any]) -> NDArray[np.float32]:
        pixels = np.array(colors, np.float32, order="C")
        processor.applyRGB(pixels.reshape(-1, 3))
        return pixels

    return apply
