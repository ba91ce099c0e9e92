# SPDX-License-Identifier: Apache-2.0
"""Relume's command line against Blender's own images, and against a double-precision evaluation of the same formulas.

The scenes in tests/data prove it for a clone alone; the larger shared ones join where they are present. `./dev truth`
prints the same figures for more models and writes docs/truth.md.
"""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "truth"))

from cases import Case, Result, cases, measure_reference, relight, run
from measure import EDGE_BAR, MEDIAN_BAR, P99_BAR, compare_edges
from rigs import committed, rig
from truth_scenes import Scene, own_scenes, shared_data, shared_scenes

# Single precision against double on the same G-buffer, relative to the brightest channel. At the rim of a spot's cone
# the light is a small difference of two cosines, whose rounding it shows.
DOUBLE_MEDIAN_BAR, DOUBLE_P99_BAR, DOUBLE_P99_BAR_SPOT = 1e-6, 1e-5, 2e-4


def _cases(scenes: list[Scene], filters: tuple[str, ...] = ("point", "aa")) -> list:
    found = [case for scene in scenes for case in cases(scene, exact_only=True) if case.kind in filters]
    return [pytest.param(case, id=case.name) for case in found]


def _check(result: Result) -> None:
    if result.edges is not None:
        assert result.edges.median <= EDGE_BAR, result.edges
        assert result.edges.fireflies == 0, result.edges
        assert result.edges.fringes == 0, result.edges
        return
    assert result.renderer.plain is not None, "no interior pixels were compared"
    assert result.renderer.plain.count > 4000, result.renderer.plain
    assert result.renderer.plain.median <= MEDIAN_BAR, result.renderer.plain
    assert result.renderer.plain.p99 <= P99_BAR, result.renderer.plain
    if result.case.every_material:
        assert not result.renderer.beyond_bars()
    assert result.double is not None
    assert result.double.median <= DOUBLE_MEDIAN_BAR, result.double
    assert result.double.p99 <= (DOUBLE_P99_BAR_SPOT if "spot" in result.case.lights else DOUBLE_P99_BAR), result.double


@pytest.mark.parametrize("case", _cases(own_scenes()))
def test_own_scenes(case: Case, tmp_path: Path) -> None:
    _check(run(case, tmp_path))


@pytest.mark.parametrize("case", _cases(own_scenes(), filters=("point",)))
def test_the_reference_itself_meets_the_renderer(case: Case) -> None:
    """The double-precision formulas, without relume: what is left is half floats and the renderer's sampling."""
    floor = measure_reference(case)
    assert floor.plain is not None
    assert floor.plain.median <= 4.5e-4
    assert floor.plain.p99 <= 2e-3


@pytest.mark.parametrize("scene", own_scenes(), ids=lambda scene: scene.name)
def test_the_rigs_in_the_repository_are_those_that_were_tested(scene: Scene) -> None:
    path, text = committed(scene)
    assert path.read_text(encoding="utf-8") == text


@pytest.mark.parametrize("case", _cases(own_scenes(), filters=("aa",)))
def test_averaged_normals_do_not_flash(case: Case, tmp_path: Path) -> None:
    """Against the same frame relit with every mean normal taken as a surface's own."""
    result = run(case, tmp_path)
    text = rig(case.scene, case.lights, case.model, case.variant) + '[gbuffer]\nnormal_variance = "off"\n'
    gbuffer = case.scene.gbuffers[case.camera, case.kind]
    off = compare_edges(relight(gbuffer, text, tmp_path, "off"), result.truth, result.surface)
    own = result.edges
    assert own is not None
    assert own.mixed < 0.6 * off.mixed, (own, off)
    assert own.inner_fireflies < 0.65 * off.inner_fireflies, (own, off)
    assert own.worst <= off.worst, (own, off)


SHARED = _cases(shared_scenes())


@pytest.mark.skipif(not SHARED, reason=f"the larger truth scenes are not in {shared_data()} (RELUME_TEST_DATA)")
@pytest.mark.parametrize("case", SHARED)
def test_shared_scenes(case: Case, tmp_path: Path) -> None:
    _check(run(case, tmp_path))
