# SPDX-License-Identifier: Apache-2.0
"""G-buffers from arrays and from files."""

from __future__ import annotations

import gc
import weakref
from pathlib import Path

import numpy as np
import pytest
import relume
from conftest import flat_channels, write_exr
from relume import GBuffer


def arrays(height: int = 5, width: int = 7, seed: int = 1) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(seed)
    normal = rng.normal(size=(height, width, 3)).astype(np.float32)
    normal /= np.linalg.norm(normal, axis=2, keepdims=True)
    return {
        "normal": normal,
        "base_color": rng.random((height, width, 3), np.float32),
        "roughness": rng.random((height, width), np.float32),
        "position": rng.normal(size=(height, width, 3)).astype(np.float32),
    }


def test_arrays_come_back() -> None:
    given = arrays()
    gbuffer = GBuffer(**given)
    assert gbuffer.shape == (5, 7)
    assert gbuffer.data_window == (0, 0, 7, 5)
    assert {info.name for info in gbuffer.channels} >= set(given)
    np.testing.assert_array_equal(gbuffer["base_color"], given["base_color"])
    np.testing.assert_array_equal(gbuffer["roughness"], given["roughness"])
    np.testing.assert_array_equal(gbuffer["position"], given["position"])
    np.testing.assert_allclose(gbuffer["normal"], given["normal"], atol=1e-6)
    assert "normal" in gbuffer and "metallic" not in gbuffer
    assert gbuffer.channel("roughness").shape == (5, 7)
    assert "normal" in repr(gbuffer)


def creased(height: int = 5, width: int = 21) -> np.ndarray:
    """Two faces that meet in the middle column, which holds their mean."""
    normal = np.zeros((height, width, 3), np.float32)
    normal[:, : width // 2] = (-0.6, 0, 0.8)
    normal[:, width // 2] = (0, 0, 0.8)
    normal[:, width // 2 + 1 :] = (0.6, 0, 0.8)
    return normal


def test_normal_variance() -> None:
    gbuffer = GBuffer(normal=creased())
    assert not gbuffer["normal_variance"].any()  # the face beside the crease stands in
    assert np.abs(gbuffer["normal"][2, 10]) == pytest.approx([0.6, 0, 0.8])
    assert {info.name: info.reason for info in gbuffer.channels}["normal_variance"].endswith("means over the pixel")
    assert "normal_variance" not in GBuffer(normal=creased(), normal_variance="off")
    short = np.full((5, 21, 3), (0, 0, 0.8), np.float32)
    assert "normal_variance" not in GBuffer(normal=short)
    assert GBuffer(normal=short, normal_variance="on")["normal_variance"] == pytest.approx(0.5, rel=1e-4)
    with pytest.raises(relume.Error, match="normal_variance"):
        GBuffer(normal=creased(), normal_variance="sometimes")


def test_normal_variance_of_a_rig(tmp_path: Path) -> None:
    normal = creased()
    path = write_exr(tmp_path / "creased.exr", {f"N.{axis}": normal[..., k] for k, axis in enumerate("XYZ")})
    assert "normal_variance" in GBuffer.read(path)
    rig = relume.Rig()
    rig.set("gbuffer.normal_variance", "off")
    assert "normal_variance" not in GBuffer.read(path, rig=rig)
    assert "normal_variance" in GBuffer.read(path, rig=rig, normal_variance="on")


def test_no_copy() -> None:
    given = arrays()
    gbuffer = GBuffer(**given)
    given["roughness"][2, 3] = 0.125
    assert gbuffer["roughness"][2, 3] == 0.125


def test_arrays_live_as_long_as_the_gbuffer() -> None:
    given = arrays()
    seen = weakref.ref(given["roughness"])
    gbuffer = GBuffer(**given)
    del given
    gc.collect()
    assert seen() is not None
    assert gbuffer["roughness"].shape == (5, 7)
    del gbuffer
    gc.collect()
    assert seen() is None


@pytest.mark.parametrize(
    "view",
    [
        lambda a: a,
        lambda a: a[::-1],
        lambda a: a[:, ::-1],
        lambda a: np.asfortranarray(a),
        lambda a: np.repeat(np.repeat(a, 2, axis=0), 3, axis=1)[::2, ::3],
        lambda a: np.moveaxis(np.ascontiguousarray(np.moveaxis(a, -1, 0)), 0, -1) if a.ndim == 3 else a.T.copy().T,
        lambda a: np.pad(a, [(1, 2), (3, 1)] + [(0, 0)] * (a.ndim - 2))[1:-2, 3:-1],
    ],
)
def test_any_strides(view: object) -> None:
    given = {name: view(array) for name, array in arrays().items()}  # type: ignore[operator]
    gbuffer = GBuffer(**given)
    for name, array in given.items():
        np.testing.assert_allclose(gbuffer[name], array, atol=1e-6)


def test_constant_by_broadcasting() -> None:
    given = arrays()
    gbuffer = GBuffer(normal=given["normal"], roughness=np.broadcast_to(np.float32(0.3), (5, 7)))
    np.testing.assert_array_equal(gbuffer["roughness"], np.full((5, 7), 0.3, np.float32))


def test_half_and_ids() -> None:
    given = arrays()
    ids = np.arange(35, dtype=np.uint32).reshape(5, 7) * 100000
    gbuffer = GBuffer(
        normal=given["normal"].astype(np.float16), object_id=ids, roughness=given["roughness"].astype(np.float16)
    )
    assert gbuffer["object_id"].dtype == np.uint32
    np.testing.assert_array_equal(gbuffer["object_id"], ids)
    np.testing.assert_array_equal(gbuffer["roughness"], given["roughness"].astype(np.float16).astype(np.float32))


def test_rules() -> None:
    given = arrays()
    coded = GBuffer(normal=0.5 * given["normal"] + 0.5, channels={"normal": {"encoding": "0..1"}})
    np.testing.assert_allclose(coded["normal"], given["normal"], atol=1e-6)
    flipped = GBuffer(normal=given["normal"] * np.array([1, -1, 1], np.float32), channels={"normal": {"flip": "y"}})
    np.testing.assert_allclose(flipped["normal"], given["normal"], atol=1e-6)
    turn = np.array([[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]], np.float64)
    seen = GBuffer(
        normal=given["normal"], channels={"normal": {"space": "camera"}}, camera={"matrix": turn.ravel(), "fov": 40}
    )
    np.testing.assert_allclose(seen["normal"], given["normal"] @ turn[:3, :3].T.astype(np.float32), atol=1e-6)


def test_camera() -> None:
    matrix = np.eye(4)
    matrix[:3, 3] = 1, 2, 3
    camera = GBuffer(normal=arrays()["normal"], camera={"matrix": matrix, "fov": 90.0}).camera
    assert camera is not None
    assert camera.matrix.shape == (4, 4) and camera.matrix.dtype == np.float64
    np.testing.assert_allclose(camera.matrix, matrix)
    np.testing.assert_allclose(camera.position, (1, 2, 3))
    np.testing.assert_allclose(camera.forward, (0, 0, -1))
    # The left edge of a picture 90 degrees wide is seen along (-1, 0, -1).
    assert camera.x_offset == pytest.approx(-1)
    assert camera.x_scale * 7 + camera.x_offset == pytest.approx(1)


def test_camera_of_another() -> None:
    normal = arrays()["normal"]
    matrix = np.eye(4)
    matrix[:3, 3] = 1, 2, 3
    for lens in ({"fov": 50.0}, {"projection": "orthographic", "width": 4.0}):
        first = GBuffer(normal=normal, camera={"matrix": matrix} | lens).camera
        second = GBuffer(normal=normal, camera=first).camera
        assert first is not None and second is not None
        np.testing.assert_array_equal(second.matrix, matrix)
        assert second.projection == first.projection
        assert second.x_scale == pytest.approx(first.x_scale)
        with pytest.raises(relume.ArgumentError, match="another size"):
            GBuffer(normal=normal[:3], camera=first)
    with pytest.raises(relume.ArgumentError, match="matrix"):
        GBuffer(normal=normal, camera=object())


@pytest.mark.parametrize(
    ("name", "array", "says"),
    [
        ("normal", np.zeros((5, 7, 3)), "astype(numpy.float32)"),
        ("normal", np.zeros((3, 50, 70), np.float32), "moveaxis"),
        ("normal", np.zeros((5, 7), np.float32), "3"),
        ("normal", np.zeros(7, np.float32), "dimensions"),
        ("normal", np.zeros((5, 7, 3), np.dtype(np.float32).newbyteorder()), "byte order"),
        ("normal", [[[0, 0, 1]]], "numpy"),
        ("normal", np.zeros((0, 0, 3), np.float32), ""),
        ("object_id", np.zeros((5, 7), np.int64), "astype(numpy.uint32)"),
        ("roughness", np.zeros((5, 8), np.float32), "same size"),
        ("roughness", np.zeros((5, 7, 2), np.float32), ""),
        ("roughness", np.zeros((5, 7), bool), "astype"),
        ("roughness", np.zeros((5, 7, 5), np.uint8)[..., :4].view(np.float32), "aligned"),
        ("roughness", np.zeros((5, 7), object), "astype"),
    ],
)
def test_refusals(name: str, array: object, says: str) -> None:
    with pytest.raises(relume.Error) as caught:
        GBuffer(**(arrays() | {name: array}))
    assert isinstance(caught.value, ValueError | LookupError), repr(caught.value)
    assert says in str(caught.value), str(caught.value)
    assert name in str(caught.value), str(caught.value)


def test_unknown_names() -> None:
    gbuffer = GBuffer(**arrays())
    with pytest.raises(relume.ChannelError, match="'roughness'"):
        gbuffer["roughnes"]
    with pytest.raises(relume.Error, match="'encoding'"):
        GBuffer(normal=arrays()["normal"], channels={"normal": {"encodng": "0..1"}})
    with pytest.raises(relume.ArgumentError, match=r"\(4, 4\)"):
        GBuffer(normal=arrays()["normal"], camera=np.eye(3))


def test_read(flat: Path) -> None:
    gbuffer = GBuffer.read(flat)
    channels = flat_channels()
    assert gbuffer.shape == (4, 6)
    np.testing.assert_array_equal(gbuffer["base_color"][..., 0], channels["albedo.R"])
    np.testing.assert_array_equal(gbuffer["normal"], np.broadcast_to(np.float32([0, 0, 1]), (4, 6, 3)))
    normal = next(info for info in gbuffer.channels if info.name == "normal")
    assert normal.sources == ["N.X", "N.Y", "N.Z"]
    assert normal.file == str(flat)
    assert normal.reason and normal.interpretation


def test_read_with_rules(tmp_path: Path) -> None:
    channels = flat_channels()
    channels["other.X"], channels["other.Y"], channels["other.Z"] = channels["N.Z"], channels["N.X"], channels["N.Y"]
    path = write_exr(tmp_path / "shot.0007.exr", channels)
    rough = write_exr(tmp_path / "rough.0007.exr", {"Y": np.full((4, 6), 0.75, np.float32)})
    gbuffer = GBuffer.read(
        tmp_path / "shot.####.exr", frame=7, channels={"normal": "other", "roughness": tmp_path / "rough.####.exr"}
    )
    np.testing.assert_array_equal(gbuffer["normal"][0, 0], (1, 0, 0))
    np.testing.assert_array_equal(gbuffer["roughness"], np.full((4, 6), 0.75, np.float32))
    info = {info.name: info for info in gbuffer.channels}
    assert info["roughness"].file == str(rough)
    assert info["normal"].file == str(path)
    rig = relume.Rig()
    rig.gbuffer.channels["normal"] = "other"
    np.testing.assert_array_equal(GBuffer.read(path, rig=rig)["normal"][0, 0], (1, 0, 0))
    np.testing.assert_array_equal(GBuffer.read(path, rig=rig, channels={"normal": "N"})["normal"][0, 0], (0, 0, 1))


def test_windows(tmp_path: Path) -> None:
    box = (np.array([10, 20], np.int32), np.array([15, 23], np.int32))
    path = write_exr(tmp_path / "crop.exr", flat_channels(), dataWindow=box)
    gbuffer = GBuffer.read(path)
    assert gbuffer.data_window == (10, 20, 6, 4)


def test_scene(sdf: Path) -> None:
    gbuffer = GBuffer.read(sdf)
    assert gbuffer.shape == (54, 96)
    assert gbuffer.producer.startswith("Blender")
    assert gbuffer.camera is not None
    assert gbuffer.camera_error < 0.01
    assert gbuffer.notes == [note for note in gbuffer.notes if note]
    lengths = np.linalg.norm(gbuffer["normal"], axis=2)
    np.testing.assert_allclose(lengths[lengths > 0], 1, atol=1e-5)
    raw = gbuffer["ViewLayer.albedo.R"]
    assert raw.shape == (54, 96)
    names = next(iter(gbuffer.cryptomatte.values()))
    assert names
    matte = gbuffer.matte("*")
    assert matte.shape == (54, 96)
    assert matte.max() == pytest.approx(1, abs=1e-3)


def test_load_many_channels_in_one_pass(sdf: Path) -> None:
    gbuffer = GBuffer.read(sdf)
    loaded = gbuffer.load("normal", "roughness", "ViewLayer.albedo.R")
    for name, array in loaded.items():
        np.testing.assert_array_equal(array, gbuffer[name])
        assert array.dtype == np.float32
    assert loaded["normal"].strides[2] == 54 * 96 * 4, "planar memory"

    half = gbuffer.load("normal", dtype=np.float16, threads=1)["normal"]
    np.testing.assert_array_equal(half, loaded["normal"].astype(np.float16))

    mine = np.zeros((54, 96, 3), np.float32)
    assert gbuffer.load("normal", out={"normal": mine})["normal"] is mine
    np.testing.assert_array_equal(mine, loaded["normal"])

    with pytest.raises(relume.ArgumentError, match=r"normal: the array is 54 × 95 × 3; the channel is 54 × 96 × 3"):
        gbuffer.load("normal", out={"normal": np.zeros((54, 95, 3), np.float32)})
    with pytest.raises(relume.ArgumentError, match=r"'roughness', which is none"):
        gbuffer.load("normal", out={"roughness": mine[..., 0]})
    with pytest.raises(relume.ArgumentError, match=r"threads is 0"):
        gbuffer.load("normal", threads=0)
    with pytest.raises(relume.ChannelError):
        gbuffer.load("normal", "no such channel")


def test_exr_file(flat: Path) -> None:
    file = relume.ExrFile(flat)
    (part,) = file.parts
    assert part.data_window == (0, 0, 6, 4)
    assert ("albedo.R", "float32") in part.channels
    assert part.compression == "zip"
    pixels = file.read(0, ["P.X", "albedo.R"])
    np.testing.assert_array_equal(pixels[..., 0], flat_channels()["P.X"])
    np.testing.assert_array_equal(pixels[..., 1], flat_channels()["albedo.R"])
    with pytest.raises(relume.ChannelError, match=r"nothing"):
        file.read(0, ["nothing"])
    with pytest.raises(relume.ArgumentError):
        file.read(3, ["P.X"])
