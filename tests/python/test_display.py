# SPDX-License-Identifier: Apache-2.0
"""Display transforms, layers to look at, and PNG files."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
import relume
from conftest import run_relume, write_exr
from relume.display import Display, from_srgb, to_display, to_srgb
from relume.layers import find_layer, layers_of, read_layer, viewable
from relume.png import write_png

RAMP = np.linspace(0, 4, 257)[:, None] * np.ones(3)


def test_srgb_is_the_standard() -> None:
    """Values of the standard's table, and each way undoes the other."""
    np.testing.assert_allclose(
        to_srgb(np.array([0, 0.0031308, 0.18, 0.5, 1])), [0, 0.04045, 0.46135613, 0.73535698, 1], atol=1e-6
    )
    codes = np.arange(256) / 255
    np.testing.assert_allclose(to_srgb(from_srgb(codes)), codes, atol=1e-7)


def test_curves() -> None:
    x = RAMP
    np.testing.assert_allclose(to_display(x, tone="reinhard", gamma="none"), x / (1 + x), rtol=1e-6)
    aces = np.clip(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0, 1)
    np.testing.assert_allclose(to_display(x, tone="aces", gamma="none"), aces, rtol=1e-5)
    np.testing.assert_allclose(to_display(x, exposure=-2, gamma="2.2"), (x / 4) ** (1 / 2.2), rtol=1e-5)
    np.testing.assert_allclose(to_display(x), np.clip(to_srgb(x), 0, 1), rtol=1e-5)
    with pytest.raises(relume.ArgumentError, match="aces"):
        to_display(x, tone="asces")


def test_spaces() -> None:
    """Colours of ACEScg land on the screen where OpenColorIO puts them, by either way."""
    colors = np.random.default_rng(8).uniform(0.1, 0.4, (50, 3))
    by_ocio = Display(space="lin_ap1", ocio_display="sRGB - Display", ocio_view="Un-tone-mapped")(colors)
    np.testing.assert_allclose(Display(space="ACEScg")(colors), by_ocio, atol=1e-3)
    ap1 = (0.713, 0.293, 0.165, 0.830, 0.128, 0.044, 0.32168, 0.33767)
    np.testing.assert_array_equal(Display(space=ap1)(colors), Display(space="lin_ap1")(colors))
    assert np.abs(Display()(colors) - by_ocio).max() > 0.01


def test_not_finite() -> None:
    seen = to_display(np.array([[np.nan, np.inf, -np.inf]]), tone="aces")
    np.testing.assert_allclose(seen, [[0, 1, 0]], atol=1e-6)


def test_ocio_is_the_srgb_curve_where_it_should_be() -> None:
    """The built-in config's plain view is an independent sRGB."""
    views = Display(ocio_display="sRGB - Display", ocio_view="Un-tone-mapped")
    inside = RAMP[RAMP[:, 0] <= 1]
    np.testing.assert_allclose(views(inside), to_srgb(inside), atol=2e-4)
    assert not np.allclose(Display(ocio_display="sRGB - Display")(inside), to_srgb(inside), atol=0.02)


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"ocio_display": "sRGB"}, "sRGB - Display"),
        ({"ocio_display": "sRGB - Display", "ocio_view": "Un-tone-maped"}, "Un-tone-mapped"),
        ({"ocio_display": "sRGB - Display", "space": "lin_rec790"}, "colour space"),
        ({"space": "lin_rec790"}, "'lin_rec709'"),
        ({"space": (1, 2)}, "8"),
        ({"ocio_config": "/nowhere/config.ocio"}, "/nowhere/config.ocio"),
    ],
)
def test_ocio_refusals(options: dict[str, str], says: str) -> None:
    with pytest.raises(relume.Error) as caught:
        Display(**options)  # type: ignore[arg-type]
    assert says in str(caught.value)


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
@pytest.mark.parametrize("components", [1, 2, 3, 4])
def test_png(tmp_path: Path, dtype: type, components: int) -> None:
    """Read back by another implementation."""
    top = np.iinfo(dtype).max
    image = np.random.default_rng(components).integers(0, top, (13, 7, components), dtype, endpoint=True)
    write_png(tmp_path / "x.png", image)
    reader = oiio.ImageInput.open(str(tmp_path / "x.png"), oiio.ImageSpec())
    spec = reader.spec()
    assert (spec.width, spec.height, spec.nchannels) == (7, 13, components)
    assert str(spec.format) == ("uint8" if dtype is np.uint8 else "uint16")
    if components in (1, 3):  # alpha is straight in the file, and OpenImageIO multiplies by it
        read = reader.read_image(0, 0, 0, components, str(spec.format))
        np.testing.assert_array_equal(read.reshape(image.shape), image)
    reader.close()
    np.testing.assert_array_equal(decoded(tmp_path / "x.png", dtype), image)
    assert [entry.name for entry in tmp_path.iterdir()] == ["x.png"]


def decoded(path: Path, dtype: type) -> np.ndarray:
    """A PNG by the specification: chunks with their checksums, filters 0 and 2."""
    data, at, idat, header = path.read_bytes(), 8, b"", b""
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    while at < len(data):
        (length,) = struct.unpack(">I", data[at : at + 4])
        kind, body = data[at + 4 : at + 8], data[at + 8 : at + 8 + length]
        assert struct.unpack(">I", data[at + 8 + length : at + 12 + length])[0] == zlib.crc32(kind + body)
        header, idat = (body if kind == b"IHDR" else header), idat + (body if kind == b"IDAT" else b"")
        at += 12 + length
    width, height, _, color = struct.unpack(">IIBB", header[:10])
    components = {0: 1, 2: 3, 4: 2, 6: 4}[color]
    rows = np.frombuffer(zlib.decompress(idat), np.uint8).reshape(height, -1)
    assert set(rows[:, 0]) <= {2}
    pixels = np.cumsum(rows[:, 1:].astype(np.uint64), axis=0).astype(np.uint8)
    big = np.dtype(dtype).newbyteorder(">")
    return pixels.reshape(-1).view(big).reshape(height, width, components).astype(dtype)


def test_png_refusals(tmp_path: Path) -> None:
    for wrong in (np.zeros((2, 2, 5), np.uint8), np.zeros((2, 2)), np.zeros((0, 2), np.uint8), np.zeros(3, np.uint8)):
        with pytest.raises(relume.ArgumentError):
            write_png(tmp_path / "x.png", wrong)
    with pytest.raises(relume.FileError, match="nowhere"):
        write_png(tmp_path / "nowhere" / "x.png", np.zeros((2, 2), np.uint8))


def all_kinds(path: Path) -> Path:
    rng = np.random.default_rng(4)
    plane = lambda: rng.random((6, 5), np.float32)  # noqa: E731
    names = [*"RGBA", *(f"VL.Normal.{c}" for c in "XYZ"), *(f"VL.Position.{c}" for c in "XYZ"), "VL.Depth.Z", "Z"]
    names += [f"diffuse.{c}" for c in "RGB"] + ["roughness", "mask.X"]
    channels = {name: plane() for name in names}
    channels["VL.Depth.Z"][2, 2] = 1e10
    channels["VL.IndexOB.X"] = rng.integers(0, 3, (6, 5)).astype(np.float32)
    channels["object_id"] = rng.integers(0, 3, (6, 5)).astype(np.uint32)
    return write_exr(path, channels)


def test_layers(tmp_path: Path) -> None:
    file = relume.ExrFile(all_kinds(tmp_path / "all.exr"))
    kinds = {layer.title: layer.kind for layer in layers_of(file)}
    assert kinds == {
        "beauty": "color",
        "VL.Normal": "normal",
        "VL.Position": "position",
        "VL.Depth": "depth",
        "Z": "depth",
        "diffuse": "color",
        "roughness": "value",
        "mask": "value",
        "VL.IndexOB": "id",
        "object_id": "id",
    }
    assert find_layer(file, None).channels == ("R", "G", "B", "A")
    assert find_layer(file, "normal").channels == ("VL.Normal.X", "VL.Normal.Y", "VL.Normal.Z")
    assert find_layer(file, "VL.Normal.Y").channels == ("VL.Normal.Y",)
    with pytest.raises(relume.ChannelError, match="'diffuse'"):
        find_layer(file, "difuse")
    assert read_layer(tmp_path / "all.exr", "object_id").dtype == np.uint32


def test_viewable() -> None:
    normals = np.float32([[[0, 0, 1], [1, 0, 0], [0, 0, 0], [np.nan, 0, 1]]])
    np.testing.assert_allclose(viewable(normals, "normal"), [[[0.5, 0.5, 1], [1, 0.5, 0.5], [0, 0, 0], [0.5, 0.5, 1]]])
    depth = np.float32([[1], [2], [1e10], [np.inf], [0]])[None]
    seen = viewable(depth, "depth")[0]
    assert seen[0] == 1 and 0 < seen[1] < 1 and not seen[2:].any()
    ids = np.uint32([[0, 1, 2, 1]])[..., None]
    colors = viewable(ids, "id")[0]
    assert not colors[0].any()
    np.testing.assert_array_equal(colors[1], colors[3])
    assert not np.array_equal(colors[1], colors[2])
    np.testing.assert_array_equal(viewable(np.float32([[[-1], [0.25], [7]]]), "value"), [[0, 0.25, 1]])


@pytest.mark.parametrize("layer", [None, "normal", "position", "Depth", "diffuse", "roughness", "IndexOB", "object_id"])
def test_command(tmp_path: Path, layer: str | None) -> None:
    path = all_kinds(tmp_path / "all.exr")
    chosen = ["--layer", layer] if layer else []
    ran = run_relume("png", path, "-o", tmp_path / "x.png", *chosen)
    assert ran.code == 0, ran
    assert decoded(tmp_path / "x.png", np.uint8).shape[:2] == (6, 5)


def test_command_values(tmp_path: Path) -> None:
    """A known colour through exposure, tone curve and code, in 8 and 16 bits."""
    color = np.float32([0.18, 0.5, 0.02])
    planes = {name: np.full((3, 4), value, np.float32) for name, value in zip("RGB", color, strict=True)}
    path = write_exr(tmp_path / "flat.exr", planes)
    ran = run_relume("png", path, "--exposure", "1", "--tone", "aces", "--bits", "16", "-o", tmp_path / "x.png")
    assert ran.code == 0, ran
    expected = to_display(color, exposure=1, tone="aces") * 65535
    assert np.abs(decoded(tmp_path / "x.png", np.uint16)[0, 0] - expected).max() <= 0.51
    assert run_relume("png", path).code == 0
    assert np.abs(decoded(tmp_path / "flat.png", np.uint8)[0, 0] - to_display(color) * 255).max() <= 0.51


def test_command_heeds_the_header(tmp_path: Path) -> None:
    planes = {name: np.full((2, 2), value, np.float32) for name, value in zip("RGB", (0.2, 0.3, 0.1), strict=True)}
    ap1 = (0.713, 0.293, 0.165, 0.830, 0.128, 0.044, 0.32168, 0.33767)
    path = write_exr(tmp_path / "ap1.exr", planes, chromaticities=ap1)
    assert run_relume("png", path).code == 0
    expected = Display(space="lin_ap1")([0.2, 0.3, 0.1]) * 255
    assert np.abs(decoded(tmp_path / "ap1.png", np.uint8)[0, 0] - expected).max() <= 0.51


def test_command_alpha(tmp_path: Path) -> None:
    planes = {name: np.full((2, 2), value, np.float32) for name, value in zip("RGBA", (0.25, 0.1, 0, 0.5), strict=True)}
    path = write_exr(tmp_path / "flat.exr", planes)
    assert run_relume("png", path, "--alpha").code == 0
    expected = [*np.rint(to_display(np.float32([0.5, 0.2, 0])) * 255), 128]
    assert np.abs(decoded(tmp_path / "flat.png", np.uint8)[0, 0] - expected).max() <= 1


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["shot.1.exr", "-o", "x.jpg"], "x.jpg: png writes PNG; give a name that ends in .png"),
        (["shot.#.exr"], "shot.#.exr: png takes one frame, as shot.1.exr"),
        (["take.#.exr"], "take.#.exr: png takes one frame"),
    ],
)
def test_command_refuses(tmp_path: Path, arguments: list[str], says: str) -> None:
    write_exr(tmp_path / "shot.1.exr", {name: np.ones((2, 2), np.float32) for name in "RGB"})
    ran = run_relume("png", *arguments, cwd=tmp_path)
    assert ran.code == 2, ran
    assert ran.err.splitlines()[-1] == f"Error: {says}"
    assert [path.name for path in tmp_path.iterdir()] == ["shot.1.exr"]
