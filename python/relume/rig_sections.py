# SPDX-License-Identifier: Apache-2.0
"""The sections of a rig, by attribute: lights, shaders, [output], [camera], [gbuffer] and its channels."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping, MutableMapping, Sequence
from typing import TYPE_CHECKING, Any

from relume import _relume
from relume.errors import ParameterError, UnknownNameError
from relume.rig_values import from_toml, key_part, quoted, toml_text

if TYPE_CHECKING:
    from relume._relume import Parameter

__all__ = ["Camera", "Channels", "GBufferSection", "Light", "Lights", "Output", "Section", "ShaderUse", "ShaderUses"]


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
        return from_toml(row, text)

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
        self._rig.set(f"{self._path()}.type", quoted(value))

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The table of its keys."""
        kind = self.type
        return next(tuple(light.parameters) for light in _relume.light_types() if light.name == kind)

    def _path(self) -> str:
        return f"light.{key_part(self._name)}"

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
        key_part(name)  # refuses what no key can name
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
        self._rig.set(f"{self._path()}.use", quoted(value))

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
        return f"gbuffer.channels.{key_part(self._name)}"


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
        self._rig.set(f"gbuffer.channels.{key_part(name)}", toml_text(rule))

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
