# SPDX-License-Identifier: Apache-2.0
"""Relighting: a G-buffer and a rig in, pictures out, as arrays or as an EXR."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from relume import _relume
from relume.errors import ArgumentError, UnknownNameError
from relume.gbuffer import GBuffer, _thread_count
from relume.images import install_reader
from relume.rig import Rig

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relume._relume import Report

__all__ = ["Relit", "relight", "relight_file"]

#: A rig, the path of a rig file, the name of a built-in one, or the text of one (anything with a line break or a `=`,
#: unless it ends like a path).
AnyRig = Rig | str | os.PathLike[str]
#: A G-buffer, or the path of one, which is read with the rig's [gbuffer] and [camera].
AnyGBuffer = GBuffer | str | os.PathLike[str]
#: Called a few times a second, in the calling thread, with the share that is done, 0…1.
Progress = Callable[[float], object]


class Relit(Mapping[str, "NDArray[Any]"]):
    """The pictures of a relight by AOV name: "beauty" (H, W, 4) first, then (H, W, 3) AOVs, scene-linear.

    Attributes:
        report: what happened to the pixels: shaded, background, NaN or infinity by channel, warnings, seconds.
    """

    def __init__(self, arrays: dict[str, NDArray[Any]], report: Report) -> None:
        self._arrays = arrays
        self.report = report

    def __getitem__(self, name: str) -> NDArray[Any]:
        try:
            return self._arrays[name]
        except KeyError:
            raise UnknownNameError(f"no AOV '{name}'; {_nearest(name, list(self._arrays))}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._arrays)

    def __len__(self) -> int:
        return len(self._arrays)

    def __repr__(self) -> str:
        return f"<Relit: {', '.join(self._arrays)}>"


def _nearest(word: str, names: list[str]) -> str:
    near = _relume.nearest_name(word, names)
    return f"did you mean '{near}'?" if near else f"there are {', '.join(names)}"


def _rig_of(rig: AnyRig) -> Rig:
    install_reader()  # for its tables
    if isinstance(rig, Rig):
        return rig
    if isinstance(rig, str) and ("\n" in rig or ("=" in rig and not rig.endswith((".relume", ".toml")))):
        return Rig.loads(rig)
    return Rig.find(rig)


def _gbuffer_of(gbuffer: AnyGBuffer, rig: Rig) -> GBuffer:
    return gbuffer if isinstance(gbuffer, GBuffer) else GBuffer.read(gbuffer, rig=rig)


def relight(
    gbuffer: AnyGBuffer,
    rig: AnyRig,
    out: Mapping[str, NDArray[Any]] | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
    step: int = 1,
) -> Relit:
    """Relight into arrays. The GIL is released meanwhile; Ctrl-C stops the work.

    Args:
        gbuffer: a G-buffer, or the path of an EXR.
        rig: a Rig, the path of a rig file, the name of a built-in one ("outdoor"), or TOML text.
        out: arrays to write into by AOV name: float32 or float16, any strides, (H, W, 4) for "beauty" and (H, W, 3)
            for the others. What is not given is made.
        threads: how many; as many as the process may use when None.
        progress: called a few times a second with the share done, 0…1.
        step: 2 shades every second pixel of every second row, from the first on: a proxy in a quarter of the time,
            whose pixels have the bits of the whole. H and W above then are those of the proxy.

    Returns:
        Arrays by AOV name, "beauty" (H, W, 4) first; the arrays of ``out`` themselves where given. Row 0 is the top of
        the data window, values are scene-linear in the working space, premultiplied by alpha.

    Raises:
        UnknownNameError: ``out`` names an AOV that the rig does not make.
        ArgumentError: an array of ``out`` has another shape or dtype.
        RigError: the rig has no lights.
        ChannelError: a channel that a light or shader needs is missing.
    """
    import numpy as np

    rig = _rig_of(rig)
    gbuffer = _gbuffer_of(gbuffer, rig)
    if step < 1:
        raise ArgumentError(f"step is {step}; give 1 (every pixel) or more")
    height, width = (-(-size // step) for size in gbuffer.shape)
    arrays: dict[str, NDArray[Any]] = {}
    given = dict(out or {})
    for name, components in rig.aovs.items():
        if name in given:
            array = given.pop(name)
            if not isinstance(array, np.ndarray):
                raise ArgumentError(f'out["{name}"]: a {type(array).__name__}; give a numpy array to write into')
            if array.shape != (height, width, components):
                raise ArgumentError(f'out["{name}"] has shape {array.shape}; it must be {(height, width, components)}')
            arrays[name] = array
        else:
            arrays[name] = np.empty((height, width, components), np.float32)
    if given:
        name = next(iter(given))
        raise UnknownNameError(f'out["{name}"]: the rig makes no such AOV; {_nearest(name, list(arrays))}')
    report = _relume.relight(gbuffer._gbuffer, rig._rig, arrays, _thread_count(threads), progress, step)
    return Relit(arrays, report)


def relight_file(
    gbuffer: AnyGBuffer,
    rig: AnyRig,
    path: str | os.PathLike[str],
    threads: int | None = None,
    progress: Progress | None = None,
) -> Report:
    """Relight into an EXR, in bands: the whole frame is never in memory. The file appears when it is whole.

    Args:
        gbuffer: a G-buffer, or the path of an EXR.
        rig: a Rig, the path of a rig file, the name of a built-in one ("outdoor"), or TOML text. Its [output] says
            type, compression and AOVs.
        path: the EXR to write.
        threads: how many; as many as the process may use when None.
        progress: called a few times a second with the share done, 0…1.

    Raises:
        FileError: the folder is missing or not writable, the disk is full. What stood at ``path`` is still there.
        RigError: the rig has no lights.
        ChannelError: a channel that a light or shader needs is missing.
    """
    rig = _rig_of(rig)
    gbuffer = _gbuffer_of(gbuffer, rig)
    return _relume.relight_file(gbuffer._gbuffer, rig._rig, Path(path), _thread_count(threads), progress)
