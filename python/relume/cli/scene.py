# SPDX-License-Identifier: Apache-2.0
"""``relume scene NAME``: a built-in scene as a G-buffer."""

from __future__ import annotations

import click


@click.command("scene")
@click.argument("name", required=False)
@click.option("-o", "--output", metavar="FILE", help="The EXR to write; NAME.exr when absent.")
@click.option("--size", metavar="WIDTHxHEIGHT", help="In pixels; the scene's own when absent.")
@click.option("--samples", type=click.IntRange(1), help="Camera rays per pixel.")
@click.option("--paths", type=click.IntRange(0), help="Light paths per camera ray (cornell); 0 leaves the beauty out.")
@click.option("--bounces", type=click.IntRange(0, 64), default=8, show_default=True, help="Of a light path (cornell).")
@click.option("--time", type=float, default=0.0, help="Seconds: the camera of sdf goes round.")
@click.option("--opaque", is_flag=True, help="The sky behind the beauty, and alpha 1.")
@click.option("--seed", type=click.IntRange(0), default=0, help="Of the light paths.")
@click.option("--threads", type=click.IntRange(1), help="How many; all that the process may use when absent.")
def command(
    name: str | None,
    output: str | None,
    size: str | None,
    samples: int | None,
    paths: int | None,
    bounces: int,
    time: float,
    opaque: bool,
    seed: int,
    threads: int | None,
) -> None:
    """Render the built-in scene NAME into a G-buffer EXR with Blender's channel names; without NAME list them."""
    from relume.builtin_scenes import scenes, write_scene
    from relume.cli.shaders import show_list

    if name is None:
        show_list((info.name, f"{info.help} ({info.width} × {info.height})") for info in scenes().values())
        return
    width, height = _size(size)
    path = output or f"{name}.exr"
    write_scene(
        name,
        path,
        width=width,
        height=height,
        samples=samples,
        paths=paths,
        bounces=bounces,
        time=time,
        opaque=opaque,
        seed=seed,
        threads=threads,
    )
    click.echo(f"{path} written", err=True)


def _size(text: str | None) -> tuple[int | None, int | None]:
    if text is None:
        return None, None
    width, _, height = text.lower().replace("×", "x").partition("x")
    if not (width.isdecimal() and height.isdecimal() and int(width) and int(height)):
        raise click.UsageError(f"--size takes WIDTHxHEIGHT, as 960x540, not '{text}'")
    return int(width), int(height)
