# SPDX-License-Identifier: Apache-2.0
"""``relume doctor``: what this installation is made of, what it can do, and what is wrong with it."""

from __future__ import annotations

import importlib
import os
import platform
from importlib import metadata
from pathlib import Path

import click

from relume.cli import EXIT_FAILED, EXIT_OK

# Optional packages: distribution, module, what it is for.
_OPTIONAL = (
    ("OpenImageIO", "OpenImageIO", "reads G-buffer channels from PNG, JPEG and TIFF"),
    ("opencolorio", "PyOpenColorIO", "display transforms by OpenColorIO (relume png --ocio-display)"),
)
_PLUGIN_SUFFIX = ".relume.so"
_REQUIRED = ("numpy", "click", "rich")


@click.command("doctor")
def command() -> int:
    """Say what this installation can do. Exit code 1 if a plugin or a setting does not work."""
    try:
        from relume import _relume
    except ImportError as error:
        click.echo(f"relume's library does not load: {error}")
        return EXIT_FAILED

    troubles: list[str] = []
    click.echo(f"relume {_relume.version()} ({Path(_relume.__file__).parent}), {_relume.openexr_build()}")
    click.echo(f"Python {platform.python_version()}, {platform.platform()}")
    _instruction_sets(troubles)
    _packages(troubles)
    _plugins(troubles)
    _hosts(troubles)
    for name in (
        "RELUME_ISA",
        "RELUME_SHADER_PATH",
        "OCIO",
        "OIIO_LIBRARY_PATH",
        "OPENIMAGEIO_PLUGIN_PATH",
        "RELUME_CACHE_MB",
    ):
        if name in os.environ:
            click.echo(f"environment: {name}={os.environ[name]}")
    config = os.environ.get("OCIO")
    if config and not config.startswith("ocio://") and not Path(config).exists():
        troubles.append(f"OCIO names a file that is not there: {config}")
    for text in troubles:
        click.echo(f"trouble: {text}")
    click.echo("all is well" if not troubles else f"{len(troubles)} trouble{'s' if len(troubles) > 1 else ''}")
    return EXIT_FAILED if troubles else EXIT_OK


def _instruction_sets(troubles: list[str]) -> None:
    from relume import _relume
    from relume.errors import Error

    usable = _relume.available_isas()
    try:
        active = _relume.active_isa()
    except Error as error:
        troubles.append(str(error))
        active = "none"
    threads = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    click.echo(f"instruction sets: {', '.join(usable)}; in use: {active}; {threads} CPUs for this process")


def _packages(troubles: list[str]) -> None:
    required = ", ".join(f"{name} {metadata.version(name)}" for name in _REQUIRED)
    click.echo(f"packages: {required}")
    for name, module, purpose in _OPTIONAL:
        try:
            version = metadata.version(name)
        except metadata.PackageNotFoundError:
            click.echo(f"  {name}: not installed; {purpose} (pip install {name})")
            continue
        try:
            importlib.import_module(module)
        except ImportError as error:
            troubles.append(f"{name} {version} is installed but does not load: {error}")
            continue
        click.echo(f"  {name} {version}: {purpose}")


def _plugins(troubles: list[str]) -> None:
    from relume import _relume

    shaders = _relume.shaders()
    own = [shader.name for shader in shaders if str(shader.file) not in ("", ".")]
    plugins = f", from plugins: {', '.join(own)}" if own else ""
    click.echo(f"shaders: {len(shaders) - len(own)} built in{plugins}")
    reports = _relume.plugin_reports()
    for report in reports:
        state = "loaded" if report.loaded else "not loaded"
        click.echo(f"  {report.file}: {state}{f': {report.message}' if report.message else ''}")
        if not report.loaded:
            troubles.append(f"{report.file}: {report.message}")
    path = os.environ.get("RELUME_SHADER_PATH", "")
    for folder in (Path(word) for word in path.split(":") if word):
        for file in sorted(folder.glob("*.so")):
            if not file.name.endswith(_PLUGIN_SUFFIX):
                troubles.append(f"{file}: no plugin, since its name does not end with {_PLUGIN_SUFFIX}")
    if not reports:
        why = "there are none on RELUME_SHADER_PATH" if path else "RELUME_SHADER_PATH is not set"
        click.echo(f"  no plugins: {why}")


def _hosts(troubles: list[str]) -> None:
    from relume.hosts import find_openimageio, oiio_plugin

    click.echo("OpenImageIO, and the plugin that makes a rig an image there:")
    found = find_openimageio()
    for host in found:
        plugin, trouble = oiio_plugin(host.release), host.trouble()
        state = "no plugin for this release" if plugin is None else f"{plugin}: {trouble or 'loads'}"
        click.echo(f"  {host.release} of {host.owner} ({host.library}): {state}")
        if trouble:
            troubles.append(f"{plugin}: does not load into {host.library}: {trouble}")
    if not found:
        click.echo("  none was found")
