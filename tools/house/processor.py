# SPDX-License-Identifier: Apache-2.0
"""Which of our instruction sets this machine can run."""

from __future__ import annotations

import platform
from pathlib import Path

# The levels of the x86-64 psABI, by the flags of /proc/cpuinfo that our kernels of that level use.
_LEVELS = {
    "x86-64-v2": {"sse4_1", "sse4_2", "ssse3", "popcnt"},
    "x86-64-v3": {"avx2", "fma", "bmi1", "bmi2", "f16c"},
    "x86-64-v4": {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"},
}


def instruction_sets() -> list[str]:
    """Values of RELUME_ISA that run here, the best first and the scalar reference last."""
    if platform.machine() == "aarch64":
        return ["neon", "scalar"]
    flags: set[str] = set()
    for line in Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("flags"):
            flags = set(line.split(":", 1)[1].split())
            break
    usable = []
    for level, needed in _LEVELS.items():
        if not needed <= flags:
            break
        usable.append(level)
    return [*reversed(usable), "scalar"]
