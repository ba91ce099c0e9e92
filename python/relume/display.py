# SPDX-License-Identifier: Apache-2.0
"""From scene-linear to what a screen shows: exposure, a tone curve, a transfer curve, or OpenColorIO."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np

from relume import _relume
from relume.errors import ArgumentError, UnknownNameError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

__all__ = ["Display", "from_srgb", "quantized", "to_display", "to_srgb"]

Tone = Literal["none", "reinhard", "aces"]
Gamma = Literal["srgb", "2.2", "none"]


def to_srgb(linear: ArrayLike) -> NDArray[np.float64]:
    """The sRGB code of linear values, piecewise (IEC 61966-2-1), in float64; it goes on below 0 and above 1."""
    return np.asarray(_relume.srgb_encode(np.asarray(linear, np.float64)))


def from_srgb(code: ArrayLike) -> NDArray[np.float64]:
    """The linear values of an sRGB code, piecewise (IEC 61966-2-1), in float64; it goes on below 0 and above 1."""
    return np.asarray(_relume.srgb_decode(np.asarray(code, np.float64)))


def quantized(picture: ArrayLike, bits: int = 8) -> NDArray[Any]:
    """0…1 as the nearest of 2^bits codes, uint8 or uint16; NaN becomes 0.

    Args:
        picture: display-coded, any shape.
        bits: 8 or 16.
    """
    quantize = _relume.quantize8 if bits == 8 else _relume.quantize16
    return np.asarray(quantize(np.asarray(picture, np.float32)))


def _eight(chromaticities: Sequence[float]) -> list[float]:
    numbers = [float(number) for number in chromaticities]
    if len(numbers) != 8:
        raise ArgumentError(f"chromaticities are 8 numbers, not {len(numbers)}")
    return numbers


def _to_rec709(space: str | Sequence[float]) -> NDArray[np.float32] | None:
    """The matrix to the primaries of sRGB screens; None where nothing is to be done."""
    screen = _relume.space_chromaticities("lin_rec709")
    assert screen is not None
    own = _relume.space_chromaticities(space) if isinstance(space, str) else _eight(space)
    if own is None:
        names = _relume.space_names()
        near = _relume.nearest_name(str(space), names)
        hint = f"did you mean '{near}'?" if near else f"there are {', '.join(names)}"
        raise UnknownNameError(f"no colour space '{space}'; {hint}")
    matrix = np.reshape(_relume.rgb_to_rgb(own, screen), (3, 3)).astype(np.float32)
    return None if np.allclose(matrix, np.eye(3), atol=1e-6) else matrix


class Display:
    """A display transform: call it with scene-linear (…, 3) and get display-coded (…, 3) float32, 0…1.

    Never baked into a relit EXR: it is for looking.
    """

    def __init__(
        self,
        *,
        exposure: float = 0.0,
        tone: Tone | str = "none",
        gamma: Gamma | str = "srgb",
        ocio_display: str | None = None,
        ocio_view: str | None = None,
        ocio_config: str | None = None,
        space: str | Sequence[float] = "lin_rec709",
    ) -> None:
        """Choose the transform.

        Args:
            exposure: stops.
            tone: "none" clips at 1; "reinhard"; "aces", the film curve's fit.
            gamma: "srgb", the piecewise curve; "2.2"; "none".
            ocio_display: a display of an OpenColorIO config: tone and gamma are then the config's.
            ocio_view: a view of that display; its default when None.
            ocio_config: a config; $OCIO or the built-in one when None.
            space: what the colours are in: "lin_rec709", "lin_ap1", "ACEScg", …, with OpenColorIO any space or role
                of the config; or the eight numbers of an EXR's attribute ``chromaticities``.

        Raises:
            ArgumentError: no such tone curve or code.
            UnknownNameError: no such space, or the config has no such display, view or space.
            MissingPackageError: OpenColorIO is asked for and is not installed.
            FileError: the OpenColorIO config cannot be read.
        """
        for value, kind, known in ((tone, "tone curve", get_args(Tone)), (gamma, "gamma", get_args(Gamma))):
            if value not in known:
                raise ArgumentError(f"no {kind} '{value}'; there are {', '.join(known)}")
        self.exposure = float(exposure)
        self.tone = tone
        self.gamma = gamma
        self._ocio: Callable[[NDArray[Any]], NDArray[np.float32]] | None = None
        self._to_rec709: NDArray[np.float32] | None = None
        if ocio_display is not None or ocio_view is not None or ocio_config is not None:
            from relume.ocio import display_transform

            name = space if isinstance(space, str) else _relume.space_name(_eight(space))
            if name is None:
                raise ArgumentError(f"OpenColorIO takes a space by name, and these chromaticities have none: {space}")
            self._ocio = display_transform(name, ocio_display, ocio_view, ocio_config)
        else:
            self._to_rec709 = _to_rec709(space)

    def __call__(self, linear: ArrayLike) -> NDArray[np.float32]:
        """Display-coded (…, 3) float32, 0…1, of scene-linear (…, 3); NaN becomes 0, infinity the brightest."""
        colors = np.array(linear, np.float32, order="C")
        if colors.ndim == 0 or colors.shape[-1] != 3:
            raise ArgumentError(f"colours have shape {colors.shape}; give (…, 3)")
        if self._ocio is not None:
            finite = np.nan_to_num(colors, copy=False, nan=0.0, posinf=65504.0, neginf=0.0)
            return np.clip(self._ocio(finite * np.float32(2.0**self.exposure)), 0, 1)
        if self._to_rec709 is not None:
            colors = np.ascontiguousarray(colors @ self._to_rec709.T)
        _relume.apply_display(colors.reshape(1, -1, 3), self.exposure, self.tone, self.gamma, straight_out=False)
        return colors


def to_display(
    linear: ArrayLike, *, exposure: float = 0.0, tone: str = "none", gamma: str = "srgb"
) -> NDArray[np.float32]:
    """Display-coded (…, 3) float32, 0…1, of scene-linear (…, 3): Display(exposure, tone, gamma) in one call."""
    return Display(exposure=exposure, tone=tone, gamma=gamma)(linear)
