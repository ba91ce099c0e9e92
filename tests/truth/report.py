# SPDX-License-Identifier: Apache-2.0
"""The generated part of docs/truth.md: tables of all comparisons."""

from __future__ import annotations

from itertools import groupby
from typing import TYPE_CHECKING

from measure import EDGE_BAR, MATERIAL_MEDIAN_BAR, MEDIAN_BAR, MIXED_LENGTH, P99_BAR

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

    from cases import Case, Result
    from measure import Errors

BEGIN, END = "<!-- begin: written by ./dev truth -->", "<!-- end: written by ./dev truth -->"


def _e(value: float) -> str:
    return f"{value:.1e}".replace("e-0", "e-").replace("e+0", "e+")


def _errors(errors: Errors | None) -> str:
    return "–" if errors is None else f"{_e(errors.median)} / {_e(errors.p90)} / {_e(errors.p99)}"


def _lights(case: Case) -> str:
    return " + ".join(case.lights)


def passed(result: Result) -> bool:
    """Whether the bars hold; models that are only reported always pass."""
    if not result.case.exact:
        return True
    if result.edges is not None:
        return result.edges.median <= EDGE_BAR and result.edges.fireflies == 0 and result.edges.fringes == 0
    if result.case.every_material and result.renderer.beyond_bars():
        return False
    return result.renderer.plain is not None and result.renderer.plain.within_bars()


def _exact_table(results: Sequence[Result]) -> Iterable[str]:
    yield "| scene, camera | lights | images | shader | pixels | relume | double precision | relume and double | |"
    yield "| --- | --- | --- | --- | --- | --- | --- | --- | --- |"
    for result in results:
        case, plain = result.case, result.renderer.plain
        floor = _errors(result.floor.plain) if result.floor else "–"
        double = "–" if result.double is None else f"{_e(result.double.median)} / {_e(result.double.p99)}"
        verdict = "✓" if passed(result) else "**✗**"
        yield (
            f"| {case.scene.name}, {case.camera} | {_lights(case)} | {case.variant} | `{case.model}` "
            f"| {plain.count if plain else 0} | {_errors(plain)} | {floor} | {double} | {verdict} |"
        )


def _other_table(results: Sequence[Result]) -> Iterable[str]:
    yield "| scene, camera | lights | shader | pixels | relume |"
    yield "| --- | --- | --- | --- | --- |"
    for result in results:
        case, plain = result.case, result.renderer.plain
        yield (
            f"| {case.scene.name}, {case.camera} | {_lights(case)} | `{case.model}` | {plain.count if plain else 0} "
            f"| {_errors(plain)} |"
        )


def _apart_table(results: Sequence[Result]) -> Iterable[str]:
    yield "| scene, camera | lights | images | material | pixels | relume | double precision |"
    yield "| --- | --- | --- | --- | --- | --- | --- |"
    for result in results:
        case = result.case
        for material in case.scene.materials:
            errors = result.renderer.by_material.get(material.name)
            if material.kind == "plain" or errors is None:
                continue
            floor = result.floor.by_material.get(material.name) if result.floor else None
            yield (
                f"| {case.scene.name}, {case.camera} | {_lights(case)} | {case.variant} "
                f"| `{material.name}` ({material.kind}) | {errors.count} | {_errors(errors)} | {_errors(floor)} |"
            )


def _material_table(results: Sequence[Result]) -> Iterable[str]:
    """One scene, camera, variant and model: materials down, lights across."""
    singles = [result for result in results if len(result.case.lights) == 1]
    yield "| material | " + " | ".join(_lights(result.case) for result in singles) + " |"
    yield "| --- |" + " --- |" * len(singles)
    for material in singles[0].case.scene.materials:
        row = [_errors(result.renderer.by_material.get(material.name)) for result in singles]
        if any(cell != "–" for cell in row):
            yield f"| `{material.name}` | " + " | ".join(row) + " |"


def _edge_table(results: Sequence[Result]) -> Iterable[str]:
    columns = "silhouettes | median | p99 | fireflies | fringes | inside: fireflies, worst | mixed"
    yield f"| scene | images | shader | {columns} | |"
    yield "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"
    for result in results:
        case, edges = result.case, result.edges
        if edges is not None:
            verdict = "✓" if passed(result) else "**✗**"
            yield (
                f"| {case.scene.name} | {case.variant} | `{case.model}` | {edges.count} "
                f"| {edges.median:.4f} | {edges.p99:.4f} | {edges.fireflies} | {edges.fringes} "
                f"| {edges.inner_fireflies}, {edges.worst:.2f} | {edges.mixed:.3f} | {verdict} |"
            )


def _group(result: Result) -> tuple[str, str, str, str]:
    case = result.case
    return case.scene.name, case.camera, case.variant, case.model


def generated(results: Sequence[Result], pictures: Sequence[tuple[str, str]]) -> str:
    """Markdown between the markers. `pictures`: (path relative to docs/, caption)."""
    interior = [result for result in results if result.edges is None]
    exact = [result for result in interior if result.case.exact]
    lines = [
        "Relative errors against the renderer's image: median / 90th / 99th percentile. The bars are "
        f"{MEDIAN_BAR:.0e} in the median and {P99_BAR:.0e} at the 99th percentile; ✓ says that a row keeps them. "
        f"For Blender 5's Principled ✓ says besides that each material keeps {MATERIAL_MEDIAN_BAR:.0e} "
        f"and {P99_BAR:.0e} on its own.",
        "",
        "### The renderer's own model",
        "",
        *_exact_table(exact),
        "",
        "### Reported apart",
        "",
        *_apart_table(exact),
        "",
        "### Antialiased G-buffers",
        "",
        "Absolute errors at silhouettes against the background, the worst of R, G, B, under the sun. "
        f"The bar is {EDGE_BAR} in the median, no firefly, no fringe. "
        "Inside are the borders of two objects and creases; *mixed* is the root mean square error where the normal is "
        f"shorter than {MIXED_LENGTH}.",
        "",
        *_edge_table(results),
        "",
        "### Other models on the same images",
        "",
        "For information: `principled` images relit with models that did not make them.",
        "",
        *_other_table([result for result in interior if not result.case.exact]),
        "",
        "### Material by material",
    ]
    for (scene, camera, variant, model), group in groupby(exact, key=_group):
        lines += ["", f"{scene}, camera {camera}, {variant}, `{model}`:", "", *_material_table(list(group))]
    if pictures:
        lines += [
            "",
            "### Pictures",
            "",
            "The renderer, relume, and the relative error: black none, blue a tenth of the bar,",
        ]
        lines += ["white the bar, red beyond it; pixels that are not interior are black.", ""]
        for path, caption in pictures:
            lines += [f"{caption}:", "", f"![{caption}]({path})", ""]
    return "\n".join(lines).rstrip() + "\n"


def insert(page: Path, text: str) -> None:
    """Replace what stands between the markers of a page."""
    old = page.read_text(encoding="utf-8")
    if BEGIN not in old or END not in old:
        raise ValueError(f"{page}: the markers '{BEGIN}' and '{END}' are missing")
    head, rest = old.split(BEGIN, 1)
    tail = rest.split(END, 1)[1]
    page.write_text(f"{head}{BEGIN}\n{text}{END}{tail}", encoding="utf-8")
