# SPDX-License-Identifier: Apache-2.0
"""One contender of ./dev bench in a process of its own: prints a JSON line of CPU and wall times and a checksum.

python contender.py {relume,numpy,drjit} WIDTH HEIGHT LIGHTS THREADS REPEATS
"""

from __future__ import annotations

import json
import os
import sys
import time
from typing import TYPE_CHECKING

import frame
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable


def relume(planes: dict[str, np.ndarray], count: int, threads: int) -> Callable[[], np.ndarray]:
    from relume import GBuffer, Rig, relight

    arrays = {k: np.moveaxis(v, 0, -1) if v.shape[0] == 3 else v[0] for k, v in planes.items()}
    gbuffer = GBuffer(camera={"matrix": frame.CAMERA.tolist(), "fov": frame.FOV}, **arrays)
    rig = Rig.loads("version = 1\n[[shader]]\nuse = 'default_lit'\n")
    for k, (position, intensity) in enumerate(frame.lights(count)):
        rig.light.add(name=f"l{k}", type="point", position=position, intensity=intensity)
    height, width = planes["normal"].shape[1:]
    out = np.zeros((4, height, width), dtype=np.float32)

    def run() -> np.ndarray:
        relight(gbuffer, rig, out={"beauty": np.moveaxis(out, 0, -1)}, threads=threads)
        return out[:3]

    return run


def numpy(planes: dict[str, np.ndarray], count: int, threads: int) -> Callable[[], np.ndarray]:
    assert threads == 1
    components = {k: list(v) for k, v in planes.items()}

    def run() -> np.ndarray:
        return np.stack(
            frame.shade(
                np,
                components,
                count,
                rsqrt=lambda x: 1 / np.sqrt(x),
                rcp=lambda x: 1 / x,
                select=np.where,
                dot=lambda a, b: a[0] * b[0] + a[1] * b[1] + a[2] * b[2],
                constant=np.float32,
            )
        )

    return run


def drjit(planes: dict[str, np.ndarray], count: int, threads: int) -> Callable[[], np.ndarray]:
    import drjit as dr
    from drjit.llvm import Float

    dr.set_thread_count(threads)
    components = {k: [Float(np.ascontiguousarray(c).ravel()) for c in v] for k, v in planes.items()}
    dr.eval(components)
    dr.sync_thread()

    def run() -> np.ndarray:
        # Unrolled over the lights, their values opaque: one kernel for every rig with that many lights.
        out = frame.shade(
            dr,
            components,
            count,
            rsqrt=dr.rsqrt,
            rcp=dr.rcp,
            select=dr.select,
            dot=lambda a, b: dr.fma(a[0], b[0], dr.fma(a[1], b[1], a[2] * b[2])),
            constant=lambda x: dr.opaque(Float, x),
        )
        dr.eval(out)
        dr.sync_thread()
        return out

    return run


def main() -> None:
    name, width, height, count, threads, repeats = sys.argv[1], *map(int, sys.argv[2:7])
    run = {"relume": relume, "numpy": numpy, "drjit": drjit}[name](frame.planes(width, height), count, threads)
    result = run()  # compiles, faults pages in
    cpu, wall = [], []
    for _ in range(repeats):
        c, w = time.process_time(), time.perf_counter()
        result = run()
        cpu.append(time.process_time() - c)
        wall.append(time.perf_counter() - w)
    mean = [float(np.asarray(c).mean(dtype=np.float64)) for c in result]
    scale = 1e9 / (width * height * count)
    print(json.dumps({"cpu_ns": min(cpu) * scale, "wall_ms": min(wall) * 1e3, "mean": mean}))
    sys.stdout.flush()
    os._exit(0)  # Dr.Jit's threads need no farewell


if __name__ == "__main__":
    main()
