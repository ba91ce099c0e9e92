# SPDX-License-Identifier: Apache-2.0
"""``relume inspect``: what is understood of a G-buffer, from which channel, why, and what is assumed."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any

import click

from relume.cli.options import gbuffer_options, load_rig, set_option

if TYPE_CHECKING:
    from relume._relume import Camera
    from relume.gbuffer import GBuffer


@click.command("inspect")
@click.argument("source", required=False, metavar="[GBUFFER]")
@click.option("--rig", "rig_path", metavar="FILE", help="A rig, whose [gbuffer] and [camera] are heeded.")
@click.option("--frame", type=int, help="The frame to look at, where GBUFFER is a sequence.")
@click.option("--json", "as_json", is_flag=True, help="For programs.")
@set_option
@gbuffer_options
def command(
    source: str | None,
    rig_path: str | None,
    frame: int | None,
    as_json: bool,
    settings: tuple[str, ...],
    channels: tuple[str, ...],
    part: str | None,
    view: str | None,
) -> None:
    """Show what is understood of GBUFFER: each channel, where it comes from, why it is taken so, and what is assumed.

    With a rig it shows what `relume relight` would see with that rig.
    """
    from relume.gbuffer import GBuffer, main_file

    rig = load_rig(rig_path, settings, channels, part, view)
    name = main_file(source, rig)
    frame = _some_frame(name) if frame is None else frame
    gbuffer = GBuffer.read(source, rig=rig, frame=frame)
    if as_json:
        click.echo(json.dumps(understood(gbuffer), indent=2, ensure_ascii=False))
    else:
        _show(gbuffer)


def _some_frame(name: str) -> int | None:
    """The first frame on disk of a sequence; None for a single file."""
    from pathlib import Path

    from relume.frames import find_frames, is_pattern

    if not is_pattern(name) or Path(name).exists():
        return None
    frames = find_frames(name)
    if not frames:
        raise click.ClickException(f"{name}: no such files")
    return frames[0]


def field_of_view(gbuffer: GBuffer, camera: Camera) -> float | None:
    """Horizontal field of view of the display window, degrees; None for an orthographic camera."""
    if camera.projection != "perspective":
        return None
    x, _, width, _ = gbuffer.display_window
    left, right = (edge * camera.x_scale + camera.x_offset for edge in (x, x + width))
    return math.degrees(math.atan(right) - math.atan(left))


def understood(gbuffer: GBuffer) -> dict[str, Any]:
    """Everything as plain data: the layout of ``relume inspect --json``."""
    camera = gbuffer.camera
    return {
        "producer": gbuffer.producer,
        "working_space": gbuffer.working_space,
        "data_window": list(gbuffer.data_window),
        "display_window": list(gbuffer.display_window),
        "pixel_aspect": gbuffer.pixel_aspect,
        "channels": [
            {
                "name": info.name,
                "components": info.components,
                "sources": info.sources,
                "file": info.file,
                "part": info.part,
                "interpretation": info.interpretation,
                "reason": info.reason,
            }
            for info in gbuffer.channels
        ],
        "camera": None
        if camera is None
        else {
            "projection": camera.projection,
            "matrix": camera.matrix.tolist(),
            "position": list(camera.position),
            "forward": list(camera.forward),
            "fov": field_of_view(gbuffer, camera),
            "reason": gbuffer.camera_reason,
            "error_pixels": gbuffer.camera_error,
        },
        "notes": gbuffer.notes,
        "cryptomatte": gbuffer.cryptomatte,
    }


def _window(window: tuple[int, int, int, int]) -> str:
    x, y, width, height = window
    return f"{width} × {height}" + (f" at ({x}, {y})" if x or y else "")


def _sources(names: list[str]) -> str:
    """ViewLayer.Normal.XYZ for three channels of one layer."""
    stems = {name.rpartition(".")[0] for name in names}
    if len(names) > 1 and len(stems) == 1:
        stem = stems.pop()
        return f"{stem}{'.' if stem else ''}{''.join(name.rpartition('.')[2] for name in names)}"
    return ", ".join(names)


def _show(gbuffer: GBuffer) -> None:
    from rich.markup import escape
    from rich.table import Table

    from relume.cli.report import console

    out = console()
    windows = _window(gbuffer.data_window)
    if gbuffer.display_window != gbuffer.data_window:
        windows += f" of a picture of {_window(gbuffer.display_window)}"
    aspect = f", pixel aspect {gbuffer.pixel_aspect:g}" if gbuffer.pixel_aspect != 1 else ""
    out.print(f"written by {gbuffer.producer}, {windows}{aspect}, working space {gbuffer.working_space}", markup=False)

    table = Table(box=None, pad_edge=False, header_style="bold")
    for title in ("channel", "from", "taken as", "because"):
        table.add_column(title, overflow="fold")
    main = gbuffer.channels[0].file if gbuffer.channels else ""
    for info in gbuffer.channels:
        place = _sources(info.sources) + (f" of {info.file}" if info.file and info.file != main else "")
        table.add_row(*(escape(text) for text in (info.name, place, info.interpretation, info.reason)))
    out.print(table)

    camera = gbuffer.camera
    if camera is None:
        out.print("camera: none", markup=False)
    else:
        position = ", ".join(f"{value:.4g}" for value in camera.position)
        forward = ", ".join(f"{value:.3f}" for value in camera.forward)
        fov = field_of_view(gbuffer, camera)
        lens = f"{fov:.2f}° wide" if fov is not None else "orthographic"
        out.print(f"camera: at ({position}), looks along ({forward}), {lens}; {gbuffer.camera_reason}", markup=False)
    for layer, names in gbuffer.cryptomatte.items():
        shown = ", ".join(names[:12]) + (f", … ({len(names)} names)" if len(names) > 12 else "")
        out.print(f"cryptomatte {layer}: {shown or 'no manifest'}", markup=False)
    for note in gbuffer.notes:
        out.print(f"note: {note}", markup=False)
