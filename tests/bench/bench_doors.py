# SPDX-License-Identifier: Apache-2.0
"""./dev bench doors: what a host's door costs over the core, for the frame of bench_files.py.

The core: understanding the G-buffer and relighting it into memory, plus one copy of the picture. OpenImageIO: opening
the rig and reading the picture, each time with another exposure, so that nothing is there already. OpenFX: the node in
our test host, by clips in its memory and by the file, against the core on the same (tests/plugins/ofx_bench.cpp).
"""

from __future__ import annotations

import json
import os
import sys
import time
from pathlib import Path

import bench_files

WORK = bench_files.WORK


def core(rig_path: str, threads: int, repeats: int) -> float:
    """Best wall seconds of the core and a copy."""
    import numpy as np
    from relume import GBuffer, Rig, relight

    best = float("inf")
    picture = np.zeros((2160, 3840, 4), np.float32)
    for k in range(repeats + 1):
        start = time.perf_counter()
        rig = Rig.load(rig_path)
        rig.light["l0"].exposure = 1e-6 * k
        relight(GBuffer.read(rig.gbuffer.file, rig=rig, threads=threads), rig, out={"beauty": picture}, threads=threads)
        picture.copy()  # as the host hands pixels out: in memory of its own
        best = min(best, time.perf_counter() - start) if k > 0 else best
    return best


def openimageio(rig_path: str, repeats: int) -> float:
    """Best wall seconds of opening and reading through the plugin."""
    import OpenImageIO as oiio  # noqa: N813

    best = float("inf")
    for k in range(repeats + 1):
        start = time.perf_counter()
        image = oiio.ImageInput.open(f"{rig_path}?light.l0.exposure={1e-6 * k}")
        if image is None:
            sys.exit(f"bench: {oiio.geterror()}")
        pixels = image.read_image(0, 0, 0, 4, "float")
        assert pixels is not None and pixels.shape == (2160, 3840, 4)
        best = min(best, time.perf_counter() - start) if k > 0 else best
    return best


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
    from relume.hosts import oiio_plugin

    WORK.mkdir(parents=True, exist_ok=True)
    exr, rig = WORK / "frame.exr", WORK / "door.relume"
    bench_files.need_frame(exr)
    text = bench_files.rig_text(16).replace("[camera]", f"[gbuffer]\nfile = '{exr}'\n[camera]")
    rig.write_text(text + "[output]\ntype = 'float'\n")
    plugin = oiio_plugin("3.2")
    if plugin is None:
        sys.exit("bench: the plugin for OpenImageIO 3.2 was not built")
    os.environ["OPENIMAGEIO_PLUGIN_PATH"] = str(plugin.parent)
    threads = os.cpu_count() or 1
    command = [sys.executable, str(Path(__file__))]
    seconds = {
        name: bench_files.run_json([*command, name, str(rig), str(threads), str(repeats)], name)["seconds"]
        for name in ("core", "openimageio")
    }
    print(f"3840×2160, 16 lights, float, {threads} threads: the core and a copy {1e3 * seconds['core']:.0f} ms")
    report("through OpenImageIO", seconds["openimageio"], seconds["core"])
    openfx(rig, exr, repeats)


if __name__ == "__main__":
    name, rig_path, threads, repeats = sys.argv[1:5]
    result = core(rig_path, int(threads), int(repeats)) if name == "core" else openimageio(rig_path, int(repeats))
    print(json.dumps({"seconds": result}))
