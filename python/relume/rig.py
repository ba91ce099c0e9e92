# SPDX-License-Identifier: Apache-2.0
"""The rig: lights, shaders, output, and how to read the G-buffer. Loaded, built and edited here; str(rig) is its TOML.

Every key that a rig file may hold is an attribute here, checked against the same tables::

    rig = relume.Rig()
    rig.light.add("key", "sun", direction=(0.36, 0.81, -0.46), irradiance=3)
    rig.light["key"].exposure = 1
    rig.shader.add("ggx", roughness=0.3, cryptomatte=["car_*"])
    rig.shader.add("cook_torrance", distribution="texture", distribution_table=painted)  # (H, W), or a file
    rig.output.aovs = ["light:key", "diffuse"]
    rig.gbuffer.channels["normal"] = {"channel": "N", "space": "camera"}
    rig.camera.fov = 39.6
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from relume import _relume
from relume.errors import Error
from relume.images import install_reader
from relume.rig_sections import Camera, Channels, GBufferSection, Light, Lights, Output, Section, ShaderUse, ShaderUses
from relume.rig_values import FromChannel, Keys, from_toml, toml_text

__all__ = [
    "Channels",
    "FromChannel",
    "Keys",
    "Light",
    "Lights",
    "Rig",
    "Section",
    "ShaderUse",
    "ShaderUses",
    "toml_text",
]


class Rig:
    """Everything that a relight needs beyond the pixels. The module's documentation shows its use."""

    def __init__(self) -> None:
        self._rig = _relume.Rig()

    @classmethod
    def _of(cls, rig: _relume.Rig) -> Rig:
        result = cls.__new__(cls)
        result._rig = rig
        return result

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Rig:
        """Read a rig file (.relume).

        Raises:
            FileError: it cannot be read.
            RigError: it is not TOML or has an unknown or ill-typed key; the message has line and column.
            ParameterError: a value is out of its range.
        """
        return cls._of(_relume.Rig.load(Path(path)))

    @classmethod
    def loads(cls, text: str, name: str = "<rig>") -> Rig:
        """Read a rig from TOML text; ``name`` stands for the file in messages. Raises as load() does."""
        return cls._of(_relume.Rig.loads(text, name))

    @classmethod
    def builtin(cls, name: str) -> Rig:
        """A copy of one of relume's own rigs: "outdoor", "sdf", "cornell".

        Raises:
            RigError: there is none of that name; the message has the nearest.
        """
        return cls._of(_relume.Rig.builtin(name))

    @classmethod
    def find(cls, name: str | os.PathLike[str]) -> Rig:
        """A rig file, or a built-in rig where no file has this name: as include and ``--rig`` take them.

        Raises as load() does.
        """
        word = os.fspath(name)
        if word in _relume.builtin_rigs() and not Path(word).exists():
            return cls.builtin(word)
        return cls.load(word)

    @property
    def light(self) -> Lights:
        """The lights by name."""
        return Lights(self._rig)

    @property
    def shader(self) -> ShaderUses:
        """The shaders in order."""
        return ShaderUses(self._rig)

    @property
    def output(self) -> Output:
        """The [output] section."""
        return Output(self._rig)

    @property
    def gbuffer(self) -> GBufferSection:
        """The [gbuffer] section."""
        return GBufferSection(self._rig)

    @property
    def camera(self) -> Camera:
        """The [camera] section."""
        return Camera(self._rig)

    @property
    def path(self) -> Path | None:
        """The file that it came from: relative names in it are relative to this file's folder. None for loads()."""
        path = self._rig.path
        return path if str(path) not in ("", ".") else None

    @property
    def aovs(self) -> dict[str, int]:
        """The pictures that it makes and their components: beauty first, then output.aovs.

        Raises:
            RigError: an AOV names no light of the rig.
        """
        return dict(self._rig.aovs())

    def set(self, key: str, value: object) -> None:
        """Set a dotted key as on the command line: set("light.key.exposure", 1), set("shader.0.roughness", 0.4).

        A string is read as TOML where it is TOML, else it is itself: "1" is a number, "float" a string.
        """
        self._rig.set(key, value if isinstance(value, str) else toml_text(value))

    def get(self, key: str) -> Any:
        """The value of a dotted key, or its default.

        Raises:
            ParameterError: there is no such key, or it was not given and has no default.
        """
        return from_toml(None, self._rig.get(key))

    def check_tables(self) -> None:
        """Read the files of its shaders' tables, as a relight does before it shades.

        Raises:
            FileError: one is missing.
            FormatError: one is no picture that can be a table.
        """
        install_reader()
        for shader in self.shader:
            for row in shader.parameters:
                value = getattr(shader, row.name) if row.type == "table" else None
                if isinstance(value, str) and value:
                    try:
                        _relume.load_table(Path(value))
                    except Error as error:
                        raise type(error)(f"{shader._title()}: {row.name}: {error}") from None

    def at(self, frame: float) -> Rig:
        """The rig of one frame: what is keyed over frames (``Keys``) has that frame's value."""
        return Rig._of(self._rig.at(frame))

    def copy(self) -> Rig:
        """An independent copy."""
        return Rig._of(_relume.Rig(self._rig))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write it as a rig file.

        Raises:
            FileError: the file cannot be written.
        """
        from relume.files import write_atomically

        write_atomically(Path(path), str(self).encode())

    def __str__(self) -> str:
        return self._rig.to_toml()

    def __repr__(self) -> str:
        lights = ", ".join(f"{light.name} ({light.type})" for light in self.light.values())
        return f"<Rig{f' {self.path}' if self.path else ''}: {lights or 'no lights'}>"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Rig) and str(self) == str(other)

    __hash__ = None  # type: ignore[assignment]

    def __copy__(self) -> Rig:
        return self.copy()

    def __deepcopy__(self, memo: object) -> Rig:
        return self.copy()

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (str(self), self.path)


def _restored(text: str, path: Path | None) -> Rig:
    rig = Rig.loads(text)
    if path is not None:
        rig._rig.path = path
    return rig
