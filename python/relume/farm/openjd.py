# SPDX-License-Identifier: Apache-2.0
"""A sequence as a job template of Open Job Description (version 2023-09), which farms and the openjd CLI run."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Any

from relume.errors import ArgumentError

__all__ = ["job_template"]

#: Open Job Description allows as many values of a task parameter.
MOST_CHUNKS = 1024


def chunks(frames: Sequence[int], size: int) -> list[str]:
    """Ranges of at most ``size`` frames each, as --frames takes them: "1001-1010", "1011-1019x2", "1020,1023"."""
    ordered = sorted(set(frames))
    return [_range(ordered[k : k + size]) for k in range(0, len(ordered), size)]


def _range(numbers: list[int]) -> str:
    steps = {b - a for a, b in itertools.pairwise(numbers)}
    if len(numbers) == 1:
        return str(numbers[0])
    if len(steps) == 1:
        step = steps.pop()
        return f"{numbers[0]}-{numbers[-1]}" + (f"x{step}" if step > 1 else "")
    return ",".join(map(str, numbers))


def job_template(
    source: str, rig: str, output: str, frames: Sequence[int], chunk: int = 10, extra: Sequence[str] = ()
) -> dict[str, Any]:
    """The template, as data for JSON or YAML.

    Args:
        source: pattern of the G-buffers, absolute.
        rig: the rig file, or the name of a built-in one.
        output: pattern of the pictures, absolute.
        frames: their numbers.
        chunk: frames of one task at the most.
        extra: further words of `relume relight`, for every task.

    Raises:
        ArgumentError: no frames, or so many that there would be more than 1024 chunks.
    """
    if chunk < 1:
        raise ArgumentError(f"chunk is {chunk}; give 1 or more frames")
    values = chunks(frames, chunk)
    if not values:
        raise ArgumentError("no frames to make a job of")
    if len(values) > MOST_CHUNKS:
        least = -(-len(set(frames)) // MOST_CHUNKS)
        raise ArgumentError(
            f"{len(values)} chunks of {chunk} frames; Open Job Description allows {MOST_CHUNKS}: "
            f"take chunks of {least} or more"
        )
    words = ["relight", "{{Param.GBuffer}}", "--rig", "{{Param.Rig}}", "-o", "{{Param.Output}}"]
    words += ["--frames", "{{Task.Param.Frames}}", "--skip-existing", "--json", *extra]
    return {
        "specificationVersion": "jobtemplate-2023-09",
        "name": "relume {{Param.JobName}}",
        "parameterDefinitions": [
            {"name": "JobName", "type": "STRING", "default": _job_name(output)},
            {"name": "GBuffer", "type": "STRING", "default": source, "description": "The G-buffers: a pattern"},
            {"name": "Rig", "type": "STRING", "default": rig, "description": "A rig file, or a built-in rig"},
            {"name": "Output", "type": "STRING", "default": output, "description": "The pictures: a pattern"},
            {"name": "Relume", "type": "STRING", "default": "relume", "description": "The program on the workers"},
        ],
        "steps": [
            {
                "name": "Relight",
                "parameterSpace": {"taskParameterDefinitions": [{"name": "Frames", "type": "STRING", "range": values}]},
                "script": {"actions": {"onRun": {"command": "{{Param.Relume}}", "args": words}}},
            }
        ],
    }


def _job_name(output: str) -> str:
    name = output.rsplit("/", 1)[-1]
    return name[:100] if name else "relight"
