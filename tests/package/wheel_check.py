# SPDX-License-Identifier: Apache-2.0
"""Runs in the clean environment into which the wheel was installed, beside PyPI's OpenEXR and OpenImageIO.

All three are in this one process and each carries an OpenEXR of its own, so this crashes where symbols leak. Relume is
imported between the other two: whichever library was loaded earlier would win.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np

import OpenEXR  # isort: skip
import relume  # isort: skip
import OpenImageIO as oiio  # noqa: N813  # isort: skip


def beauty_by_openexr(path: Path) -> np.ndarray:
    """Pixels (H, W, 4) of the first RGBA layer, by PyPI's OpenEXR."""
    with OpenEXR.File(str(path)) as file:
        channels = file.channels()
        name = next(name for name in channels if name in ("RGBA", "RGB") or name.endswith(("RGBA", "Combined")))
        return np.asarray(channels[name].pixels, dtype=np.float32)


def beauty_by_oiio(path: Path) -> np.ndarray:
    """The same pixels by PyPI's OpenImageIO."""
    buffer = oiio.ImageBuf(str(path))
    assert not buffer.has_error, buffer.geterror()
    return np.asarray(buffer.get_pixels(oiio.FLOAT), dtype=np.float32)[..., :4]


def main() -> None:
    """Relight a built-in scene in memory, to a file and by the command line, and read it back by all three."""
    inside = Path(relume.__file__).resolve()
    assert "site-packages" in inside.parts, f"relume is imported from {inside}, not from the wheel"

    scene, relit = Path("scene.exr"), Path("relit.exr")
    relume.write_scene("sdf", scene, width=160, height=90)
    rig = relume.Rig.builtin("sdf")
    result = relume.relight(relume.GBuffer.read(scene, rig=rig), rig)["beauty"]
    assert result.shape == (90, 160, 4)
    assert np.isfinite(result).all()
    assert 0.05 < float(result[..., :3].mean()) < 5

    relume.relight_file(scene, rig, relit)
    for beauty in (beauty_by_openexr(relit), beauty_by_oiio(relit)):
        np.testing.assert_allclose(beauty, result, rtol=1e-3, atol=1e-4)  # half floats in the file

    program = Path(sys.executable).with_name("relume")
    subprocess.run(
        [program, "relight", scene, "--rig", "sdf", "-o", "again.exr"], check=True, stdout=subprocess.DEVNULL
    )
    assert np.array_equal(beauty_by_oiio(Path("again.exr")), beauty_by_oiio(relit))
    subprocess.run([program, "doctor"], check=True)


main()
