# SPDX-License-Identifier: Apache-2.0
"""``relume rig check FILE``: whether a rig is right, without relighting anything."""

from __future__ import annotations

import click

from relume.cli.options import RigFailure, load_rig, set_option


@click.group("rig")
def command() -> None:
    """Check a rig."""


@command.command("check")
@click.argument("path", metavar="FILE")
@set_option
@click.option(
    "--print", "as_toml", is_flag=True, help="Write the rig as it is understood, includes and all, to standard output."
)
def check(path: str, settings: tuple[str, ...], as_toml: bool) -> None:
    """Read the rig FILE and say what it holds; exit code 2 and the place of the first mistake if there is one."""
    from relume.cli.report import one_line
    from relume.errors import Error

    rig = load_rig(path, settings)
    aovs = rig.aovs  # an AOV that names no light is a mistake too
    try:
        rig.check_tables()
    except Error as error:
        raise RigFailure(f"{path}: {one_line(error)}") from None
    if as_toml:
        click.echo(str(rig), nl=False)
        return
    lights = [light for light in rig.light.values() if light.enabled]
    off = len(rig.light) - len(lights)
    if not rig.light:
        raise RigFailure(f"{path}: no lights; add a [[light]]")
    click.echo(f"{path}: right")
    click.echo(
        f"  lights: {', '.join(f'{light.name} ({light.type})' for light in lights)}{f'; {off} off' if off else ''}"
    )
    click.echo(f"  shaders: {', '.join(shader.use for shader in rig.shader) or 'principled for every pixel'}")
    click.echo(f"  pictures: {', '.join(aovs)}")
