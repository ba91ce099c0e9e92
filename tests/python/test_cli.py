# SPDX-License-Identifier: Apache-2.0
"""The other commands: what they print, and that they start quickly."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
import relume
from conftest import KEY, flat_channels, run_relume, write_exr
from relume import light_types, shaders

COMMANDS = ["relight", "inspect", "png", "shaders", "lights", "rig", "scene", "demo", "plugins", "doctor"]


def test_version_and_help() -> None:
    ran = run_relume("--version")
    assert (ran.code, ran.out) == (0, f"relume {relume.__version__}\n")
    ran = run_relume("--help")
    assert ran.code == 0
    for command in COMMANDS:
        assert f"\n  {command} " in ran.out
        ran_help = run_relume(command, "--help")
        assert ran_help.code == 0 and "Usage: relume" in ran_help.out


def test_unknown_command() -> None:
    ran = run_relume("relihgt")
    assert ran.code == 2
    assert "'relight'" in ran.err


def test_help_needs_nothing_heavy() -> None:
    code = """
import sys
from relume.cli import run
run(["--help"])
print([name for name in ("numpy", "rich", "relume._relume") if name in sys.modules])
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.endswith("[]\n")


def test_a_relight_needs_no_numpy(flat: Path, rig: Path, tmp_path: Path) -> None:
    """From file to file no pixel is Python's, and numpy is most of the start-up's time."""
    code = f"""
import sys
from relume.cli import run
assert run(["relight", {str(flat)!r}, "--rig", {str(rig)!r}, "-o", {str(tmp_path / "out.exr")!r}, "--quiet"]) == 0
print([name for name in ("numpy", "rich", "OpenImageIO") if name in sys.modules])
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.endswith("[]\n")


def test_shaders() -> None:
    ran = run_relume("shaders")
    assert ran.code == 0
    for name in shaders:
        assert name in ran.out
    ran = run_relume("shaders", "ggx")
    for row in shaders["ggx"].parameters:
        assert row.name in ran.out
    described = json.loads(run_relume("shaders", "ggx", "--json").out)
    assert [row["name"] for row in described["parameters"]] == [row.name for row in shaders["ggx"].parameters]
    assert len(json.loads(run_relume("shaders", "--json").out)) == len(shaders)
    ran = run_relume("shaders", "gxg")
    assert (ran.code, ran.out) == (2, "")
    assert "'ggx'" in ran.err and len(ran.err.splitlines()) == 1


def test_first_sentence() -> None:
    from relume.cli.shaders import first_sentence

    assert first_sentence("D of [Walter2007, eq. 33], V = 1. The rest.") == "D of [Walter2007, eq. 33], V = 1."
    assert first_sentence("One line.\ndistribution: ggx") == "One line."
    assert first_sentence("No stop") == "No stop"


def test_lights() -> None:
    ran = run_relume("lights")
    for name in light_types:
        assert name in ran.out
    ran = run_relume("lights", "spot")
    assert "cone_angle" in ran.out and "degrees" in ran.out
    assert len(json.loads(run_relume("lights", "--json").out)) == len(light_types)
    assert run_relume("lights", "spott").code == 2


def test_inspect(sdf: Path) -> None:
    ran = run_relume("inspect", sdf)
    assert ran.code == 0, ran
    assert "Blender" in ran.out and "96 × 54" in ran.out
    assert "ViewLayer.Normal.XYZ" in ran.out
    assert "camera: at" in ran.out and "° wide" in ran.out
    data = json.loads(run_relume("inspect", sdf, "--json").out)
    assert data["data_window"] == [0, 0, 96, 54]
    names = {channel["name"]: channel for channel in data["channels"]}
    assert names["normal"]["sources"] == [f"ViewLayer.Normal.{axis}" for axis in "XYZ"]
    assert names["normal"]["reason"]
    assert data["camera"]["error_pixels"] < 0.01
    assert len(data["camera"]["matrix"]) == 4


def test_inspect_heeds_flags_and_rigs(tmp_path: Path, flat: Path) -> None:
    ran = run_relume("inspect", flat, "--channel", "normal.space=camera", "--set", "camera.fov=50", "--json")
    data = json.loads(ran.out)
    normal = next(channel for channel in data["channels"] if channel["name"] == "normal")
    assert "camera space" in normal["interpretation"]
    path = tmp_path / "key.relume"
    path.write_text(KEY + '[gbuffer]\nfile = "flat.exr"\nworking_space = "lin_ap1"\n')
    assert json.loads(run_relume("inspect", "--rig", path, "--json").out)["working_space"].startswith("lin_ap1")


def test_inspect_into_a_closed_pipe(sdf: Path) -> None:
    command = f"{sys.executable} -m relume.cli inspect {sdf} | head -1"
    done = subprocess.run(["bash", "-o", "pipefail", "-c", command], capture_output=True, text=True, check=False)
    assert done.returncode == 0 and done.stderr == ""


def test_rig_check(tmp_path: Path) -> None:
    path = tmp_path / "key.relume"
    path.write_text(KEY + "[output]\naovs = ['diffuse']\n")
    ran = run_relume("rig", "check", path)
    assert ran.code == 0, ran
    assert "key (sun)" in ran.out and "beauty, diffuse" in ran.out
    ran = run_relume("rig", "check", path, "--print", "--set", "light.key.exposure=2")
    assert relume.Rig.loads(ran.out).light["key"].exposure == 2.0
    path.write_text(KEY + "[output]\naovs = ['light:kee']\n")
    ran = run_relume("rig", "check", path)
    assert ran.code == 2 and "light:key" in ran.err
    path.write_text(KEY + "\n[camera]\nfovv = 3\n")
    ran = run_relume("rig", "check", path)
    assert ran.code == 2 and "key.relume:10:1" in ran.err and "'fov'" in ran.err
    path.write_text("version = 1\n")
    assert run_relume("rig", "check", path).code == 2
    path.write_text(KEY + "[[shader]]\nuse = 'cook_torrance'\ndistribution_table = 'lost.exr'\n")
    ran = run_relume("rig", "check", path)
    assert ran.code == 2 and f"distribution_table: {tmp_path / 'lost.exr'}: no such file" in ran.err


@pytest.mark.parametrize(
    "rig", sorted((Path(__file__).parents[2] / "examples" / "rigs").glob("*.relume")), ids=lambda p: p.stem
)
def test_example_rigs(rig: Path) -> None:
    ran = run_relume("rig", "check", rig)
    assert ran.code == 0, ran


def test_scene(tmp_path: Path) -> None:
    ran = run_relume("scene")
    assert ran.code == 0 and "sdf" in ran.out and "cornell" in ran.out
    ran = run_relume("scene", "cornell", "-o", tmp_path / "c.exr", "--size", "32x24", "--samples", "1", "--paths", "1")
    assert ran.code == 0, ran
    assert relume.GBuffer.read(tmp_path / "c.exr").shape == (24, 32)
    ran = run_relume("scene", "cornel", cwd=tmp_path)
    assert ran.code == 2 and "cornell" in ran.err
    assert run_relume("scene", "sdf", "--size", "big").code == 2


def test_doctor(tmp_path: Path) -> None:
    ran = run_relume("doctor")
    assert ran.code == 0, ran
    for word in (
        relume.__version__,
        "OpenEXR",
        "instruction sets",
        "numpy",
        "OpenImageIO",
        "opencolorio",
        "all is well",
    ):
        assert word in ran.out
    (tmp_path / "broken.relume.so").write_bytes(b"not a library")
    (tmp_path / "other.so").write_bytes(b"not ours")
    ran = run_relume("doctor", env=os.environ | {"RELUME_SHADER_PATH": str(tmp_path)})
    assert ran.code == 1
    assert "broken.relume.so: not loaded" in ran.out and "other.so: no plugin" in ran.out and "2 troubles" in ran.out
    ran = run_relume("doctor", env=os.environ | {"RELUME_ISA": "x86-64-v9"})
    assert ran.code == 1 and "x86-64-v9" in ran.out


def test_debug_shows_the_traceback() -> None:
    ran = run_relume("shaders", "gxg", env=os.environ | {"RELUME_DEBUG": "1"})
    assert "Traceback" in ran.err


def test_stereo_and_layers(tmp_path: Path) -> None:
    channels = flat_channels()
    both = {f"{layer}.{name}": plane for layer in ("A", "B") for name, plane in channels.items()}
    both["B.N.X"], both["B.N.Z"] = both["B.N.Z"], both["B.N.X"]
    path = write_exr(tmp_path / "two.exr", both)
    data = json.loads(run_relume("inspect", path, "--part", "B", "--json").out)
    normal = next(channel for channel in data["channels"] if channel["name"] == "normal")
    assert normal["sources"][0] == "B.N.X"


def test_both_modules_are_the_command_line() -> None:
    for module in ("relume", "relume.cli"):
        ran = subprocess.run([sys.executable, "-m", module, "--version"], capture_output=True, text=True, check=False)
        assert ran.returncode == 0 and ran.stdout == f"relume {relume.__version__}\n"
