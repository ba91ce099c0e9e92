# SPDX-License-Identifier: Apache-2.0
"""``./dev test``: every way in which a change can be wrong, the quick ones first, and one closing line."""

from __future__ import annotations

import functools
import json
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree

from house import blender, build, fuzz, package, processor
from house.checkout import BUILD, PYTHON, ROOT, StepError, say

_SANITIZER_ENVIRONMENT = {
    "ASAN_OPTIONS": "detect_stack_use_after_return=1:strict_string_checks=1:allocator_may_return_null=1",
    "UBSAN_OPTIONS": "print_stacktrace=1:halt_on_error=1",
    "TSAN_OPTIONS": "halt_on_error=1:second_deadlock_stack=1",
}


#: The node in a host of our own.
_OFX_TESTS = "plugins/relume_ofx_tests"

#: Of each fuzz target, within ./dev test.
_FUZZ_SECONDS = 15
#: A test that fails should fail because of a change; `./dev fuzz` takes other numbers each time.
_FUZZ_SEED = 1


@dataclass
class Tally:
    """Tests counted so far, and what failed."""

    passed: int = 0
    skipped: int = 0
    failures: list[str] = field(default_factory=list)


def _gtest(tally: Tally, preset: str, isa: str | None = None, tests: str = "cpp/relume_tests") -> None:
    """Run C++ tests of a preset, for one instruction set where one is named."""
    kind = "C++ tests" if tests == "cpp/relume_tests" else f"tests of {tests.rpartition('/')[2]}"
    title = f"{kind}, {preset}" + (f", {isa}" if isa else "")
    program = BUILD / preset / "tests" / tests
    report = BUILD / preset / f"{program.name}-{isa or 'default'}.json"
    report.unlink(missing_ok=True)
    environment = build.python_environment() | _SANITIZER_ENVIRONMENT
    if isa:
        environment["RELUME_ISA"] = isa
    say(title)
    if not program.exists():
        tally.failures.append(f"{title}: there are none")
        return
    status = subprocess.run(
        [program, "--gtest_brief=1", f"--gtest_output=json:{report}"], cwd=ROOT, env=environment, check=False
    ).returncode
    failed = []
    if report.exists():
        cases = [case for suite in json.loads(report.read_text())["testsuites"] for case in suite["testsuite"]]
        failed = [case for case in cases if case.get("failures")]
        skipped = sum(case["result"] == "SKIPPED" for case in cases)
        tally.skipped += skipped
        tally.passed += len(cases) - len(failed) - skipped
        tally.failures += [f"{title}: {case['classname']}.{case['name']}" for case in failed]
    if status != 0 and not failed:
        tally.failures.append(f"{title}: ended with exit code {status}")


def _count(tally: Tally, title: str, report: Path, status: int) -> None:
    """Count what pytest's report says; a run without a report, or that ended badly for no test's sake, has failed."""
    failed = []
    if report.exists():
        for case in ElementTree.parse(report).getroot().iter("testcase"):
            if case.find("failure") is not None or case.find("error") is not None:
                failed.append(f"{case.get('classname')}::{case.get('name')}")
            elif case.find("skipped") is not None:
                tally.skipped += 1
            else:
                tally.passed += 1
        tally.failures += [f"{title}: {name}" for name in failed]
    if status != 0 and not failed:
        tally.failures.append(f"{title}: pytest ended with exit code {status}")


def _pytest(tally: Tally, arguments: list[str]) -> None:
    report = BUILD / "release" / "pytest.xml"
    report.unlink(missing_ok=True)
    say("Python tests")
    status = subprocess.run(
        [PYTHON, "-m", "pytest", "-q", f"--junitxml={report}", "--ignore=tests/plugins/blender", *arguments],
        cwd=ROOT,
        env=build.python_environment(),
        check=False,
    ).returncode
    _count(tally, "Python tests", report, status)


def _blender(tally: Tally) -> None:
    """Build the extension, and run its tests in each Blender."""
    try:
        archive = blender.build_extension()
        for run in blender.test_runs(archive):
            say(run.title)
            status = subprocess.run(run.command, cwd=ROOT, env=run.environment, check=False).returncode
            _count(tally, run.title, run.report, status)
    except StepError as failure:
        tally.failures.append(f"the Blender extension: {failure}")


def _step(tally: Tally, title: str, action: Callable[[], object]) -> bool:
    """Run something that either works or raises; counts as one test."""
    say(title)
    start = time.monotonic()
    try:
        action()
    except StepError as failure:
        tally.failures.append(f"{title}: {failure}")
        return False
    tally.passed += 1
    say(f"{title}: {time.monotonic() - start:.0f} s")
    return True


def test(arguments: list[str]) -> int:
    """Build everything and run every test: test [quick] [--blender] [PYTEST-ARGS...]; quick leaves the other builds
    out, --blender adds the extension's tests in Blender 5.0 and 4.5, which it fetches once (740 MB)"""
    start = time.monotonic()
    quick = arguments[:1] == ["quick"]
    with_blender = "--blender" in arguments
    arguments = [word for word in arguments[quick:] if word != "--blender"]
    tally = Tally()
    build.build("release")
    for isa in processor.instruction_sets():
        _gtest(tally, "release", isa)
    _gtest(tally, "release", tests=_OFX_TESTS)
    _pytest(tally, arguments)
    if not quick:
        for preset in ("asan-ubsan", "tsan", "clang"):
            if _step(tally, f"build without warnings, {preset}", functools.partial(build.build, preset)):
                _gtest(tally, preset)
                _gtest(tally, preset, tests=_OFX_TESTS)
        _step(tally, "damaged files and rigs under libFuzzer", functools.partial(fuzz.run, _FUZZ_SECONDS, _FUZZ_SEED))
        _step(tally, "a program outside the tree, by find_package", package.out_of_tree)
        _step(tally, "the wheel, in a clean environment", package.wheel)
    if with_blender:
        _blender(tally)
    for failure in tally.failures:
        print(f"FAILED {failure}", file=sys.stderr)
    say(f"all of it took {time.monotonic() - start:.0f} s")
    skipped = f", {tally.skipped} skipped" if tally.skipped else ""
    print(f"relume: {tally.passed} passed, {len(tally.failures)} failed{skipped}", flush=True)
    return 1 if tally.failures else 0
