# SPDX-License-Identifier: Apache-2.0
"""``./dev fuzz``: the reading path and the rig reader under libFuzzer and the sanitizers."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

from house import build
from house.checkout import ROOT, StepError, say

# Program, folders of seeds, the longest input, further options.
_WORDS = "-dict=tests/fuzz/words.dict"
_TARGETS = {
    "exr_fuzz": (["tests/data/exr"], 20_000, ["-malloc_limit_mb=300", _WORDS]),
    "gbuffer_fuzz": (["tests/data/exr"], 20_000, ["-malloc_limit_mb=300", _WORDS]),
    "rig_fuzz": (["examples/rigs"], 2_000, []),
}


def run(seconds: int, seed: int = 0) -> None:
    """Fuzz each target for that long. What is found stays in build/fuzz/corpus and is where the next run begins.

    Args:
        seconds: for each target.
        seed: of libFuzzer's random numbers; 0 is another one each time.

    Raises:
        StepError: an input crashed a target, or took more than 5 s or 300 MB; the message names its file.
    """
    directory = build.build("fuzz", *_TARGETS)
    for name, (seeds, longest, options) in _TARGETS.items():
        corpus, found = directory / "corpus" / name, directory / "found" / name
        shutil.rmtree(found, ignore_errors=True)
        for folder in (corpus, found):
            folder.mkdir(parents=True, exist_ok=True)
        say(f"{name}, {seconds} s")
        command: list[str | Path] = [
            directory / "tests" / "fuzz" / name,
            f"-max_total_time={seconds}",
            f"-max_len={longest}",
            f"-seed={seed}",
            "-timeout=5",
        ]
        command += ["-rss_limit_mb=1000", "-print_final_stats=1", f"-artifact_prefix={found}/", *options]
        command += [corpus, *(ROOT / seed for seed in seeds)]
        environment = os.environ | {"ASAN_OPTIONS": "allocator_may_return_null=1"}
        done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            inputs = sorted(str(path.relative_to(ROOT)) for path in found.iterdir())
            raise StepError(f"{name}: {', '.join(inputs) or 'failed'}\n{done.stderr[-4000:]}")
        stats = dict(line[6:].split(":", 1) for line in done.stderr.splitlines() if line.startswith("stat::"))
        say(f"{name}: {stats.get('number_of_executed_units', '?').strip()} inputs, nothing found")


def fuzz(arguments: list[str]) -> int:
    """Feed damaged files and rigs to the readers, looking for crashes: fuzz [--seconds N]"""
    if arguments[:1] == ["--seconds"] and len(arguments) == 2 and arguments[1].isdigit():
        run(int(arguments[1]))
    elif not arguments:
        run(60)
    else:
        raise StepError("fuzz takes --seconds N alone")
    return 0
