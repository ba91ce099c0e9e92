# SPDX-License-Identifier: Apache-2.0
"""``./dev truth``: relights every truth scene with the command line, compares with the renderer, writes docs/truth.md.

    ./dev truth [NAME-PART...]      only comparisons whose name holds one of the parts; the page is then left alone
    ./dev truth --own               the scenes in tests/data alone

Rigs, relit EXRs and difference pictures go to build/truth; a few pictures to docs/images/truth. Exit code 1 when a bar
is missed.
"""

from __future__ import annotations

import argparse
import sys

from cases import Result, cases, run
from pictures import picture, write_png
from report import generated, insert, passed
from truth_scenes import ROOT, own_scenes, shared_data, shared_scenes

OUTPUT = ROOT / "build" / "truth"
PAGE = ROOT / "docs" / "truth.md"

# Comparisons whose picture stands in the manual.
SHOWN = {
    "orrery-main-point-sun+point+spot-principled-blender_principled": "orrery (Blender 3.4), Principled, three lights",
    "orrery-shift-point-spot-lambertggx-cook_torrance": "orrery through a shifted lens, Lambert + GGX, spot light",
    "atelier-main-point-sun+point+spot-lambertggx-cook_torrance": "atelier (Blender 5.0), Lambert + GGX, three lights",
    "orrery-main-point-sun-principled-principled": "orrery, the same image relit with Disney's `principled`, sun",
}


def _line(result: Result) -> str:
    plain, edges = result.renderer.plain, result.edges
    if edges is not None:
        figures = f"edge median {edges.median:.4f}, {edges.fireflies} fireflies, {edges.fringes} fringes"
    elif plain is not None:
        figures = f"median {plain.median:.1e}, p99 {plain.p99:.1e} over {plain.count} pixels"
    else:
        figures = "no pixels to compare"
    double = f"; to double precision p99 {result.double.p99:.1e}" if result.double else ""
    verdict = "reported" if not result.case.exact else "ok" if passed(result) else "FAILED"
    return f"{verdict:8} {result.case.name}: {figures}{double}"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", help="only comparisons whose name holds one of these")
    parser.add_argument("--own", action="store_true", help="only the scenes in tests/data")
    arguments = parser.parse_args()
    shared = [] if arguments.own else shared_scenes()
    if not arguments.own and len(shared) < 2:
        print(
            f"truth: the larger scenes are not in {shared_data()} (RELUME_TEST_DATA); comparing with tests/data alone"
        )
    OUTPUT.mkdir(parents=True, exist_ok=True)
    results = []
    for scene in [*own_scenes(), *shared]:
        for case in cases(scene):
            if arguments.parts and not any(part in case.name for part in arguments.parts):
                continue
            result = run(case, OUTPUT)
            write_png(OUTPUT / f"{case.name}.png", picture(result))
            results.append(result)
            print(_line(result), flush=True)
    if not arguments.parts and len(shared) == 2:
        pictures = []
        for result in results:
            if result.case.name in SHOWN:
                name = f"images/truth/{result.case.name.replace('+', '-')}.png"
                write_png(PAGE.parent / name, picture(result))
                pictures.append((name, SHOWN[result.case.name]))
        insert(PAGE, generated(results, pictures))
        print(f"truth: wrote {PAGE.relative_to(ROOT)}")
    failures = [result for result in results if not passed(result)]
    print(f"truth: {len(results)} comparisons, {len(failures)} beyond the bars")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
