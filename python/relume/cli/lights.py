# SPDX-License-Identifier: Apache-2.0
"""``relume lights [TYPE]``: the kinds of light, from their tables."""

from __future__ import annotations

import json

import click


@click.command("lights")
@click.argument("kind", required=False, metavar="[TYPE]")
@click.option("--json", "as_json", is_flag=True, help="For programs.")
def command(kind: str | None, as_json: bool) -> None:
    """List the kinds of light, or what TYPE takes."""
    from relume.cli.shaders import as_data, show_entry, show_list
    from relume.shading import light_types

    if as_json:
        chosen = [light_types[kind]] if kind else list(light_types.values())
        rows = [
            {"name": t.name, "label": t.label, "help": t.help, "parameters": [as_data(row) for row in t.parameters]}
            for t in chosen
        ]
        click.echo(json.dumps(rows[0] if kind else rows, indent=2, ensure_ascii=False))
    elif kind:
        light = light_types[kind]
        show_entry(f"{light.name}: {light.label}", light.help, light.parameters)
    else:
        show_list((light.name, light.help) for light in light_types.values())
        click.echo("\n`relume lights TYPE` shows what one takes.")
