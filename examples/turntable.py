# SPDX-License-Identifier: Apache-2.0
"""A key light that goes round a still picture: the G-buffer is read once, the rig changes from frame to frame.

    python examples/turntable.py [GBUFFER.exr] [FRAMES]

Without a G-buffer the built-in scene sdf is used. Writes turntable.0001.png, turntable.0002.png, ….
"""

import math
import sys

import relume

source = sys.argv[1] if len(sys.argv) > 1 else "turntable.exr"
frames = int(sys.argv[2]) if len(sys.argv) > 2 else 24
if len(sys.argv) < 2:
    relume.write_scene("sdf", source, width=480, height=270)

gbuffer = relume.GBuffer.read(source)
rig = relume.Rig.builtin("sdf")
key = rig.light["sun"]
display = relume.Display(tone="aces")

result = None
for frame in range(1, frames + 1):
    angle = 2 * math.pi * frame / frames
    key.direction = (math.cos(angle), -0.8, math.sin(angle))
    # Written into the arrays of the frame before: no memory is asked for again.
    result = relume.relight(gbuffer, rig, out=result)
    picture = display(result["beauty"][..., :3])
    relume.write_png(f"turntable.{frame:04d}.png", relume.quantized(picture))
    print(f"turntable.{frame:04d}.png  {1000 * result.report.seconds:.1f} ms")
