# SPDX-License-Identifier: Apache-2.0
"""Light is additive: relight once with an AOV for each light, then mix exposures and colours by adding arrays.

    python examples/light_mixer.py

Checks that the mix is what relighting with those exposures gives.
"""

import numpy as np
import relume

relume.write_scene("sdf", "mixer.exr", width=320, height=180)
gbuffer = relume.GBuffer.read("mixer.exr")

rig = relume.Rig.builtin("sdf")
lights = list(rig.light)
rig.output.aovs = [f"light:{name}" for name in lights]
parts = relume.relight(gbuffer, rig)

stops = {"sun": -1.0, "sky": 1.0, "back": 2.0}
mixed = sum(2 ** stops[name] * parts[f"light:{name}"] for name in lights)

for name in lights:
    rig.light[name].exposure = stops[name]
relit = relume.relight(gbuffer, rig)
expected = sum(relit[f"light:{name}"] for name in lights)
print(f"largest difference {np.abs(mixed - expected).max():.1e} of {expected.max():.2f}")
assert np.allclose(mixed, expected, rtol=1e-5, atol=1e-6)
