# SPDX-License-Identifier: Apache-2.0
"""Rigs built and edited in Python."""

from __future__ import annotations

import copy
import pickle
from pathlib import Path

import numpy as np
import pytest
import relume
from conftest import KEY, write_exr
from relume import FromChannel, Rig, light_types


@pytest.fixture
def rig() -> Rig:
    return Rig.loads(KEY)


def test_attributes(rig: Rig) -> None:
    key = rig.light["key"]
    assert (key.name, key.type, key.exposure, key.enabled) == ("key", "sun", 0.0, True)
    assert key.irradiance == (3.0, 3.0, 3.0)
    assert key.direction == (0.3, -0.8, -0.5)
    key.exposure = 1
    key.color = np.array([1, 0.5, 0.25], np.float32)
    assert rig.light["key"].exposure == 1.0
    assert key.color == (1.0, 0.5, 0.25)
    key.exposure = None
    assert key.exposure == 0.0
    key.exposure = 2
    del key.exposure
    assert key.exposure == 0.0


def test_lights(rig: Rig) -> None:
    fill = rig.light.add("fill", "point", position=(1, 2, 3), intensity=50)
    assert list(rig.light) == ["key", "fill"]
    assert len(rig.light) == 2
    assert "fill" in rig.light
    assert rig.light["fill"].position == (1.0, 2.0, 3.0)
    fill.name = "rim"
    assert list(rig.light) == ["key", "rim"]
    fill.exposure = -1
    fill.type = "spot"
    assert rig.light["rim"].type == "spot"
    assert rig.light["rim"].exposure == -1.0
    assert rig.light["rim"].position == (1.0, 2.0, 3.0)
    assert rig.light["rim"].cone_angle > 0
    del rig.light["rim"]
    assert list(rig.light) == ["key"]


def test_a_failed_add_changes_nothing(rig: Rig) -> None:
    before = str(rig)
    for arguments in (
        {"name": "key", "type": "sun"},
        {"name": "x", "type": "pont"},
        {"name": "x", "type": "point", "intensty": 1},
        {"name": "x", "type": "point", "position": "here"},
        {"name": "", "type": "point"},
    ):
        with pytest.raises(relume.Error):
            rig.light.add(**arguments)
    for keywords in ({"roughnes": 0.3}, {"roughness": 5}, {"roughness": "x"}):
        with pytest.raises(relume.Error):
            rig.shader.add("ggx", **keywords)
    with pytest.raises(relume.ParameterError, match="'ggx'"):
        rig.shader.add("gggx")
    assert str(rig) == before


def test_awkward_names() -> None:
    rig = Rig()
    for name in ("a.b", "two words", "säule", "0", 'it"s'):
        rig.light.add(name, "sun", exposure=1)
        rig.light[name].exposure = 2
        assert rig.light[name].exposure == 2.0
    assert Rig.loads(str(rig)) == rig


def test_shaders(rig: Rig) -> None:
    car = rig.shader.add("ggx", roughness=0.3, cryptomatte=["car_*", "wheel"])
    rig.shader.add("lambert", base_color=(1, 0, 0))
    rig.shader.add("default_lit", index=1, object_id=[1, 2], metallic=FromChannel("metal.X", 2, -0.5))
    assert [shader.use for shader in rig.shader] == ["ggx", "default_lit", "lambert"]
    assert car.roughness == 0.3
    assert car.cryptomatte == ["car_*", "wheel"]
    assert rig.shader[1].object_id == [1, 2]
    assert rig.shader[1].metallic == FromChannel("metal.X", 2.0, -0.5)
    assert rig.shader[-1].base_color == (1.0, 0.0, 0.0)
    car.roughness = {"channel": "rough"}
    assert car.roughness == FromChannel("rough")
    car.energy_conserving = False
    assert car.energy_conserving is False
    car.use = "lambert"
    assert car.cryptomatte == ["car_*", "wheel"]
    with pytest.raises(AttributeError, match="lambert"):
        _ = car.roughness
    del rig.shader[0]
    assert len(rig.shader) == 2
    with pytest.raises(IndexError):
        rig.shader[2]


def test_output_and_gbuffer(rig: Rig) -> None:
    rig.output.aovs = ["light:key", "diffuse"]
    rig.output.type = "float"
    assert rig.output.aovs == ["light:key", "diffuse"]
    assert rig.output.compression == "zip"
    assert rig.aovs == {"beauty": 4, "light:key": 3, "diffuse": 3}
    rig.gbuffer.file = "shot.####.exr"
    rig.gbuffer.view = "left"
    rig.gbuffer.channels["normal"] = {"channel": "N", "space": "camera", "flip": "y"}
    rig.gbuffer.channels["roughness"] = "rough.X"
    assert rig.gbuffer.view == "left"
    assert rig.gbuffer.channels["normal"].space == "camera"
    assert rig.gbuffer.channels["roughness"].channel == "rough.X"
    rig.gbuffer.channels["normal"].encoding = "0..1"
    assert rig.gbuffer.channels["normal"].flip == "y"
    assert list(rig.gbuffer.channels) == ["normal", "roughness"]
    del rig.gbuffer.channels["roughness"]
    rig.gbuffer.view = None
    assert rig.gbuffer.view is None
    matrix = np.eye(4)
    matrix[:3, 3] = 1, 2, 3
    rig.camera.matrix = matrix
    rig.camera.fov = 40
    np.testing.assert_array_equal(np.reshape(rig.camera.matrix, (4, 4)), matrix)
    assert rig.camera.fov == 40.0
    assert Rig.loads(str(rig)) == rig


@pytest.mark.parametrize(
    ("set_it", "says"),
    [
        (lambda rig: setattr(rig.light["key"], "exposre", 1), "'exposure'"),
        (lambda rig: setattr(rig.output, "aov", []), "'aovs'"),
        (lambda rig: setattr(rig.camera, "fv", 1), "'fov'"),
        (lambda rig: setattr(rig.gbuffer, "vew", "left"), "'view'"),
        (lambda rig: rig.light["kye"], "'key'"),
        (lambda rig: rig.gbuffer.channels.__setitem__("normall", "N"), "'normal'"),
        (lambda rig: rig.set("light.key.exposre", 1), "'exposure'"),
        (lambda rig: rig.set("lihgt.key.exposure", 1), "'light'"),
    ],
)
def test_unknown_names(rig: Rig, set_it: object, says: str) -> None:
    before = str(rig)
    with pytest.raises(relume.Error) as caught:
        set_it(rig)  # type: ignore[operator]
    assert says in str(caught.value)
    assert isinstance(caught.value, ValueError)
    assert str(rig) == before


def test_unknown_attributes_are_attribute_errors(rig: Rig) -> None:
    assert not hasattr(rig.light["key"], "exposre")
    assert hasattr(rig.light["key"], "exposure")
    assert rig.light.get("nobody") is None


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("exposure", "bright"),
        ("exposure", [1, 2]),
        ("enabled", 2),
        ("color", (1, 2)),
        ("irradiance", object()),
        ("color", {1, 2}),
    ],
)
def test_wrong_values(rig: Rig, key: str, value: object) -> None:
    before = str(rig)
    with pytest.raises(ValueError):
        setattr(rig.light["key"], key, value)
    assert str(rig) == before


def test_set_and_get(rig: Rig) -> None:
    rig.set("light.key.exposure", 1.5)
    rig.set("light.key.color", [1, 0, 0])
    rig.set("output.type", "float")
    rig.set("light.key.angle", "2")
    assert rig.get("light.key.exposure") == 1.5
    assert rig.get("light.key.color") == [1.0, 0.0, 0.0]
    assert rig.get("output.type") == "float"
    assert rig.light["key"].angle == 2.0
    with pytest.raises(relume.ParameterError, match=r"camera\.fov"):
        rig.get("camera.fov")


def test_text_and_copies(rig: Rig, tmp_path: Path) -> None:
    rig.light["key"].exposure = 0.1
    rig.shader.add("ggx", roughness=0.25)
    assert Rig.loads(str(rig)) == rig
    for other in (rig.copy(), copy.copy(rig), copy.deepcopy(rig), pickle.loads(pickle.dumps(rig))):
        assert other == rig
        other.light["key"].exposure = 5
        assert other != rig
    rig.save(tmp_path / "saved.relume")
    loaded = Rig.load(tmp_path / "saved.relume")
    assert loaded == rig
    assert loaded.path == tmp_path / "saved.relume"
    assert rig.path is None
    assert [entry.name for entry in tmp_path.iterdir()] == ["saved.relume"]
    with pytest.raises(relume.FileError, match=r"no\.where"):
        rig.save(tmp_path / "no.where" / "x.relume")


def test_built_in_rigs() -> None:
    assert list(Rig.builtin("outdoor").light) == ["sun", "sky", "bounce"]
    with pytest.raises(relume.RigError, match="outdoor"):
        Rig.builtin("outdor")


@pytest.mark.parametrize("kind", list(light_types))
def test_every_key_of_every_light(kind: str) -> None:
    """Each key takes its own default and keeps it through TOML."""
    rig = Rig()
    light = rig.light.add("it", kind)
    for row in light.parameters:
        if row.default is None and row.type == "vector":  # what every such light must be given
            assert getattr(light, row.name) is None
            setattr(light, row.name, (1, 2, 3))
            assert getattr(light, row.name) == (1.0, 2.0, 3.0)
    for row in light.parameters:
        assert row.help and row.label
        assert row.name in dir(light)
        value = getattr(light, row.name)
        if row.default is not None:
            assert value == row.default
            setattr(light, row.name, value)
            assert getattr(light, row.name) == value
    assert Rig.loads(str(rig)) == rig


def test_representations(rig: Rig) -> None:
    rig.shader.add("ggx")
    for thing in (rig, rig.light, rig.light["key"], rig.shader, rig.shader[0], rig.output, rig.gbuffer, rig.camera):
        assert repr(thing).startswith("<")
    assert "key (sun)" in repr(rig)


def test_a_table_of_numbers_stays_with_the_rig(rig: Rig) -> None:
    table = np.random.default_rng(1).random((3, 5), np.float32)
    use = rig.shader.add("cook_torrance", distribution="texture", distribution_table=table)
    for each in (rig, rig.copy(), pickle.loads(pickle.dumps(rig)), Rig.loads(str(rig))):
        assert each == rig
        np.testing.assert_array_equal(each.shader[0].distribution_table, table)
        assert each.shader[0].distribution_table.dtype == np.float32
    use.distribution_table = Path("lobes") / "soft.exr"
    assert use.distribution_table == "lobes/soft.exr"
    del use.distribution_table
    assert use.distribution_table == ""
    with pytest.raises(relume.ParameterError, match="list of lists"):
        use.distribution_table = np.zeros((2, 2, 3))


def test_a_table_lights_from_array_png_and_exr_alike(rig: Rig, tmp_path: Path) -> None:
    import OpenImageIO as oiio  # noqa: N813

    steps = np.random.default_rng(2).integers(0, 256, (4, 6)).astype(np.uint8)
    table = steps.astype(np.float32) / np.float32(255)
    png = oiio.ImageOutput.create(str(tmp_path / "lobe.png"))
    png.open(str(tmp_path / "lobe.png"), oiio.ImageSpec(6, 4, 1, "uint8"))
    png.write_image(steps[..., None])
    png.close()
    write_exr(tmp_path / "lobe.exr", {"R": table, "G": table, "B": table})
    normal = np.random.default_rng(3).normal(size=(16, 16, 3)).astype(np.float32)
    gbuffer = relume.GBuffer(normal=normal)
    pictures = []
    for value in (table, tmp_path / "lobe.png", tmp_path / "lobe.exr"):
        lit = rig.copy()
        lit.shader.add("cook_torrance", distribution="texture", spec_power=20, distribution_table=value)
        lit.check_tables()
        pictures.append(relume.relight(gbuffer, lit)["beauty"])
    plain = rig.copy()
    plain.shader.add("cook_torrance", distribution="texture", spec_power=20)
    assert np.abs(relume.relight(gbuffer, plain)["beauty"] - pictures[0]).max() > 0.01
    np.testing.assert_allclose(pictures[1], pictures[0], rtol=1e-5, atol=1e-6)
    np.testing.assert_allclose(pictures[2], pictures[0], rtol=1e-5, atol=1e-6)


def test_a_table_that_is_not_there(rig: Rig, tmp_path: Path) -> None:
    rig.shader.add("cook_torrance", distribution="texture", distribution_table=tmp_path / "lost.png")
    gbuffer = relume.GBuffer(normal=np.ones((2, 2, 3), np.float32))
    for act in (rig.check_tables, lambda: relume.relight(gbuffer, rig)):
        with pytest.raises(relume.FileError, match=r"cook_torrance.*distribution_table: .*lost\.png: no such file"):
            act()
