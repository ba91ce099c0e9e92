# SPDX-License-Identifier: Apache-2.0
"""Bad input, through the command line: one clear error that names the file, an exit code below 126, no half files."""

from __future__ import annotations

import os
import resource
import shutil
import struct
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
import relume
from conftest import KEY, Ran, flat_channels, read_exr, run_for_memory, run_relume, write_exr
from relume import _relume

OLD = b"what was there before"


class Folder:
    """A folder with a G-buffer, a rig and an output of earlier, to be broken."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.gbuffer = path / "shot.exr"
        self.rig = path / "key.relume"
        self.output = path / "out.exr"
        write_exr(self.gbuffer, flat_channels())
        self.rig.write_text(KEY)
        self.output.write_bytes(OLD)

    def relight(self, *more: object, **settings: object) -> Ran:
        return run_relume("relight", self.gbuffer, "--rig", self.rig, "-o", self.output, *more, **settings)

    def refused(self, *more: object, named: str, code: int = 1, says: str = "", **settings: object) -> str:
        """The relight must fail with this code and one line that names the culprit, and leave everything alone."""
        before = sorted(entry.name for entry in self.path.iterdir())
        ran = self.relight(*more, **settings)
        check_refusal(ran, named, code, says)
        assert self.output.read_bytes() == OLD
        assert sorted(entry.name for entry in self.path.iterdir()) == before, "files were left behind"
        return ran.err


def check_refusal(ran: Ran, named: str, code: int, says: str = "") -> None:
    assert ran.code == code, ran
    lines = ran.err.strip().splitlines()
    assert len(lines) == 1, ran.err
    assert "Traceback" not in ran.err
    assert "internal error" not in ran.err
    assert named in lines[0], lines[0]
    assert says in lines[0], lines[0]


@pytest.fixture
def folder(tmp_path: Path) -> Folder:
    return Folder(tmp_path)


def test_the_folder_is_good(folder: Folder) -> None:
    """What the other tests break works when it is whole."""
    ran = folder.relight()
    assert ran.code == 0, ran
    assert read_exr(folder.output)["R"].max() > 0


def test_missing_file(folder: Folder) -> None:
    folder.gbuffer.unlink()
    folder.refused(named="shot.exr")


def test_not_an_exr(folder: Folder) -> None:
    folder.gbuffer.write_bytes(b"P6\n2 2\n255\n" + bytes(12))
    folder.refused(named="shot.exr", says="EXR")


def test_empty(folder: Folder) -> None:
    folder.gbuffer.write_bytes(b"")
    folder.refused(named="shot.exr")


@pytest.mark.parametrize("share", [0.02, 0.3, 0.7, 0.99])
def test_truncated(folder: Folder, share: float) -> None:
    rng = np.random.default_rng(1)
    noise = {name: plane + rng.random(plane.shape, np.float32) for name, plane in flat_channels(64, 64).items()}
    data = write_exr(folder.gbuffer, noise).read_bytes()
    folder.gbuffer.write_bytes(data[: int(share * len(data))])
    folder.refused(named="shot.exr")


def test_a_folder_for_a_file(folder: Folder) -> None:
    folder.gbuffer.unlink()
    folder.gbuffer.mkdir()
    folder.refused(named="shot.exr")


def test_missing_normal(folder: Folder) -> None:
    channels = {name: plane for name, plane in flat_channels().items() if not name.startswith("N.")}
    write_exr(folder.gbuffer, channels)
    folder.refused(named="shot.exr", says="normal")


def test_mismatched_sizes(folder: Folder) -> None:
    other = write_exr(folder.path / "other.exr", flat_channels(8, 8))
    err = folder.refused("--channel", f"roughness={other}", named="other.exr", says="8x8")
    assert "6x4" in err


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ('[[shader]]\nuse = "lambertt"\n', "lambert"),
        ('[[shader]]\nuse = "ggx"\nroughnes = 0.5\n', "roughness"),
        ('[[light]]\nname = "fill"\ntype = "pont"\n', "point"),
        ('[[light]]\nname = "fill"\ntype = "point"\nintensty = 2\n', "intensity"),
        ('[output]\naovs = ["light:kye"]\n', "light:key"),
        ('[output]\ntype = "hlaf"\n', "half"),
        ("[outptu]\n", "output"),
    ],
)
def test_unknown_names(folder: Folder, text: str, hint: str) -> None:
    folder.rig.write_text(KEY + text)
    err = folder.refused(named="key.relume" if "aovs" not in text else "kye", code=2)
    assert f"'{hint}'" in err


@pytest.mark.parametrize(
    ("setting", "hint"),
    [("light.kye.exposure=1", "key"), ("light.key.exposre=1", "exposure"), ("outptu.type=half", "output")],
)
def test_unknown_settings(folder: Folder, setting: str, hint: str) -> None:
    assert f"'{hint}'" in folder.refused("--set", setting, named=setting.partition("=")[0].split(".")[0], code=2)


def test_out_of_range(folder: Folder) -> None:
    folder.refused("--set", "light.key.exposure=bright", named="exposure", code=2)
    folder.rig.write_text(KEY + '[[shader]]\nuse = "ggx"\nroughness = 7\n')
    folder.refused(named="roughness", code=2)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("channel", ["N.Y", "albedo.G", "roughness"])
def test_not_finite(folder: Folder, channel: str, bad: float) -> None:
    """Not an error: the pixel is left black, counted and told, and its neighbours are as they would be without it."""
    channels = flat_channels()
    folder.output.unlink()
    assert folder.relight().code == 0
    clean = read_exr(folder.output)

    channels[channel] = channels[channel].copy()
    channels[channel][1, 2] = bad
    write_exr(folder.gbuffer, channels)
    ran = folder.relight()
    assert ran.code == 0, ran
    assert "1 pixel with NaN or infinity" in ran.err
    relit = read_exr(folder.output)
    others = np.ones((4, 6), bool)
    others[1, 2] = False
    for name in "RGB":
        assert np.isfinite(relit[name]).all()
        assert relit[name][1, 2] == 0
        np.testing.assert_array_equal(relit[name][others], clean[name][others])


def test_no_such_folder(folder: Folder) -> None:
    ran = run_relume("relight", folder.gbuffer, "--rig", folder.rig, "-o", folder.path / "nowhere" / "out.exr")
    check_refusal(ran, "nowhere", 1)


def test_a_file_for_a_folder(folder: Folder) -> None:
    ran = run_relume("relight", folder.gbuffer, "--rig", folder.rig, "-o", folder.rig / "out.exr")
    check_refusal(ran, "key.relume", 1)


def test_unwritable_folder(folder: Folder) -> None:
    """As a user who may read everything and write nothing here."""
    settings: dict[str, object] = {}
    if os.geteuid() == 0:
        nobody = 65534
        settings = {"user": nobody, "group": nobody, "extra_groups": []}
        for parent in [folder.path, *folder.path.parents[:-1]]:
            if not parent.stat().st_mode & 0o005:
                parent.chmod(parent.stat().st_mode | 0o005)
    folder.path.chmod(0o555)
    try:
        folder.refused(named="out.exr", **settings)
    finally:
        folder.path.chmod(0o755)


def test_full_disk(folder: Folder) -> None:
    """No file may grow beyond 4096 bytes: writing fails half-way, as on a full disk."""
    rng = np.random.default_rng(2)
    noise = {name: plane + rng.random(plane.shape, np.float32) for name, plane in flat_channels(128, 128).items()}
    write_exr(folder.gbuffer, noise)

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))

    folder.refused(named="out.exr", preexec_fn=limit)


def test_full_disk_png(folder: Folder) -> None:
    picture = folder.path / "out.png"
    picture.write_bytes(OLD)
    write_exr(folder.gbuffer, {name: np.random.default_rng(3).random((128, 128), np.float32) for name in "RGB"})

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))

    before = sorted(entry.name for entry in folder.path.iterdir())
    check_refusal(run_relume("png", folder.gbuffer, "-o", picture, preexec_fn=limit), "out.png", 1)
    assert picture.read_bytes() == OLD
    assert sorted(entry.name for entry in folder.path.iterdir()) == before


@pytest.mark.parametrize("text", ["[[light]\n", "version = \n", "\x00\x01\x02", 'name = "', "<xml/>"])
def test_rig_is_not_toml(folder: Folder, text: str) -> None:
    folder.rig.write_text(text)
    folder.refused(named="key.relume:1:", code=2)


def test_rig_is_no_text(folder: Folder) -> None:
    folder.rig.write_bytes(bytes(range(128, 256)))
    folder.refused(named="key.relume", code=2)


def test_rig_is_missing(folder: Folder) -> None:
    folder.rig.unlink()
    folder.refused(named="key.relume", code=2)


def test_no_lights(folder: Folder) -> None:
    folder.rig.write_text("version = 1\n")
    folder.refused(named="light", code=2)


def test_every_light_off(folder: Folder) -> None:
    """Somebody wanted that: black, and a word about it."""
    folder.rig.write_text(KEY + "enabled = false\n")
    ran = folder.relight()
    assert ran.code == 0, ran
    assert "off" in ran.err
    assert read_exr(folder.output)["R"].max() == 0


def test_one_pixel(folder: Folder) -> None:
    write_exr(folder.gbuffer, flat_channels(1, 1))
    ran = folder.relight()
    assert ran.code == 0, ran
    relit = read_exr(folder.output)
    assert relit["R"].shape == (1, 1)
    assert relit["R"][0, 0] > 0


def _with_window(data: bytes, name: bytes, window: tuple[int, int, int, int]) -> bytes:
    """An EXR with another dataWindow or displayWindow in its header (box2i: four little-endian ints)."""
    key = name + b"\0box2i\0" + struct.pack("<i", 16)
    at = data.index(key) + len(key)
    return data[:at] + struct.pack("<4i", *window) + data[at + 16 :]


@pytest.mark.parametrize(
    "window",
    [
        (0, 0, -1, -1),  # 0 × 0
        (0, 0, 65535, 32767),  # 2³¹ pixels
        (0, 0, 2**31 - 2, 0),
        (-(2**31), -(2**31), 2**31 - 1, 2**31 - 1),
        (5, 5, 2, 2),
    ],
)
def test_absurd_windows(folder: Folder, window: tuple[int, int, int, int]) -> None:
    data = _with_window(folder.gbuffer.read_bytes(), b"dataWindow", window)
    folder.gbuffer.write_bytes(_with_window(data, b"displayWindow", window))

    def limit() -> None:
        # What such a header makes a careless reader allocate would not fit.
        resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30))

    folder.refused(named="shot.exr", preexec_fn=limit)


@pytest.mark.parametrize("limit", [None, 2**40])
def test_claims_cost_no_memory(folder: Folder, limit: int | None) -> None:
    """A kilobyte that claims 2³¹ pixels, below the limit or beyond it, is refused within 100 MB, Python and all."""
    window = (0, 0, 65535, 32767)
    data = _with_window(folder.gbuffer.read_bytes()[:1024], b"dataWindow", window)
    folder.gbuffer.write_bytes(_with_window(data, b"displayWindow", window))
    settings = [] if limit is None else ["--set", f"gbuffer.max_pixels={limit}"]
    ran, peak = run_for_memory("relight", folder.gbuffer, "--rig", folder.rig, "-o", folder.output, *settings)
    check_refusal(ran, "shot.exr", 1, "65536x32768")
    assert peak < 100e6


def test_limits_are_the_users(folder: Folder) -> None:
    folder.refused("--set", "gbuffer.max_pixels=11", named="shot.exr", says="limit of 11 (max_pixels)")
    folder.refused("--set", "gbuffer.max_channels=2", named="shot.exr", says="limit of 2 channels (max_channels)")
    assert folder.relight("--set", "gbuffer.max_parts=1").code == 0
    with pytest.raises(relume.FormatError, match="max_pixels"):
        relume.GBuffer.read(folder.gbuffer, max_pixels=11)


@pytest.mark.parametrize("channel", ["N.Y", "albedo.G", "P.X"])
def test_nothing_but_nan(folder: Folder, channel: str) -> None:
    """What a crashed renderer leaves is an error; NaN and infinity behind the surfaces are nobody's business."""
    channels = flat_channels()
    channels["N.Z"] = channels["N.Z"].copy()
    channels["N.Z"][:2] = 0  # background
    channels[channel] = np.full_like(channels[channel], np.nan)
    write_exr(folder.gbuffer, channels)
    pixels = 24 if channel == "N.Y" else 12
    point = (
        KEY.replace('"sun"', '"point"').replace("irradiance = 3.0", "intensity = 3.0").replace("direction", "position")
    )
    folder.rig.write_text(point)
    folder.refused(named="shot.exr", says=f"in all {pixels} pixels")

    channels = flat_channels()
    channels["N.Z"] = channels["N.Z"].copy()
    channels["N.Z"][:2] = 0
    channels["P.X"] = channels["P.X"].copy()
    channels["P.X"][:2] = np.inf
    channels["P.X"][3, 3] = np.nan
    write_exr(folder.gbuffer, channels)
    ran = folder.relight()
    assert ran.code == 0, ran
    assert "1 pixel with NaN or infinity" in ran.err


def test_one_bad_frame(folder: Folder) -> None:
    """The frame is named, the others are written, and its own old output stays."""
    for frame in (1, 2, 3, 5):
        shutil.copy(folder.gbuffer, folder.path / f"shot.{frame:04d}.exr")
    (folder.path / "shot.0002.exr").write_bytes(b"broken")
    (folder.path / "out.0002.exr").write_bytes(OLD)
    nan = {name: np.full_like(plane, np.nan) for name, plane in flat_channels().items()}
    write_exr(folder.path / "shot.0006.exr", nan)
    source, output = folder.path / "shot.####.exr", folder.path / "out.####.exr"
    ran = run_relume("relight", source, "--rig", folder.rig, "-o", output, "--frames", "1-6", "--quiet")
    assert ran.code == 1
    lines = ran.err.strip().splitlines()
    assert len(lines) == 3, ran.err
    assert "frame 2" in lines[0] and "shot.0002.exr" in lines[0]
    assert "frame 4" in lines[1] and "shot.0004.exr" in lines[1]
    assert "frame 6" in lines[2] and "shot.0006.exr" in lines[2] and "NaN" in lines[2]
    assert (folder.path / "out.0002.exr").read_bytes() == OLD
    for frame in (1, 3, 5):
        assert read_exr(folder.path / f"out.{frame:04d}.exr")["R"].max() > 0
    assert not (folder.path / "out.0004.exr").exists() and not (folder.path / "out.0006.exr").exists()


@pytest.mark.parametrize(
    "arguments",
    [("inspect", "{}"), ("png", "{}"), ("relight", "{}", "--rig", "{}", "-o", "x.exr"), ("rig", "check", "{}")],
)
def test_every_command_names_what_is_missing(tmp_path: Path, arguments: tuple[str, ...]) -> None:
    ran = run_relume(*(word.format(tmp_path / "nothing.here") for word in arguments), cwd=tmp_path)
    assert 0 < ran.code < 126
    assert "nothing.here" in ran.err
    assert len(ran.err.strip().splitlines()) == 1, ran.err


def rename_channels(path: Path, names: dict[bytes, bytes]) -> None:
    """Patch names in a header, which no writer of today would write, to names of the same length."""
    data = path.read_bytes()
    for old, new in names.items():
        assert len(old) == len(new)
        assert old in data
        data = data.replace(old, new)
    path.write_bytes(data)


def sources_of(gbuffer: relume.GBuffer, semantic: str) -> list[str]:
    return next(info.sources for info in gbuffer.channels if info.name == semantic)


def test_names_of_a_file_that_are_no_text_are_shown_and_asked_for_as_text(folder: Folder) -> None:
    channels = flat_channels()
    for letter in "XYZ":
        channels[f"lookAAAA.{letter}"] = channels.pop(f"N.{letter}")
    write_exr(folder.gbuffer, channels)
    rename_channels(folder.gbuffer, {b"lookAAAA": b"d\xe9\n\x1b[31m", b"roughness": b"roughnes\x07"})
    shown = "d\u00e9\\n\\x1b[31m"
    message = folder.refused(named=str(folder.gbuffer), says="no normal channel")
    assert f"'{shown}'" in message
    assert "roughnes\\x07" in message
    ran = folder.relight("--channel", f"normal={shown}")
    assert ran.code == 0, ran
    assert np.abs(read_exr(folder.output)["G"]).max() > 0
    ran = run_relume("inspect", folder.gbuffer, "--channel", f"normal={shown}")
    assert ran.code == 0, ran
    assert f"{shown}.XYZ" in ran.out
    assert "\x1b" not in ran.out + ran.err
    assert "\x07" not in ran.out + ran.err
    gbuffer = relume.GBuffer.read(folder.gbuffer, channels={"normal": shown})
    assert sources_of(gbuffer, "normal") == [f"{shown}.{letter}" for letter in "XYZ"]


def test_a_view_whose_name_is_no_text(tmp_path: Path) -> None:
    channels = {f"leAA.{name}": array for name, array in flat_channels().items()}
    path = write_exr(tmp_path / "stereo.exr", channels, multiView=["leAA", "right"])
    rename_channels(path, {b"leAA": b"l\xe9\n!"})
    gbuffer = relume.GBuffer.read(path)
    assert sources_of(gbuffer, "normal")[0] == "l\u00e9\\n!.N.X"


def test_files_whose_names_are_no_text(folder: Folder) -> None:
    strange = folder.path / os.fsdecode(b"sh\xe9t\n.exr")
    folder.gbuffer.rename(strange)
    folder.gbuffer = strange
    assert folder.relight().code == 0
    assert relume.GBuffer.read(strange).channels[0].file == str(strange)
    strange.write_bytes(b"no picture")
    folder.output.write_bytes(OLD)
    folder.refused(named="sh\u00e9t\\n.exr", says="not an EXR")


@pytest.mark.skipif("bundled" not in _relume.openexr_build(), reason="the system's OpenEXR has no HTJ2K")
def test_a_damaged_htj2k_chunk_is_one_line_alone(folder: Folder) -> None:
    """Its decoder has messages of its own, for standard output among others."""
    random = np.random.default_rng(5)
    noise = {name: random.random((64, 64), np.float32) for name in flat_channels()}
    write_exr(folder.gbuffer, noise, compression=OpenEXR.HTJ2K256_COMPRESSION)
    whole = folder.gbuffer.read_bytes()
    failed = 0
    for _ in range(10):
        damaged = bytearray(whole)
        for at in random.integers(len(whole) // 4, len(whole), 40):
            damaged[at] = random.integers(256)
        folder.gbuffer.write_bytes(damaged)
        ran = folder.relight()
        assert ran.out == ""
        if ran.code == 0:  # the damage was of pixels alone
            folder.output.write_bytes(OLD)
            continue
        failed += 1
        check_refusal(ran, str(folder.gbuffer), 1)
    assert failed > 2
