# SPDX-License-Identifier: Apache-2.0
"""./dev bench sequences: start-up, a sequence against its steady frame time, and the memory of a large frame.

All through the command line, as a farm runs it. Memory is the peak resident set of the whole process.
"""

from __future__ import annotations

import os
import struct
import subprocess
import sys
import time
from pathlib import Path

import bench_files

WORK = bench_files.WORK
RELUME = [sys.executable, "-m", "relume"]
FRAMES = 24
STEADY = 24


def seconds(command: list[str], repeats: int) -> float:
    """The best wall time of a command that must succeed."""
    best = float("inf")
    for _ in range(repeats):
        start = time.perf_counter()
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        best = min(best, time.perf_counter() - start)
        if done.returncode != 0:
            sys.exit(f"bench: {' '.join(command)} failed:\n{done.stderr}")
    return best


# A process's peak counts what its parent held when it was forked: a small parent between.
WATCHED = """
import os, sys
child = os.spawnv(os.P_NOWAIT, sys.argv[1], sys.argv[1:])
_, status, usage = os.wait4(child, 0)
print(usage.ru_maxrss)
sys.exit(os.waitstatus_to_exitcode(status))
"""


def peak_bytes(command: list[str]) -> tuple[int, float]:
    """Peak resident set and wall seconds."""
    start = time.perf_counter()
    done = subprocess.run([sys.executable, "-c", WATCHED, *command], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"bench: {' '.join(command)} failed:\n{done.stderr}")
    return int(done.stdout) * 1024, time.perf_counter() - start


def repeat_rows(source: Path, target: Path, times: int) -> None:
    """A scanline EXR again and again below itself: chunks do not know their surroundings, but for their row."""
    data = source.read_bytes()
    at = 8
    windows = []
    while data[at]:
        name_end = data.index(b"\0", at)
        type_end = data.index(b"\0", name_end + 1)
        if data[at:name_end] in (b"dataWindow", b"displayWindow"):
            windows.append(type_end + 5)
        at = type_end + 5 + struct.unpack_from("<i", data, type_end + 1)[0]
    table = at + 1
    x0, y0, x1, y1 = struct.unpack_from("<4i", data, windows[0])
    height = y1 - y0 + 1
    first = struct.unpack_from("<Q", data, table)[0]
    count = (first - table) // 8
    offsets = struct.unpack_from(f"<{count}Q", data, table)
    header = bytearray(data[:table])
    for window in windows:
        struct.pack_into("<4i", header, window, x0, y0, x1, y0 + height * times - 1)
    with target.open("wb") as file:
        file.write(header)
        start = table + 8 * count * times
        for k in range(times):
            file.write(struct.pack(f"<{count}Q", *(o - first + start + k * (len(data) - first) for o in offsets)))
        body = bytearray(data[first:])
        for k in range(times):
            for offset in offsets:
                y = struct.unpack_from("<i", data, offset)[0]
                struct.pack_into("<i", body, offset - first, y + k * height)
            file.write(body)


def report(what: str, value: float, bar: float, unit: str) -> None:
    print(f"  {value:8.3f} {unit} {what} (bar ≤ {bar} {unit}){'' if value <= bar else '  MISSED'}")


def start_up(repeats: int) -> None:
    tiny, rig = WORK / "tiny.exr", WORK / "frame.relume"
    bench_files.make_frame(tiny, 64, 64)
    report("relume --version", seconds([*RELUME, "--version"], repeats), 0.06, "s")
    command = [*RELUME, "relight", str(tiny), "--rig", str(rig), "-o", str(WORK / "tiny_out.exr"), "--quiet"]
    report("a relight of 64×64 pixels", seconds(command, repeats), 0.25, "s")


def sequence() -> None:
    """The steady time is that of frames in the middle: what more of them add."""
    shot, rig = WORK / "shot", WORK / "frame.relume"
    shot.mkdir(exist_ok=True)
    frame = WORK / "frame_1080p.exr"
    bench_files.make_frame(frame, 1920, 1080)
    for number in range(1, FRAMES + STEADY + 1):
        link = shot / f"in.{number:04d}.exr"
        link.unlink(missing_ok=True)
        os.link(frame, link)

    def relight(last: int) -> float:
        command = [*RELUME, "relight", str(shot / "in.####.exr"), "--rig", str(rig), "--quiet", "--frames", f"1-{last}"]
        return seconds([*command, "-o", str(shot / "out.####.exr")], 3)

    whole, more = relight(FRAMES), relight(FRAMES + STEADY)
    steady = (more - whole) / STEADY
    print(f"  {FRAMES} frames of 1080p in {whole:.2f} s, {steady:.3f} s each when steady")
    report(f"of {FRAMES} steady frames", whole / (FRAMES * steady), 1.05, "×")
    for file in shot.iterdir():
        file.unlink()


def memory() -> None:
    strip, large, rig = WORK / "strip.exr", WORK / "large.exr", WORK / "aovs.relume"
    bench_files.make_frame(strip, 16384, 512)
    repeat_rows(strip, large, 16)
    strip.unlink()
    out = WORK / "large_out.exr"
    for aovs in ([], ["diffuse", "specular"], ["diffuse", "specular"] + [f"light:l{k}" for k in range(16)]):
        rig.write_text(f"{bench_files.rig_text(16)}[output]\naovs = {aovs}\n")
        command = [*RELUME, "relight", str(large), "--rig", str(rig), "-o", str(out), "--quiet"]
        size, wall = peak_bytes(command)
        report(f"at the peak, 16384×8192 with {len(aovs)} AOVs ({wall:.1f} s)", size / 1e6, 600, "MB")
    large.unlink()
    out.unlink()


def run(repeats: int) -> None:
    """Prints figures and bars."""
    WORK.mkdir(parents=True, exist_ok=True)
    (WORK / "frame.relume").write_text(bench_files.rig_text(16))
    print("The command line, from start to end:")
    start_up(repeats)
    sequence()
    memory()
