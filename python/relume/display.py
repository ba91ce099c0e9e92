# SPDX-License-Identifier: Apache-2.0
"""From scene-linear to what a screen shows: exposure, a tone curve, a transfer curve, or OpenColorIO."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from relume.errors import ArgumentError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

__all__ = ["Display", "from_srgb", "to_display", "to_srgb"]

Tone = Literal["none", "reinhard", "aces"]
Gamma = Literal["srgb", "2.2", "none"]


def to_srgb(linear: NDArray[Any]) -> NDArray[Any]:
    """The sRGB code of linear values, piecewise (IEC 61966-2-1); negative values are 0."""
    positive = np.maximum(linear, 0)
    power = 1.055 * np.power(positive, 1 / 2.4) - 0.055
    return np.where(positive <= 0.0031308, 12.92 * positive, power)


def from_srgb(coded: NDArray[Any]) -> NDArray[Any]:
    """The linear values of an sRGB code, piecewise (IEC 61966-2-1); negative values are 0."""
    positive = np.maximum(coded, 0)
    return np.where(positive <= 0.04045, positive / 12.92, np.power((positive + 0.055) / 1.055, 2.4))


def reinhard(linear: NDArray[Any]) -> NDArray[Any]:
    """x/(1 + x) (Reinhard et al. 2002, equation 3)."""
    positive = np.maximum(linear, 0)
    return positive / (1 + positive)


def aces_fit(linear: NDArray[Any]) -> NDArray[Any]:
    """(x(2.51x + 0.03))/(x(2.43x + 0.59) + 0.14), clamped to 0…1 (Narkowicz 2016's fit of the ACES film curve)."""
    x = np.maximum(linear, 0)
    return np.clip(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0, 1)


_TONES: dict[str, Callable[[NDArray[Any]], NDArray[Any]]] = {
    "none": lambda x: x,
    "reinhard": reinhard,
    "aces": aces_fit,
}
_GAMMAS: dict[str, Callable[[NDArray[Any]], NDArray[Any]]] = {
    "srgb": to_srgb,
    "2.2": lambda x: np.power(np.maximum(x, 0), 1 / 2.2),
    "none": lambda x: x,
}


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
        ocio_space: str | None = None,
    ) -> None:
        """Choose the transform.

        Args:
            exposure: stops.
            tone: "none" clips at 1; "reinhard"; "aces", the film curve's fit.
            gamma: "srgb", the piecewise curve; "2.2"; "none".
            ocio_display: a display of an OpenColorIO config: tone and gamma are then the config's.
            ocio_view: a view of that display; its default when None.
            ocio_config: a config; $OCIO or the built-in one when None.
            ocio_space: what the colours are in; lin_rec709 where the config knows it, else its scene_linear, when None.

        Raises:
            ArgumentError: no such tone curve or code.
            MissingPackageError: OpenColorIO is asked for and is not installed.
            FileError: the OpenColorIO config cannot be read.
            UnknownNameError: the config has no such display, view or space.
        """
        if tone not in _TONES:
            raise ArgumentError(f"no tone curve '{tone}'; there are {', '.join(_TONES)}")
        if gamma not in _GAMMAS:
            raise ArgumentError(f"no gamma '{gamma}'; there are {', '.join(_GAMMAS)}")
        self.exposure = float(exposure)
        self.tone = tone
        self.gamma = gamma
        self._ocio: Callable[[NDArray[Any]], NDArray[np.float32]] | None = None
        if any(option is not None for option in (ocio_display, ocio_view, ocio_config, ocio_space)):
            from relume.ocio import display_transform

            self._ocio = display_transform(ocio_display, ocio_view, ocio_config, ocio_space)

    def __call__(self, linear: ArrayLike) -> NDArray[np.float32]:
        """Display-coded (…, 3) float32 of scene-linear (…, 3); NaN becomes 0, infinity the brightest."""
        colors = np.asarray(linear, np.float32)
        finite = np.nan_to_num(colors, nan=0.0, posinf=65504.0, neginf=0.0) * np.float32(2.0**self.exposure)
        if self._ocio is not None:
            return np.clip(self._ocio(finite), 0, 1)
        return np.clip(_GAMMAS[self.gamma](_TONES[self.tone](finite)), 0, 1).astype(np.float32)


def to_display(
    linear: ArrayLike, *, exposure: float = 0.0, tone: str = "none", gamma: str = "srgb"
) -> NDArray[np.float32]:
    """Display-coded (…, 3) float32, 0…1, of scene-linear (…, 3): Display(exposure, tone, gamma) in one call."""
    return Display(exposure=exposure, tone=tone, gamma=gamma)(linear)
