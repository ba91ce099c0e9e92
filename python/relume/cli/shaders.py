# SPDX-License-Identifier: Apache-2.0
"""``relume shaders [NAME]``: the shading models, from the tables that they declare."""

from __future__ import annotations

import json
import math
import re
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from collections.abc import Iterable

    from relume._relume import Parameter


@click.command("shaders")
@click.argument("name", required=False)
@click.option("--json", "as_json", is_flag=True, help="For programs.")
def command(name: str | None, as_json: bool) -> None:
    """List the shading models, or what NAME is for and what it takes."""
    from relume.shading import shaders

    if as_json:
        chosen = [shaders[name]] if name else list(shaders.values())
        rows = [
            {
                "name": shader.name,
                "label": shader.label,
                "help": shader.help,
                "file": str(shader.file) if shader.file else None,
                "parameters": [as_data(row) for row in shader.parameters],
            }
            for shader in chosen
        ]
        click.echo(json.dumps(rows[0] if name else rows, indent=2, ensure_ascii=False))
    elif name:
        shader = shaders[name]
        origin = f" (from {shader.file})" if shader.file else ""
        show_entry(f"{shader.name}: {shader.label}{origin}", shader.help, shader.parameters)
    else:
        show_list((shader.name, shader.help) for shader in shaders.values())
        click.echo("\n`relume shaders NAME` shows what one takes.")


def as_data(row: Parameter) -> dict[str, Any]:
    """A row of a parameter table as plain data; ranges without an end are null."""
    data: dict[str, Any] = {
        "name": row.name,
        "type": row.type,
        "default": row.default,
        "label": row.label,
        "help": row.help,
    }
    data["min"] = row.min if math.isfinite(row.min) else None
    data["max"] = row.max if math.isfinite(row.max) else None
    data["unit"] = row.unit
    if row.choices:
        data["choices"] = row.choices
    return data


def show_list(rows: Iterable[tuple[str, str]]) -> None:
    """Names with the first sentence of their help."""
    from rich.markup import escape
    from rich.table import Table

    from relume.cli.report import console

    table = Table(box=None, pad_edge=False, show_header=False)
    table.add_column(style="bold", no_wrap=True)
    table.add_column()
    for name, text in rows:
        table.add_row(escape(name), escape(first_sentence(text)))
    console().print(table)


def first_sentence(text: str) -> str:
    """Up to the first full stop that ends a sentence: a capital follows, or a new line ("eq. 33" goes on)."""
    end = re.search(r"\.(?=\n|\s+[A-Z])|\n", text)
    return text[: end.start()] + "." if end else text


def show_entry(title: str, text: str, parameters: Iterable[Parameter]) -> None:
    """A name, its help and its parameter table."""
    from rich.markup import escape
    from rich.table import Table

    from relume.cli.report import console
    from relume.shading import default_text, range_text

    out = console()
    out.print(f"[bold]{escape(title)}[/bold]\n{escape(text)}\n")
    table = Table(box=None, pad_edge=False, header_style="bold")
    for heading in ("parameter", "type", "default", "range", "what"):
        table.add_column(heading, overflow="fold", no_wrap=heading in ("parameter", "default"))
    for row in parameters:
        kind = " | ".join(row.choices) if row.choices else row.type
        limits = "" if row.type in ("boolean", "choice", "table") else range_text(row)
        table.add_row(*(escape(cell) for cell in (row.name, kind, default_text(row), limits, row.help)))
    out.print(table)
