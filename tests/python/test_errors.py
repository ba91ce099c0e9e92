# SPDX-License-Identifier: Apache-2.0
"""One family of exceptions, each also what Python calls such a thing."""

from __future__ import annotations

import importlib
import re
from pathlib import Path

import pytest
import relume


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("FileError", OSError),
        ("FormatError", ValueError),
        ("ChannelError", LookupError),
        ("RigError", ValueError),
        ("ParameterError", ValueError),
        ("UnknownNameError", KeyError),
        ("UnknownNameError", AttributeError),
        ("ArgumentError", ValueError),
        ("PluginError", RuntimeError),
        ("MissingPackageError", ImportError),
        ("Cancelled", Exception),
    ],
)
def test_family(name: str, kind: type[Exception]) -> None:
    error = getattr(relume, name)
    assert issubclass(error, relume.Error)
    assert issubclass(error, kind)
    assert str(error("what is wrong")) == "what is wrong"
    assert error.__doc__


def test_the_library_raises_them(tmp_path: Path) -> None:
    with pytest.raises(relume.FileError, match=r"nothing\.exr"):
        relume.GBuffer.read(tmp_path / "nothing.exr")
    with pytest.raises(OSError):
        relume.Rig.load(tmp_path / "nothing.relume")
    (tmp_path / "x.exr").write_bytes(b"no EXR")
    with pytest.raises(relume.FormatError, match=r"x\.exr"):
        relume.GBuffer.read(tmp_path / "x.exr")
    with pytest.raises(relume.RigError, match="<rig>:1:"):
        relume.Rig.loads("lights = 3")


def test_every_public_name_is_there() -> None:
    for name in relume.__all__:
        assert getattr(relume, name) is not None
    assert set(relume.__all__) <= set(dir(relume))
    with pytest.raises(AttributeError):
        _ = relume.nothing


def test_type_checkers_see_the_same_names() -> None:
    """What __init__ imports for type checkers is what it hands out at run time, each from the same module."""
    source = Path(relume.__file__).read_text()
    typed = dict(re.findall(r"^    from relume\.\w+ import (\w+) as (\w+)$", source, re.MULTILINE))
    assert set(typed) == {name for name in relume.__all__ if name != "__version__"}
    for module, name in re.findall(r"^    from relume\.(\w+) import (\w+) as", source, re.MULTILINE):
        assert getattr(relume, name) is getattr(importlib.import_module(f"relume.{module}"), name)
