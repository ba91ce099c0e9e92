# SPDX-License-Identifier: Apache-2.0
"""relight() and relight_file(): values, arrays to write into, threads, interruption."""

from __future__ import annotations

import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
import relume
from conftest import KEY, cpu_seconds, flat_channels, read_exr, write_exr
from relume import GBuffer, Rig, relight, relight_file, shaders

SUN = np.array([0.3, -0.8, -0.5])


def random_gbuffer(height: int = 37, width: int = 53) -> tuple[GBuffer, dict[str, np.ndarray]]:
    rng = np.random.default_rng(11)
    normal = rng.normal(size=(height, width, 3))
    normal /= np.linalg.norm(normal, axis=2, keepdims=True)
    view = rng.normal(size=(height, width, 3))
    view /= np.linalg.norm(view, axis=2, keepdims=True)
    view *= np.where(np.sum(view * normal, axis=2, keepdims=True) < 0, -1, 1)
    arrays = {
        "normal": normal.astype(np.float32),
        "view": view.astype(np.float32),
        "base_color": rng.random((height, width, 3), np.float32),
        "roughness": rng.uniform(0.2, 1, (height, width)).astype(np.float32),
    }
    return GBuffer(**arrays), arrays


@pytest.fixture(scope="module")
def ggx_rig() -> Rig:
    rig = Rig.loads(KEY)
    rig.shader.add("ggx")
    rig.output.aovs = ["diffuse", "specular", "light:key"]
    return rig


def test_against_evaluate(ggx_rig: Rig) -> None:
    """Every pixel is the light times what the same shader says on arrays, in double."""
    gbuffer, arrays = random_gbuffer()
    result = relight(gbuffer, ggx_rig)
    to_light = -SUN / np.linalg.norm(SUN)
    unit = {name: arrays[name].astype(np.float64) for name in ("normal", "view")}
    for vectors in unit.values():
        vectors /= np.linalg.norm(vectors, axis=2, keepdims=True)
    value = shaders["ggx"].evaluate(
        n=unit["normal"],
        v=unit["view"],
        l=to_light,
        base_color=arrays["base_color"].astype(np.float64),
        roughness=arrays["roughness"].astype(np.float64),
    )
    for name, expected in (("diffuse", 3 * value.diffuse), ("specular", 3 * value.specular)):
        np.testing.assert_allclose(result[name], expected, rtol=5e-4, atol=2e-5)
    both = 3 * (value.diffuse + value.specular)
    np.testing.assert_allclose(result["beauty"][..., :3], both, rtol=5e-4, atol=2e-5)
    np.testing.assert_allclose(result["light:key"], both, rtol=5e-4, atol=2e-5)
    assert result.report.shaded == 37 * 53


def test_result(ggx_rig: Rig) -> None:
    gbuffer, _ = random_gbuffer()
    result = relight(gbuffer, ggx_rig)
    assert list(result) == ["beauty", "diffuse", "specular", "light:key"]
    assert result["beauty"].shape == (37, 53, 4)
    assert result["diffuse"].shape == (37, 53, 3)
    assert all(array.dtype == np.float32 for array in result.values())
    with pytest.raises(KeyError, match="'diffuse'"):
        result["difuse"]
    assert result.get("nothing") is None
    report = result.report
    assert (report.pixels, report.background, report.nonfinite) == (37 * 53, 0, {})
    assert report.seconds > 0


@pytest.mark.parametrize("dtype", [np.float32, np.float16])
def test_out(ggx_rig: Rig, dtype: type) -> None:
    gbuffer, _ = random_gbuffer()
    expected = relight(gbuffer, ggx_rig)
    beauty = np.full((4, 37, 53), np.nan, dtype)
    wide = np.full((37, 53 * 2, 3), 7, dtype)
    out = {"beauty": np.moveaxis(beauty, 0, -1), "diffuse": wide[::-1, 53 - 1 :: -1]}
    result = relight(gbuffer, ggx_rig, out=out)
    assert result["beauty"] is out["beauty"]
    assert result["diffuse"] is out["diffuse"]
    np.testing.assert_array_equal(np.moveaxis(beauty, 0, -1), expected["beauty"].astype(dtype))
    np.testing.assert_array_equal(wide[::-1, 53 - 1 :: -1], expected["diffuse"].astype(dtype))
    np.testing.assert_array_equal(wide[:, 53:], np.full((37, 53, 3), 7, dtype))
    np.testing.assert_array_equal(result["specular"], expected["specular"])


def test_half_does_not_overflow(tmp_path: Path) -> None:
    """What is finite stays so, in arrays and in files; infinity in the input is black, as ever."""
    emission = np.array([1, 65504, 65519, 65520, 1e6, 1e37, np.inf, np.nan], np.float32)
    wanted = np.array([1, 65504, 65504, 65504, 65504, 65504, 0, 0], np.float16)
    normal = np.zeros((1, 8, 3), np.float32)
    normal[..., 2] = 1
    gbuffer = GBuffer(normal=normal, emission=np.repeat(emission[None, :, None], 3, axis=2), base_color=0 * normal)
    rig = Rig.loads(KEY)
    rig.shader.add("lambert")
    interleaved, planar = np.zeros((1, 8, 4), np.float16), np.zeros((4, 1, 8), np.float16)
    for beauty in (interleaved, np.moveaxis(planar, 0, -1)):
        relight(gbuffer, rig, out={"beauty": beauty})
        np.testing.assert_array_equal(beauty[0, :, 1], wanted)
    relight_file(gbuffer, rig, tmp_path / "half.exr")
    np.testing.assert_array_equal(read_exr(tmp_path / "half.exr")["G"][0], wanted)
    whole = relight(gbuffer, rig)["beauty"][0, :6, 1]
    np.testing.assert_allclose(whole, emission[:6], rtol=1e-6)


def test_threads_change_nothing(ggx_rig: Rig) -> None:
    gbuffer, _ = random_gbuffer()
    one, five = relight(gbuffer, ggx_rig, threads=1), relight(gbuffer, ggx_rig, threads=5)
    for name in one:
        np.testing.assert_array_equal(one[name], five[name])


def test_kept_channels_and_steps(ggx_rig: Rig, tmp_path: Path) -> None:
    """The bits of the whole, from a file that is not there any more."""
    path = tmp_path / "scene.exr"
    relume.write_scene("sdf", path, width=53, height=37, samples=4)
    expected = relight(path, ggx_rig)
    gbuffer = GBuffer.read(path)
    gbuffer.keep_channels(1 << 30)
    relight(gbuffer, ggx_rig)
    path.write_bytes(b"another file")
    for name, array in relight(gbuffer, ggx_rig).items():
        np.testing.assert_array_equal(array.view(np.uint32), expected[name].view(np.uint32))
    for name, array in relight(gbuffer, ggx_rig, step=3).items():
        np.testing.assert_array_equal(array, expected[name][::3, ::3])
    with pytest.raises(relume.ArgumentError, match="step is 0"):
        relight(gbuffer, ggx_rig, step=0)
    with pytest.raises(relume.ArgumentError, match=r"\(19, 27, 4\)"):
        relight(gbuffer, ggx_rig, out={"beauty": np.zeros((37, 53, 4), np.float32)}, step=2)


def readonly() -> np.ndarray:
    array = np.zeros((37, 53, 4), np.float32)
    array.flags.writeable = False
    return array


@pytest.mark.parametrize(
    ("out", "error", "says"),
    [
        ({"beuty": np.zeros((37, 53, 4), np.float32)}, relume.UnknownNameError, "'beauty'"),
        ({"beauty": np.zeros((37, 53, 3), np.float32)}, relume.ArgumentError, "(37, 53, 4)"),
        ({"beauty": np.zeros((36, 53, 4), np.float32)}, relume.ArgumentError, "(37, 53, 4)"),
        ({"beauty": np.zeros((37, 53, 4))}, relume.ArgumentError, "float32"),
        ({"beauty": np.zeros((37, 53, 4), np.uint32)}, relume.ArgumentError, "float32"),
        ({"beauty": readonly()}, relume.ArgumentError, "read-only"),
        ({"beauty": [[1.0]]}, relume.ArgumentError, "numpy"),
    ],
)
def test_out_refusals(ggx_rig: Rig, out: dict[str, np.ndarray], error: type[Exception], says: str) -> None:
    gbuffer, _ = random_gbuffer()
    with pytest.raises(error) as caught:
        relight(gbuffer, ggx_rig, out=out)
    assert says in str(caught.value)


def test_refusals(ggx_rig: Rig) -> None:
    gbuffer, _ = random_gbuffer()
    with pytest.raises(relume.RigError, match="light"):
        relight(gbuffer, Rig())
    with pytest.raises(relume.ArgumentError, match="threads"):
        relight(gbuffer, ggx_rig, threads=0)
    lamp = Rig()
    lamp.light.add("lamp", "point")
    with pytest.raises(relume.ParameterError, match="lamp"):
        relight(gbuffer, lamp)
    lamp.light["lamp"].position = 0, 0, 1
    with pytest.raises(relume.ChannelError, match="position"):
        relight(gbuffer, lamp)


def test_rigs_in_every_form(tmp_path: Path) -> None:
    gbuffer, _ = random_gbuffer()
    path = tmp_path / "key.relume"
    path.write_text(KEY)
    expected = relight(gbuffer, Rig.loads(KEY))["beauty"]
    for rig in (KEY, path, str(path)):
        np.testing.assert_array_equal(relight(gbuffer, rig)["beauty"], expected)


def test_file_and_arrays_agree(flat: Path, ggx_rig: Rig, tmp_path: Path) -> None:
    rig = ggx_rig.copy()
    rig.output.type = "float"
    out = tmp_path / "out.exr"
    report = relight_file(flat, rig, out)
    assert report.shaded == 24
    result = relight(flat, rig)
    written = read_exr(out)
    for index, letter in enumerate("RGBA"):
        np.testing.assert_array_equal(written[letter], result["beauty"][..., index])
    for index, letter in enumerate("RGB"):
        np.testing.assert_array_equal(written[f"diffuse.{letter}"], result["diffuse"][..., index])


def test_progress(tmp_path: Path, ggx_rig: Rig) -> None:
    gbuffer, _ = random_gbuffer()
    shares: list[float] = []
    relight(gbuffer, ggx_rig, progress=shares.append)
    assert shares[-1] == 1.0
    assert shares == sorted(shares)


def big_gbuffer() -> GBuffer:
    """Nearly a gigapixel in one pixel's memory: long work without a long preparation."""
    shape = (30000, 30000)
    normal = np.broadcast_to(np.float32([0.6, 0, 0.8]), (*shape, 3))
    return GBuffer(normal=normal, view=np.broadcast_to(np.float32([0, 0, 1]), (*shape, 3)))


def big_out() -> dict[str, np.ndarray]:
    """Arrays for the results of big_gbuffer() that take no memory: every row is the same one."""
    row = np.zeros((1, 30000, 4), np.float32)
    return {"beauty": np.lib.stride_tricks.as_strided(row, (30000, 30000, 4), (0, 16, 4))}


def test_an_exception_in_progress_stops_the_work(ggx_rig: Rig) -> None:
    class EnoughError(Exception):
        pass

    def progress(share: float) -> None:
        if share < 1:
            raise EnoughError

    start = time.process_time()  # whatever else the machine does
    with pytest.raises(EnoughError):
        relight(big_gbuffer(), Rig.loads(KEY), out=big_out(), progress=progress)
    assert time.process_time() - start < 5, "the whole takes tens of seconds"


def test_the_gil_is_released() -> None:
    """Python goes on in other threads while pixels are shaded."""
    steps = 0
    done = threading.Event()

    def count() -> None:
        nonlocal steps
        while not done.is_set():
            steps += 1
            time.sleep(0.002)

    counter = threading.Thread(target=count)

    def progress(share: float) -> None:
        if steps > 20:
            raise KeyboardInterrupt

    counter.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            relight(big_gbuffer(), Rig.loads(KEY), out=big_out(), progress=progress)
    finally:
        done.set()
        counter.join()
    assert steps > 20


_LONG = """
import sys
sys.path.insert(0, {folder!r})
from test_relight import *
print("ready", flush=True)
try:
    relight(big_gbuffer(), Rig.loads(KEY), out=big_out())
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""


def test_ctrl_c() -> None:
    code = _LONG.format(folder=str(Path(__file__).parent))
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        time.sleep(0.3)
        start = cpu_seconds(process.pid)
        process.send_signal(signal.SIGINT)
        assert process.stdout.readline() == "interrupted\n"
        assert cpu_seconds(process.pid) - start < 1
        assert process.wait(30) == 0


def test_many_at_once(ggx_rig: Rig) -> None:
    """Several threads relight the same G-buffer and rig, and one changes its own copy."""
    gbuffer, _ = random_gbuffer()
    expected = relight(gbuffer, ggx_rig)["beauty"]
    wrong: list[str] = []

    def work() -> None:
        for _ in range(10):
            if not np.array_equal(relight(gbuffer, ggx_rig, threads=2)["beauty"], expected):
                wrong.append("differs")

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def test_beside_other_openexr(flat: Path, ggx_rig: Rig, tmp_path: Path) -> None:
    """In one process with PyPI's OpenEXR and OpenImageIO, each reading what the other wrote."""
    import OpenImageIO as oiio  # noqa: N813

    relight_file(flat, ggx_rig, tmp_path / "out.exr")
    buffer = oiio.ImageBuf(str(tmp_path / "out.exr"))
    assert not buffer.has_error
    pixels = buffer.get_pixels("float")
    np.testing.assert_array_equal(pixels[..., 0], read_exr(tmp_path / "out.exr")["R"].astype(np.float32))
    buffer.write(str(tmp_path / "again.exr"))
    again = relume.ExrFile(tmp_path / "again.exr").read(0, ["R"])
    np.testing.assert_array_equal(again[..., 0], pixels[..., 0])
    write_exr(tmp_path / "one.exr", flat_channels(1, 1))
    assert GBuffer.read(tmp_path / "one.exr").shape == (1, 1)
