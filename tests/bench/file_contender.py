# SPDX-License-Identifier: Apache-2.0
"""One contender of ./dev bench files in a process of its own: prints a JSON line of the best CPU and wall seconds.

python file_contender.py {relume,openexr,openimageio} FRAME RIG OUT THREADS REPEATS
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from bench_files import NEEDED

if TYPE_CHECKING:
    from collections.abc import Callable


def best(work: Callable[[], object], repeats: int) -> list[float]:
    """[CPU, wall] seconds of the best of the repeats, after one that does not count."""
    work()
    cpu, wall = [], []
    for _ in range(repeats):
        c, w = time.process_time(), time.perf_counter()
        work()
        cpu.append(time.process_time() - c)
        wall.append(time.perf_counter() - w)
    return [min(cpu), min(wall)]


def relume(exr: str, rig_path: str, out: str, threads: int, repeats: int) -> dict[str, list[float]]:
    from relume import GBuffer, Rig, relight, relight_file

    rig = Rig.load(rig_path)
    whole = best(lambda: relight_file(GBuffer.read(exr, rig=rig, threads=threads), rig, out, threads), repeats)
    gbuffer = GBuffer.read(exr, rig=rig)
    names = ("normal", "position", "base_color", "metallic", "roughness")
    read = best(lambda: gbuffer.load(*names, threads=threads), repeats)
    arrays = gbuffer.load(*names, threads=threads)
    memory = GBuffer(camera=gbuffer.camera, **arrays)
    picture = {"beauty": np.moveaxis(np.zeros((4, *gbuffer.shape), np.float32), 0, -1)}
    shade = best(lambda: relight(memory, rig, out=picture, threads=threads), repeats)
    return {"whole": whole, "read": read, "shade": shade}


def openexr(exr: str, rig: str, out: str, threads: int, repeats: int) -> dict[str, list[float]]:
    import OpenEXR

    def read() -> dict[str, np.ndarray]:
        with OpenEXR.File(exr, separate_channels=True) as file:
            channels = file.channels()
            return {name: channels[name].pixels.astype(np.float32) for name in NEEDED}

    return {"read": best(read, repeats)}


def openimageio(exr: str, rig: str, out: str, threads: int, repeats: int) -> dict[str, list[float]]:
    import OpenImageIO

    OpenImageIO.attribute("threads", threads)

    def read() -> np.ndarray:
        image = OpenImageIO.ImageInput.open(exr)
        pixels = image.read_image(OpenImageIO.FLOAT)
        image.close()
        return pixels

    return {"read": best(read, repeats)}


if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).parent))
    name, exr, rig, out, threads, repeats = sys.argv[1:7]
    run = {"relume": relume, "openexr": openexr, "openimageio": openimageio}[name]
    print(json.dumps(run(exr, rig, out, int(threads), int(repeats))))
