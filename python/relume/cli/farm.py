# SPDX-License-Identifier: Apache-2.0
"""``relume farm``: what render farms are given."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

from relume.cli.options import gbuffer_options, load_rig, set_option

if TYPE_CHECKING:
    from relume.rig import Rig


@click.group("farm")
def command() -> None:
    """Describe a relight to a render farm."""


@command.command("openjd")
@click.argument("source", metavar="GBUFFER")
@click.option("--rig", "rig_path", required=True, metavar="FILE", help="The rig, or the name of a built-in one.")
@click.option(
    "-o", "--output", required=True, metavar="FILE", help="The EXRs to write, with #### where GBUFFER has it."
)
@click.option("--frames", metavar="RANGE", help="1001-1100, 1001-1100x2; all that are on disk when absent.")
@click.option("--chunk", type=click.IntRange(min=1), default=10, show_default=True, help="Frames of a task.")
@click.option("--template", "template_path", metavar="FILE", help="Where to write it; standard output when absent.")
@set_option
@gbuffer_options
def openjd(
    source: str,
    rig_path: str,
    output: str,
    frames: str | None,
    chunk: int,
    template_path: str | None,
    settings: tuple[str, ...],
    channels: tuple[str, ...],
    part: str | None,
    view: str | None,
) -> None:
    """Write an Open Job Description template: a task for each chunk of frames, each a `relume relight`.

    Check and run it with the openjd CLI (`openjd check FILE`, `openjd run FILE --step Relight`), or submit it to a farm
    that takes such templates. Paths are made absolute: they must mean the same on every worker.
    """
    from relume.cli.relight import plan
    from relume.farm.openjd import job_template
    from relume.files import write_atomically

    rig = load_rig(rig_path, settings, channels, part, view)  # a mistake shows here, not on a hundred workers
    numbers = [frame.number for frame in plan(source, rig, output, frames) if frame.number is not None]
    if not numbers:
        raise click.UsageError(f"{source}: one file; a farm's job wants a sequence, as shot.####.exr")
    extra = [word for setting in settings for word in ("--set", _absolute(rig, setting))]
    extra += [word for channel in channels for word in ("--channel", _absolute(rig, channel, "gbuffer.channels."))]
    extra += [word for name, value in (("--part", part), ("--view", view)) if value for word in (name, value)]
    where = str(Path(rig_path).absolute()) if Path(rig_path).exists() else rig_path
    template = job_template(
        str(Path(source).absolute()), where, str(Path(output).absolute()), numbers, chunk, _escaped(extra)
    )
    text = json.dumps(template, indent=2, ensure_ascii=False) + "\n"
    if template_path is None:
        click.echo(text, nl=False)
    else:
        write_atomically(Path(template_path), text.encode())


def _absolute(rig: Rig, setting: str, section: str = "") -> str:
    """KEY=VALUE as the rig holds it where it names a file: a worker has another current folder."""
    key = setting.partition("=")[0].strip()
    value = rig.get(section + key)
    return f"{key}={value}" if value in map(str, rig._rig.input_files()) else setting


def _escaped(words: list[str]) -> list[str]:
    """What the template language would take for its own."""
    for word in words:
        if "{{" in word:
            raise click.UsageError(f"'{word}' cannot stand in a template, which fills in what is in double braces")
    return words
