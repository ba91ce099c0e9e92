# SPDX-License-Identifier: Apache-2.0
"""./dev bench doors: what a host's door costs over the core, for the frame of bench_files.py.

The core: understanding the G-buffer and relighting it into memory, plus one copy of the picture. OpenImageIO: opening
the rig and reading the picture. Each time with another exposure, so that nothing is there already, and into memory that
the program has had before: fresh pages are the host's own cost. OpenFX: the node in our test host, by clips in its
memory and by the file, against the core on the same (tests/plugins/ofx_bench.cpp). Blender: from a light's change to
pixels in the image datablock (blender_latency.py), where Blender is there as a Python module.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import bench_files

ROOT, WORK = bench_files.ROOT, bench_files.WORK


def core(rig_path: str, threads: int, repeats: int) -> float:
    """Best wall seconds of the core and a copy."""
    import numpy as np
    from relume import GBuffer, Rig, relight

    best = float("inf")
    picture, copy = np.zeros((2, 2160, 3840, 4), np.float32)
    for k in range(repeats + 1):
        start = time.perf_counter()
        rig = Rig.load(rig_path)
        rig.light["l0"].exposure = 1e-6 * k
        relight(GBuffer.read(rig.gbuffer.file, rig=rig, threads=threads), rig, out={"beauty": picture}, threads=threads)
        np.copyto(copy, picture)  # as the host hands pixels out: in memory of its own
        best = min(best, time.perf_counter() - start) if k > 0 else best
    return best


def openimageio_program() -> Path:
    """oiio_door.cpp for the installed OpenImageIO, built once."""
    program, source = WORK / "oiio_door", Path(__file__).with_name("oiio_door.cpp")
    if not program.exists() or program.stat().st_mtime < source.stat().st_mtime:
        command = ["g++", "-std=c++17", "-O2", source, "-o", program, "-lOpenImageIO", "-lOpenImageIO_Util"]
        subprocess.run(command, check=True)
    return program


#: Milliseconds from a light's change to new pixels, 1080p, four lights, two cores.
LATENCY_BAR = 100.0


def blender(repeats: int) -> None:
    """Prints what Blender takes from a light to pixels, and each step's share."""
    home = ROOT / "build" / "blender"
    pythons = sorted(home.glob("venv-*/bin/python"))
    archives = sorted(home.glob("relume-*.zip"))
    if not pythons or not archives:
        print("Blender's latency is left out: ./dev blender-extension fetches Blender and builds the extension")
        return
    resources = WORK / "blender-user"
    shutil.rmtree(resources, ignore_errors=True)
    resources.mkdir(parents=True)
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    environment["BLENDER_USER_RESOURCES"] = str(resources)
    program = Path(__file__).with_name("blender_latency.py")
    # Eight measurements of a light for each repeat: milliseconds scatter more than seconds.
    words = [pythons[-1], program, archives[-1], WORK, str(8 * repeats)]
    done = subprocess.run(list(map(str, words)), env=environment, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"bench: {program.name} failed:\n{done.stderr}")
    result = json.loads(done.stdout.splitlines()[-1])
    cores = os.cpu_count() or 1
    print(f"Blender {result['blender']}, 1920×1080, four lights, {cores} CPUs")
    print("ms from a light to pixels: median, 95th percentile")
    for name, times in result["times"].items():
        ordered = sorted(times)
        median, late = ordered[len(ordered) // 2], ordered[int(0.95 * len(ordered))]
        whole = name in ("whole frame", "proxy")
        bar = f"   (bar ≤ {LATENCY_BAR:.0f}){'' if median <= LATENCY_BAR else '  MISSED'}" if whole else ""
        print(f"  {'' if whole else '  '}{name:{16 if whole else 14}s} {median:7.1f} {late:7.1f}{bar}")


def report(what: str, seconds: float, core_seconds: float) -> None:
    """A door's row, as a share of the core's time."""
    share = seconds / core_seconds
    met = "" if share <= 1.15 else "  MISSED"
    print(f"  {share:6.2f} of that {what}, {1e3 * seconds:.0f} ms (bar ≤ 1.15){met}")


def openfx(rig: Path, exr: Path, repeats: int) -> None:
    """The rows of the node."""
    program = bench_files.ROOT / "build" / "release" / "tests" / "plugins" / "relume_ofx_bench"
    if not program.exists():
        sys.exit(f"bench: {program} was not built")
    seconds = bench_files.run_json([str(program), str(rig), str(exr), str(repeats)], "openfx")
    clips, file = seconds["clips"], seconds["file"]
    print(f"from six float RGBA clips in memory: the core and a copy {1e3 * clips['core']:.0f} ms")
    report("through OpenFX, in one render", clips["frame"], clips["core"])
    report("through OpenFX, in tiles of 256 rows", clips["tiles"], clips["core"])
    print(f"from the EXR: the core and a copy {1e3 * file['core']:.0f} ms")
    report("through OpenFX", file["frame"], file["core"])
    print(f"  {file['again'] / file['core']:6.2f} of that when a knob was turned, {1e3 * file['again']:.0f} ms")


def run(repeats: int) -> None:
    """Prints figures and bars."""
    from relume.hosts import find_openimageio, oiio_plugin

    WORK.mkdir(parents=True, exist_ok=True)
    exr, rig = WORK / "frame.exr", WORK / "door.relume"
    bench_files.need_frame(exr)
    text = bench_files.rig_text(16).replace("[camera]", f"[gbuffer]\nfile = '{exr}'\n[camera]")
    rig.write_text(text + "[output]\ntype = 'float'\n")
    [release] = {found.release for found in find_openimageio() if found.owner == "the system"}
    plugin = oiio_plugin(release)
    if plugin is None:
        sys.exit(f"bench: the plugin for OpenImageIO {release} was not built")
    threads = os.cpu_count() or 1
    repeats = max(repeats, 12)  # more than the cache holds
    us = [sys.executable, str(Path(__file__)), str(rig), str(threads), str(repeats)]
    host = [str(openimageio_program()), str(rig), "l0", str(repeats)]
    seconds = {
        "core": bench_files.run_json(us, "core")["seconds"],
        "openimageio": bench_files.run_json(host, "OpenImageIO", OIIO_LIBRARY_PATH=str(plugin.parent))["seconds"],
    }
    print(f"3840×2160, 16 lights, float, {threads} threads: the core and a copy {1e3 * seconds['core']:.0f} ms")
    report("through OpenImageIO", seconds["openimageio"], seconds["core"])
    openfx(rig, exr, repeats)
    blender(repeats)


if __name__ == "__main__":
    rig_path, threads, repeats = sys.argv[1:4]
    print(json.dumps({"seconds": core(rig_path, int(threads), int(repeats))}))
