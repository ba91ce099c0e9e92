# SPDX-License-Identifier: Apache-2.0
"""``relume plugins``: where the plugins for other programs are."""

from __future__ import annotations

import click

from relume.cli import EXIT_FAILED, EXIT_OK


@click.command("plugins")
@click.argument("host", required=False, type=click.Choice(["oiio"]))
@click.argument("release", required=False)
def command(host: str | None, release: str | None) -> int:
    """Print the folder of the plugin for HOST, to be put on that program's search path; without HOST list all.

    OpenImageIO (oiio) needs a plugin of its own RELEASE (2.4, 3.0, …); when it is left out, that of the
    oiiotool on PATH.

    \b
        export OIIO_LIBRARY_PATH="$(relume plugins oiio)"
    """
    from relume.hosts import oiio_plugin, oiio_release_in_use, oiio_releases

    if host is None:
        for name in oiio_releases():
            click.echo(f"oiio {name}: {oiio_plugin(name)}")
        if not oiio_releases():
            click.echo("this installation brings no plugins")
        return EXIT_OK
    if release is None:
        release = oiio_release_in_use()
        if release is None:
            raise click.UsageError(
                "no OpenImageIO is installed here: say for which release, as `relume plugins oiio 3.0`"
            )
    plugin = oiio_plugin(release)
    if plugin is None:
        there = ", ".join(oiio_releases()) or "none"
        click.echo(f"relume: no plugin for OpenImageIO {release} in this installation; there are: {there}", err=True)
        return EXIT_FAILED
    click.echo(str(plugin.parent))
    return EXIT_OK
