# SPDX-License-Identifier: Apache-2.0
"""Sequences of frames: overlap, what fails alone, what a killed run leaves."""

from __future__ import annotations

import os
import random
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
import relume
from conftest import KEY, flat_channels, write_exr
from relume.sequence import Frame, inputs_of, is_up_to_date, relight_frames


def frames_in(folder: Path, count: int) -> list[Frame]:
    return [Frame(n, str(folder / f"shot.{n:04}.exr"), folder / f"out.{n:04}.exr") for n in range(1, count + 1)]


@pytest.fixture
def shot(tmp_path: Path, flat: Path) -> Path:
    for n in range(1, 7):
        shutil.copy(flat, tmp_path / f"shot.{n:04}.exr")
    return tmp_path


def test_results_come_in_the_calling_thread(shot: Path) -> None:
    seen: list[tuple[int | None, str, threading.Thread]] = []
    frames = frames_in(shot, 6)
    results = relight_frames(
        frames,
        relume.Rig.loads(KEY),
        on_result=lambda r: seen.append((r.frame.number, r.status, threading.current_thread())),
    )
    assert sorted(r.frame.number or 0 for r in results) == [1, 2, 3, 4, 5, 6]
    assert {status for _, status, _ in seen} == {"done"}
    assert {thread for _, _, thread in seen} == {threading.current_thread()}
    one = relume.relight(frames[0].source, relume.Rig.loads(KEY))["beauty"]
    for frame in frames:
        with OpenEXR.File(str(frame.output)) as file:
            np.testing.assert_array_equal(file.channels()["RGBA"].pixels, one.astype(np.float16))


def test_a_frame_fails_alone(shot: Path) -> None:
    (shot / "shot.0002.exr").unlink()
    (shot / "shot.0003.exr").write_bytes((shot / "shot.0001.exr").read_bytes()[:-30])
    results = relight_frames(frames_in(shot, 6), relume.Rig.loads(KEY))
    failed = {r.frame.number: r.error for r in results if r.status == "failed"}
    assert set(failed) == {2, 3}
    assert isinstance(failed[2], relume.FileError) and isinstance(failed[3], relume.FormatError)
    assert sorted(p.name for p in shot.glob("out*")) == [f"out.{n:04}.exr" for n in (1, 4, 5, 6)]


def test_a_rig_that_fits_no_frame_ends_the_run(shot: Path) -> None:
    with pytest.raises(relume.RigError):
        relight_frames(frames_in(shot, 6), relume.Rig())
    assert not list(shot.glob("out*"))


def test_an_exception_in_a_callback_stops_the_frames(shot: Path) -> None:
    large = np.random.default_rng(1).random((2000, 3000), np.float32)
    for n in (3, 4):
        write_exr(shot / f"shot.{n:04}.exr", dict.fromkeys(flat_channels(), large), compression=OpenEXR.NO_COMPRESSION)

    class EnoughError(Exception):
        pass

    def stop(frame: Frame, share: float) -> None:
        if frame.number in (3, 4):
            raise EnoughError

    with pytest.raises(EnoughError) as caught:
        relight_frames(frames_in(shot, 6), relume.Rig.loads(KEY), on_progress=stop)
    statuses = {r.frame.number: r.status for r in caught.value.results}  # type: ignore[attr-defined]
    assert statuses[1] == statuses[2] == "done"
    assert "cancelled" in statuses.values()
    assert not list(shot.glob(".*.part"))


def test_up_to_date(shot: Path) -> None:
    rig, (frame, *_) = relume.Rig.loads(KEY), frames_in(shot, 1)
    assert not is_up_to_date(frame, rig)
    relight_frames([frame], rig)
    assert is_up_to_date(frame, rig)
    brighter = rig.copy()
    brighter.light["key"].exposure = 1
    assert not is_up_to_date(frame, brighter)
    whole = frame.output.read_bytes()
    for cut in (0, 1, 300, len(whole) // 2, len(whole) - 1):
        frame.output.write_bytes(whole[:cut])
        assert not is_up_to_date(frame, rig), cut
    frame.output.write_bytes(whole)
    assert is_up_to_date(frame, rig)


def test_keyed_rigs(shot: Path) -> None:
    """Each frame has its own exposure, and --skip-existing knows which one a picture was made with."""
    rig = relume.Rig.loads(KEY + "[output]\ntype = 'float'\n")
    rig.light["key"].exposure = relume.Keys([(1, 0.0), (5, 2.0)])
    assert rig.light["key"].exposure == relume.Keys(((1.0, 0.0), (5.0, 2.0)), "linear")
    frames = frames_in(shot, 6)
    relight_frames(frames, rig)
    pictures = []
    for frame in frames:
        with OpenEXR.File(str(frame.output)) as file:
            pictures.append(file.channels()["RGBA"].pixels[..., :3])
    for number, stops in ((2, 0.5), (3, 1.0), (5, 2.0), (6, 2.0)):
        np.testing.assert_allclose(pictures[number - 1], pictures[0] * 2**stops, rtol=1e-5)
    assert all(is_up_to_date(frame, rig) for frame in frames)
    rig.light["key"].exposure = relume.Keys([(1, 0.0), (4, 1.5), (6, 2.0)], "hold")
    # Frames 1, 4 and 6 have the same exposure either way.
    assert [is_up_to_date(frame, rig) for frame in frames] == [True, False, False, True, False, True]
    assert rig.at(5).light["key"].exposure == 1.5
    with pytest.raises(relume.ParameterError, match=r"keys whose frames do not rise"):
        rig.light["key"].exposure = relume.Keys([(2, 0.0), (1, 1.0)])


def test_a_table_is_an_input(shot: Path) -> None:
    table = shot / "lobe.exr"
    write_exr(table, {"Y": np.linspace(0, 1, 12, dtype=np.float32).reshape(3, 4)})
    rig = relume.Rig.loads(
        KEY + f"[[shader]]\nuse = 'cook_torrance'\ndistribution = 'texture'\ndistribution_table = '{table}'\n"
    )
    (frame, *_) = frames_in(shot, 1)
    assert [r.status for r in relight_frames([frame], rig)] == ["done"]
    assert table in inputs_of(frame, rig) and is_up_to_date(frame, rig)
    later = frame.output.stat().st_mtime + 10
    os.utime(table, (later, later))
    assert not is_up_to_date(frame, rig)


def test_killed_at_random_moments(shot: Path) -> None:
    """kill -9 never leaves a half-written frame under its name, and the same command goes on where it was."""
    pixels = np.random.default_rng(1).random((120, 160), np.float32)
    frame = dict.fromkeys(flat_channels(), pixels)
    for n in range(1, 7):
        write_exr(shot / f"shot.{n:04}.exr", frame)
    rig = shot / "key.relume"
    rig.write_text(KEY)
    expected = relume.relight(shot / "shot.0001.exr", rig)["beauty"].astype(np.float16)
    words = "from relume.cli import main; main()"
    command = [sys.executable, "-c", words, "relight", "shot.####.exr", "--rig", rig.name, "-o", "out.####.exr"]

    start = time.monotonic()
    assert subprocess.run(command, cwd=shot, capture_output=True, check=False).returncode == 0
    usual = time.monotonic() - start
    moments = random.Random(1)
    killed = 0
    for _ in range(50):
        for output in shot.glob("out*"):
            if moments.random() < 0.7:
                output.unlink()
        with subprocess.Popen([*command, "--skip-existing"], cwd=shot, stderr=subprocess.DEVNULL) as process:
            time.sleep(moments.uniform(0.3, 1.0) * usual)
            process.send_signal(signal.SIGKILL)
        if process.returncode == -signal.SIGKILL:
            killed += 1
        else:
            usual *= 0.9  # the machine was busier when it was measured
        for output in shot.glob("out*"):
            with OpenEXR.File(str(output)) as file:
                np.testing.assert_array_equal(file.channels()["RGBA"].pixels, expected)
    assert killed >= 10, "most runs were over before they were killed"
    assert subprocess.run([*command, "--skip-existing"], cwd=shot, capture_output=True, check=False).returncode == 0
    assert len(list(shot.glob("out.*"))) == 6
