# SPDX-License-Identifier: Apache-2.0
"""./dev bench: speed and memory against the bars, every ratio from one run: the shading core here, from file to file in
bench_files.py, the command line in bench_sequences.py.

Each contender shades the same frame in a process of its own (tests/bench/contender.py), and all give the same picture,
or the run fails. CPU times are of one thread and the best of several repeats; machines are noisy, ratios less so.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import subprocess
import sys
from pathlib import Path

import bench_doors
import bench_files
import bench_sequences

ROOT = Path(__file__).resolve().parents[2]
BENCH_VENV = ROOT / ".venv-bench"
REQUIREMENTS = ROOT / "tools" / "requirements-bench.txt"


def bench_python() -> str:
    """The Python that has Dr.Jit; made on the first run."""
    python = BENCH_VENV / "bin" / "python"
    stamp = BENCH_VENV / "relume-stamp"
    if not stamp.exists() or stamp.read_text() != REQUIREMENTS.read_text():
        subprocess.run([sys.executable, "-m", "venv", "--clear", BENCH_VENV], check=True)
        subprocess.run(
            [python, "-m", "pip", "install", "-q", "--disable-pip-version-check", "-r", REQUIREMENTS], check=True
        )
        stamp.write_text(REQUIREMENTS.read_text())
    return str(python)


def llvm_library() -> str:
    """The newest libLLVM on the machine; Dr.Jit wants 15 or later."""
    found = [*Path("/usr/lib").glob("*/libLLVM.so.*"), *Path("/usr/lib").glob("*/libLLVM-*.so.1")]
    versions = {
        int("".join(c for c in p.name.split("so.")[-1 if "LLVM.so" in p.name else 0] if c.isdigit())[:2]): p
        for p in found
    }
    usable = {v: p for v, p in versions.items() if v >= 15}
    if not usable:
        sys.exit("bench: Dr.Jit needs LLVM 15 or later: apt-get install libllvm19")
    return str(usable[max(usable)])


def measure(
    name: str, size: tuple[int, int], lights: int, threads: int = 1, repeats: int = 5, isa: str | None = None
) -> dict:
    environment = dict(os.environ)
    python = sys.executable
    if isa:
        environment["RELUME_ISA"] = isa
    if name == "drjit":
        python = bench_python()
        environment.setdefault("DRJIT_LIBLLVM_PATH", llvm_library())
    command = [
        python,
        str(Path(__file__).with_name("contender.py")),
        name,
        *map(str, (*size, lights, threads, repeats)),
    ]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"bench: {' '.join(command[1:])} failed:\n{done.stderr}")
    return json.loads(done.stdout.splitlines()[-1])


def check_same(a: dict, b: dict, what: str) -> None:
    for x, y in zip(a["mean"], b["mean"], strict=True):
        if abs(x - y) > 2e-5 * abs(y):
            sys.exit(f"bench: {what} gives another picture: channel means {a['mean']} and {b['mean']}")


def cpu_name() -> str:
    for line in Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return platform.processor()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "what", nargs="?", choices=("core", "files", "sequences", "doors"), help="one of them; all when absent"
    )
    parser.add_argument("--json", type=Path, help="write the figures to this file as well")
    parser.add_argument("--repeats", type=int, default=7)
    options = parser.parse_args()
    if options.what in (None, "core"):
        core(options)
    if options.what in (None, "files"):
        bench_files.run(options.repeats)
    if options.what in (None, "sequences"):
        bench_sequences.run(options.repeats)
    if options.what in (None, "doors"):
        bench_doors.run(options.repeats)


def core(options: argparse.Namespace) -> None:
    """The shading core in memory."""
    full, part, small = (3840, 2160), (3840, 540), (960, 540)

    threads = min(2, os.cpu_count() or 1)
    print(f"{cpu_name()}, {os.cpu_count()} CPUs; 3840×2160 float planes, default_lit, point lights, {threads} threads")
    wall = {n: measure("relume", full, n, threads, options.repeats) for n in (1, 4, 16)}
    for n, bar in ((1, 20), (4, 33), (16, 100)):
        print(f"  {n:2d} lights  {wall[n]['wall_ms']:7.1f} ms   (bar {bar} ms on an idle AVX-512 machine)")

    best = measure("relume", part, 16, 1, options.repeats)
    scalar = measure("relume", small, 16, 1, 2, isa="scalar")
    plain = measure("numpy", small, 16, 1, 2)
    jit = measure("drjit", part, 16, 1, options.repeats)
    small_best = measure("relume", small, 16, 1, options.repeats)
    check_same(jit, best, "Dr.Jit")
    check_same(plain, small_best, "numpy")
    check_same(scalar, small_best, "the scalar reference")
    print("CPU ns per pixel and light, 16 lights, one thread:")
    for name, result in (("relume", best), ("Dr.Jit LLVM", jit), ("relume, T = float", scalar), ("numpy", plain)):
        print(f"  {name:18s} {result['cpu_ns']:7.2f}")
    ratios = [
        ("of Dr.Jit's CPU time", best["cpu_ns"] / jit["cpu_ns"], "≤", 0.9),
        ("times faster than T = float", scalar["cpu_ns"] / small_best["cpu_ns"], "≥", 10.0),
        ("times faster than numpy", plain["cpu_ns"] / small_best["cpu_ns"], "≥", 15.0),
    ]
    for what, value, sign, bar in ratios:
        met = value <= bar if sign == "≤" else value >= bar
        print(f"  {value:6.2f} {what} (bar {sign} {bar}){'' if met else '  MISSED'}")
    if options.json:
        options.json.write_text(
            json.dumps(
                {
                    "cpu": cpu_name(),
                    "wall_ms": {n: wall[n]["wall_ms"] for n in wall},
                    "cpu_ns": {
                        "relume": best["cpu_ns"],
                        "drjit": jit["cpu_ns"],
                        "scalar": scalar["cpu_ns"],
                        "numpy": plain["cpu_ns"],
                    },
                    "ratios": {what: value for what, value, _, _ in ratios},
                },
                indent=1,
            )
        )


if __name__ == "__main__":
    main()
