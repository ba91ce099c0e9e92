# SPDX-License-Identifier: Apache-2.0
"""The G-buffer: read from files, or made from numpy arrays without a copy."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from relume import _relume
from relume.errors import ArgumentError, ChannelError
from relume.rig import Rig

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, DTypeLike, NDArray

    from relume._relume import Camera, ChannelInfo

__all__ = ["GBuffer"]

# As a rule of [gbuffer.channels]: a channel, layer or file, or a mapping of the rule's keys.
ChannelRules = Mapping[str, "str | os.PathLike[str] | Mapping[str, object]"]

_IDS = ("object_id", "material_id", "shading_model_id")


class GBuffer:
    """What a renderer knows of each pixel: normal, base colour, roughness, position, ….

    ``GBuffer.read(path)`` understands an EXR; ``GBuffer(normal=…, base_color=…)`` takes arrays in memory::

        gbuffer = relume.GBuffer(normal=n, base_color=c, roughness=r, position=p, camera=matrix)

    Arrays are float32 or float16, IDs uint32 too, (height, width) or (height, width, components), of any strides; they
    are not copied, and what they hold when relight() runs is what is shaded. ``gbuffer["normal"]`` gives a channel in
    canonical form: decoded, in world space and working space, divided by coverage.
    """

    _gbuffer: _relume.GBuffer
    _arrays: dict[str, NDArray[Any]]

    def __init__(
        self,
        *,
        normal: ArrayLike,
        channels: ChannelRules | None = None,
        camera: ArrayLike | Mapping[str, object] | Camera | None = None,
        alpha: ArrayLike | str | None = None,
        working_space: str | None = None,
        normal_variance: str | None = None,
        **arrays: ArrayLike,
    ) -> None:
        """Take arrays in memory.

        Args:
            normal: (H, W, 3) surface normals, 0 on background. World space and -1..1 unless ``channels`` says
                otherwise.
            channels: how arrays are stored, by name: ``{"normal": {"space": "camera", "encoding": "0..1"}}``. The keys
                are those of a rig's [gbuffer.channels].
            camera: (4, 4) camera-to-world matrix (column vectors, looks down -Z, +Y up), or a mapping of the keys of a
                rig's [camera]: ``{"matrix": m, "fov": 39.6}``, or the camera of another G-buffer. Recovered from
                ``position`` where that is given.
            alpha: (H, W) the beauty's alpha; or "premultiplied" or "straight", which is what the beauty's colours are.
            working_space: what the colours are in, "lin_rec709" by default.
            normal_variance: "on", "off" or "auto" (the default): whether a normal shorter than 1 is a mean over the
                pixel, which widens the pixel's highlights.
            arrays: by semantic name. beauty (H, W, 3 or 4), coverage, position (H, W, 3), view (H, W, 3) unit
                to the camera, depth, base_color (H, W, 3), roughness, metallic, specular, emission (H, W, 3),
                ambient_occlusion, opacity, tangent (H, W, 3), object_id, material_id, shading_model_id; and any
                parameter of any shader.

        Raises:
            ArgumentError: an array of another dtype or shape; the message says how to convert.
            UnknownNameError: a name that no shader and no rule knows; the message has the nearest.
        """
        mode = alpha if isinstance(alpha, str) else None
        given = {"normal": normal, "alpha": None if mode else alpha} | arrays
        self._arrays = {name: _without_copy(name, array) for name, array in given.items() if array is not None}
        options = _options(None, None, None, mode, working_space, normal_variance, channels, camera)
        self._gbuffer = _relume.GBuffer.from_arrays(self._arrays, options._rig)
        _check_camera(camera, self._gbuffer.camera)

    @classmethod
    def read(
        cls,
        path: str | os.PathLike[str] | None = None,
        *,
        rig: Rig | None = None,
        frame: int | None = None,
        part: str | None = None,
        view: str | None = None,
        alpha: str | None = None,
        working_space: str | None = None,
        normal_variance: str | None = None,
        channels: ChannelRules | None = None,
        camera: ArrayLike | Mapping[str, object] | Camera | None = None,
        max_pixels: int | None = None,
        threads: int | None = None,
    ) -> GBuffer:
        """Understand a file. Its headers and a few of its rows are read now, its pixels when they are needed.

        Args:
            path: an EXR, multilayer or multi-part. May be left out where the rig or ``channels`` name files.
            rig: its [gbuffer] and [camera] are heeded; the arguments below go before them.
            frame: replaces ####, %04d or {frame} in the path and in the rig's and ``channels``' file names; the rig's
                own [gbuffer] frame when None.
            part: layer or part to take when the file holds several.
            view: "left", … of a stereo file.
            alpha: "premultiplied" or "straight".
            working_space: what the colours are in, where the file does not say or is wrong.
            normal_variance: as in GBuffer().
            channels: by semantic name a channel, layer or further file, or a mapping of the keys of a rig's
                [gbuffer.channels]: ``{"normal": {"channel": "N", "space": "camera"}}``. Files that are not EXR (PNG,
                JPEG, TIFF) are read by the package OpenImageIO: sRGB is decoded for colours of 8 bits, vectors are
                0..1.
            camera: as in GBuffer(); for files whose header and positions have none.
            max_pixels: a file that claims more is refused; 2^30 when neither this nor the rig says.
            threads: how many; as many as the process may use when None.

        Raises:
            FileError: the file is missing or cannot be read.
            FormatError: it is not an EXR, or damaged.
            ChannelError: it has no normal, or several and nothing says which; further files of another size.
            UnknownNameError: an argument that no rig knows.
        """
        options = _options(rig, part, view, alpha, working_space, normal_variance, channels, camera)
        if max_pixels is not None:
            options.gbuffer.max_pixels = max_pixels
        main = main_file(path, options)
        if frame is None:
            frame = options._rig.frame
        if frame is not None:
            from relume.frames import resolve_frame

            main = resolve_frame(main, frame)
            options._rig = options._rig.of_frame(frame)
        from relume.images import install_reader

        install_reader()
        result = cls.__new__(cls)
        result._arrays = {}
        result._gbuffer = _relume.GBuffer.read(Path(main), options._rig, _thread_count(threads))
        _check_camera(camera, result._gbuffer.camera)
        return result

    @property
    def shape(self) -> tuple[int, int]:
        """(height, width) of the data window, as of every array."""
        _, _, width, height = self._gbuffer.data_window
        return height, width

    @property
    def data_window(self) -> tuple[int, int, int, int]:
        """(x, y, width, height) of the pixels that there are; x and y may be negative."""
        return self._gbuffer.data_window

    @property
    def display_window(self) -> tuple[int, int, int, int]:
        """(x, y, width, height) of the picture that the camera frames."""
        return self._gbuffer.display_window

    @property
    def pixel_aspect(self) -> float:
        """Width of a pixel over its height."""
        return self._gbuffer.pixel_aspect

    @property
    def channels(self) -> list[ChannelInfo]:
        """What was understood of each channel, and why."""
        return self._gbuffer.channels

    @property
    def camera(self) -> Camera | None:
        """The camera; ``camera.matrix`` is (4, 4) float64. None when nothing gives one."""
        return self._gbuffer.camera

    @property
    def camera_reason(self) -> str:
        """Where the camera comes from."""
        return self._gbuffer.camera_reason

    @property
    def camera_error(self) -> float:
        """Median reprojection error, in pixels, of a camera recovered from positions; else 0."""
        return self._gbuffer.camera_error

    @property
    def notes(self) -> list[str]:
        """What is missing and what is assumed instead."""
        return self._gbuffer.notes

    @property
    def producer(self) -> str:
        """ "Blender 5.0.1", "Arnold", …, or "unknown"."""
        return self._gbuffer.producer

    @property
    def working_space(self) -> str:
        """What the colours are in."""
        return self._gbuffer.working_space

    @property
    def cryptomatte(self) -> dict[str, list[str]]:
        """Names in the Cryptomatte manifests, by layer."""
        return self._gbuffer.cryptomatte

    def keep_channels(self, bytes: int) -> None:
        """Have a file read once: what relights ask for is kept, and a relight with other lights only shades.

        Pixels are the same. A file that is written again meanwhile is not looked at: read it anew.

        Args:
            bytes: of memory at the most, 4 for each number of a pixel; what does not fit is read every time.
        """
        self._gbuffer.keep_channels(bytes)

    def __contains__(self, name: object) -> bool:
        return any(info.name == name for info in self.channels)

    def load(
        self,
        *names: str,
        dtype: DTypeLike = "float32",
        out: Mapping[str, NDArray[Any]] | None = None,
        threads: int | None = None,
    ) -> dict[str, NDArray[Any]]:
        """Channels in canonical form, all in one multi-threaded pass over the file. The GIL is released meanwhile.

        Args:
            names: semantic names of ``channels``, or names of channels or layers in the file.
            dtype: float32 or float16 of the arrays that are made; IDs are uint32 always.
            out: arrays to read into, by name: float32, float16 or (IDs) uint32, any strides. What is not given is made.
            threads: how many; as many as the process may use when None.

        Returns:
            By name (H, W, 3) or (H, W) arrays, views of planar memory. Row 0 is the top of the data window. Normals are
            unit, in world space, 0 on background; colours linear, in the working space; both divided by coverage. What
            is asked for by the file's own names is not converted, only divided by coverage where samples were averaged.

        Raises:
            ChannelError: there is none of that name.
            ArgumentError: an array of ``out`` has another shape or dtype.
        """
        import numpy as np

        requests = [self._request(name) for name in names]
        given = dict(out or {})
        height, width = self.shape
        arrays: dict[str, NDArray[Any]] = {}
        for name, (_, components, kind) in zip(names, requests, strict=True):
            if name in given:
                arrays[name] = given.pop(name)
                continue
            planar = np.empty((components, height, width), np.uint32 if kind == "id" else dtype)
            arrays[name] = planar[0] if components == 1 else np.moveaxis(planar, 0, -1)
        if given:
            raise ArgumentError(f"out has '{next(iter(given))}', which is none of the channels to load")
        self._gbuffer.load([r for r, _, _ in requests], list(arrays.values()), _thread_count(threads))
        return arrays

    def _request(self, name: str) -> tuple[_relume.ChannelRequest, int, str]:
        """What to ask the core for, its components, and its kind."""
        for info in self.channels:
            if info.name == name:
                if name in _IDS:
                    return _relume.ChannelRequest.id(name), 1, "id"
                return _relume.ChannelRequest.semantic(name, info.components), info.components, "semantic"
        return _relume.ChannelRequest.raw(name, 1), 1, "raw"

    def channel(self, name: str) -> NDArray[Any]:
        """One channel in canonical form: ``load(name)[name]``.

        Args:
            name: a semantic name of ``channels``, or the name of a channel or layer in the file.

        Returns:
            (H, W, 3) or (H, W) float32, a new array. Normals are unit, in world space, 0 on background; colours
            linear, in the working space; both divided by coverage. IDs are uint32.

        Raises:
            ChannelError: there is none of that name.
        """
        try:
            return self.load(name)[name]
        except ChannelError:
            names = [info.name for info in self.channels]
            if name in names:
                raise
            near = _relume.nearest_name(name, names)
            hint = f"did you mean '{near}'?" if near else f"there are {', '.join(names)}"
            raise ChannelError(f"the G-buffer has no channel '{name}'; {hint}") from None

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self.channel(name)

    def matte(self, *patterns: str) -> NDArray[np.float32]:
        """(H, W) float32: share of each pixel that Cryptomatte objects or materials of these names have;
        "object:NAME" and "material:NAME" mean one kind.

        Args:
            patterns: names, with * and ?.

        Raises:
            ChannelError: there is no Cryptomatte.
        """
        import numpy as np

        coverage = np.empty(self.shape, np.float32)
        self._gbuffer.load([_relume.ChannelRequest.matte(list(patterns))], [coverage], 0)
        return coverage

    def __repr__(self) -> str:
        height, width = self.shape
        return f"<GBuffer {width} × {height}: {', '.join(info.name for info in self.channels)}>"


def _thread_count(threads: int | None) -> int:
    if threads is None:
        return 0
    if threads < 1:
        raise ArgumentError(f"threads is {threads}; give 1 or more, or None for as many as the process may use")
    return threads


def _without_copy(name: str, array: object) -> NDArray[Any]:
    import numpy as np

    if isinstance(array, np.ndarray):
        return array
    # Lists would have to be converted, and a conversion that nobody sees is a copy that nobody wants.
    if isinstance(array, (Sequence, int, float)) or not hasattr(array, "__array__"):
        raise ArgumentError(
            f"{name}: a {type(array).__name__}; give a numpy array, as numpy.asarray({name}, numpy.float32)"
        )
    return np.asarray(array)


def _options(
    rig: Rig | None,
    part: str | None,
    view: str | None,
    alpha: str | None,
    working_space: str | None,
    normal_variance: str | None,
    channels: ChannelRules | None,
    camera: ArrayLike | Mapping[str, object] | Camera | None,
) -> Rig:
    """A rig whose [gbuffer] and [camera] say all that was given."""
    options = rig.copy() if rig is not None else Rig()
    words = {
        "part": part,
        "view": view,
        "alpha": alpha,
        "working_space": working_space,
        "normal_variance": normal_variance,
    }
    for key, word in words.items():
        if word is not None:
            setattr(options.gbuffer, key, word)
    for name, rule in (channels or {}).items():
        if isinstance(rule, Mapping) and name in options.gbuffer.channels:
            for key, value in rule.items():  # beside what the rig says of it
                setattr(options.gbuffer.channels[name], str(key), value)
        else:
            options.gbuffer.channels[name] = rule
    if isinstance(camera, Mapping):
        for key, value in camera.items():
            setattr(options.camera, str(key), value)
    elif isinstance(camera, _relume.Camera):
        options.camera.matrix = camera.matrix
        options.camera.projection = camera.projection
        if camera.projection == "perspective":
            options.camera.fov = 2 * math.degrees(math.atan(-camera.x_offset))
        else:
            options.camera.width = -2 * camera.x_offset
    elif camera is not None:
        import numpy as np

        try:
            matrix = np.asarray(camera, dtype=np.float64)
        except (TypeError, ValueError):
            raise ArgumentError(f"camera: a {type(camera).__name__}; give a (4, 4) matrix, camera to world") from None
        if matrix.shape != (4, 4):
            raise ArgumentError(f"camera: a matrix of shape {matrix.shape}; give (4, 4), camera to world")
        options.camera.matrix = matrix
    return options


def _check_camera(given: object, taken: Camera | None) -> None:
    """A camera of another G-buffer is handed on as a field of view, which says nothing of crops and lens shifts."""
    if not isinstance(given, _relume.Camera):
        return
    import numpy as np

    lens = [(c.x_scale, c.x_offset, c.y_scale, c.y_offset) for c in (given, taken) if c is not None]
    if len(lens) < 2 or not np.allclose(lens[0], lens[1], rtol=1e-6, atol=1e-9):
        raise ArgumentError(
            "camera: it is of a picture of another size, or off-centre; give positions, or matrix and fov"
        )


def main_file(path: str | os.PathLike[str] | None, options: Rig) -> str:
    if path is not None:
        return os.fspath(path)
    source = options._rig.main_file()
    if source:
        return source
    raise ArgumentError("no file to read: give one, a rig with [gbuffer] file, or a file for the channel normal")
