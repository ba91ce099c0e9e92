# SPDX-License-Identifier: Apache-2.0
"""The layers of any EXR, and how to look at each: a colour, a direction, a depth, an ID."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from relume import _relume
from relume.errors import ChannelError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relume._relume import ExrFile

__all__ = ["Kind", "Layer", "find_layer", "layers_of", "read_layer", "space_of", "viewable"]

Kind = Literal["color", "normal", "position", "depth", "id", "value"]

# Blender's background; whatever is this far is no surface.
_FAR = 1e9
_COMPONENT_SETS = ("RGBA", "RGB", "XYZ", "XYZW", "UVA", "XY", "UV")


@dataclass(frozen=True)
class Layer:
    """Channels of one part that belong together.

    Attributes:
        name: "diffuse", "ViewLayer.Normal"; "" for the channels R, G, B, A without a name.
        part: index of the part.
        channels: full names, in the order R G B A or X Y Z.
        kind: what its numbers mean, by the names.
        ids: stored as whole numbers.
    """

    name: str
    part: int
    channels: tuple[str, ...]
    kind: Kind
    ids: bool = False

    @property
    def title(self) -> str:
        """What a list of layers calls it."""
        return self.name or "beauty"


def _kind(name: str, letters: str, integer: bool) -> Kind:
    words = name.lower().replace("_", ".").replace(" ", ".").split(".")
    label = words[-1] if words else ""
    if integer or label.startswith(("index", "id", "crypto")) or label.endswith(("id", "index")) or "index" in words:
        return "id"
    if label in ("n", "normal", "normals", "tangent", "worldnormal", "cameranormal", "ns", "nn", "view"):
        return "normal"
    if label in ("p", "position", "pref", "worldposition") or (letters == "XYZ" and "position" in label):
        return "position"
    if len(letters) <= 1:
        return "depth" if letters == "Z" or label in ("z", "depth", "zdepth", "worlddepth") else "value"
    return "color" if set("RGB") <= set(letters.upper()) else "value"


def layers_of(file: ExrFile) -> list[Layer]:
    """The layers of a file in the order of its parts; deep parts are left out."""
    layers: list[Layer] = []
    for index, part in enumerate(file.parts):
        if part.deep:
            continue
        groups: dict[str, dict[str, str]] = {}
        integers = {name for name, dtype in part.channels if dtype == "uint32"}
        for name, _ in part.channels:
            stem, _, letter = name.rpartition(".")
            if len(letter) > 1 and letter.lower() in ("red", "green", "blue", "alpha"):
                groups.setdefault(stem, {})[letter[0].upper()] = name
            elif len(letter) > 1:
                groups.setdefault(name, {})[""] = name
            else:
                groups.setdefault(stem, {})[letter.upper()] = name
        for stem, members in groups.items():
            layers += _split(stem or part.name, index, members, integers)
    return layers


def _split(name: str, part: int, members: dict[str, str], integers: set[str]) -> list[Layer]:
    """One layer for a known set of components, and one for each that is left over (R, G, B, A and a Z beside them)."""
    result: list[Layer] = []
    left = dict(members)
    for letters in _COMPONENT_SETS:
        if set(letters) <= set(left):
            channels = tuple(left.pop(letter) for letter in letters)
            integer = any(channel in integers for channel in channels)
            result.append(Layer(name, part, channels, _kind(name, letters, integer), integer))
    for letter, channel in left.items():
        full = channel if result or len(left) > 1 else (name or channel)
        result.append(Layer(full, part, (channel,), _kind(full, letter, channel in integers), channel in integers))
    return result


def find_layer(file: ExrFile, name: str | None) -> Layer:
    """The layer of a name: the full one, else its last words ("Normal" for "ViewLayer.Normal"); the beauty for None.

    "light:key.001", an AOV as a rig names it, finds its layer "light_key_001".

    Raises:
        ChannelError: there is none, or several; the message has the nearest name or the candidates.
    """
    layers = layers_of(file)
    if not layers:
        raise ChannelError(f"{file.path}: has no channels that can be looked at")
    if name is None:
        for wanted in ("", "beauty", "combined", "rgba"):
            for layer in layers:
                if layer.name.rpartition(".")[2].lower() == wanted and layer.kind == "color":
                    return layer
        return next((layer for layer in layers if layer.kind == "color"), layers[0])
    aov = name.translate(str.maketrans(":. ", "___")) if name.startswith("light:") else name
    exact = [layer for layer in layers if layer.name == aov or name in (layer.name, layer.title)]
    if exact:
        return exact[0]
    folded = name.lower()
    ends = [layer for layer in layers if layer.name.lower() == folded or layer.name.lower().endswith(f".{folded}")]
    if len(ends) == 1:
        return ends[0]
    channel = [
        Layer(full, layer.part, (full,), _kind(full, full.rpartition(".")[2].upper(), layer.ids), layer.ids)
        for layer in layers
        for full in layer.channels
        if full == name
    ]
    if channel:
        return channel[0]
    if ends:
        raise ChannelError(
            f"{file.path}: several layers are called '{name}': {', '.join(layer.title for layer in ends)}"
        )
    titles = [layer.title for layer in layers]
    near = _relume.nearest_name(name, titles) or _relume.nearest_name(name, [t.rpartition(".")[2] for t in titles])
    hint = f"did you mean '{near}'?" if near else f"it has {', '.join(titles)}"
    raise ChannelError(f"{file.path}: no layer '{name}'; {hint}")


def read_layer(path: str | os.PathLike[str], name: str | None = None) -> NDArray[Any]:
    """The pixels of one layer of any EXR.

    Args:
        path: the file.
        name: a layer, its last words, or a channel; the beauty when None.

    Returns:
        (H, W, C) over the layer's data window, as stored: float32, or uint32 for whole numbers.

    Raises:
        FileError: the file is missing.
        FormatError: it is not an EXR, or damaged.
        ChannelError: it has no such layer.
    """
    file = _relume.ExrFile(Path(path))
    return pixels_of(file, find_layer(file, name))


def space_of(file: ExrFile, part: int) -> str | list[float]:
    """What the colours of a part are in, for Display(space=…): as its header says, else lin_rec709."""
    attributes = [file.parts[index].attributes for index in (part, 0)]
    for header in attributes:
        name = header.get("colorInteropID")
        if isinstance(name, str) and _relume.space_chromaticities(name) is not None:
            return name
    for header in attributes:
        numbers = header.get("chromaticities")
        if isinstance(numbers, list) and len(numbers) == 8:
            return _relume.space_name(numbers) or numbers
    return "lin_rec709"


def pixels_of(file: ExrFile, layer: Layer) -> NDArray[Any]:
    """(H, W, C) of a layer, uint32 where it is stored so, else float32."""
    if layer.ids:
        return file.read_uint32(layer.part, list(layer.channels))
    return file.read(layer.part, list(layer.channels))


def viewable(pixels: NDArray[Any], kind: Kind) -> NDArray[np.float32]:
    """Numbers that are no colours as a picture, 0…1, (H, W) or (H, W, 3), to be shown without a display transform.

    Normals are shown as (n + 1)/2 and background as black, positions by the range that they have, depths from white
    (near) to black (far and background), IDs by a colour each, values as they are.
    """
    finite = np.isfinite(pixels)
    clean = np.where(finite, pixels, 0)
    if kind == "normal":
        covered = np.any(clean != 0, axis=-1, keepdims=True)
        return np.where(covered, np.clip(0.5 * clean[..., :3] + 0.5, 0, 1), 0).astype(np.float32)
    if kind == "position":
        covered = np.all(finite, axis=-1, keepdims=True) & np.any(clean != 0, axis=-1, keepdims=True)
        return np.where(covered, _by_range(clean[..., :3], covered[..., 0]), 0).astype(np.float32)
    if kind == "depth":
        depth = clean[..., 0]
        covered = finite[..., 0] & (np.abs(depth) < _FAR) & (depth != 0)
        near_is_white = 1 - 0.9 * _by_range(depth[..., np.newaxis], covered)[..., 0]
        return np.where(covered, near_is_white, 0).astype(np.float32)
    if kind == "id":
        return _hashed(pixels[..., 0])
    picture = np.clip(clean, 0, 1).astype(np.float32)
    if picture.shape[-1] == 2:
        picture = np.concatenate([picture, np.zeros_like(picture[..., :1])], axis=-1)
    return np.asarray(picture[..., 0] if picture.shape[-1] == 1 else picture[..., :3])


def _by_range(values: NDArray[Any], covered: NDArray[np.bool_]) -> NDArray[Any]:
    """Each component from the range of its covered pixels, without the outermost half percent, to 0…1."""
    if not np.any(covered):
        return np.zeros_like(values)
    low, high = np.percentile(values[covered], (0.5, 99.5), axis=0)
    return np.asarray(np.clip((values - low) / np.maximum(high - low, 1e-12), 0, 1))


def _hashed(ids: NDArray[Any]) -> NDArray[np.float32]:
    """A bright colour for each number, black for 0; the same number has the same colour in every picture."""
    bits = ids if ids.dtype == np.uint32 else np.ascontiguousarray(ids, np.float32).view(np.uint32)
    mixed = bits.astype(np.uint64) * np.uint64(0x9E3779B97F4A7C15)
    hue = ((mixed >> np.uint64(40)) & np.uint64(0xFFFF)).astype(np.float32) / 65535
    value = 0.55 + 0.45 * ((mixed >> np.uint64(24)) & np.uint64(0xFF)).astype(np.float32) / 255
    wheel = np.abs((hue[..., np.newaxis] * 6 + np.array([0, 4, 2], np.float32)) % 6 - 3) - 1
    colors = (0.25 + 0.75 * np.clip(wheel, 0, 1)) * value[..., np.newaxis]
    return np.where((bits != 0)[..., np.newaxis], colors, 0).astype(np.float32)
