# SPDX-License-Identifier: Apache-2.0
"""Options that several commands have: the rig, and what detection is told of a G-buffer."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import click

if TYPE_CHECKING:
    from relume.rig import Rig

F = TypeVar("F", bound=Callable[..., object])


def gbuffer_options(function: F) -> F:
    """--channel, --part, --view."""
    for option in (
        click.option("--view", metavar="NAME", help="View to take of a stereo file."),
        click.option("--part", metavar="NAME", help="Layer or part to take when the file holds several."),
        click.option(
            "--channel",
            "channels",
            multiple=True,
            metavar="NAME=SOURCE",
            help="Where a channel comes from: normal=N, roughness=rough.####.png. NAME.KEY=VALUE says how it is "
            "stored: normal.space=camera. May be repeated.",
        ),
    ):
        function = option(function)
    return function


def set_option(function: F) -> F:
    """--set."""
    return click.option(
        "--set",
        "settings",
        multiple=True,
        metavar="KEY=VALUE",
        help="Change the rig: light.key.exposure=1, output.type=float, camera.fov=39.6. May be repeated.",
    )(function)


def _split(word: str, option: str) -> tuple[str, str]:
    key, equals, value = word.partition("=")
    if not equals or not key.strip():
        raise click.UsageError(f"{option} takes KEY=VALUE, not '{word}'")
    return key.strip(), value.strip()


def load_rig(
    path: str | None,
    settings: Sequence[str] = (),
    channels: Sequence[str] = (),
    part: str | None = None,
    view: str | None = None,
) -> Rig:
    """The rig with everything that the command line changes. Whatever is wrong with it is a usage error.

    Raises:
        click.UsageError: no such file, not a rig, no such key.
    """
    from relume.cli.report import one_line
    from relume.errors import Error
    from relume.rig import Rig, toml_text

    try:
        rig = Rig.find(path) if path is not None else Rig()
        for word in settings:
            rig.set(*_split(word, "--set"))
        for word in channels:
            key, value = _split(word, "--channel")
            # A bare name is a source, whatever it looks like as TOML.
            rig._rig.set(f"gbuffer.channels.{key}", value if "." in key else toml_text(value))
        if part is not None:
            rig.gbuffer.part = part
        if view is not None:
            rig.gbuffer.view = view
        # A worker of a farm has another current folder.
        rig._rig.resolve_files(Path.cwd())
    except Error as error:
        raise RigFailure(one_line(error)) from error
    return rig


class RigFailure(click.UsageError):
    """Something is wrong with the rig: one line, without the usage that click adds."""

    def show(self, file: object = None) -> None:
        """One line on standard error."""
        click.echo(f"relume: {self.message}", err=True)
