# SPDX-License-Identifier: Apache-2.0
"""Frames on a farm: Dask with real worker processes, Open Job Description by its own command line."""

from __future__ import annotations

import json
import os
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
from conftest import KEY, flat_channels, read_exr, run_relume, write_exr
from relume.farm import dask
from relume.farm.openjd import chunks, job_template
from relume.frames import parse_frames
from relume.sequence import Frame


@pytest.fixture
def shot(tmp_path: Path, flat: Path, rig: Path) -> Path:
    for n in range(1, 7):
        shutil.copy(flat, tmp_path / f"shot.{n:04}.exr")
    return tmp_path


def frames_in(folder: Path, count: int) -> list[Frame]:
    return [Frame(n, str(folder / f"shot.{n:04}.exr"), folder / f"out.{n:04}.exr") for n in range(1, count + 1)]


def check_outputs(folder: Path, numbers: list[int]) -> None:
    assert sorted(p.name for p in folder.glob("out*")) == [f"out.{n:04}.exr" for n in numbers]
    for n in numbers:
        expected = relume.relight(folder / f"shot.{n:04}.exr", relume.Rig.loads(KEY))["beauty"].astype(np.float16)
        with OpenEXR.File(str(folder / f"out.{n:04}.exr")) as file:
            np.testing.assert_array_equal(file.channels()["RGBA"].pixels, expected)


def test_command_line_on_local_workers(shot: Path) -> None:
    (shot / "shot.0003.exr").write_bytes(b"broken")
    words = ["relight", "shot.####.exr", "--rig", "key.relume", "-o", "out.####.exr", "--json"]
    ran = run_relume(*words, "--dask", "local", "--workers", "2", cwd=shot)
    assert ran.code == 1, ran
    events = [json.loads(line) for line in ran.out.splitlines()]
    statuses = {e["frame"]: e["status"] for e in events if e["event"] == "frame"}
    assert statuses == {1: "done", 2: "done", 3: "failed", 4: "done", 5: "done", 6: "done"}
    assert "shot.0003.exr" in ran.err and "Traceback" not in ran.err
    check_outputs(shot, [1, 2, 4, 5, 6])

    shutil.copy(shot / "shot.0001.exr", shot / "shot.0003.exr")
    os.utime(shot / "shot.0003.exr")
    ran = run_relume(*words, "--dask", "local", "--workers", "1", "--skip-existing", cwd=shot)
    assert ran.code == 0, ran
    assert "1 of 6 frames relit" in ran.err and "5 there already" in ran.err
    check_outputs(shot, [1, 2, 3, 4, 5, 6])


def test_a_killed_worker_loses_nothing(shot: Path) -> None:
    """Workers of a cluster of our own; the one that holds a frame is killed in the middle of it."""
    from distributed import Client, LocalCluster

    pixels = np.random.default_rng(1).random((1500, 2000), np.float32)
    for n in (1, 2, 3, 4):
        write_exr(shot / f"shot.{n:04}.exr", dict.fromkeys(flat_channels(), pixels))
    killed: list[int] = []

    def kill_one(processes: list[int]) -> None:
        limit = time.monotonic() + 60
        while time.monotonic() < limit and not killed:
            for part in shot.glob(".*.part"):  # .PID-N.NAME.part
                pid = int(part.name[1:].split("-")[0])
                if pid in processes:
                    os.kill(pid, signal.SIGKILL)
                    killed.append(pid)
                    return
            time.sleep(0.001)

    with (
        LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster,
        Client(cluster) as client,
    ):
        processes = list(client.run(os.getpid).values())
        watcher = threading.Thread(target=kill_one, args=(processes,))
        watcher.start()
        results = dask.relight_frames(frames_in(shot, 4), relume.Rig.loads(KEY), cluster.scheduler_address, threads=1)
        watcher.join()
    assert killed, "no worker was caught with a frame under way"
    assert sorted((r.frame.number, r.status) for r in results) == [(n, "done") for n in (1, 2, 3, 4)]
    check_outputs(shot, [1, 2, 3, 4])


def test_a_missing_file_is_tried_again(shot: Path) -> None:
    """A file that appears late, as on a slow disk."""
    from distributed import LocalCluster

    late = shot / "shot.0002.exr"
    content = late.read_bytes()
    late.unlink()
    with LocalCluster(n_workers=1, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
        results = dask.relight_frames(frames_in(shot, 2), relume.Rig.loads(KEY), cluster.scheduler_address, retries=1)
        failed = next(r for r in results if r.frame.number == 2)
        assert failed.status == "failed" and isinstance(failed.error, relume.FileError)
        assert str(late) in str(failed.error)

        threading.Timer(0.5, late.write_bytes, (content,)).start()
        results = dask.relight_frames(
            frames_in(shot, 2), relume.Rig.loads(KEY), cluster.scheduler_address, retries=2000
        )
        assert {r.status for r in results} == {"done"}


def test_no_scheduler(shot: Path) -> None:
    with pytest.raises(relume.FileError, match=r"tcp://127.0.0.1:1: no Dask scheduler answers"):
        dask.relight_frames(frames_in(shot, 1), relume.Rig.loads(KEY), "tcp://127.0.0.1:1", timeout=1)


def test_without_dask(shot: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(relume.MissingPackageError, match=r"pip install 'relume\[farm\]'"):
        dask.relight_frames(frames_in(shot, 1), relume.Rig.loads(KEY), "local")


def test_chunks() -> None:
    assert chunks(range(1, 8), 3) == ["1-3", "4-6", "7"]
    assert chunks([1, 3, 5, 7, 20, 23, 24], 4) == ["1-7x2", "20,23,24"]
    for values in (range(-3, 40, 3), [5, 9, 10, 11, 40]):
        back = [n for chunk in chunks(values, 4) for n in parse_frames(chunk)]
        assert back == list(values)


def test_openjd_checks_and_runs(shot: Path) -> None:
    words = ["farm", "openjd", "shot.####.exr", "--rig", "key.relume", "-o", "out.####.exr", "--chunk", "4"]
    ran = run_relume(*words, "--set", "light.key.exposure=1", "--template", "job.json", cwd=shot)
    assert ran.code == 0, ran
    openjd = [sys.executable, "-c", "import sys; from openjd.cli import main; sys.exit(main())"]
    checked = subprocess.run([*openjd, "check", "job.json"], cwd=shot, capture_output=True, text=True, check=False)
    assert checked.returncode == 0, checked.stdout + checked.stderr

    program = shot / "relume"
    program.write_text(f"#!/bin/sh\nexec '{sys.executable}' -m relume.cli \"$@\"\n")
    program.chmod(0o755)
    command = [*openjd, "run", "job.json", "--step", "Relight", "-p", f"Relume={program}"]
    done = subprocess.run(command, cwd=shot, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert sorted(p.name for p in shot.glob("out*")) == [f"out.{n:04}.exr" for n in range(1, 7)]
    rig = relume.Rig.loads(KEY)
    rig.light["key"].exposure = 1
    expected = relume.relight(shot / "shot.0001.exr", rig)["beauty"].astype(np.float16)
    with OpenEXR.File(str(shot / "out.0006.exr")) as file:
        np.testing.assert_array_equal(file.channels()["RGBA"].pixels, expected)


def test_files_that_are_set_mean_the_same_on_every_worker(shot: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    """Tasks of a farm have a current folder of their own; a file's name on the command line is of this one's."""
    rough = np.full((4, 6), 0.9, np.float32)
    for n in range(1, 7):
        write_exr(shot / f"rough.{n:04}.exr", {"roughness": rough})
    more = ["--channel", "roughness=rough.####.exr", "--set", "gbuffer.channels.metallic=rough.####.exr"]
    assert run_relume("relight", "shot.####.exr", "--rig", "key.relume", "-o", "at.####.exr", *more, cwd=shot).code == 0
    ran = run_relume(
        "farm", "openjd", "shot.####.exr", "--rig", "key.relume", "-o", "out.####.exr", *more, "--set",
        "light.key.exposure=0", "--template", "job.json", cwd=shot,
    )  # fmt: skip
    assert ran.code == 0, ran
    script = json.loads((shot / "job.json").read_text())["steps"][0]["script"]["actions"]["onRun"]["args"]
    assert f"roughness={shot}/rough.####.exr" in script
    assert f"gbuffer.channels.metallic={shot}/rough.####.exr" in script
    assert "light.key.exposure=0" in script
    elsewhere = tmp_path_factory.mktemp("elsewhere")
    values = {"{{Param.GBuffer}}": "shot.####.exr", "{{Param.Rig}}": "key.relume", "{{Param.Output}}": "out.####.exr"}
    words = [str(shot / values[w]) if w in values else "1-6" if w.startswith("{{Task") else w for w in script]
    ran = run_relume(*words, cwd=elsewhere)
    assert ran.code == 0, ran
    pixels = {name: read_exr(shot / name)["G"] for name in ("at.0001.exr", "out.0001.exr", "out.0006.exr")}
    np.testing.assert_array_equal(pixels["out.0001.exr"], pixels["at.0001.exr"])
    np.testing.assert_array_equal(pixels["out.0006.exr"], pixels["at.0001.exr"])
    as_it_is = relume.relight(shot / "shot.0001.exr", relume.Rig.loads(KEY))["beauty"][..., 1]
    assert np.abs(pixels["out.0001.exr"] - as_it_is).max() > 0.01


def test_openjd_refuses(shot: Path) -> None:
    with pytest.raises(relume.ArgumentError, match=r"take chunks of 2 or more"):
        job_template("/a.####.exr", "/r", "/o.####.exr", range(2000), 1)
    ran = run_relume("farm", "openjd", "shot.0001.exr", "--rig", "key.relume", "-o", "out.exr", cwd=shot)
    assert ran.code == 2 and "sequence" in ran.err
    ran = run_relume("farm", "openjd", "shot.####.exr", "--rig", "kye.relume", "-o", "out.####.exr", cwd=shot)
    assert ran.code == 2 and "kye.relume" in ran.err
