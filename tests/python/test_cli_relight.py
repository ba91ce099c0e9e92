# SPDX-License-Identifier: Apache-2.0
"""`relume relight`: sequences, what is refused, exit codes, interruption."""

from __future__ import annotations

import json
import os
import pty
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
import relume
from conftest import KEY, flat_channels, read_exr, run_for_memory, run_relume, write_exr


@pytest.fixture
def shot(tmp_path: Path, flat: Path, rig: Path) -> Path:
    """shot.1001.exr to shot.1004.exr."""
    for frame in range(1001, 1005):
        shutil.copy(flat, tmp_path / f"shot.{frame}.exr")
    return tmp_path


def relight(folder: Path, *arguments: str):  # type: ignore[no-untyped-def]
    return run_relume("relight", *arguments, "--rig", "key.relume", cwd=folder)


def outputs(folder: Path) -> list[str]:
    return sorted(entry.name for entry in folder.glob("out*"))


def test_one_file(shot: Path) -> None:
    ran = relight(shot, "flat.exr", "-o", "out.exr")
    assert ran.code == 0, ran
    assert "out.exr" in ran.err and ran.out == ""
    expected = relume.relight(shot / "flat.exr", shot / "key.relume")["beauty"]
    for index, letter in enumerate("RGBA"):
        np.testing.assert_array_equal(read_exr(shot / "out.exr")[letter], expected[..., index].astype(np.float16))


def test_sequence(shot: Path) -> None:
    ran = relight(shot, "shot.####.exr", "-o", "out.####.exr", "--frames", "1001-1004x2")
    assert ran.code == 0, ran
    assert outputs(shot) == ["out.1001.exr", "out.1003.exr"]
    assert "2 of 2 frames relit" in ran.err


@pytest.mark.parametrize(
    ("source", "target"), [("shot.%04d.exr", "out.%05d.exr"), ("shot.{frame}.exr", "out.{frame:05d}.exr")]
)
def test_other_patterns_and_all_frames(shot: Path, source: str, target: str) -> None:
    assert relight(shot, source, "-o", target).code == 0
    assert outputs(shot) == [f"out.0{frame}.exr" for frame in range(1001, 1005)]


def test_skip_existing(shot: Path) -> None:
    sequence = ["shot.####.exr", "-o", "out.####.exr", "--skip-existing"]
    assert relight(shot, *sequence).code == 0
    first = {name: (shot / name).stat().st_mtime_ns for name in outputs(shot)}

    # Nothing has changed.
    ran = relight(shot, *sequence)
    assert ran.code == 0, ran
    assert "0 of 4 frames relit" in ran.err and "4 there already" in ran.err
    assert {name: (shot / name).stat().st_mtime_ns for name in outputs(shot)} == first

    # One is half there, one is older than its input.
    whole = (shot / "out.1002.exr").read_bytes()
    (shot / "out.1002.exr").write_bytes(whole[:-40])
    os.utime(shot / "out.1003.exr", (1, 1))
    ran = relight(shot, *sequence)
    assert "2 of 4 frames relit" in ran.err and "2 there already" in ran.err
    assert (shot / "out.1002.exr").read_bytes() == whole

    # Another rig.
    ran = relight(shot, *sequence, "--set", "light.key.exposure=1")
    assert "4 of 4 frames relit" in ran.err


def test_json_events(shot: Path) -> None:
    (shot / "shot.1003.exr").write_bytes(b"broken")
    ran = relight(shot, "shot.####.exr", "-o", "out.####.exr", "--json", "--quiet")
    assert ran.code == 1
    events = [json.loads(line) for line in ran.out.splitlines()]
    assert events[0] == {"event": "start", "frames": 4}
    frames = {e["frame"]: e for e in events if e["event"] == "frame"}
    assert {n: e["status"] for n, e in frames.items()} == {1001: "done", 1002: "done", 1003: "failed", 1004: "done"}
    assert "shot.1003.exr" in frames[1003]["error"]
    assert frames[1001]["shaded"] == 24 and frames[1001]["output"] == "out.1001.exr" and frames[1001]["seconds"] > 0
    summary = events[-1]
    assert summary["event"] == "summary" and summary["failed"] == [1003] and summary["done"] == 3
    assert summary["frames_per_second"] > 0 and not summary["interrupted"]


def test_a_summary_names_the_frames(shot: Path) -> None:
    (shot / "shot.1003.exr").unlink()
    ran = relight(shot, "shot.####.exr", "-o", "out.####.exr", "--frames", "1001-1005")
    assert ran.code == 1
    table = {line.split()[0]: line.split()[1:] for line in ran.err.splitlines() if line.startswith(("relit", "failed"))}
    assert table["relit"] == ["3", "1001-1002,", "1004"]
    assert table["failed"] == ["2", "1003,", "1005"]


def test_settings(shot: Path) -> None:
    assert relight(shot, "flat.exr", "-o", "out1.exr", "--set", "output.type=float").code == 0
    more = ["--set", "light.key.exposure=1", "--set", "output.type=float", "--threads", "1"]
    assert relight(shot, "flat.exr", "-o", "out2.exr", *more).code == 0
    one, two = read_exr(shot / "out1.exr"), read_exr(shot / "out2.exr")
    assert one["R"].dtype == np.float32
    np.testing.assert_allclose(two["R"], 2 * one["R"], rtol=1e-6)


def test_channels(shot: Path) -> None:
    channels = flat_channels()
    channels |= {"other.X": channels["N.X"], "other.Y": -channels["N.Z"], "other.Z": channels["N.X"]}
    write_exr(shot / "two.exr", channels)
    assert relight(shot, "two.exr", "-o", "out1.exr", "--channel", "normal=other").code == 0
    assert (
        relight(shot, "two.exr", "-o", "out2.exr", "--channel", "normal=other", "--channel", "normal.flip=y").code == 0
    )
    # The sun travels towards −y: a surface that looks that way is dark, its opposite is lit.
    assert read_exr(shot / "out1.exr")["R"].max() == 0
    assert read_exr(shot / "out2.exr")["R"].min() > 0


def test_the_rig_names_the_gbuffer(shot: Path) -> None:
    (shot / "key.relume").write_text(KEY + '[gbuffer]\nfile = "shot.####.exr"\n')
    assert relight(shot, "-o", "out.####.exr", "--frames", "1002").code == 0
    assert outputs(shot) == ["out.1002.exr"]


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["shot.####.exr", "-o", "out.exr"], "one file"),
        (["shot.####.exr", "-o", "shot.####.exr"], "overwrite an input"),
        (["shot.####.exr", "-o", "../{folder}/shot.%d.exr"], "overwrite an input"),
        (["flat.exr", "-o", "./flat.exr"], "overwrite an input"),
        (["flat.exr", "-o", "out.png"], "EXR"),
        (["flat.exr", "-o", "out.exr", "--frames", "1-2"], "sequence"),
        (["shot.####.exr", "-o", "out.####.exr", "--frames", "1002-"], "1002-"),
        (["shot.####.exr", "-o", "out.####.exr", "--threads", "0"], "--threads"),
        (["flat.exr", "-o", "out.exr", "--set", "light.key.exposure"], "KEY=VALUE"),
        (["flat.exr", "-o", "out.exr", "--channel", "normall=N"], "'normal'"),
        (["-o", "out.exr"], "no file to read"),
        (["flat.exr"], "--output"),
    ],
)
def test_refused_as_usage(shot: Path, arguments: list[str], says: str) -> None:
    before = {entry.name: entry.read_bytes() for entry in shot.iterdir()}
    ran = relight(shot, *(word.format(folder=shot.name) for word in arguments))
    assert ran.code == 2, ran
    assert says in ran.err
    assert {entry.name: entry.read_bytes() for entry in shot.iterdir()} == before


def test_an_output_over_another_input(shot: Path) -> None:
    """Channels from other files are inputs too."""
    ran = relight(shot, "flat.exr", "-o", "shot.1001.exr", "--channel", "roughness=shot.1001.exr")
    assert ran.code == 2
    assert "overwrite an input" in ran.err


def test_no_such_frames(shot: Path) -> None:
    ran = relight(shot, "nothing.####.exr", "-o", "out.####.exr")
    assert ran.code == 1
    assert "nothing.####.exr" in ran.err


def test_a_link_to_the_input_is_the_input(shot: Path) -> None:
    (shot / "out.exr").symlink_to(shot / "flat.exr")
    assert relight(shot, "flat.exr", "-o", "out.exr").code == 2


def test_warnings_are_told_once(shot: Path) -> None:
    channels = flat_channels()
    channels["roughness"][1, 1] = np.nan
    for frame in range(1001, 1005):
        write_exr(shot / f"shot.{frame}.exr", channels)
    ran = relight(shot, "shot.####.exr", "-o", "out.####.exr")
    assert ran.code == 0
    assert ran.err.count("NaN or infinity in roughness") == 2
    assert "(4 frames)" in ran.err


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_interruption(shot: Path, number: int) -> None:
    """The frame under way leaves nothing behind; those before it stay."""
    large = np.random.default_rng(1).random((3000, 4000), np.float32)
    write_exr(shot / "big.0001.exr", dict.fromkeys(flat_channels(), large[:4, :4]))
    write_exr(shot / "big.0002.exr", dict.fromkeys(flat_channels(), large), compression=OpenEXR.NO_COMPRESSION)
    command = [
        sys.executable,
        "-m",
        "relume.cli",
        "relight",
        "big.####.exr",
        "--rig",
        "key.relume",
        "-o",
        "out.####.exr",
    ]
    with subprocess.Popen(command, cwd=shot, stderr=subprocess.PIPE, text=True) as process:
        limit = time.monotonic() + 30
        while not (shot / "out.0001.exr").exists() or len(list(shot.glob(".*")) + list(shot.glob("*tmp*"))) == 0:
            assert process.poll() is None, process.stderr and process.stderr.read()
            assert time.monotonic() < limit
            time.sleep(0.002)
        process.send_signal(number)
        _, err = process.communicate(timeout=30)
    assert process.returncode == 3, err
    assert "interrupted" in err and "Traceback" not in err
    assert outputs(shot) == ["out.0001.exr"]
    assert not [entry for entry in shot.iterdir() if entry.name.startswith(".") or "tmp" in entry.name]


def test_progress_bar(shot: Path) -> None:
    """On a terminal there is a bar, and errors stay readable."""
    (shot / "shot.1003.exr").write_bytes(b"broken")
    main, other = pty.openpty()
    command = [
        sys.executable,
        "-m",
        "relume.cli",
        "relight",
        "shot.####.exr",
        "--rig",
        "key.relume",
        "-o",
        "out.####.exr",
    ]
    with subprocess.Popen(
        command, cwd=shot, stderr=other, env=os.environ | {"TERM": "xterm", "COLUMNS": "200"}
    ) as process:
        os.close(other)
        text = b""
        while True:
            try:
                more = os.read(main, 4096)
            except OSError:
                break
            if not more:
                break
            text += more
    os.close(main)
    assert process.returncode == 1
    shown = text.decode()
    assert "100%" in shown and "4/4" in shown
    assert "frame 1003" in shown
    assert "3 of 4 frames relit" in shown and "1 failed: 1003" in shown


def test_memory_is_that_of_bands(tmp_path: Path) -> None:
    """A frame of 8192×1024 holds 340 MB of channels alone; it passes through in bands, whatever comes out."""
    write_exr(tmp_path / "large.exr", flat_channels(1024, 8192))
    peaks = []
    for aovs in ([], ["diffuse", "specular", "light:key"]):
        rig = tmp_path / "rig.relume"
        rig.write_text(f"{KEY}[output]\naovs = {aovs}\n")
        ran, peak = run_for_memory(
            "relight", tmp_path / "large.exr", "--rig", rig, "-o", tmp_path / "out.exr", "--quiet"
        )
        assert ran.code == 0, ran
        peaks.append(peak)
    assert peaks[0] < 150e6
    # Four planes of bands more, of each of two threads or more.
    assert peaks[1] < peaks[0] + 50e6
