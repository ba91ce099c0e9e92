# SPDX-License-Identifier: Apache-2.0
"""The parts, channels and colour IDs of a relit EXR, read back by PyPI's OpenEXR and OpenImageIO.

Blender (3.4 and 5.0 were tried) and other programs find the layers by these: a source of several parts is answered
with several, each named as its layer; one part with one.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
import OpenImageIO as oiio  # noqa: N813
import pytest
import relume
from conftest import KEY, flat_channels, read_exr, write_exr
from relume import GBuffer, Rig, relight, relight_file

DATA = Path(__file__).parents[1] / "data"
PARTS = DATA / "blender5" / "atelier_main_aa_gbuffer.exr"  # a part per pass
SHIFT = DATA / "blender5" / "atelier_shift_point_gbuffer.exr"  # one part, pixel aspect 0.8
OLD = DATA / "blender3" / "orrery_main_aa_gbuffer.exr"  # one part, as Blender 3.4 writes

Stored = dict[str, tuple[dict[str, Any], dict[str, np.ndarray]]]


def stored(path: Path) -> Stored:
    """Header and channels of each part by its name, in the file's order."""
    with OpenEXR.File(str(path), separate_channels=True) as file:
        return {
            part.name(): (dict(part.header), {name: channel.pixels.copy() for name, channel in part.channels.items()})
            for part in file.parts
        }


def write_parts(path: Path, parts: dict[str, tuple[dict[str, Any], dict[str, np.ndarray]]]) -> Path:
    common = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File([OpenEXR.Part(common | header, channels, name) for name, (header, channels) in parts.items()]).write(
        str(path)
    )
    return path


def flat_parts(beauty: str, *, bare: bool = False, views: bool = False) -> Stored:
    """A flat G-buffer, a part per layer as Blender 5 writes it, with a beauty of this name."""
    parts: Stored = {}
    one = np.ones((4, 6), np.float16)
    layers = {beauty: {c: k * one / 4 for k, c in enumerate("RGBA")}}
    for name, pixels in flat_channels().items():
        layer, _, component = name.rpartition(".")
        layers.setdefault(f"V.{layer}" if layer else "V.roughness", {})[component if layer else "X"] = pixels
    for name, channels in layers.items():
        prefix = "" if bare and name == beauty else f"{name}."
        interop = "lin_ap1_scene" if set("RGB") <= set(channels) else "data"
        for view in ("left", "right") if views else ("",):
            header = {"colorInteropID": interop} | ({"view": view} if view else {})
            full = {prefix + component: np.ascontiguousarray(pixels) for component, pixels in channels.items()}
            parts[f"{name}-{view}" if view else name] = (header, full)
    return parts


@pytest.fixture(scope="module")
def rig() -> Rig:
    rig = Rig.loads(KEY)
    rig.light.add("fill.001", "sun", direction=(-1, -1, -1), irradiance=1)
    rig.output.aovs = ["diffuse", "light:key", "light:fill.001"]
    return rig


AOVS = {"diffuse": "diffuse", "light_key": "light:key", "light_fill_001": "light:fill.001"}


@pytest.mark.parametrize("mode", ["replace", "add"])
@pytest.mark.parametrize("pixels", [np.float16, np.float32])
def test_parts_for_parts(rig: Rig, tmp_path: Path, pixels: type, mode: str) -> None:
    """A part per picture, each named as its layer; channels in them carry the layer, the beauty's are R, G, B, A."""
    rig = Rig.loads(str(rig))
    rig.output.mode, rig.output.type = mode, "half" if pixels is np.float16 else "float"
    gbuffer = GBuffer.read(PARTS)
    want = relight(gbuffer, rig)
    relight_file(gbuffer, rig, tmp_path / "relit.exr")

    parts = stored(tmp_path / "relit.exr")
    assert list(parts) == ["Combined", *AOVS]
    assert sorted(parts["Combined"][1]) == sorted("RGBA")
    for part, (header, channels) in parts.items():
        assert header["colorInteropID"] == "lin_rec709_scene"
        name, prefix, components = ("beauty", "", "RGBA") if part == "Combined" else (AOVS[part], f"{part}.", "RGB")
        assert sorted(channels) == sorted(prefix + c for c in components)
        for k, component in enumerate(components):
            assert channels[prefix + component].dtype == pixels
            np.testing.assert_array_equal(channels[prefix + component], want[name][..., k].astype(pixels))

    image = oiio.ImageInput.open(str(tmp_path / "relit.exr"))
    for k, (part, name) in enumerate({"Combined": "beauty", **AOVS}.items()):
        assert image.seek_subimage(k, 0)
        assert image.spec().getattribute("oiio:subimagename") == part
        got = image.read_image(k, 0, 0, image.spec().nchannels, oiio.FLOAT)
        np.testing.assert_array_equal(got, want[name].astype(pixels))
    assert not image.seek_subimage(len(parts), 0)


@pytest.mark.parametrize("source", [SHIFT, OLD])
def test_one_part_for_one(rig: Rig, tmp_path: Path, source: Path) -> None:
    gbuffer = GBuffer.read(source)
    want = relight(gbuffer, rig)
    relight_file(gbuffer, rig, tmp_path / "relit.exr")
    [(_, channels)] = stored(tmp_path / "relit.exr").values()
    assert set(channels) == {*"RGBA"} | {f"{layer}.{c}" for layer in AOVS for c in "RGB"}
    for layer, name in {"": "beauty", **AOVS}.items():
        for k, component in enumerate("RGB"):
            got = channels[f"{layer}.{component}" if layer else component]
            np.testing.assert_array_equal(got, want[name][..., k].astype(np.float16))


@pytest.mark.parametrize(
    ("beauty", "bare", "views", "part"),
    [
        ("V.Combined", False, False, "Combined"),
        ("V.Combined", False, True, "Combined"),
        ("View Layer.001.Combined", False, False, "Combined"),
        ("rgba", False, False, "rgba"),
        ("beauty", True, False, "rgba"),  # its channels are plain R, G, B, A
    ],
)
def test_name_of_the_beautys_part(rig: Rig, tmp_path: Path, beauty: str, bare: bool, views: bool, part: str) -> None:
    """Blender 5 names a pass by its part where the channels are bare, so "Combined" has to stay that."""
    source = write_parts(tmp_path / "source.exr", flat_parts(beauty, bare=bare, views=views))
    relight_file(source, rig, tmp_path / "relit.exr")
    parts = stored(tmp_path / "relit.exr")
    assert list(parts) == [part, *AOVS]
    assert all("view" not in header for header, _ in parts.values())


def test_beauty_called_as_an_aov(rig: Rig, tmp_path: Path) -> None:
    """Two parts of one name are no EXR."""
    source = write_parts(tmp_path / "source.exr", flat_parts("V.diffuse"))
    gbuffer = GBuffer.read(source, channels={"beauty": "V.diffuse"})
    relight_file(gbuffer, rig, tmp_path / "relit.exr")
    assert list(stored(tmp_path / "relit.exr")) == ["rgba", *AOVS]


def test_color_of_the_beauty_not_of_the_first_part(rig: Rig, tmp_path: Path) -> None:
    """Where data come first, the relit picture is still no data."""
    parts = flat_parts("V.Combined")
    source = write_parts(tmp_path / "source.exr", dict(reversed(parts.items())))
    assert next(iter(stored(source).values()))[0]["colorInteropID"] == "data"
    relight_file(source, rig, tmp_path / "relit.exr")
    assert {header["colorInteropID"] for header, _ in stored(tmp_path / "relit.exr").values()} == {"lin_ap1_scene"}


AP1 = (0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767)  # AMPAS S-2014-004, table 1
REC709 = (0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329)  # ITU-R BT.709-6, item 1.3


@pytest.mark.parametrize("said", [{}, {"chromaticities": REC709}, {"colorInteropID": "lin_rec709_scene"}])
def test_a_space_that_the_rig_gives_is_said_in_the_output(said: dict[str, object], tmp_path: Path) -> None:
    """A picture in ACEScg that says nothing, or Rec.709, is shown in wrong colours."""
    source = write_exr(tmp_path / "source.exr", flat_channels(), **said)
    relight_file(source, Rig.loads(KEY), tmp_path / "as_said.exr")
    [(header, _)] = stored(tmp_path / "as_said.exr").values()
    assert {name for name in header if name in ("chromaticities", "colorInteropID")} == set(said)
    given = Rig.loads(KEY + "[gbuffer]\nworking_space = 'ACEScg'\n")
    relight_file(source, given, tmp_path / "relit.exr")
    [(header, _)] = stored(tmp_path / "relit.exr").values()
    assert header["colorInteropID"] == "lin_ap1_scene"
    np.testing.assert_allclose(header["chromaticities"], AP1, atol=1e-6)
    spec = oiio.ImageInput.open(str(tmp_path / "relit.exr")).spec()
    assert spec.getattribute("oiio:ColorSpace") in ("lin_ap1_scene", "ACEScg", "acescg")
    # The other way round, and into parts.
    ap1 = write_exr(tmp_path / "ap1.exr", flat_channels(), chromaticities=AP1, colorInteropID="lin_ap1_scene")
    relight_file(ap1, Rig.loads(KEY + "[gbuffer]\nworking_space = 'lin_rec709'\n"), tmp_path / "rec709.exr")
    [(header, _)] = stored(tmp_path / "rec709.exr").values()
    assert header["colorInteropID"] == "lin_rec709_scene"
    np.testing.assert_allclose(header["chromaticities"], REC709, atol=1e-6)


def test_no_color_is_not_data(rig: Rig, tmp_path: Path) -> None:
    """One file per channel: what the normal's says of itself is not said of the picture."""
    channels = flat_channels()
    normal = {name: pixels for name, pixels in channels.items() if name.startswith("N")}
    color = {component: channels[f"albedo.{component}"] for component in "RGB"}
    write_exr(tmp_path / "normal.exr", normal, colorInteropID="data", shot="010")
    files = {"base_color": write_exr(tmp_path / "color.exr", color)}
    relight_file(GBuffer.read(tmp_path / "normal.exr", channels=files), rig, tmp_path / "relit.exr")
    [(header, _)] = stored(tmp_path / "relit.exr").values()
    assert "colorInteropID" not in header
    assert header["shot"] == "010"


@pytest.mark.parametrize("several", [False, True])
def test_windows(rig: Rig, tmp_path: Path, several: bool) -> None:
    """Overscan: every part has the source's windows, and pixels stay where they are."""
    windows = {
        "dataWindow": (np.array([-1, 2], np.int32), np.array([4, 5], np.int32)),
        "displayWindow": (np.array([0, 0], np.int32), np.array([9, 8], np.int32)),
        "pixelAspectRatio": 2.0,
    }
    source = tmp_path / "source.exr"
    if several:
        write_parts(source, {name: (header | windows, c) for name, (header, c) in flat_parts("V.Combined").items()})
    else:
        write_exr(source, flat_channels(), **windows)
    gbuffer = GBuffer.read(source)
    relight_file(gbuffer, rig, tmp_path / "relit.exr")
    want = relight(gbuffer, rig)["beauty"]
    parts = stored(tmp_path / "relit.exr")
    assert len(parts) == (4 if several else 1)
    for header, _ in parts.values():
        for name in ("dataWindow", "displayWindow"):
            np.testing.assert_array_equal(header[name], windows[name])
        assert header["pixelAspectRatio"] == 2
    np.testing.assert_array_equal(read_exr(tmp_path / "relit.exr")["R"], want[..., 0].astype(np.float16))
    image = oiio.ImageBuf(str(tmp_path / "relit.exr"))
    assert (image.xbegin, image.ybegin, image.xend, image.yend) == (-1, 2, 5, 6)
    assert (image.spec().full_width, image.spec().full_height) == (10, 9)


def test_names_that_become_one(tmp_path: Path, flat: Path) -> None:
    """Dots and colons turn to "_" in a layer's name; two lights may then be the same layer."""
    rig = Rig.loads(KEY)
    rig.light.add("a.b", "sun", direction=(0, 0, -1), irradiance=1)
    rig.light.add("a_b", "sun", direction=(0, 0, -1), irradiance=1)
    rig.output.aovs = ["light:a.b", "light:a_b"]
    with pytest.raises(relume.Error, match="light_a_b"):
        relight_file(flat, rig, tmp_path / "relit.exr")


@pytest.mark.parametrize("source", [PARTS, OLD])
def test_layers_by_the_rigs_names(rig: Rig, tmp_path: Path, source: Path) -> None:
    relight_file(source, rig, tmp_path / "relit.exr")
    want = relight(source, rig)
    for name in ("light:key", "light:fill.001", "diffuse"):
        np.testing.assert_array_equal(
            relume.read_layer(tmp_path / "relit.exr", name), want[name].astype(np.float16).astype(np.float32)
        )
    np.testing.assert_array_equal(
        relume.read_layer(tmp_path / "relit.exr"), want["beauty"].astype(np.float16).astype(np.float32)
    )
    with pytest.raises(relume.ChannelError, match="no layer 'light:kee'; did you mean 'light_key'"):
        relume.read_layer(tmp_path / "relit.exr", "light:kee")
