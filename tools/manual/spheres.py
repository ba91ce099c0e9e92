# SPDX-License-Identifier: Apache-2.0
"""Strips of spheres: a shader's parameter from one end of its range to the other, through the Python API."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from relume import GBuffer, relight, shaders

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from relume import Parameter, Shader

#: Pixels across one sphere's square, and samples across one pixel.
SIZE, SAMPLES = 104, 3
STEPS = 5

Value = float | bool | str | tuple[float, float, float]

_COPPER = (0.8, 0.32, 0.12)
_COLORS: tuple[Value, ...] = ((0.0, 0.0, 0.0), (0.8, 0.8, 0.8), (0.8, 0.1, 0.05), (0.1, 0.6, 0.1), (0.05, 0.15, 0.8))
# Emission and ambient are added to the rest.
_DIM: tuple[Value, ...] = tuple(tuple(0.4 * c for c in color) for color in _COLORS)  # type: ignore[misc]

# What else must be set for a parameter to show, where its table has it.
_STAGE: dict[str, dict[str, Value]] = {
    "": {"base_color": _COPPER, "roughness": 0.35},
    "anisotropic": {"metallic": 1.0, "roughness": 0.4},
    "anisotropic_rotation": {"metallic": 1.0, "roughness": 0.4, "anisotropic": 0.8},
    "anisotropy": {"metallic": 1.0, "roughness": 0.4},
    "clearcoat": {"roughness": 0.7, "generation": "3"},
    "clearcoat_gloss": {"clearcoat": 1.0, "roughness": 0.7},
    "clearcoat_roughness": {"clearcoat": 1.0, "roughness": 0.7, "generation": "3"},
    "coat_ior": {"coat_weight": 1.0, "coat_roughness": 0.15, "roughness": 0.7},
    "coat_roughness": {"coat_weight": 1.0, "roughness": 0.7},
    "coat_tint": {"coat_weight": 1.0, "base_color": (0.8, 0.8, 0.8), "roughness": 0.7},
    "coat_weight": {"coat_roughness": 0.1, "coat_tint": (0.8, 0.4, 0.2), "roughness": 0.7},
    "diffuse_roughness": {"roughness": 0.8, "specular": 0.0},
    "emission_is": {"emission": (0.3, 0.3, 0.3), "coat_weight": 1.0, "coat_tint": (0.9, 0.3, 0.1)},
    "fresnel": {"metallic": 0.0, "roughness": 0.5, "specular": 1.0},
    "masking": {"metallic": 1.0, "roughness": 0.8},
    "percent_specular": {"roughness": 0.5},
    "roughness": {"exponent_from": "roughness"},
    "sheen": {"base_color": (0.05, 0.08, 0.3), "roughness": 0.8, "generation": "3"},
    "sheen_roughness": {"sheen_weight": 1.0, "base_color": (0.05, 0.08, 0.3), "roughness": 0.8},
    "sheen_tint": {"sheen": 1.0, "sheen_weight": 1.0, "base_color": (0.3, 0.02, 0.02), "roughness": 0.8},
    "sheen_weight": {"base_color": (0.05, 0.08, 0.3), "roughness": 0.8},
    "spec_power": {"distribution": "texture"},
    "specular_color": {
        "distribution": "texture",
        "base_color": (0.02, 0.02, 0.02),
        "percent_specular": 0.7,
        "roughness": 0.85,
    },
    "specular_tint": {"specular": 1.0},
    "sss_anisotropy": {"sss_color": (0.8, 0.3, 0.2), "base_color": (0.1, 0.1, 0.1)},
    "sss_color": {"base_color": (0.1, 0.1, 0.1)},
    "subsurface": {"roughness": 0.8},
}

_LIGHTS = """
version = 1
[[light]]
name = "key"
type = "sun"
direction = [0.6, -0.7, -0.8]
irradiance = 2.6
[[light]]
name = "rim"
type = "sun"
direction = [-0.9, -0.25, 0.45]
irradiance = [1.6, 1.8, 2.2]
[[light]]
name = "sky"
type = "sky"
up = [0, 1, 0]
sky_color = [0.35, 0.4, 0.5]
ground_color = [0.1, 0.09, 0.08]
[[shader]]
use = "{shader}"
{values}
[output]
type = "float"
"""


@dataclass(frozen=True)
class Strip:
    """One picture: the spheres of one parameter."""

    shader: str
    parameter: str
    values: tuple[Value, ...]

    @property
    def file(self) -> str:
        """Name of the picture."""
        return f"{self.shader}.{self.parameter}.jpg"


def values_of(row: Parameter) -> tuple[Value, ...]:
    """What the spheres of a strip show: the slider's range, the choices, some colours."""
    if row.type == "choice":
        return tuple(row.choices) if len(row.choices) > 1 else ()
    if row.type == "boolean":
        return (False, True)
    if row.type == "color":
        return _DIM if row.name in ("emission", "ambient") else _COLORS
    if row.type == "scalar":
        low, high = max(row.soft_min, row.min), min(row.soft_max, row.max)
        return tuple(round(low + (high - low) * k / (STEPS - 1), 4) for k in range(STEPS))
    return ()


def all_strips() -> list[Strip]:
    """The strips of all built-in shaders."""
    strips = []
    for shader in shaders.values():
        if shader.file is None:
            rows = [(row, values_of(row)) for row in shader.parameters]
            strips += [Strip(shader.name, row.name, values) for row, values in rows if values]
    return strips


def _toml(value: Value) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, tuple):
        return f"[{', '.join(_toml(component) for component in value)}]"
    return repr(float(value))


def _stage(shader: Shader, parameter: str) -> dict[str, Value]:
    known = {row.name for row in shader.parameters}
    return {k: v for k, v in (_STAGE[""] | _STAGE.get(parameter, {})).items() if k in known}


def _sphere() -> tuple[GBuffer, NDArray[np.float32]]:
    """A unit sphere seen along −Z, and where it is in the picture: (H, W, 1), 0 or 1."""
    count = SIZE * SAMPLES
    axis = ((np.arange(count) + 0.5) / count * 2 - 1) * 1.08
    x, y = np.meshgrid(axis, -axis)
    inside = x * x + y * y < 1
    z = np.sqrt(np.maximum(0, 1 - x * x - y * y))
    normal = np.where(inside[..., None], np.stack([x, y, z], -1), 0).astype(np.float32)
    # Along the circles of latitude, so that stretched highlights show.
    tangent = np.stack([z, np.zeros_like(z), -x], -1)
    tangent /= np.maximum(np.linalg.norm(tangent, axis=-1, keepdims=True), 1e-6)
    camera = {"matrix": np.eye(4), "projection": "orthographic", "width": 2.16}
    gbuffer = GBuffer(normal=normal, tangent=tangent.astype(np.float32), camera=camera)
    return gbuffer, inside[..., None].astype(np.float32)


def render(strip: Strip) -> NDArray[np.uint8]:
    """The strip's pixels, (SIZE, SIZE × values, 3), sRGB."""
    shader = shaders[strip.shader]
    gbuffer, inside = _sphere()
    squares = []
    for value in strip.values:
        settings = _stage(shader, strip.parameter) | {strip.parameter: value}
        text = "\n".join(f"{name} = {_toml(setting)}" for name, setting in settings.items())
        rgb = relight(gbuffer, _LIGHTS.format(shader=strip.shader, values=text))["beauty"][..., :3]
        rgb = rgb * inside + 0.045 * (1 - inside)
        squares.append(rgb.reshape(SIZE, SAMPLES, SIZE, SAMPLES, 3).mean(axis=(1, 3)))
    linear = np.clip(np.concatenate(squares, axis=1), 0, 1)
    # IEC 61966-2-1
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return (encoded * 255 + 0.5).astype(np.uint8)


def write(strip: Strip, path: Path) -> bool:
    """Write a strip as JPEG. Returns whether its spheres differ.

    Raises:
        OSError: it cannot be written.
    """
    import OpenImageIO as oiio  # noqa: N813

    pixels = render(strip)
    height, width, channels = pixels.shape
    spec = oiio.ImageSpec(width, height, channels, "uint8")
    spec["compression"] = "jpeg:88"
    output = oiio.ImageOutput.create(str(path))
    if output is None or not output.open(str(path), spec) or not output.write_image(pixels) or not output.close():
        raise OSError(f"{path}: {oiio.geterror()}")
    first, *rest = np.split(pixels, len(strip.values), axis=1)
    return any(not np.array_equal(first, other) for other in rest)
