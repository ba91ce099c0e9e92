# SPDX-License-Identifier: Apache-2.0
"""The command line ``relume``. A command is a module here; what is heavy is imported when a command runs."""

from __future__ import annotations

import importlib
import os
import sys
from collections.abc import Sequence

import click

#: Exit codes, all below 126, for scripts and farms.
EXIT_OK = 0
EXIT_FAILED = 1  # a frame or a file failed
EXIT_USAGE = 2  # the command line or the rig is wrong: another machine would not do better
EXIT_INTERRUPTED = 3  # Ctrl-C or a SIGTERM; nothing half-written is left

# Command, module (its object is `command`), what `relume --help` says.
_COMMANDS = {
    "relight": ("relight", "Relight a frame or a sequence."),
    "inspect": ("inspect", "Show what is understood of a G-buffer, and why."),
    "png": ("png", "Turn a layer of an EXR into a PNG to look at."),
    "shaders": ("shaders", "List the shading models, or what one takes."),
    "lights": ("lights", "List the kinds of light, or what one takes."),
    "rig": ("rig", "Check a rig."),
    "farm": ("farm", "Describe a relight to a render farm."),
    "scene": ("scene", "Render a built-in scene into a G-buffer."),
    "demo": ("demo", "Make the built-in scenes, relight them, write pictures."),
    "plugins": ("plugins", "Say where the plugins for other programs are."),
    "doctor": ("doctor", "Say what this installation can do, and what is wrong with it."),
}


class _Commands(click.Group):
    """Imports a command's module when the command is asked for."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(_COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in _COMMANDS:
            return None
        module = importlib.import_module(f"relume.cli.{_COMMANDS[cmd_name][0]}")
        command = module.command
        assert isinstance(command, click.Command)
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        try:
            return super().resolve_command(ctx, args)
        except click.UsageError as error:
            import difflib

            near = difflib.get_close_matches(args[0], _COMMANDS, 1)
            if near:
                raise click.UsageError(f"No such command '{args[0]}'; did you mean '{near[0]}'?", ctx) from error
            raise

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl([(name, text) for name, (_, text) in _COMMANDS.items()])


def _version(ctx: click.Context, parameter: click.Parameter, value: bool) -> None:
    if not value or ctx.resilient_parsing:
        return
    import relume

    click.echo(f"relume {relume.__version__}")
    ctx.exit()


@click.command(cls=_Commands, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.option("--version", is_flag=True, callback=_version, expose_value=False, is_eager=True, help="Show the version.")
def commands() -> None:
    """Relight rendered pictures from their G-buffers.

    Exit codes: 0 all went well, 1 a frame or file failed, 2 the command line or the rig is wrong, 3 interrupted.
    """


def run(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns its exit code. Errors become one line on standard error."""
    try:
        code = commands.main(args=arguments, prog_name="relume", standalone_mode=False)
        sys.stdout.flush()
        return code if isinstance(code, int) else EXIT_OK
    except click.ClickException as error:
        error.show()
        return EXIT_USAGE if isinstance(error, click.UsageError) else EXIT_FAILED
    except (click.Abort, KeyboardInterrupt):
        click.echo("relume: interrupted", err=True)
        return EXIT_INTERRUPTED
    except BrokenPipeError:
        # Whoever read our output has had enough (`relume inspect … | head`).
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return EXIT_OK
    except Exception as error:
        from relume.cli.report import exit_code_of, one_line

        if os.environ.get("RELUME_DEBUG"):
            raise
        click.echo(f"relume: {one_line(error)}", err=True)
        return exit_code_of(error)


def main() -> None:
    """Entry of the program ``relume``."""
    sys.exit(run())
