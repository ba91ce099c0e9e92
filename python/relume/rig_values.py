# SPDX-License-Identifier: Apache-2.0
"""Values of a rig's keys, and their TOML."""

from __future__ import annotations

import math
import os
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from relume.errors import ParameterError

if TYPE_CHECKING:
    from relume._relume import Parameter

__all__ = ["FromChannel", "Keys", "from_toml", "key_part", "quoted", "toml_text"]


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
        return quoted(os.fspath(value))
    if isinstance(value, Mapping):
        return f"{{{', '.join(f'{_key(str(name))} = {toml_text(item)}' for name, item in value.items())}}}"
    if isinstance(value, Iterable):
        return f"[{', '.join(toml_text(item) for item in value)}]"
    raise ParameterError(
        f"a rig cannot hold a {type(value).__name__}; give a number, three numbers, true or false, a string, "
        'a list of strings, or {"channel": name}'
    )


def quoted(text: str) -> str:
    """A TOML string."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(c if c >= " " and c != "\x7f" else f"\\u{ord(c):04x}" for c in escaped) + '"'


def _key(name: str) -> str:
    bare = name.isascii() and name.replace("_", "a").replace("-", "a").isalnum()
    return name if bare else quoted(name)


def key_part(name: str) -> str:
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


def from_toml(row: Parameter | None, text: str) -> Any:
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
