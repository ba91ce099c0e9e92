# SPDX-License-Identifier: Apache-2.0
"""The shading models: what they take, and their values on arrays (for tests, plots and fitting)."""

from __future__ import annotations

import inspect
import math
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from relume import _relume
from relume._relume import LightType, Parameter
from relume.errors import ArgumentError, ParameterError, UnknownNameError
from relume.images import install_reader

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from relume._shader_types import ShaderMapping

__all__ = ["Evaluation", "Shader", "light_types", "shaders"]

# A direction further from unit length than this is a mistake and not rounding.
_UNIT_TOLERANCE = 1e-3


class Evaluation(NamedTuple):
    """f·NdotL of the three lobes, 1/sr, each (…, 3) RGB."""

    diffuse: NDArray[Any]
    specular: NDArray[Any]
    transmission: NDArray[Any]


class Shader:
    """A shading model. Everything about it comes from the table that its source declares.

    Attributes:
        name: what a rig calls it.
        label: what a user interface calls it.
        help: what it is for, what its result includes, its limits and its references.
        parameters: its parameter table.
        evaluate: its value on arrays; ``help(shader.evaluate)`` shows its keyword arguments.
    """

    def __init__(self, info: _relume.ShaderInfo) -> None:
        self._info = info
        self.name = info.name
        self.label = info.label
        self.help = info.help
        self.parameters: tuple[Parameter, ...] = tuple(info.parameters)
        self.__doc__ = f"{info.label}: {info.help}"
        self.evaluate: Callable[..., Evaluation] = _evaluate_of(self)

    @property
    def file(self) -> Path | None:
        """The plugin that it comes from; None when it is built in."""
        path = self._info.file
        return path if str(path) not in ("", ".") else None

    @property
    def isas(self) -> list[str]:
        """Instruction sets that it has kernels for."""
        return self._info.isas

    @property
    def needs_tangent(self) -> bool:
        """Whether the tangent changes its value."""
        return self._info.needs_tangent

    def parameter(self, name: str) -> Parameter:
        """The row of its table.

        Raises:
            UnknownNameError: it has no such parameter; the message has the nearest name.
        """
        for row in self.parameters:
            if row.name == name:
                return row
        raise UnknownNameError(
            f"shader '{self.name}' has no parameter '{name}'{_hint(name, [p.name for p in self.parameters])}"
        )

    def table(self, name: str) -> NDArray[np.float32]:
        """The built-in table of a parameter of type table, (H, W).

        Raises:
            UnknownNameError: it has no such parameter; the message has the nearest name.
            ParameterError: the parameter is not a table.
        """
        return _relume.builtin_table(self._info, self.parameter(name).name)

    def __repr__(self) -> str:
        return f"<Shader {self.name}: {', '.join(p.name for p in self.parameters)}>"


class Shaders(Mapping[str, Shader]):
    """All registered shading models by name: the built-in ones first, then those of RELUME_SHADER_PATH."""

    def __init__(self) -> None:
        self._by_name: dict[str, Shader] | None = None

    def _all(self) -> dict[str, Shader]:
        if self._by_name is None:
            self._by_name = {info.name: Shader(info) for info in _relume.shaders()}
        return self._by_name

    def __getitem__(self, name: str) -> Shader:
        try:
            return self._all()[name]
        except KeyError:
            raise UnknownNameError(f"no shader '{name}'{_hint(name, list(self._all()))}") from None

    def __contains__(self, name: object) -> bool:
        return name in self._all()

    def __iter__(self) -> Iterator[str]:
        return iter(self._all())

    def __len__(self) -> int:
        return len(self._all())

    def __repr__(self) -> str:
        return f"<shaders: {', '.join(self)}>"


def _hint(word: str, candidates: Sequence[str]) -> str:
    near = _relume.nearest_name(word, list(candidates))
    return f"; did you mean '{near}'?" if near else f"; there are {', '.join(candidates)}"


class _LightTypes(Mapping[str, LightType]):
    """The kinds of light by name, each with its parameter table."""

    def __getitem__(self, name: str) -> LightType:
        types = {light.name: light for light in _relume.light_types()}
        if name not in types:
            raise UnknownNameError(f"no light type '{name}'{_hint(name, list(types))}")
        return types[name]

    def __iter__(self) -> Iterator[str]:
        return (light.name for light in _relume.light_types())

    def __len__(self) -> int:
        return len(_relume.light_types())

    def __repr__(self) -> str:
        return f"<light types: {', '.join(self)}>"


def range_text(parameter: Parameter) -> str:
    """The hard range and the unit of a parameter, "0…1", "≥ 0 degrees", "" when anything goes."""
    low, high = parameter.min, parameter.max
    if math.isfinite(low) and math.isfinite(high):
        text = f"{low:g}…{high:g}"
    elif math.isfinite(low):
        text = f"≥ {low:g}"
    elif math.isfinite(high):
        text = f"≤ {high:g}"
    else:
        text = ""
    return f"{text} {parameter.unit}".strip()


def default_text(parameter: Parameter) -> str:
    """The default of a parameter as a rig would write it."""
    value = parameter.default
    if value is None:
        return "–"
    if parameter.type == "table":
        return value or "built in"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (tuple, list)):
        return f"[{', '.join(f'{v:g}' if isinstance(v, float) else repr(v) for v in value)}]"
    return f"{value:g}" if isinstance(value, float) else str(value)


def _is_option(row: Parameter) -> bool:
    return row.type in ("boolean", "integer", "choice")


def _is_number(row: Parameter) -> bool:
    return row.type in ("scalar", "color", "vector")


def _argument_help(row: Parameter) -> str:
    shape = {
        "color": "(…, 3) linear RGB, or (…) for grey",
        "vector": "(…, 3)",
        "scalar": "(…)",
        "choice": " | ".join(row.choices),
        "boolean": "bool",
        "integer": "int",
        "table": "(H, W) numbers, or a file of them",
    }.get(row.type, row.type)
    limits = "" if row.type in ("boolean", "choice", "table") else range_text(row)
    about = f"{shape}{', ' + limits if limits else ''}, default {default_text(row)}."
    return f"{row.name}: {about} {row.help}"


def _evaluate_of(shader: Shader) -> Callable[..., Evaluation]:
    """A function whose signature and docstring are the shader's own."""

    def evaluate(
        *,
        n: ArrayLike,
        v: ArrayLike,
        l: ArrayLike,  # noqa: E741
        tangent: ArrayLike | None = None,
        **parameters: Any,
    ) -> Evaluation:
        return _evaluate(shader, n, v, l, tangent, parameters)

    keyword = inspect.Parameter.KEYWORD_ONLY
    arguments = [inspect.Parameter(name, keyword, annotation="ArrayLike") for name in ("n", "v", "l")]
    arguments.append(inspect.Parameter("tangent", keyword, default=None, annotation="ArrayLike | None"))
    arguments += [inspect.Parameter(row.name, keyword, default=row.default) for row in shader.parameters]
    evaluate.__name__ = "evaluate"
    evaluate.__qualname__ = f"shaders[{shader.name!r}].evaluate"
    evaluate.__signature__ = inspect.Signature(arguments, return_annotation=Evaluation)  # type: ignore[attr-defined]
    rows = "\n        ".join(_argument_help(row) for row in shader.parameters)
    evaluate.__doc__ = f"""f·NdotL (1/sr) of {shader.name} on arrays, which broadcast against each other.

    {shader.help}

    The work is done in float64 unless every array that is given is float32 or float16.

    Args:
        n: (…, 3) surface normal, unit.
        v: (…, 3) to the viewer, unit.
        l: (…, 3) to the light, unit.
        tangent: (…, 3) unit, orthogonal to n; made from n where it is not given.
        {rows}

    Returns:
        Diffuse, specular and transmission, each (…, 3).

    Raises:
        UnknownNameError: no such parameter; the message has the nearest name.
        ParameterError: a value out of its range.
        ArgumentError: shapes that do not broadcast, directions that are not unit.
    """
    return evaluate


def _dtype_of(values: Sequence[object]) -> type[np.float32] | type[np.float64]:
    arrays = [value for value in values if isinstance(value, (np.ndarray, np.generic))]
    single = bool(arrays) and all(array.dtype in (np.float32, np.float16) for array in arrays)
    return np.float32 if single else np.float64


def _array(name: str, value: object, dtype: type[np.float32] | type[np.float64]) -> NDArray[Any]:
    try:
        return np.asarray(value, dtype=dtype)
    except (TypeError, ValueError):
        raise ArgumentError(f"evaluate: {name} must be numbers, not {value!r}") from None


def _direction(name: str, value: object, dtype: type[np.float32] | type[np.float64]) -> NDArray[Any]:
    array = _array(name, value, dtype)
    if array.ndim == 0 or array.shape[-1] != 3:
        raise ArgumentError(f"evaluate: {name} has shape {array.shape}; give (…, 3)")
    squared = np.einsum("...k,...k->...", array, array)
    if np.any(np.abs(squared - 1) > 2 * _UNIT_TOLERANCE):
        raise ArgumentError(f"evaluate: {name} must be unit vectors; divide them by their length")
    return array


def _option(shader: Shader, row: Parameter, value: object) -> int:
    if row.type == "choice":
        if value not in row.choices:
            hint = _hint(str(value), row.choices)
            raise ParameterError(f"shader '{shader.name}': {row.name} has no choice {value!r}{hint}")
        return row.choices.index(str(value))
    if not isinstance(value, (bool, int, np.bool_, np.integer)):
        raise ParameterError(f"shader '{shader.name}': {row.name} is a {row.type}, not {value!r}")
    if not row.min <= int(value) <= row.max:
        raise ParameterError(f"shader '{shader.name}': {row.name} = {value} is outside {range_text(row)}")
    return int(value)


def _table(row: Parameter, value: object) -> NDArray[np.float32] | None:
    """The numbers of a table by its value; None for the built-in one."""
    if value is None or (isinstance(value, str) and not value):
        return None
    if isinstance(value, (str, os.PathLike)):
        install_reader()
        return _relume.load_table(Path(value))
    return _array(row.name, value, np.float32)


def _evaluate(
    shader: Shader,
    n: object,
    v: object,
    l: object,  # noqa: E741
    tangent: object,
    given: dict[str, Any],
) -> Evaluation:
    info = shader._info
    rows = {name: shader.parameter(name) for name in given}
    tables: list[NDArray[np.float32] | None] = [None] * info.table_slots
    for name, row in rows.items():
        if row.type == "table":
            tables[row.slot] = _table(row, given[name])
    floats = {name: value for name, value in given.items() if _is_number(rows[name])}
    dtype = _dtype_of([n, v, l, tangent, *floats.values()])

    directions = [_direction("n", n, dtype), _direction("v", v, dtype), _direction("l", l, dtype)]
    if tangent is not None:
        directions.append(_direction("tangent", tangent, dtype))

    # Every input becomes columns: its components, each an array that broadcasts to the common shape.
    values: dict[str, NDArray[Any]] = {}
    shapes = {name: array.shape[:-1] for name, array in zip("nvlt", directions, strict=False)}
    for name, value in floats.items():
        row, array = rows[name], _array(name, value, dtype)
        if np.any(array < row.min) or np.any(array > row.max):
            raise ParameterError(f"shader '{shader.name}': {name} is outside {range_text(row)}")
        if row.components == 3:
            if row.type == "vector" and array.ndim == 0:
                raise ArgumentError(f"evaluate: {name} has shape (); give (…, 3)")
            if array.ndim and array.shape[-1] not in (1, 3):
                raise ArgumentError(f"evaluate: {name} has shape {array.shape}; give (…, 3), or one number for grey")
            shapes[name] = array.shape[:-1]
        else:
            shapes[name] = array.shape
        values[name] = array
    try:
        shape = np.broadcast_shapes(*shapes.values())
    except ValueError:
        listing = ", ".join(f"{name} {extent}" for name, extent in shapes.items())
        raise ArgumentError(f"evaluate: these shapes do not broadcast (without the 3 of vectors): {listing}") from None
    count = math.prod(shape)

    def column(array: NDArray[Any]) -> NDArray[Any]:
        if array.size == 1:
            return array.reshape(1)
        return np.ascontiguousarray(np.broadcast_to(array, shape)).reshape(count)

    columns = [column(array[..., k]) for array in directions for k in range(3)]
    params = [np.zeros(1, dtype)] * info.float_slots
    options = [0] * info.option_slots
    for row in shader.parameters:
        if _is_option(row):
            options[row.slot] = _option(shader, row, given.get(row.name, row.default))
        if not _is_number(row):
            continue
        array = values[row.name] if row.name in values else np.asarray(row.default, dtype)
        for k in range(row.components):
            part = array if row.components == 1 or array.ndim == 0 else array[..., min(k, array.shape[-1] - 1)]
            params[row.slot + k] = column(part)
    evaluate = _relume.evaluate_float if dtype is np.float32 else _relume.evaluate_double
    flat = evaluate(info, count, columns, params, options, tables)
    lobes = np.moveaxis(flat.reshape(3, 3, *shape), 1, -1)
    return Evaluation(*(np.ascontiguousarray(lobe) for lobe in lobes))


if TYPE_CHECKING:
    shaders: ShaderMapping
else:
    shaders = Shaders()

#: The kinds of light by name; ``light_types["sun"].parameters`` is what one takes.
light_types: Mapping[str, LightType] = MappingProxyType(_LightTypes())
