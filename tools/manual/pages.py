# SPDX-License-Identifier: Apache-2.0
"""The texts of the generated pages."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

from relume import light_types, shaders
from relume.shading import default_text, range_text

from manual import references, spheres

if TYPE_CHECKING:
    from collections.abc import Iterable

    from relume import Parameter, Shader

_MADE = "<!-- Made by ./dev docs from {source}: change that. -->\n\n"


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ")


def _sentence(text: str) -> str:
    """The first sentence of a help text, without its citations."""
    bare = re.sub(r" ?\[[A-Za-z]{2,}\d{4}[^\]]*\]", "", text)
    return re.split(r"(?<=[.:])\s", bare, maxsplit=1)[0].rstrip(":").rstrip(".") + "."


def _table(rows: Iterable[Parameter]) -> str:
    lines = ["| parameter | default | range | meaning |", "| --- | --- | --- | --- |"]
    for row in rows:
        names = ("true", "false") if row.type == "boolean" else row.choices
        limits = " ".join(f"`{choice}`" for choice in names) or range_text(row)
        lines.append(f"| `{row.name}` | {_cell(default_text(row))} | {_cell(limits)} | {_cell(row.help)} |")
    return "\n".join(lines) + "\n"


def _value(value: spheres.Value) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, tuple):
        return "[" + ", ".join(f"{component:.3g}" for component in value) + "]"
    return value if isinstance(value, str) else f"{value:g}"


def _shader_page(shader: Shader, bibliography: dict[str, dict[str, str]]) -> str:
    text = f"# {shader.label}: `{shader.name}`\n\n"
    text += _MADE.format(source=f"plugins/shaders/{shader.name}.h")
    text += shader.help + "\n\n" + _table(shader.parameters) + "\n"
    text += f'In a rig:\n\n```toml\n[[shader]]\nuse = "{shader.name}"\n```\n'
    strips = [strip for strip in spheres.all_strips() if strip.shader == shader.name]
    if strips:
        text += "\n## What each parameter does\n"
    for strip in strips:
        shown = " · ".join(_value(value) for value in strip.values)
        text += f"\n`{strip.parameter}`: {shown}\n\n![{strip.parameter}](pictures/{strip.file})\n"
    keys = references.cited(shader.help)
    if keys:
        text += "\n## References\n\n"
        text += "".join(f"- [{key}] {references.entry_text(bibliography[key])}\n" for key in keys)
    return text


def _shader_list(built_in: list[Shader]) -> str:
    text = "# Shading models\n\n" + _MADE.format(source="plugins/shaders")
    text += "| shader | what it is |\n| --- | --- |\n"
    for shader in built_in:
        text += f"| [`{shader.name}`]({shader.name}.md) | {_cell(_sentence(shader.help))} |\n"
    text += "\nOne of your own: [howto-shader.md](../howto-shader.md). "
    return text + "Units and directions: [conventions.md](../conventions.md).\n"


def _lights() -> str:
    text = "# Lights\n\n" + _MADE.format(source="core/lights/light_types.cpp")
    types = list(light_types.values())
    shared = [row for row in types[0].parameters if all(row.name in {r.name for r in t.parameters} for t in types)]
    names = {row.name for row in shared}
    text += "Units and directions: [conventions.md](conventions.md). The rig file around them: [rig.md](rig.md).\n\n"
    text += "## Every light\n\n" + _table(shared)
    for light in types:
        text += f"\n## `{light.name}`\n\n{light.help}\n\n" + _table(
            row for row in light.parameters if row.name not in names
        )
    return text


def all_pages(docs: Path) -> dict[Path, str]:
    """The generated pages below `docs`, by path."""
    bibliography = references.read(docs / "references.bib")
    built_in = [shader for shader in shaders.values() if shader.file is None]
    pages = {docs / "shaders" / f"{shader.name}.md": _shader_page(shader, bibliography) for shader in built_in}
    pages[docs / "shaders" / "README.md"] = _shader_list(built_in)
    pages[docs / "lights.md"] = _lights()
    return pages
