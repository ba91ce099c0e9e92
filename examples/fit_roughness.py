# SPDX-License-Identifier: Apache-2.0
"""Fitting with shaders on arrays: the roughness of a measured highlight, by golden-section search in double precision.

python examples/fit_roughness.py
"""

import numpy as np
import relume

ggx = relume.shaders["ggx"]
angle = np.linspace(0.0, 1.4, 200)
light = np.stack([np.sin(angle), np.zeros_like(angle), np.cos(angle)], axis=-1)
view = np.array([-0.6, 0.0, 0.8])
up = np.array([0.0, 0.0, 1.0])


def highlight(roughness: float) -> np.ndarray:
    """The specular part over the angle of the light, 1/sr."""
    return ggx.evaluate(n=up, v=view, l=light, roughness=roughness).specular[:, 0]


rng = np.random.default_rng(7)
measured = highlight(0.37) * rng.normal(1.0, 0.02, angle.size)


def error(roughness: float) -> float:
    """Squared difference to what was measured."""
    return float(np.sum((highlight(roughness) - measured) ** 2))


low, high = 0.05, 1.0
golden = (5**0.5 - 1) / 2
while high - low > 1e-6:
    left, right = high - golden * (high - low), low + golden * (high - low)
    if error(left) < error(right):
        high = right
    else:
        low = left
print(f"roughness {low:.3f}; the measurement was made with 0.370 and 2 % of noise")
assert abs(low - 0.37) < 0.01
