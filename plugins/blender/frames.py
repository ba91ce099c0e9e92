# SPDX-License-Identifier: Apache-2.0
"""A render's passes in memory, as arrays: a light that moves costs shading and nothing else."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import bpy
import numpy as np
import relume

if TYPE_CHECKING:
    from collections.abc import Iterator

    from .lights import RigLight
    from .linking import Linking

#: Channels that every relight reads where there are such.
_ALWAYS = ("normal", "beauty", "alpha", "coverage", "position", "depth", "tangent", "ambient_occlusion", "emission")

#: What only the first of several passes over a frame may add.
_ONCE = ("beauty", "emission")

#: A light that adds nothing, so that a frame without lights still shows what glows and what stands behind.
_DARK = "no light"


class NoFrameError(Exception):
    """There is no render to relight; the message says what to do."""


def save_render_result(scene: bpy.types.Scene, folder: Path) -> Path:
    """The render that was just made, every pass, as a 32-bit EXR.

    Raises:
        NoFrameError: nothing has been rendered.
    """
    path = folder / "render.exr"
    settings = scene.render.image_settings
    names = ["media_type", "file_format", "color_depth", "exr_codec"]
    before = {name: getattr(settings, name) for name in names if hasattr(settings, name)}
    try:
        if "media_type" in before:
            settings.media_type = "MULTI_LAYER_IMAGE"
        settings.file_format, settings.color_depth, settings.exr_codec = "OPEN_EXR_MULTILAYER", "32", "NONE"
        bpy.data.images["Render Result"].save_render(str(path), scene=scene)
    except (KeyError, RuntimeError) as error:
        raise NoFrameError("no render yet: render the frame (F12), or choose an EXR on disk") from error
    finally:
        for name, value in before.items():
            setattr(settings, name, value)
    return path


@dataclass
class _Scale:
    """The frame, or every second pixel of it: views of the same arrays."""

    frame: relume.GBuffer
    #: Without what only one of several passes may add.
    further: relume.GBuffer
    #: Top row first.
    pixels: np.ndarray[Any, Any]


class LoadedFrame:
    """A frame in memory: the channels that a rig reads, and mattes as lights ask for them."""

    def __init__(self, file: relume.GBuffer, rig: relume.Rig) -> None:
        self._file = file
        self._mattes: dict[tuple[str, ...], np.ndarray[Any, Any]] = {}
        self.notes = [*file.notes]
        present = {info.name for info in file.channels}
        wanted = dict.fromkeys(name for name in _ALWAYS if name in present)
        for use in rig.shader:
            wanted |= dict.fromkeys(row.name for row in use.parameters if row.name in present)
        arrays = file.load(*wanted)
        spread = "normal_variance" in present
        self._options: dict[str, Any] = {"working_space": file.working_space}
        self._options["normal_variance"] = "on" if spread else "off"
        if spread:
            arrays["normal"] = _stored_normal(file)
            if "coverage" in arrays:
                # As a renderer leaves it: what is divided by coverage already counts as no mean.
                arrays["normal"] *= arrays["coverage"][..., None]
                self._options["channels"] = {"normal": {"premultiplied": True}}
        self._rig = self._of_arrays(rig, arrays)
        _fold_constants(self._rig, arrays)
        self._arrays = arrays
        if "position" not in arrays:
            self._options["camera"] = file.camera
        self._scales: dict[int, _Scale] = {}
        height, width = file.shape
        #: Bottom row first, as Blender has its images.
        self.pixels = np.zeros((height, width, 4), np.float32)

    @classmethod
    def read(cls, path: Path, rig: relume.Rig, frame: int | None = None) -> LoadedFrame:
        """Load a multilayer EXR.

        Raises:
            relume.Error: there is none, or it has no normals.
        """
        return cls(relume.GBuffer.read(path, rig=rig, frame=frame), rig)

    @classmethod
    def rendered(cls, scene: bpy.types.Scene, rig: relume.Rig) -> LoadedFrame:
        """Load the render that was just made.

        Raises:
            NoFrameError: there is none.
            relume.Error: it has no normals.
        """
        with tempfile.TemporaryDirectory(prefix="relume-") as folder:
            return cls.read(save_render_result(scene, Path(folder)), rig)

    @property
    def size(self) -> tuple[int, int]:
        """(width, height)."""
        height, width = self.pixels.shape[:2]
        return width, height

    def _of_arrays(self, rig: relume.Rig, arrays: dict[str, Any]) -> relume.Rig:
        """The rig as arrays need it: what a file's header and Cryptomatte say is said outright."""
        result = rig.copy()
        ids: np.ndarray[Any, Any] | None = None
        for place, use in enumerate(result.shader, start=1):
            rows = {row.name for row in use.parameters}
            if "generation" in rows and use.generation == "auto":
                use.generation = "3" if _blender_version(self._file.producer) < (4, 0) else "5"
            if "emission_is" in rows and use.emission_is == "auto" and "emission" in arrays:
                reason = next(info.reason for info in self._file.channels if info.name == "emission")
                use.emission_is = "seen" if "Emission pass" in reason else "emitted"
            if use.cryptomatte:
                if ids is None:
                    ids = np.zeros(self._file.shape, np.uint32)
                # Where several share a pixel, it is that one's which has most of it.
                ids[(self.matte(tuple(use.cryptomatte)) > 0.5) & (ids == 0)] = place
                use.cryptomatte = []
                use.material_id = [place]
        if ids is not None:
            arrays["material_id"] = ids
        return result

    def matte(self, patterns: tuple[str, ...]) -> np.ndarray[Any, Any]:
        """Share of each pixel that objects or materials of these names have."""
        if patterns not in self._mattes:
            self._mattes[patterns] = self._file.matte(*patterns)
        return self._mattes[patterns]

    @property
    def has_proxy(self) -> bool:
        """Whether every second pixel can stand for four: with a camera in place of positions it cannot."""
        return "position" in self._arrays

    def relight(self, lights: list[RigLight], step: int = 1) -> relume.Report:
        """Relight into ``pixels``. Light linking is by the Cryptomatte of the objects.

        Args:
            lights: of the scene.
            step: 2 shades every second pixel of every second row, which then stands for four.

        Raises:
            relume.Error: a channel is missing that a light or the model needs.
        """
        scale = self._scale(step)
        report = None
        for linking, some in _by_linking(lights):
            rig = self._rig.copy()
            rig.output.aovs = []
            for light in some:
                keys = {key: value for key, value in light.keys.items() if key not in ("include", "exclude")}
                rig.light.add(f"{len(rig.light)}", light.type, **keys)
            if linking is None:
                if not len(rig.light):
                    rig.light.add(_DARK, "ambient", irradiance=0.0)
                report = relume.relight(scale.frame, rig, out={"beauty": scale.pixels}).report
            else:
                part = relume.relight(scale.further, rig)["beauty"]
                scale.pixels[..., :3] += part[..., :3] * self._share(linking)[::step, ::step, None]
        assert report is not None
        if step > 1:
            wide = np.repeat(scale.pixels, step, axis=1)[:, : self.size[0]]
            for row in range(step):
                rows = self.pixels[::-1][row::step]
                rows[...] = wide[: len(rows)]
        return report

    def _scale(self, step: int) -> _Scale:
        if step not in self._scales:
            arrays = {name: array[::step, ::step] for name, array in self._arrays.items()}
            later = {name: array for name, array in arrays.items() if name not in _ONCE}
            pixels = self.pixels[::-1] if step == 1 else np.zeros((*arrays["normal"].shape[:2], 4), np.float32)
            frame = relume.GBuffer(**self._options, **arrays)
            self._scales[step] = _Scale(frame, relume.GBuffer(**self._options, **later), pixels)
        return self._scales[step]

    def _share(self, linking: Linking) -> np.ndarray[Any, Any]:
        share = self.matte(linking.include) if linking.include else np.ones(self._file.shape, np.float32)
        return share * (1 - self.matte(linking.exclude)) if linking.exclude else share


def _stored_normal(file: relume.GBuffer) -> np.ndarray[Any, Any]:
    """The normals as the file has them, divided by coverage: a mean over the pixel is shorter than 1, and that widens
    highlights."""
    stored = next(info.sources for info in file.channels if info.name == "normal")
    planar = np.empty((3, *file.shape), np.float32)
    file.load(*stored, out=dict(zip(stored, planar, strict=True)))
    return np.moveaxis(planar, 0, -1)


def _fold_constants(rig: relume.Rig, arrays: dict[str, Any]) -> None:
    """What is the same in every pixel that has a surface is a constant of the rig: less to keep and to read."""
    surface = np.abs(arrays["normal"]).max(axis=-1) > 0
    if not surface.any():
        return
    first = np.unravel_index(np.argmax(surface), surface.shape)
    rows = {row.name: row for use in rig.shader for row in use.parameters if row.type in ("scalar", "color")}
    for name in [name for name in arrays if name in rows]:
        array = arrays[name]
        value, differs = array[first], array != array[first]
        if (differs.any(axis=-1) if differs.ndim == 3 else differs)[surface].any():
            continue
        if not (value >= rows[name].min).all() or not (value <= rows[name].max).all():
            continue  # a channel is clamped, a constant of a rig would be refused
        del arrays[name]
        for use in rig.shader:
            if name in (row.name for row in use.parameters) and name not in use._given():
                setattr(use, name, tuple(map(float, value)) if array.ndim == 3 else float(value))


def _by_linking(lights: list[RigLight]) -> Iterator[tuple[Linking | None, list[RigLight]]]:
    """Lights by what they reach; first those (or none) that reach everything."""
    parts: dict[Linking, list[RigLight]] = {}
    for light in lights:
        parts.setdefault(light.linking, []).append(light)
    everything = [light for light in lights if not any(light.linking)]
    yield None, everything
    for linking, some in parts.items():
        if any(linking):
            yield linking, some


def _blender_version(producer: str) -> tuple[int, int]:
    """(major, minor) of "Blender 5.0.1"; of this Blender where the file does not say."""
    words = producer.split()
    numbers = words[1].split(".") if len(words) > 1 else []
    if words[:1] == ["Blender"] and len(numbers) >= 2 and all(number.isdigit() for number in numbers[:2]):
        return int(numbers[0]), int(numbers[1])
    return bpy.app.version[:2]


def newest(path: Path, frame: int) -> tuple[str, int]:
    """What tells whether a file has changed since it was loaded."""
    from relume.frames import resolve_frame

    name = resolve_frame(str(path), frame)
    try:
        return name, Path(name).stat().st_mtime_ns
    except OSError:
        return name, 0
