# SPDX-License-Identifier: Apache-2.0
"""``relume demo``: from nothing to relit pictures."""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from relume.rig import Rig


@dataclass(frozen=True)
class Look:
    """One way to light a scene: a built-in rig with changes, and what the picture shows."""

    name: str
    rig: str
    changes: tuple[tuple[str, object], ...]
    tone: str
    about: str


# Scene, layers of its G-buffer to look at, looks.
_SCENES: dict[str, tuple[tuple[str, ...], tuple[Look, ...]]] = {
    "sdf": (
        ("beauty", "Normal", "albedo"),
        (
            Look("relit", "sdf", (), "none", "its own lights again, by relume"),
            Look(
                "evening",
                "sdf",
                (
                    ("light.sun.direction", (0.9, -0.35, 0.25)),
                    ("light.sun.color", (1.0, 0.45, 0.15)),
                    ("light.sun.exposure", 0.7),
                    ("light.sky.exposure", -1.5),
                    ("light.back.enabled", False),
                ),
                "aces",
                "the sun low on the other side",
            ),
        ),
    ),
    "cornell": (
        ("beauty", "Normal", "albedo"),
        (
            Look("relit", "cornell", (), "aces", "the ceiling light as one spot"),
            Look(
                "blue",
                "cornell",
                (
                    ("light.ceiling.color", (0.25, 0.45, 1.0)),
                    ("light.walls.exposure", -2.0),
                ),
                "aces",
                "the same spot in blue, the walls' glow down by two stops",
            ),
        ),
    ),
}


@click.command("demo")
@click.argument("folder", default="relume-demo", metavar="[FOLDER]")
@click.option("--threads", type=click.IntRange(1), help="How many; all that the process may use when absent.")
def command(folder: str, threads: int | None) -> None:
    """Make the two built-in scenes, relight them under new lights, and write pictures, into FOLDER (relume-demo).

    Everything is written as EXR, PNG and rig, so that the same can be done by hand.
    """
    target = Path(folder)
    target.mkdir(parents=True, exist_ok=True)
    for scene, (layers, looks) in _SCENES.items():
        _scene(target, scene, layers, looks, threads)
    click.echo(f"\nThe pictures are in {target}. The same by hand:")
    click.echo(f"  relume inspect {target / 'sdf.exr'}")
    files = f"{target / 'sdf.exr'} --rig {target / 'sdf.evening.relume'} -o out.exr"
    click.echo(f"  relume relight {files} --set light.sun.exposure=2")
    click.echo("  relume png out.exr -o out.png --tone aces")


def _scene(target: Path, scene: str, layers: tuple[str, ...], looks: tuple[Look, ...], threads: int | None) -> None:
    from relume.builtin_scenes import write_scene
    from relume.gbuffer import GBuffer
    from relume.relighting import relight_file
    from relume.rig import Rig

    source = target / f"{scene}.exr"
    start = time.perf_counter()
    write_scene(scene, source, threads=threads)
    gbuffer = GBuffer.read(source)
    height, width = gbuffer.shape
    click.echo(f"{source}: the scene {scene}, {width} × {height}, {time.perf_counter() - start:.1f} s")
    for layer in layers:
        picture = target / f"{scene}.{layer.lower()}.png"
        _picture(source, picture, None if layer == "beauty" else layer, looks[0].tone)
        click.echo(f"{picture}: its {layer if layer == 'albedo' else layer.lower()}")
    for look in looks:
        rig: Rig = Rig.builtin(look.rig)
        for key, value in look.changes:
            rig.set(key, value)
        rig.save(target / f"{scene}.{look.name}.relume")
        relit = target / f"{scene}.{look.name}.exr"
        report = relight_file(gbuffer, rig, relit, threads)
        picture = relit.with_suffix(".png")
        _picture(relit, picture, None, look.tone)
        click.echo(f"{picture}: {look.about}, {1000 * report.seconds:.0f} ms")


def _picture(path: Path, target: Path, layer: str | None, tone: str) -> None:
    from relume import _relume
    from relume.cli.png import picture_of
    from relume.display import Display, quantized
    from relume.layers import find_layer, pixels_of
    from relume.png import write_png

    file = _relume.ExrFile(path)
    found = find_layer(file, layer)
    write_png(target, quantized(picture_of(pixels_of(file, found), found.kind, Display(tone=tone)), 8))
