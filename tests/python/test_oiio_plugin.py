# SPDX-License-Identifier: Apache-2.0
"""The OpenImageIO plugin in its hosts: PyPI's wheel in Python, and the installed release's command-line tools.

Each host runs in a process of its own, so that none sees another's libraries.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import relume
from conftest import read_exr, run_relume
from relume.hosts import OpenImageIO, find_openimageio

PLUGINS = Path(relume.__file__).parent / "oiio"
RIG = """
version = 1
[gbuffer]
file = "shot.exr"
[[light]]
name = "key"
type = "sun"
direction = [-0.6, -0.8, 0.5]
irradiance = 2.0
[output]
aovs = ["diffuse", "light:key"]
"""


def folder_of(release: str) -> Path:
    folder = PLUGINS / release
    assert (folder / "relume.imageio.so").exists(), f"{folder}: the plugin was not built"
    return folder


@pytest.fixture
def shot(tmp_path: Path) -> Path:
    """A folder with shot.exr and shot.relume."""
    relume.write_scene("sdf", tmp_path / "shot.exr", width=150, height=90, samples=1)
    (tmp_path / "shot.relume").write_text(RIG)
    return tmp_path


#: The programs of Debian's OpenImageIO, and those of PyPI's wheel beside this Python, which PATH may hold first.
TOOLS = {"2.4": Path("/usr/bin"), "3.2": Path(sys.executable).parent}


def host(
    folder: Path, program: str, *arguments: object, release: str = "2.4", **environment: str
) -> subprocess.CompletedProcess[str]:
    """A program of OpenImageIO, with the plugin."""
    variables = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
    variables |= {"OIIO_LIBRARY_PATH": str(folder_of(release))} | environment
    command = [str(TOOLS[release] / program), *map(str, arguments)]
    return subprocess.run(command, cwd=folder, env=variables, capture_output=True, text=True, timeout=600, check=False)


def python(folder: Path, code: str, release: str = "3.2", **environment: str) -> list[object]:
    """What a program prints as JSON that reads by the wheel, with the plugin; numpy arrays go by files."""
    program = "import json, sys\nimport numpy as np\nimport OpenImageIO as oiio\nout = []\n" + code
    program += "\nprint(json.dumps(out))"
    variables = dict(os.environ) | {"OPENIMAGEIO_PLUGIN_PATH": str(folder_of(release))} | environment
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=folder, env=variables, capture_output=True, text=True, timeout=600
    )
    assert done.returncode == 0, done.stderr
    result: list[object] = json.loads(done.stdout.splitlines()[-1])
    return result


@pytest.mark.parametrize("release", TOOLS)
def test_formats_name_it(shot: Path, release: str) -> None:
    assert host(shot, "oiiotool", "--version", release=release).stdout.startswith(release)
    assert "relume : relume" in host(shot, "oiiotool", "--list-formats", release=release).stdout


@pytest.mark.parametrize("release", TOOLS)
@pytest.mark.parametrize("kind", ["half", "float"])
def test_the_tools_see_what_relight_writes(shot: Path, kind: str, release: str) -> None:
    """oiiotool's copy has the pixels, windows and metadata of the EXR from the command line."""
    rig = relume.Rig.load(shot / "shot.relume")
    rig.output.type = kind
    rig.save(shot / "shot.relume")
    relume.relight_file(shot / "shot.exr", rig, shot / "cli.exr")
    copied = host(shot, "oiiotool", "shot.relume", "-o", "oiio.exr", release=release)
    assert copied.returncode == 0, copied.stderr + copied.stdout
    ours, theirs = relume._relume.ExrFile(shot / "cli.exr"), relume._relume.ExrFile(shot / "oiio.exr")
    assert [part.name for part in theirs.parts] == ["beauty", "diffuse", "light_key"]
    for part, layer in enumerate(("", "diffuse.", "light_key.")):
        channels = dict(theirs.parts[part].channels)
        assert set(channels) == ({"R", "G", "B", "A"} if part == 0 else {"R", "G", "B"})
        assert set(channels.values()) == {"float16" if kind == "half" else "float32"}
        for name in channels:
            np.testing.assert_array_equal(theirs.read(part, [name]), ours.read(0, [layer + name]))
        assert theirs.parts[part].data_window == ours.parts[0].data_window
        assert theirs.parts[part].display_window == ours.parts[0].display_window
    copy, original = (file.parts[0].attributes for file in (theirs, ours))
    for name in ("relume/rig", "relume/channels", "relume/version", "comments"):
        assert copy[name] == original[name]


def test_windows_that_are_not_at_the_origin(shot: Path) -> None:
    """A crop: data window, display window and pixels stand where they stood."""
    cut = host(shot, "oiiotool", "shot.exr", "--crop", "70x50+33+21", "-o", "crop.exr")
    assert cut.returncode == 0, cut.stderr
    (shot / "shot.relume").write_text(RIG.replace("shot.exr", "crop.exr"))
    relume.relight_file(shot / "crop.exr", shot / "shot.relume", shot / "cli.exr")
    assert host(shot, "oiiotool", "shot.relume", "-o", "oiio.exr").returncode == 0
    ours, theirs = relume._relume.ExrFile(shot / "cli.exr").parts[0], relume._relume.ExrFile(shot / "oiio.exr").parts[0]
    assert theirs.data_window == ours.data_window == (33, 21, 70, 50)
    assert theirs.display_window == ours.display_window
    for name in "RGBA":
        np.testing.assert_array_equal(read_exr(shot / "oiio.exr")[name], read_exr(shot / "cli.exr")[name])


def test_other_tools(shot: Path) -> None:
    info = host(shot, "iinfo", "-v", "-a", "shot.relume").stdout
    assert "3 subimages" in info and 'oiio:subimagename: "light_key"' in info and "tile size: 64 x 64" in info
    made = host(shot, "maketx", "shot.relume", "-o", "shot.tx")
    assert made.returncode == 0, made.stderr + made.stdout
    assert (shot / "shot.tx").exists()
    compared = host(shot, "idiff", "-a", "shot.relume", "shot.relume?light.key.exposure=0")
    assert compared.returncode == 0, compared.stdout + compared.stderr


def test_overrides(shot: Path) -> None:
    """Hints and the name change the rig, in every way that a host has."""
    rig = relume.Rig.load(shot / "shot.relume")
    rig.light["key"].exposure = 1.5
    rig.light["key"].color = (1.0, 0.5, 0.25)
    rig.output.type = "float"
    np.save(shot / "wanted.npy", relume.relight(shot / "shot.exr", rig)["beauty"])
    compared = python(
        shot,
        """
wanted = np.load("wanted.npy")
name = "shot.relume?light.key.exposure=1.5&light.key.color=[1,0.5,0.25]&output.type=float"
hints = oiio.ImageSpec()
hints.attribute("relume:light.key.exposure", 1.5)
hints.attribute("relume:light.key.color", "float[3]", (1.0, 0.5, 0.25))
hints.attribute("relume:output.type", "float")
hints.attribute("oiio:UnassociatedAlpha", 1)
image = oiio.ImageInput.open("shot.relume", hints)
out.append(bool(np.array_equal(image.read_image(0, 0, 0, 4, "float"), wanted)))
for buffer in (oiio.ImageBuf(name), oiio.ImageBuf("shot.relume", 0, 0, hints)):
    out.append(bool(np.array_equal(buffer.get_pixels(), wanted)))
""",
    )
    assert compared == [True] * 3
    # Types that hosts have for what is several numbers to a rig.
    told = python(
        shot,
        """
wanted = np.load("wanted.npy")
for kind in ("color", "vector", "float[3]"):
    hints = oiio.ImageSpec()
    hints.attribute("relume:light.key.color", kind, (1.0, 0.5, 0.25))
    hints.attribute("relume:output.aovs", "string[2]", ("diffuse", "specular"))
    image = oiio.ImageInput.open("shot.relume?light.key.exposure=1.5&output.type=float", hints)
    pixels = None if image is None else image.read_image(0, 0, 0, 4, "float")
    out.append(oiio.geterror() if image is None else bool(np.array_equal(pixels, wanted)))
    image.seek_subimage(2, 0)
    out.append(image.spec().get_string_attribute("oiio:subimagename"))
""",
    )
    assert told == [True, "specular"] * 3
    flags = ["--iconfig", "relume:light.key.exposure", "1.5", "--iconfig", "relume:light.key.color", "[1, 0.5, 0.25]"]
    assert (
        host(
            shot, "oiiotool", *flags, "--iconfig", "relume:output.type", "float", "shot.relume", "-o", "o.exr"
        ).returncode
        == 0
    )
    wanted = np.load(shot / "wanted.npy")
    for k, name in enumerate("RGBA"):
        file = relume._relume.ExrFile(shot / "o.exr")
        np.testing.assert_array_equal(file.read(0, [name])[..., 0], wanted[..., k])


def comma_locale(folder: Path) -> dict[str, str]:
    """The environment of a locale whose numbers have commas, made here; systems bring few."""
    if shutil.which("localedef") is None or not Path("/usr/share/i18n/locales/de_DE").exists():
        pytest.skip("no localedef, or no sources of locales")
    subprocess.run(["localedef", "-i", "de_DE", "-f", "UTF-8", folder / "de_DE.UTF-8"], check=True)
    return {"LOCPATH": str(folder), "LC_ALL": "de_DE.UTF-8"}


@pytest.mark.parametrize("release", TOOLS)
def test_another_locale_changes_nothing(shot: Path, release: str) -> None:
    """Pixels and metadata are those of the C locale, and points stay points."""
    (shot / "shot.relume").write_text(RIG + '[[light]]\ntype = "point"\nposition = [0.5, 1.5, 1.25]\n')
    flags = ["--iconfig", "relume:light.key.exposure", "1.25", "shot.relume?light.key.color=[1,0.5,0.25]"]
    environment = comma_locale(shot)
    probe = "import locale; locale.setlocale(locale.LC_ALL, ''); print(locale.localeconv()['decimal_point'])"
    told = subprocess.run([sys.executable, "-c", probe], env=os.environ | environment, capture_output=True, text=True)
    assert told.stdout.strip() == ","
    for name, variables in (("point", {"LC_ALL": "C"}), ("comma", environment)):
        ran = host(shot, "oiiotool", *flags, "-o", f"{name}.exr", release=release, **variables)
        assert ran.returncode == 0, ran.stderr + ran.stdout
    points, commas = (relume._relume.ExrFile(shot / f"{name}.exr") for name in ("point", "comma"))
    for key in ("relume/rig", "relume/channels"):
        assert commas.parts[0].attributes[key] == points.parts[0].attributes[key]
    for name in "RGBA":
        np.testing.assert_array_equal(commas.read(0, [name]), points.read(0, [name]))
    # oiiotool stays in the C locale; a program in Python does not.
    code = """
import locale
locale.setlocale(locale.LC_ALL, "")
image = oiio.ImageInput.open("shot.relume?light.key.color=[1,0.5,0.25]&light.key.exposure=1.25")
spec = image.spec()
out += [spec.get_string_attribute("relume/rig"), spec.get_string_attribute("relume/channels")]
"""
    if release == "3.2":
        rig, channels = python(shot, code, **environment)
        assert rig == points.parts[0].attributes["relume/rig"]
        assert channels == points.parts[0].attributes["relume/channels"]


def test_tiles_and_threads(shot: Path) -> None:
    """Tiles, scanlines and eight threads through an ImageCache give the same pixels."""
    compared = python(
        shot,
        """
from concurrent.futures import ThreadPoolExecutor
image = oiio.ImageInput.open("shot.relume")
whole = image.read_image(0, 0, 0, 4, "half")
spec = image.spec()
for y in range(0, spec.height, spec.tile_height):
    for x in range(0, spec.width, spec.tile_width):
        tile = image.read_tile(x, y, 0, "half")
        part = whole[y : y + 64, x : x + 64]
        out.append(bool(np.array_equal(tile[: part.shape[0], : part.shape[1]], part)))
out.append(bool(np.array_equal(image.read_scanlines(10, 77, 0, 0, 4, "half"), whole[10:77])))
def read(k):
    return np.array_equal(oiio.ImageBuf("shot.relume").get_pixels(oiio.HALF), whole)
with ThreadPoolExecutor(8) as pool:
    out += list(map(bool, pool.map(read, range(50))))
""",
    )
    assert compared and all(compared)


def test_a_changed_file_is_seen(shot: Path) -> None:
    """By the next open, whether the rig changed or the G-buffer; the other one stays what it is."""
    relume.write_scene("sdf", shot / "other.exr", width=150, height=90, samples=1, time=1.0)
    shutil.copy(shot / "shot.relume", shot / "other.relume")
    told = python(
        shot,
        """
import os, shutil
def read():
    image = oiio.ImageInput.open("shot.relume")
    return image.read_image(0, 0, 0, 4, "half")
first = read()
out.append(bool(np.array_equal(read(), first)))
shutil.copy("other.exr", "shot.exr")
second = read()
out.append(bool(np.array_equal(second, first)))
text = open("shot.relume").read()
open("shot.relume", "w").write(text.replace("irradiance = 2.0", "irradiance = 4.0"))
out.append(bool(np.array_equal(read(), second)))
open("shot.relume", "w").write(text)
out.append(bool(np.array_equal(read(), second)))
""",
    )
    assert told == [True, False, False, True]


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("missing.relume", "missing.relume"),
        ("shot.relume?gbuffer.file=gone.exr", "gone.exr"),
        ("shot.relume?light.kex.exposure=1", "'key'"),
        ("shot.relume?light.key.exposure=bright", "exposure"),
        ("broken.relume", "broken.relume:3"),
        ("dark.relume", "light"),
        ("sequence.relume", "say which frame"),
        ("flat.relume", "normal"),
    ],
)
def test_errors_reach_the_host(shot: Path, name: str, says: str) -> None:
    (shot / "broken.relume").write_text("version = 1\n[output]\ntype = 7\n")
    (shot / "dark.relume").write_text('version = 1\n[gbuffer]\nfile = "shot.exr"\n')
    (shot / "sequence.relume").write_text(RIG.replace("shot.exr", "shot.####.exr"))
    (shot / "flat.relume").write_text(RIG.replace("shot.exr", "flat.exr"))
    assert host(shot, "oiiotool", "--create", "16x16", "3", "-o", "flat.exr").returncode == 0
    # oiiotool 2.4 says of any name with a query that fails to open that there is no such file.
    file, _, setting = name.partition("?")
    hint = ["--iconfig", f"relume:{setting.partition('=')[0]}", setting.partition("=")[2]] if setting else []
    ran = host(shot, "oiiotool", *hint, file, "-o", "out.exr")
    assert ran.returncode != 0
    assert says in ran.stderr + ran.stdout
    [error, pixels] = python(
        shot,
        f"""
image = oiio.ImageInput.open({name!r})
error = oiio.geterror() if image is None else ""
if image is not None:
    pixels = image.read_image(0, 0, 0, 4, "float")
    error = image.geterror()
out += [error, False]
good = oiio.ImageInput.open("shot.relume")
out[1] = good is not None and good.read_image(0, 0, 0, 4, "float") is not None
""",
    )
    assert says in str(error)
    assert pixels is True  # the host stays up


def test_other_files_are_left_alone(shot: Path) -> None:
    """OpenImageIO tries every format on what it does not know, with a lock held: no hang, and nothing claimed."""
    shutil.copy(shot / "shot.relume", shot / "rig.txt")
    shutil.copy(shot / "shot.relume", shot / "rig.exr")
    for name in ("rig.txt", "rig.exr"):
        for program in ("oiiotool", "iinfo"):
            ran = host(shot, program, name)  # which gives up on one that hangs
            assert ran.returncode != 0, ran
    shutil.copy(shot / "shot.exr", shot / "image.unknown")
    assert "150" in host(shot, "iinfo", "image.unknown").stdout


def test_a_channel_from_a_png(shot: Path) -> None:
    """The host's own OpenImageIO reads what is not EXR."""
    assert (
        host(shot, "oiiotool", "--create", "150x90", "1", "--addc", "0.25", "-d", "uint16", "-o", "r.png").returncode
        == 0
    )
    (shot / "shot.relume").write_text(RIG.replace('"shot.exr"', '"shot.exr"\n[gbuffer.channels]\nroughness = "r.png"'))
    relume.relight_file(shot / "shot.exr", shot / "shot.relume", shot / "cli.exr")
    ran = host(shot, "oiiotool", "shot.relume", "-o", "oiio.exr")
    assert ran.returncode == 0, ran.stderr + ran.stdout
    for name in "RGB":
        np.testing.assert_array_equal(read_exr(shot / "oiio.exr")[name], read_exr(shot / "cli.exr")[name])


def test_doctor_and_plugins_name_them() -> None:
    ran = run_relume("doctor")
    assert ran.code == 0, ran
    for release in ("2.4 of the system", "3.2 of PyPI's OpenImageIO"):
        [line] = [line for line in ran.out.splitlines() if release in line]
        assert line.endswith("loads")
    for release, tools in TOOLS.items():  # for the oiiotool that the shell would start
        path = f"{tools}{os.pathsep}{os.environ['PATH']}"
        assert run_relume("plugins", "oiio", env=os.environ | {"PATH": path}).out.strip() == str(folder_of(release))
    assert run_relume("plugins", "oiio", "3.0").out.strip() == str(folder_of("3.0"))
    assert "there are: 2.4, 3.0, 3.2" in run_relume("plugins", "oiio", "9.9").err
    # The plugin of another release is told, not passed over as OpenImageIO itself does.
    [system] = [found for found in find_openimageio() if found.owner == "the system"]
    trouble = OpenImageIO(system.library, "3.0", "a test").trouble()
    assert trouble is not None and "libOpenImageIO" in trouble


@pytest.mark.parametrize("release", ["2.4", "3.0", "3.2"])
def test_only_the_entry_points_are_exported(release: str) -> None:
    listed = subprocess.run(
        ["nm", "-D", "--defined-only", folder_of(release) / "relume.imageio.so"],
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    assert sorted(line.split()[-1] for line in listed.splitlines()) == [
        "relume_imageio_library_version",
        "relume_imageio_version",
        "relume_input_extensions",
        "relume_input_imageio_create",
    ]
