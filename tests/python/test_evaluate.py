# SPDX-License-Identifier: Apache-2.0
"""shaders[…].evaluate() on arrays: closed forms, broadcasting, precision, refusals, and what it says of itself."""

from __future__ import annotations

import inspect
from pathlib import Path

import numpy as np
import pytest
import relume
from conftest import write_exr
from relume import shaders

UP = np.array([0.0, 0.0, 1.0])


def directions(count: int, seed: int = 1) -> np.ndarray:
    """(count, 3) unit vectors of the upper hemisphere, float64."""
    vectors = np.random.default_rng(seed).normal(size=(count, 3))
    vectors[:, 2] = np.abs(vectors[:, 2]) + 0.05
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def test_lambert_is_its_closed_form() -> None:
    l = directions(1000)  # noqa: E741
    color = np.random.default_rng(2).random((1000, 3))
    value = shaders["lambert"].evaluate(n=UP, v=UP, l=l, base_color=color)
    np.testing.assert_allclose(value.diffuse, color / np.pi * l[:, 2:], rtol=1e-14)
    assert not value.specular.any()
    assert not value.transmission.any()


def ggx_by_hand(v: np.ndarray, l: np.ndarray, roughness: np.ndarray, f0: np.ndarray) -> np.ndarray:  # noqa: E741
    """Hable's GGX with the ¼: models.md section 1, in double, from the formulas."""
    h = v + l
    h /= np.linalg.norm(h, axis=-1, keepdims=True)
    alpha = roughness**2
    n_dot_l, n_dot_v, n_dot_h = l[..., 2], v[..., 2], h[..., 2]
    l_dot_h = np.sum(l * h, axis=-1)
    distribution = alpha**2 / (np.pi * (1 - n_dot_h**2 + alpha**2 * n_dot_h**2) ** 2)
    k = alpha / 2
    visibility = 1 / (n_dot_l * (1 - k) + k) / (n_dot_v * (1 - k) + k) / 4
    fresnel = f0 + (1 - f0) * (1 - l_dot_h[..., None]) ** 5
    return (distribution * visibility * n_dot_l)[..., None] * fresnel


def test_ggx_is_its_formula() -> None:
    v, l = directions(2000, 3), directions(2000, 4)  # noqa: E741
    rng = np.random.default_rng(5)
    roughness, f0 = rng.uniform(0.1, 1, 2000), rng.random((2000, 3))
    value = shaders["ggx"].evaluate(n=UP, v=v, l=l, roughness=roughness, f0=f0)
    np.testing.assert_allclose(value.specular, ggx_by_hand(v, l, roughness, f0), rtol=1e-9)


def test_precision_follows_the_arrays() -> None:
    v, l = directions(500, 6), directions(500, 7)  # noqa: E741
    double = shaders["ggx"].evaluate(n=UP, v=v, l=l, roughness=0.4)
    assert double.specular.dtype == np.float64
    single = shaders["ggx"].evaluate(n=UP, v=v.astype(np.float32), l=l.astype(np.float32), roughness=0.4)
    # n is float64 here: one array in double makes all of it double.
    assert single.specular.dtype == np.float64
    flat = UP.astype(np.float32)
    single = shaders["ggx"].evaluate(n=flat, v=v.astype(np.float32), l=l.astype(np.float32), roughness=0.4)
    assert single.specular.dtype == np.float32
    np.testing.assert_allclose(single.specular, double.specular, rtol=2e-4, atol=1e-7)
    assert shaders["ggx"].evaluate(n=[0, 0, 1], v=[0, 0, 1], l=[0, 0, 1]).diffuse.dtype == np.float64


def test_broadcasting() -> None:
    l = directions(7)  # noqa: E741
    roughness = np.linspace(0.1, 1, 5)[:, None]
    value = shaders["ggx"].evaluate(n=UP, v=UP, l=l, roughness=roughness, base_color=0.5)
    assert value.specular.shape == (5, 7, 3)
    one = shaders["ggx"].evaluate(n=UP, v=UP, l=l[3], roughness=roughness[2, 0], base_color=(0.5, 0.5, 0.5))
    assert one.specular.shape == (3,)
    np.testing.assert_array_equal(value.specular[2, 3], one.specular)
    np.testing.assert_array_equal(value.diffuse[2, 3], one.diffuse)


def test_more_than_a_block() -> None:
    """Work is done in blocks: their seams must not show."""
    l = directions(10001)  # noqa: E741
    whole = shaders["lambert"].evaluate(n=UP, v=UP, l=l).diffuse
    parts = [shaders["lambert"].evaluate(n=UP, v=UP, l=part).diffuse for part in np.array_split(l, 7)]
    np.testing.assert_array_equal(whole, np.concatenate(parts))


def test_strides_and_emptiness() -> None:
    l = directions(100)  # noqa: E741
    np.testing.assert_array_equal(
        shaders["lambert"].evaluate(n=UP, v=UP, l=l[::-3]).diffuse,
        shaders["lambert"].evaluate(n=UP, v=UP, l=l[::-3].copy()).diffuse,
    )
    assert shaders["lambert"].evaluate(n=UP, v=UP, l=np.empty((0, 3))).diffuse.shape == (0, 3)


def test_options() -> None:
    kept = shaders["lambert"].evaluate(n=UP, v=UP, l=UP, base_color=1.0)
    plain = shaders["lambert"].evaluate(n=UP, v=UP, l=UP, base_color=1.0, energy_conserving=False)
    np.testing.assert_allclose(plain.diffuse, np.pi * kept.diffuse, rtol=1e-14)


@pytest.mark.parametrize(
    ("arguments", "error", "says"),
    [
        ({"roughnes": 0.5}, relume.UnknownNameError, "'roughness'"),
        ({"roughness": 1.5}, relume.ParameterError, "0…1"),
        ({"energy_conserving": 0.5}, relume.ParameterError, "boolean"),
        ({"roughness": "rough"}, relume.ArgumentError, "numbers"),
        ({"l": (0, 0, 2)}, relume.ArgumentError, "unit"),
        ({"l": (0, 1)}, relume.ArgumentError, "(…, 3)"),
        ({"base_color": np.ones((4, 2))}, relume.ArgumentError, "(…, 3)"),
        ({"l": directions(4), "roughness": np.full(3, 0.5)}, relume.ArgumentError, "broadcast"),
    ],
)
def test_refusals(arguments: dict[str, object], error: type[Exception], says: str) -> None:
    with pytest.raises(error) as caught:
        shaders["ggx"].evaluate(**({"n": UP, "v": UP, "l": UP} | arguments))  # type: ignore[arg-type]
    assert says in str(caught.value)


def test_unknown_shader() -> None:
    with pytest.raises(KeyError, match="'lambert'"):
        shaders["lambrt"]
    assert "lambrt" not in shaders
    assert shaders.get("lambrt") is None


@pytest.mark.parametrize("name", list(shaders))
def test_a_shader_describes_itself(name: str) -> None:
    shader = shaders[name]
    assert shader.name == name
    assert shader.label and shader.help
    signature = inspect.signature(shader.evaluate)
    assert list(signature.parameters)[:4] == ["n", "v", "l", "tangent"]
    assert [row.name for row in shader.parameters] == list(signature.parameters)[4:]
    for row in shader.parameters:
        assert row.help and row.label
        assert f"{row.name}: " in (shader.evaluate.__doc__ or "")
        assert signature.parameters[row.name].default == row.default


@pytest.mark.parametrize("name", list(shaders))
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_every_shader_evaluates(name: str, dtype: type) -> None:
    v, l = directions(200, 8).astype(dtype), directions(200, 9).astype(dtype)  # noqa: E741
    value = shaders[name].evaluate(n=UP.astype(dtype), v=v, l=l)
    for lobe in value:
        assert lobe.shape == (200, 3)
        assert lobe.dtype == dtype
        assert np.isfinite(lobe).all()
        assert (lobe >= 0).all()


def test_a_table_is_an_array_or_a_file(tmp_path: Path) -> None:
    cook = shaders["cook_torrance"]
    settings = {"distribution": "texture", "roughness": 0.5, "metallic": 1.0, "fresnel": "none", "base_color": 1.0}
    v = directions(300, 8)
    l = v * [-1, -1, 1]  # noqa: E741 - NdotH = 1
    # One texel: T is 3 everywhere. In the mirror direction the cavity hides nothing: spec_power · F · G · T² = 2 · 9.
    given = cook.evaluate(n=UP, v=v, l=l, distribution_table=[[3.0]], masking="v_cavity", **settings).specular
    np.testing.assert_allclose(given, np.full((300, 3), 18.0), rtol=1e-12)
    table = np.random.default_rng(9).random((4, 8), np.float32)
    by_array = cook.evaluate(n=UP, v=v, l=v, distribution_table=table, **settings).specular
    path = tmp_path / "lobe.exr"
    write_exr(path, {"Y": table})
    np.testing.assert_array_equal(cook.evaluate(n=UP, v=v, l=v, distribution_table=path, **settings).specular, by_array)
    built_in = cook.evaluate(n=UP, v=v, l=v, **settings).specular
    assert np.abs(built_in - by_array).max() > 0.1
    again = cook.evaluate(n=UP, v=v, l=v, distribution_table=cook.table("distribution_table"), **settings)
    np.testing.assert_array_equal(again.specular, built_in)


def test_tables_that_are_refused(tmp_path: Path) -> None:
    cook = shaders["cook_torrance"]
    for value, said in (
        (np.zeros((2, 3, 3)), "3 dimensions; a table is (height, width)"),
        (np.zeros((0, 3)), "has no texels"),
        ([[1.0, np.nan]], "column 1, row 0 is not finite"),
        (np.zeros((2049, 2048), np.float32), "at most 4194304"),
        (object(), "distribution_table must be numbers"),
    ):
        with pytest.raises(relume.ArgumentError) as caught:
            cook.evaluate(n=UP, v=UP, l=UP, distribution_table=value)
        assert "distribution_table" in str(caught.value) and said in str(caught.value)
    with pytest.raises(relume.FileError, match=r"lost\.exr: no such file"):
        cook.evaluate(n=UP, v=UP, l=UP, distribution_table=tmp_path / "lost.exr")
    with pytest.raises(relume.UnknownNameError):
        cook.table("distribution_tabel")
    with pytest.raises(relume.ParameterError, match="has no table 'roughness'"):
        cook.table("roughness")
