# SPDX-License-Identifier: Apache-2.0
"""A render whose passes are read once: a light that moves costs shading and nothing else.

The frame is the file's own G-buffer and the rig is the scene's, as the command line would have them, so that it gives
the same bits.
"""

from __future__ import annotations

import shutil
import tempfile
import weakref
from pathlib import Path
from typing import TYPE_CHECKING, Any

import bpy
import numpy as np
import relume

from .passes import refuses_parts

if TYPE_CHECKING:
    from .lights import RigLight

#: A light that adds nothing, so that a frame without lights still shows what glows and what stands behind.
_DARK = "no light"

#: Bytes that a frame may take: what a rig asks for and no more, however large the frame is.
_ALL = 1 << 62


class NoFrameError(Exception):
    """There is no render to relight; the message says what to do."""


def save_render_result(scene: bpy.types.Scene, folder: Path) -> Path:
    """The render that was just made, every pass, as a 32-bit EXR.

    Raises:
        NoFrameError: nothing has been rendered, or there is no room for it.
    """
    path = folder / "render.exr"
    settings = scene.render.image_settings
    names = ["media_type", "file_format", "color_depth", "exr_codec", "use_exr_interleave"]
    before = {name: getattr(settings, name) for name in names if hasattr(settings, name)}
    try:
        if "media_type" in before:
            settings.media_type = "MULTI_LAYER_IMAGE"
        settings.file_format, settings.color_depth, settings.exr_codec = "OPEN_EXR_MULTILAYER", "32", "NONE"
        if refuses_parts(scene):
            settings.use_exr_interleave = True
        bpy.data.images["Render Result"].save_render(str(path), scene=scene)
    except KeyError as error:
        raise NoFrameError("no render yet: render the frame (F12), or choose an EXR on disk") from error
    except RuntimeError as error:
        advice = f"render the frame (F12), free space in {folder.parent}, or choose an EXR on disk"
        raise NoFrameError(f"the render cannot be taken ({str(error).strip()}): {advice}") from error
    finally:
        for name, value in before.items():
            setattr(settings, name, value)
    if not path.exists() or not relume.ExrFile(path).is_whole():  # Blender says nothing of it
        raise NoFrameError(f"the render could not be kept in {folder.parent}: free space there, or set TMPDIR")
    return path


class LoadedFrame:
    """A frame, what relights have asked of it, and the picture.

    Attributes:
        rig: everything but the scene's lights.
        pixels: (H, W, 4), bottom row first, as Blender has its images.
    """

    def __init__(self, file: relume.GBuffer, rig: relume.Rig) -> None:
        self.rig = rig
        self.notes = [*file.notes]
        self._file = file
        file.keep_channels(_ALL)
        height, width = file.shape
        self.pixels = np.zeros((height, width, 4), np.float32)
        self._proxies: dict[int, np.ndarray[Any, Any]] = {}

    @classmethod
    def read(cls, path: Path, rig: relume.Rig, frame: int | None = None) -> LoadedFrame:
        """Understand a multilayer EXR.

        Raises:
            relume.Error: there is none, or it has no normals.
        """
        return cls(relume.GBuffer.read(path, rig=rig, frame=frame), rig)

    @classmethod
    def rendered(cls, scene: bpy.types.Scene, rig: relume.Rig) -> LoadedFrame:
        """Take the render that was just made; a temporary file holds it as long as the frame is there.

        Raises:
            NoFrameError: there is none.
            relume.Error: it has no normals.
        """
        folder = Path(tempfile.mkdtemp(prefix="relume-"))
        try:
            frame = cls.read(save_render_result(scene, folder), rig)
        except BaseException:
            shutil.rmtree(folder, ignore_errors=True)
            raise
        weakref.finalize(frame, shutil.rmtree, folder, ignore_errors=True)
        return frame

    @property
    def size(self) -> tuple[int, int]:
        """(width, height)."""
        height, width = self.pixels.shape[:2]
        return width, height

    def relight(self, scene: bpy.types.Scene, lights: list[RigLight], step: int = 1) -> relume.Report:
        """Relight into ``pixels``.

        Args:
            scene: whose frame and rig this is.
            lights: of the scene; they join those of the rig.
            step: 2 shades every second pixel of every second row, which then stands for four.

        Raises:
            relume.Error: a channel is missing that a light or the model needs; a light is none for this frame.
        """
        from .scene_rig import add_lights, order_of_lights

        rig = self.rig.at(scene.frame_current)
        rig.output.aovs = []
        add_lights(rig, lights, order_of_lights(scene))
        if not len(rig.light):
            rig.light.add(_DARK, "ambient", irradiance=0.0)
        pixels = self.pixels[::-1] if step == 1 else self._proxy(step)
        report = relume.relight(self._file, rig, out={"beauty": pixels}, step=step).report
        if step > 1:
            _spread(pixels, self.pixels[::-1], step)
        return report

    def _proxy(self, step: int) -> np.ndarray[Any, Any]:
        if step not in self._proxies:
            width, height = self.size
            self._proxies[step] = np.zeros((-(-height // step), -(-width // step), 4), np.float32)
        return self._proxies[step]


def _spread(small: np.ndarray[Any, Any], pixels: np.ndarray[Any, Any], step: int) -> None:
    """Have each pixel of a proxy stand for the `step` × `step` that it is one of."""
    # A pixel of four floats is moved as one number of 16 bytes.
    ones, wide = (array.view(np.complex128)[..., 0] for array in (small, pixels))
    first = wide[::step]
    for column in range(step):
        part = first[:, column::step]
        part[...] = ones[:, : part.shape[1]]
    for row in range(1, step):
        rows = wide[row::step]
        rows[...] = first[: len(rows)]


def newest(path: Path, frame: int) -> tuple[object, ...]:
    """What tells whether a file has changed since it was read."""
    from relume.frames import resolve_frame

    name = resolve_frame(str(path), frame)
    try:
        status = Path(name).stat()
    except OSError:
        return (name,)
    return name, status.st_mtime_ns, status.st_size, status.st_ino
