# SPDX-License-Identifier: Apache-2.0
"""G-buffers from files that are not EXR: PNG, JPEG, TIFF, one per channel."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
import relume
from conftest import KEY, flat_channels, run_relume, write_exr
from relume import GBuffer
from relume.display import from_srgb


def write_image(path: Path, pixels: np.ndarray) -> Path:
    image = oiio.ImageBuf(pixels)
    kind = {np.dtype(np.uint8): "uint8", np.dtype(np.uint16): "uint16", np.dtype(np.float32): "float"}[pixels.dtype]
    assert image.write(str(path), kind), image.geterror()
    return path


@pytest.fixture
def images(tmp_path: Path) -> dict[str, np.ndarray]:
    """normal.png, base_color.png (8 bits), roughness.png (16 bits, grey) in tmp_path."""
    rng = np.random.default_rng(9)
    normal = rng.normal(size=(4, 6, 3))
    normal /= np.linalg.norm(normal, axis=2, keepdims=True)
    pixels = {
        "normal": np.rint((0.5 * normal + 0.5) * 255).astype(np.uint8),
        "base_color": rng.integers(0, 256, (4, 6, 3), np.uint8),
        "roughness": rng.integers(0, 65536, (4, 6, 1), np.uint16),
    }
    for name, array in pixels.items():
        write_image(tmp_path / f"{name}.png", array)
    return pixels


def test_pngs_alone(tmp_path: Path, images: dict[str, np.ndarray]) -> None:
    gbuffer = GBuffer.read(channels={name: tmp_path / f"{name}.png" for name in images})
    assert gbuffer.shape == (4, 6)
    decoded = images["normal"].astype(np.float64) / 255 * 2 - 1
    decoded /= np.linalg.norm(decoded, axis=2, keepdims=True)
    np.testing.assert_allclose(gbuffer["normal"], decoded, atol=1e-6)
    np.testing.assert_allclose(gbuffer["base_color"], from_srgb(images["base_color"] / 255), rtol=1e-5)
    np.testing.assert_allclose(gbuffer["roughness"], images["roughness"][..., 0] / 65535, rtol=1e-6)
    reasons = {info.name: info.reason for info in gbuffer.channels}
    assert "sRGB" in reasons["base_color"]
    assert "(v + 1)/2" in reasons["normal"]
    assert "sRGB" not in reasons["roughness"]


def test_beside_an_exr(tmp_path: Path, images: dict[str, np.ndarray], flat: Path) -> None:
    gbuffer = GBuffer.read(flat, channels={"base_color": tmp_path / "base_color.png"})
    np.testing.assert_allclose(gbuffer["base_color"], from_srgb(images["base_color"] / 255), rtol=1e-5)
    np.testing.assert_array_equal(gbuffer["normal"][0, 0], (0, 0, 1))


# Rec.709 to ACES AP1 with Bradford's adaptation, as ACES prints it; and to Rec.2020 (ITU-R BT.2087-0).
TO_AP1 = (
    (0.6130974024, 0.3395231462, 0.0473794514),
    (0.0701937225, 0.9163538791, 0.0134523985),
    (0.0206155929, 0.1095697729, 0.8698146342),
)
TO_REC2020 = ((0.6274, 0.3293, 0.0433), (0.0691, 0.9195, 0.0114), (0.0164, 0.0880, 0.8956))


@pytest.mark.parametrize(
    ("space", "matrix", "tolerance"), [("lin_ap1", TO_AP1, 2e-5), ("lin_rec2020", TO_REC2020, 1e-4)]
)
def test_srgb_comes_into_the_working_space(
    tmp_path: Path, images: dict[str, np.ndarray], flat: Path, space: str, matrix: object, tolerance: float
) -> None:
    channels = {"base_color": tmp_path / "base_color.png", "roughness": tmp_path / "roughness.png"}
    gbuffer = GBuffer.read(flat, channels=channels, working_space=space)
    linear = from_srgb(images["base_color"].astype(np.float64) / 255)
    np.testing.assert_allclose(gbuffer["base_color"], linear @ np.array(matrix).T, atol=tolerance)
    np.testing.assert_allclose(gbuffer["roughness"], images["roughness"][..., 0] / 65535, rtol=1e-6)
    reasons = {info.name: info.reason for info in gbuffer.channels}
    assert "Rec.709" in reasons["base_color"]
    assert "Rec.709" not in reasons["roughness"]


def test_grey_is_grey_in_every_space(tmp_path: Path, flat: Path) -> None:
    levels = np.arange(24, dtype=np.uint8).reshape(4, 6, 1) * 10
    path = write_image(tmp_path / "grey.png", levels)
    gbuffer = GBuffer.read(flat, channels={"base_color": path}, working_space="lin_ap0")
    expected = np.repeat(from_srgb(levels.astype(np.float64) / 255), 3, axis=2)
    np.testing.assert_allclose(gbuffer["base_color"], expected, atol=1e-6)


def test_an_unknown_space_is_said(tmp_path: Path, images: dict[str, np.ndarray], flat: Path) -> None:
    gbuffer = GBuffer.read(flat, channels={"base_color": tmp_path / "base_color.png"}, working_space="lin_house")
    np.testing.assert_allclose(gbuffer["base_color"], from_srgb(images["base_color"] / 255), rtol=1e-5)
    assert any("lin_house" in note and "sRGB" in note for note in gbuffer.notes)


def test_one_file_for_two(tmp_path: Path, images: dict[str, np.ndarray], flat: Path) -> None:
    """As a colour its sRGB is decoded, as a number it is not."""
    path = tmp_path / "base_color.png"
    gbuffer = GBuffer.read(flat, channels={"base_color": path, "roughness": path})
    np.testing.assert_allclose(gbuffer["base_color"], from_srgb(images["base_color"] / 255), rtol=1e-5)
    np.testing.assert_allclose(gbuffer["roughness"], images["base_color"][..., 0] / 255, rtol=1e-6)


def test_sixteen_bits_and_floats_are_linear(tmp_path: Path, flat: Path) -> None:
    rng = np.random.default_rng(3)
    deep = rng.integers(0, 65536, (4, 6, 3), np.uint16)
    gbuffer = GBuffer.read(flat, channels={"base_color": write_image(tmp_path / "deep.tif", deep)})
    np.testing.assert_allclose(gbuffer["base_color"], deep / 65535, rtol=1e-6)
    signed = np.broadcast_to(np.float32([0, -1, 0]), (4, 6, 3)).copy()
    gbuffer = GBuffer.read(flat, channels={"normal": write_image(tmp_path / "normal.tif", signed)})
    np.testing.assert_allclose(gbuffer["normal"], signed, atol=1e-6)


def test_command_line(tmp_path: Path, images: dict[str, np.ndarray], rig: Path) -> None:
    options = [f"--channel={name}={tmp_path / name}.png" for name in images]
    ran = run_relume("relight", "--rig", rig, "-o", tmp_path / "out.exr", *options)
    assert ran.code == 0, ran
    assert relume.ExrFile(tmp_path / "out.exr").read(0, ["R", "G", "B"]).max() > 0
    ran = run_relume("inspect", *options)
    assert ran.code == 0, ran
    assert "sRGB" in ran.out


def test_sequences(tmp_path: Path, images: dict[str, np.ndarray]) -> None:
    write_exr(tmp_path / "shot.0001.exr", flat_channels())
    write_exr(tmp_path / "shot.0002.exr", flat_channels())
    for frame, value in ((1, 51), (2, 255)):
        write_image(tmp_path / f"rough.{frame:04d}.png", np.full((4, 6, 1), value, np.uint8))
    rig = tmp_path / "key.relume"
    rig.write_text(KEY + '[gbuffer]\nfile = "shot.####.exr"\n[gbuffer.channels]\nroughness = "rough.####.png"\n')
    read = [GBuffer.read(rig=relume.Rig.load(rig), frame=frame)["roughness"][0, 0] for frame in (1, 2)]
    np.testing.assert_allclose(read, [0.2, 1])
    ran = run_relume("relight", "--rig", rig, "-o", tmp_path / "out.####.exr", cwd="/")
    assert ran.code == 0, ran
    assert (tmp_path / "out.0001.exr").exists() and (tmp_path / "out.0002.exr").exists()


def test_refusals(tmp_path: Path, images: dict[str, np.ndarray], flat: Path) -> None:
    (tmp_path / "broken.png").write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(20))
    small = write_image(tmp_path / "small.png", np.zeros((2, 2, 3), np.uint8))
    for path, error, says in (
        (tmp_path / "broken.png", relume.FormatError, "broken.png"),
        (tmp_path / "nowhere.png", relume.FileError, "nowhere.png"),
        (small, relume.ChannelError, "2x2"),
    ):
        with pytest.raises(error, match=says):
            GBuffer.read(flat, channels={"base_color": path})


def test_without_openimageio(tmp_path: Path, images: dict[str, np.ndarray]) -> None:
    """The package is named, and how to install it."""
    code = f"""
import sys
sys.modules["OpenImageIO"] = None
import relume
try:
    relume.GBuffer.read(channels={{"normal": {str(tmp_path / "normal.png")!r}}})
except relume.MissingPackageError as error:
    print(error)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "pip install OpenImageIO" in done.stdout
    assert "normal.png" in done.stdout
