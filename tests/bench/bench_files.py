# SPDX-License-Identifier: Apache-2.0
"""./dev bench files: from file to file against its bars, every ratio from one run.

The frame of bench.py as a renderer's EXR: 3840×2160, ZIP, 12 half channels and 4 float ones, 11 of them needed; out
comes RGBA half, ZIP. The parts that today's tools are made of (reading and writing by OpenEXR's C++ library 3.1.5 and
3.5.3, shading by our kernel) are measured beside `relight_file`, which overlaps them.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import frame
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
DEPS = ROOT / ".deps"
WORK = ROOT / "build" / "bench"
SIZE = (3840, 2160)
NEEDED = [f"{layer}.{c}" for layer in ("normal", "position", "base_color") for c in "XYZ"]
NEEDED = [n.replace("color.X", "color.R").replace("color.Y", "color.G").replace("color.Z", "color.B") for n in NEEDED]
NEEDED += ["metallic.V", "roughness.V"]


def make_frame(path: Path, width: int, height: int) -> None:
    """The bench's planes as a renderer would write them: a beauty with its noise, half but for position and depth."""
    import OpenEXR

    planes = frame.planes(width, height)
    random = np.random.default_rng(1)
    beauty = planes["base_color"] * (0.2 + planes["normal"][2]) * random.gamma(60, 1 / 60, (3, height, width))
    channels: dict[str, np.ndarray] = {}
    for name, values, letters in (
        ("beauty", beauty, "RGB"),
        ("normal", planes["normal"], "XYZ"),
        ("base_color", planes["base_color"], "RGB"),
        ("metallic", planes["metallic"], "V"),
        ("roughness", planes["roughness"], "V"),
        ("specular", planes["specular"], "V"),
    ):
        for letter, plane in zip(letters, values, strict=True):
            channels[f"{name}.{letter}"] = np.ascontiguousarray(plane.astype(np.float16))
    for letter, plane in zip("XYZ", planes["position"], strict=True):
        channels[f"position.{letter}"] = np.ascontiguousarray(plane)
    channels["depth.Z"] = np.ascontiguousarray(frame.EYE[2] - planes["position"][2])
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    with OpenEXR.File(header, channels) as file:
        file.write(str(path))


def need_frame(exr: Path) -> None:
    """The frame, made again when what makes it has changed."""
    if not exr.exists() or exr.stat().st_mtime < Path(frame.__file__).stat().st_mtime:
        make_frame(exr, *SIZE)


def rig_text(lights: int) -> str:
    """default_lit under the bench's point lights; `specular` is a constant, so that 11 channels are needed."""
    matrix = ", ".join(str(float(x)) for x in frame.CAMERA.ravel())
    text = f"version = 1\n[camera]\nmatrix = [{matrix}]\nfov = {frame.FOV}\n"
    text += "[[shader]]\nuse = 'default_lit'\nspecular = 0.5\n"
    for k, (position, intensity) in enumerate(frame.lights(lights)):
        text += (
            f"[[light]]\nname = 'l{k}'\ntype = 'point'\nposition = {list(position)}\nintensity = {list(intensity)}\n"
        )
    return text


def imf_program(version: str) -> Path:
    """imf_parts.cpp with the system's OpenEXR ("system"), or with the bundled release's C++ library, built once."""
    program = WORK / f"imf_parts_{version}"
    source = Path(__file__).with_name("imf_parts.cpp")
    if program.exists() and program.stat().st_mtime > source.stat().st_mtime:
        return program
    command = ["g++", "-std=c++17", "-O3", str(source), "-o", str(program)]
    if version == "system":
        flags = subprocess.run(
            ["pkg-config", "--cflags", "--libs", "OpenEXR"], check=True, capture_output=True, text=True
        ).stdout.split()
        command += flags
    else:
        prefix = WORK / f"openexr-{version}"
        if not (prefix / "lib").is_dir():
            build_openexr(version, prefix)
        command += [f"-I{prefix}/include", f"-I{prefix}/include/OpenEXR", "-I/usr/include/Imath"]
        archives = map(str, sorted((prefix / "lib").glob("*.a")))
        command += ["-Wl,--start-group", *archives, "-Wl,--end-group", "-lImath", "-lpthread"]
    subprocess.run(command, check=True)
    return program


def build_openexr(version: str, prefix: Path) -> None:
    """OpenEXR's C++ library from the source release that CMake has fetched for the core."""
    print(f"bench: building OpenEXR {version}'s C++ library, once", file=sys.stderr)
    with tempfile.TemporaryDirectory() as folder:
        shutil.unpack_archive(DEPS / f"openexr-{version}.tar.gz", folder)
        build = Path(folder) / "build"
        options = ["OPENEXR_BUILD_TOOLS", "OPENEXR_BUILD_EXAMPLES", "OPENEXR_TEST_LIBRARIES", "BUILD_TESTING"]
        forced = [f"OPENEXR_FORCE_INTERNAL_{name}" for name in ("DEFLATE", "OPENJPH", "ZSTD")]
        subprocess.run(
            ["cmake", "-S", f"{folder}/openexr-{version}", "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release"]
            + ["-DBUILD_SHARED_LIBS=OFF", f"-DCMAKE_INSTALL_PREFIX={prefix}", "-DCMAKE_CXX_FLAGS=-march=x86-64-v2"]
            + ["-DCMAKE_C_FLAGS=-march=x86-64-v2", "-DCMAKE_INSTALL_LIBDIR=lib"]
            + [f"-D{o}=OFF" for o in options]
            + [f"-D{o}=ON" for o in forced],
            check=True,
            stdout=subprocess.DEVNULL,
        )
        subprocess.run(["cmake", "--build", build], check=True, stdout=subprocess.DEVNULL)
        subprocess.run(["cmake", "--install", build], check=True, stdout=subprocess.DEVNULL)


def run_json(command: list[str], what: str, **environment: str) -> dict:
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=os.environ | environment)
    if done.returncode != 0:
        sys.exit(f"bench: {what} failed:\n{done.stderr}")
    return json.loads(done.stdout.splitlines()[-1])


def contender(name: str, exr: Path, rig: Path, threads: int, repeats: int) -> dict:
    script = Path(__file__).with_name("file_contender.py")
    return run_json(
        [sys.executable, str(script), name, str(exr), str(rig), str(WORK / "out.exr"), str(threads), str(repeats)], name
    )


def run(repeats: int) -> None:
    """Prints figures and ratios."""
    WORK.mkdir(parents=True, exist_ok=True)
    exr, rig = WORK / "frame.exr", WORK / "frame.relume"
    need_frame(exr)
    rig.write_text(rig_text(16))
    threads = min(2, os.cpu_count() or 1)
    print(f"3840×2160, ZIP, 12 half + 4 float channels, {exr.stat().st_size / 1e6:.0f} MB; 16 point lights; ms")
    parts: dict[tuple[str, int], dict] = {}
    ours: dict[int, dict] = {}
    for n in (1, threads):
        for version in ("system", "3.5.3"):
            program = imf_program(version)
            parts[version, n] = run_json(
                [str(program), str(exr), str(WORK / "imf.exr"), str(n), str(repeats), *NEEDED], f"OpenEXR {version}"
            )
        ours[n] = contender("relume", exr, rig, n, repeats)
    wheels = {name: contender(name, exr, rig, threads, max(2, repeats // 2)) for name in ("openexr", "openimageio")}
    for n in (1, threads):
        print(f"{n} thread{'s' if n > 1 else ''}:                 read        write       file to file   (CPU, wall)")
        for version in ("system", "3.5.3"):
            p = parts[version, n]
            read, write = ([1e3 * x for x in p[k]] for k in ("read", "write"))
            print(
                f"  OpenEXR {p['version']:7s}  {read[0]:6.0f} {read[1]:6.0f}  {write[0]:6.0f} {write[1]:6.0f}"
                f"  {sum((read[0], write[0], 1e3 * ours[n]['shade'][0])):6.0f}"
                f" {sum((read[1], write[1], 1e3 * ours[n]['shade'][1])):6.0f}   (sum of parts, our shading)"
            )
        o = {k: [1e3 * x for x in v] for k, v in ours[n].items()}
        print(
            f"  relume           {o['read'][0]:6.0f} {o['read'][1]:6.0f}                 "
            f"{o['whole'][0]:6.0f} {o['whole'][1]:6.0f}   (shading {o['shade'][0]:.0f} {o['shade'][1]:.0f})"
        )
    print(
        "  read by a Python wheel: OpenEXR "
        + f"{1e3 * wheels['openexr']['read'][1]:.0f}, OpenImageIO {1e3 * wheels['openimageio']['read'][1]:.0f} (wall)"
    )

    def total(version: str, n: int, which: int) -> float:
        p = parts[version, n]
        return p["read"][which] + p["write"][which] + ours[n]["shade"][which]

    whole = ours[threads]["whole"]
    ratios = [
        ("of the parts by OpenEXR 3.1's C++ library, wall", whole[1] / total("system", threads, 1), "≤", 0.42),
        ("of the parts by OpenEXR 3.5.3's, wall", whole[1] / total("3.5.3", threads, 1), "≤", 0.85),
        ("of the parts by OpenEXR 3.1's, CPU", ours[1]["whole"][0] / total("system", 1, 0), "≤", 0.45),
        ("times faster with the second thread", ours[1]["whole"][1] / whole[1], "≥", 1.85),
        ("of the OpenEXR wheel's reading, wall", ours[threads]["read"][1] / wheels["openexr"]["read"][1], "≤", 0.45),
        ("of OpenImageIO's reading, wall", ours[threads]["read"][1] / wheels["openimageio"]["read"][1], "≤", 0.25),
    ]
    for what, value, sign, bar in ratios:
        met = value <= bar if sign == "≤" else value >= bar
        print(f"  {value:6.2f} {what} (bar {sign} {bar}){'' if met else '  MISSED'}")
