# SPDX-License-Identifier: Apache-2.0
"""``relume png``: any layer of an EXR as a PNG to look at."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relume.layers import Kind


@click.command("png")
@click.argument("path", metavar="FILE")
@click.option("-o", "--output", metavar="FILE", help="The PNG to write; FILE.png or FILE.LAYER.png when absent.")
@click.option("--layer", metavar="NAME", help="diffuse, light:key, Normal, …; the beauty when absent.")
@click.option("--list", "only_list", is_flag=True, help="List the layers and stop.")
@click.option(
    "--as",
    "kind",
    type=click.Choice(["color", "normal", "position", "depth", "id", "value"]),
    help="What the numbers are, where the names say it wrongly.",
)
@click.option("--exposure", type=float, default=0.0, metavar="STOPS", help="For colours.")
@click.option(
    "--tone",
    type=click.Choice(["none", "reinhard", "aces"]),
    default="none",
    show_default=True,
    help="Tone curve for colours.",
)
@click.option("--gamma", type=click.Choice(["srgb", "2.2"]), default="srgb", show_default=True, help="Code of the PNG.")
@click.option("--ocio-display", metavar="NAME", help="Show colours through OpenColorIO instead, on this display.")
@click.option("--ocio-view", metavar="NAME", help="View of that display; its default when absent.")
@click.option("--ocio-config", metavar="FILE", help="An OpenColorIO config; $OCIO or the built-in one when absent.")
@click.option("--space", metavar="NAME", help="Colour space of the file, where its header does not say: lin_ap1, ….")
@click.option("--alpha", is_flag=True, help="Keep alpha (straight) instead of showing the picture over black.")
@click.option("--bits", type=click.Choice(["8", "16"]), default="8", show_default=True, help="Per channel.")
def command(
    path: str,
    output: str | None,
    layer: str | None,
    only_list: bool,
    kind: Kind | None,
    exposure: float,
    tone: str,
    gamma: str,
    ocio_display: str | None,
    ocio_view: str | None,
    ocio_config: str | None,
    space: str | None,
    alpha: bool,
    bits: str,
) -> None:
    """Turn a layer of the EXR FILE into a PNG.

    Colours get the exposure, the tone curve and the sRGB code; the EXR is left as it is. Normals, positions, depths
    and IDs are shown so that something can be seen.
    """
    from relume import _relume
    from relume.display import Display, quantized
    from relume.frames import find_frames, is_pattern, resolve_frame
    from relume.layers import find_layer, layers_of, pixels_of, space_of
    from relume.png import write_png

    if output is not None and Path(output).suffix.lower() != ".png":
        raise click.UsageError(f"{output}: png writes PNG; give a name that ends in .png")
    if is_pattern(path) and not Path(path).exists():
        frames = find_frames(path)
        one = f", as {resolve_frame(path, frames[0])}" if frames else ""
        raise click.UsageError(f"{path}: png takes one frame{one}")
    file = _relume.ExrFile(Path(path))
    if only_list:
        for entry in layers_of(file):
            click.echo(f"{entry.title}  ({entry.kind}: {', '.join(entry.channels)})")
        return
    chosen = find_layer(file, layer)
    display = Display(
        exposure=exposure,
        tone=tone,
        gamma=gamma,
        ocio_display=ocio_display,
        ocio_view=ocio_view,
        ocio_config=ocio_config,
        space=space or space_of(file, chosen.part),
    )
    picture = picture_of(pixels_of(file, chosen), kind or chosen.kind, display, alpha)
    target = Path(output) if output is not None else _beside(Path(path), layer)
    write_png(target, quantized(picture, int(bits)))
    click.echo(f"{target} written", err=True)


def _beside(path: Path, layer: str | None) -> Path:
    word = re.sub(r"[^\w.-]+", "-", layer) if layer else ""
    return path.with_suffix(f".{word}.png" if word else ".png")


def picture_of(pixels: NDArray[Any], kind: Kind, display: Any, alpha: bool = False) -> NDArray[Any]:
    """What is seen of a layer, display-coded 0…1, (H, W), (H, W, 3) or (H, W, 4)."""
    import numpy as np

    from relume.layers import viewable

    if kind != "color":
        return viewable(pixels, kind)
    color = np.asarray(pixels, np.float32)
    if color.shape[-1] < 3:
        color = np.repeat(color[..., :1], 3, axis=-1)
    if not alpha or color.shape[-1] < 4:
        return np.asarray(display(color[..., :3]))
    opacity = np.clip(np.nan_to_num(color[..., 3:4]), 0, 1)
    straight = np.divide(color[..., :3], opacity, out=np.zeros_like(color[..., :3]), where=opacity > 0)
    return np.concatenate([display(straight), opacity], axis=-1)
