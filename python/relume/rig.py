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

import math
import os
import tomllib
from collections.abc import Iterable, Iterator, Mapping, MutableMapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from relume import _relume
from relume.errors import Error, ParameterError, UnknownNameError
from relume.images import install_reader

if TYPE_CHECKING:
    from relume._relume import Parameter

__all__ = ["Channels", "FromChannel", "Keys", "Light", "Lights", "Rig", "Section", "ShaderUse", "ShaderUses"]


class FromChannel(NamedTuple):
    """A shader parameter that is read from a channel of the file: value · scale + offset."""

    channel: str
    scale: float = 1.0
    offset: float = 0.0


class Keys(NamedTuple):
    """A number, colour or vector that changes over the frames of a sequence.

    Before the first key it has that one's value, after the last one that one's; ``Rig.at(frame)`` gives a frame's rig.
    """

    #: (frame, value) with rising frames; a value is a number or three.
    keys: Sequence[tuple[float, float | Sequence[float]]]
    #: "linear", "hold" (the key before) or "smooth" (t²(3 − 2t) from key to key).
    interpolation: str = "linear"


def toml_text(value: object) -> str:
    """A value as TOML: numbers, strings, booleans, sequences, mappings, numpy scalars and arrays, FromChannel.

    Raises:
        ParameterError: no rig can hold a value of this kind.
    """
    if isinstance(value, (FromChannel, Keys)):
        return toml_text(value._asdict())
    if hasattr(value, "tolist"):  # numpy
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        if math.isfinite(value):
            text = repr(value)
            return text if "." in text or "e" in text else f"{text}.0"
        return "nan" if math.isnan(value) else "inf" if value > 0 else "-inf"
    if isinstance(value, (str, os.PathLike)):
        return _quoted(os.fspath(value))
    if isinstance(value, Mapping):
        return f"{{{', '.join(f'{_key(str(name))} = {toml_text(item)}' for name, item in value.items())}}}"
    if isinstance(value, Iterable):
        return f"[{', '.join(toml_text(item) for item in value)}]"
    raise ParameterError(
        f"a rig cannot hold a {type(value).__name__}; give a number, three numbers, true or false, a string, "
        'a list of strings, or {"channel": name}'
    )


def _quoted(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(c if c >= " " and c != "\x7f" else f"\\u{ord(c):04x}" for c in escaped) + '"'


def _key(name: str) -> str:
    bare = name.isascii() and name.replace("_", "a").replace("-", "a").isalnum()
    return name if bare else _quoted(name)


def _part(name: str) -> str:
    """A name as a part of a dotted key, in quotes where it has dots; such quotes know no escapes."""
    if name and not any(c in name for c in ".\"'"):
        return name
    quote = "'" if '"' in name else '"'
    if quote in name:
        raise ParameterError(f"the name {name!r} has both kinds of quotes: no key can name it")
    return f"{quote}{name}{quote}"


def _key_pair(key: list[float]) -> tuple[float, float | tuple[float, ...]]:
    frame, *value = (float(number) for number in key)
    return frame, value[0] if len(value) == 1 else tuple(value)


def _from_toml(row: Parameter | None, text: str) -> Any:
    """The Python value of what Rig::get() says, in the type of its row."""
    if not text:
        return None
    value = tomllib.loads(f"value = {text}")["value"]
    if isinstance(value, dict) and "channel" in value:
        return FromChannel(value["channel"], float(value.get("scale", 1)), float(value.get("offset", 0)))
    if isinstance(value, dict) and "keys" in value:
        return Keys(tuple(_key_pair(key) for key in value["keys"]), value.get("interpolation", "linear"))
    if row is None or isinstance(value, dict):
        return value
    if row.type == "scalar":
        return float(value)
    if row.type in ("color", "vector"):
        numbers = value if isinstance(value, list) else [value] * 3
        return tuple(float(number) for number in numbers)
    if row.type == "table":
        if isinstance(value, str):
            return value
        import numpy as np

        return np.asarray(value, np.float32)
    if row.type == "text_list":
        return value if isinstance(value, list) else [value]
    if row.type == "number_list":
        return value if isinstance(value, list) else [value]
    return value


class Section:
    """A part of a rig whose keys are attributes.

    Reading gives what was set, else the default, None where there is none. Setting checks the type, the range and the
    name; setting None, or ``del``, goes back to the default.

    Raises:
        UnknownNameError: no such key (an AttributeError as well); the message has the nearest one.
        ParameterError: a value of the wrong type or out of range.
    """

    _rig: _relume.Rig
    _own: tuple[str, ...] = ("_rig",)

    def __init__(self, rig: _relume.Rig) -> None:
        object.__setattr__(self, "_rig", rig)

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The table of its keys: types, ranges, units, defaults, help."""
        raise NotImplementedError

    def _path(self) -> str:
        raise NotImplementedError

    def _title(self) -> str:
        return self._path()

    def _given(self) -> list[str]:
        return [row.name for row in self.parameters if getattr(self, row.name) is not None]

    def _unset(self, name: str) -> None:
        raise ParameterError(f"{self._title()}: {name} cannot be taken back; make a new rig without it")

    def _row(self, name: str) -> Parameter:
        names = [row.name for row in self.parameters]
        if name in names:
            return self.parameters[names.index(name)]
        if name.startswith("_"):
            raise AttributeError(name)
        near = _relume.nearest_name(name, names)
        hint = f"did you mean '{near}'?" if near else f"there are {', '.join(names)}"
        raise UnknownNameError(f"{self._title()} has no '{name}'; {hint}")

    def __getattr__(self, name: str) -> Any:
        row = self._row(name)
        try:
            text = self._rig.get(f"{self._path()}.{name}")
        except ParameterError:
            if row.default is None:  # the key is right, so what is missing is its value
                return None
            raise
        return _from_toml(row, text)

    def __setattr__(self, name: str, value: object) -> None:
        if name in type(self)._own or isinstance(getattr(type(self), name, None), property):
            object.__setattr__(self, name, value)
            return
        self._row(name)
        if value is None:
            self._unset(name)
        else:
            self._rig.set(f"{self._path()}.{name}", toml_text(value))

    def __delattr__(self, name: str) -> None:
        self._row(name)
        self._unset(name)

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *(row.name for row in self.parameters)})

    def __repr__(self) -> str:
        values = ", ".join(f"{name}={getattr(self, name)!r}" for name in self._given())
        return f"<{self._title()}{': ' if values else ''}{values}>"


class Light(Section):
    """A light of a rig, by its name. Its keys depend on its type: ``light.parameters`` lists them."""

    _own = ("_rig", "_name")
    _name: str

    def __init__(self, rig: _relume.Rig, name: str) -> None:
        super().__init__(rig)
        object.__setattr__(self, "_name", name)

    @property
    def name(self) -> str:
        """Its name; setting it renames the light."""
        return self._name

    @name.setter
    def name(self, value: str) -> None:
        self._rig.rename_light(self._name, value)
        object.__setattr__(self, "_name", value)

    @property
    def type(self) -> str:
        """Its kind; setting it keeps the keys that the new kind has too."""
        return self._rig.light_type(self._name)

    @type.setter
    def type(self, value: str) -> None:
        self._rig.set(f"{self._path()}.type", _quoted(value))

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The table of its keys."""
        kind = self.type
        return next(tuple(light.parameters) for light in _relume.light_types() if light.name == kind)

    def _path(self) -> str:
        return f"light.{_part(self._name)}"

    def _title(self) -> str:
        return f"light '{self._name}' ({self.type})"

    def _given(self) -> list[str]:
        return self._rig.light_given(self._name)

    def _unset(self, name: str) -> None:
        self._rig.light_unset(self._name, name)


class Lights(Mapping[str, Light]):
    """The lights of a rig, in order: ``rig.light["key"]``, iteration over names, ``add`` and ``del``."""

    def __init__(self, rig: _relume.Rig) -> None:
        self._rig = rig

    def __getitem__(self, name: str) -> Light:
        self._rig.light_type(name) if name in self._rig.light_names() else self._refuse(name)
        return Light(self._rig, name)

    def _refuse(self, name: str) -> None:
        names = self._rig.light_names()
        near = _relume.nearest_name(name, names)
        hint = f"did you mean '{near}'?" if near else f"it has {', '.join(names) or 'none'}"
        raise UnknownNameError(f"the rig has no light '{name}'; {hint}")

    def __iter__(self) -> Iterator[str]:
        return iter(self._rig.light_names())

    def __len__(self) -> int:
        return len(self._rig.light_names())

    def __delitem__(self, name: str) -> None:
        self[name]
        self._rig.remove_light(name)

    def add(self, name: str, type: str, **keys: object) -> Light:
        """Add a light; ``keys`` are those of its type. On an error the rig is as before.

        Raises:
            ParameterError: the name is taken, there is no such type or key, or a value is out of range.
        """
        _part(name)  # refuses what no key can name
        self._rig.add_light(name, type)
        light = Light(self._rig, name)
        try:
            for key, value in keys.items():
                setattr(light, key, value)
        except BaseException:
            self._rig.remove_light(name)
            raise
        return light

    def __repr__(self) -> str:
        return f"<lights: {', '.join(self) or 'none'}>"


class ShaderUse(Section):
    """One [[shader]] of a rig, by its place: which model, for which pixels, with which parameters."""

    _own = ("_rig", "_index")
    _index: int

    def __init__(self, rig: _relume.Rig, index: int) -> None:
        super().__init__(rig)
        object.__setattr__(self, "_index", index)

    @property
    def use(self) -> str:
        """The shading model; setting it keeps the parameters that the new one has too."""
        uses = self._rig.shader_uses()
        if self._index >= len(uses):
            raise ParameterError(f"the rig has no shader {self._index} any more; it has {len(uses)}")
        return uses[self._index]

    @use.setter
    def use(self, value: str) -> None:
        self._rig.set(f"{self._path()}.use", _quoted(value))

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Which pixels it is for (cryptomatte, object_id, …), then the parameters of the model."""
        use = self.use
        of_model = next((tuple(info.parameters) for info in _relume.shaders() if info.name == use), ())
        return tuple(row for row in _relume.shader_key_parameters() if row.name != "use") + of_model

    def _path(self) -> str:
        return f"shader.{self._index}"

    def _title(self) -> str:
        return f"shader {self._index} ({self.use})"

    def _given(self) -> list[str]:
        matches = [row.name for row in _relume.shader_key_parameters() if row.name != "use"]
        return [name for name in matches if getattr(self, name)] + self._rig.shader_given(self._index)

    def _unset(self, name: str) -> None:
        if name in (row.name for row in _relume.shader_key_parameters()):
            self._rig.set(f"{self._path()}.{name}", "[]")
        else:
            self._rig.shader_unset(self._index, name)


class ShaderUses(Sequence[ShaderUse]):
    """The shaders of a rig, in order: the first that matches a pixel wins, the last without a match is the default."""

    def __init__(self, rig: _relume.Rig) -> None:
        self._rig = rig

    def __getitem__(self, index: int) -> ShaderUse:  # type: ignore[override]
        count = len(self)
        if not -count <= index < count:
            raise IndexError(f"the rig has no shader {index}; it has {count}")
        return ShaderUse(self._rig, index % count)

    def __len__(self) -> int:
        return len(self._rig.shader_uses())

    def __delitem__(self, index: int) -> None:
        self._rig.remove_shader(self[index]._index)

    def add(self, use: str, index: int | None = None, **keys: object) -> ShaderUse:
        """Add a shader, at the end or before the one at ``index``. On an error the rig is as before.

        Args:
            use: a shading model, or "from_material_expression".
            index: its place in the order.
            keys: cryptomatte, object_id, material_id, shading_model_id, and parameters of the model: constants, or
                channels as FromChannel("coat.X") or {"channel": "coat.X"}.

        Raises:
            ParameterError: no such model or key, or a value out of range.
        """
        place = len(self) if index is None else range(len(self) + 1)[index]
        self._rig.add_shader(place, use)
        shader = ShaderUse(self._rig, place)
        try:
            for key, value in keys.items():
                setattr(shader, key, value)
        except BaseException:
            self._rig.remove_shader(place)
            raise
        return shader

    def __repr__(self) -> str:
        return f"<shaders: {', '.join(self._rig.shader_uses()) or 'none: principled for every pixel'}>"


class Output(Section):
    """What is written: mode, AOVs, type, compression, metadata."""

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The table of its keys."""
        return tuple(_relume.output_parameters())

    def _path(self) -> str:
        return "output"

    def _given(self) -> list[str]:
        return self._rig.output_given()

    def _unset(self, name: str) -> None:
        self._rig.output_unset(name)


class Camera(Section):
    """The camera, where header and positions do not give one: matrix (4, 4), fov, projection, …."""

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The table of its keys."""
        return tuple(_relume.camera_parameters())

    def _path(self) -> str:
        return "camera"

    def __setattr__(self, name: str, value: object) -> None:
        if name == "matrix" and value is not None:
            value = [number for row in value for number in (row if isinstance(row, Iterable) else [row])]  # type: ignore[attr-defined]
        super().__setattr__(name, value)

    def _unset(self, name: str) -> None:
        self._rig.unset_camera(name)


class ChannelRule(Section):
    """How one semantic channel is stored: channel, part, encoding, space, flip, …. What is absent is detected."""

    _own = ("_rig", "_name")
    _name: str

    def __init__(self, rig: _relume.Rig, name: str) -> None:
        super().__init__(rig)
        object.__setattr__(self, "_name", name)

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The table of its keys."""
        return tuple(_relume.channel_rule_parameters())

    def _path(self) -> str:
        return f"gbuffer.channels.{_part(self._name)}"


class Channels(MutableMapping[str, ChannelRule]):
    """What the rig says of channels: ``channels["normal"] = "N"`` or ``= {"channel": "N", "space": "camera"}``."""

    def __init__(self, rig: _relume.Rig) -> None:
        self._rig = rig

    def __getitem__(self, name: str) -> ChannelRule:
        if name not in self._rig.channel_sources():
            raise UnknownNameError(f"the rig says nothing of channel '{name}'")
        return ChannelRule(self._rig, name)

    def __setitem__(self, name: str, rule: str | os.PathLike[str] | Mapping[str, object] | ChannelRule) -> None:
        if isinstance(rule, ChannelRule):
            rule = {key: getattr(rule, key) for key in rule._given()}
        self._rig.set(f"gbuffer.channels.{_part(name)}", toml_text(rule))

    def __delitem__(self, name: str) -> None:
        self[name]
        self._rig.remove_channel(name)

    def __iter__(self) -> Iterator[str]:
        return iter(self._rig.channel_sources())

    def __len__(self) -> int:
        return len(self._rig.channel_sources())

    def __repr__(self) -> str:
        return f"<channels: {', '.join(repr(rule) for rule in self.values()) or 'as detected'}>"


class GBufferSection(Section):
    """How the G-buffer is read: file, frame, part, view, alpha, …, limits, and ``channels``."""

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The table of its keys."""
        return tuple(_relume.gbuffer_parameters())

    @property
    def channels(self) -> Channels:
        """Rules by semantic name."""
        return Channels(self._rig)

    def _path(self) -> str:
        return "gbuffer"

    def _unset(self, name: str) -> None:
        self._rig.unset_gbuffer(name)


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
        return _from_toml(None, self._rig.get(key))

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
