# SPDX-License-Identifier: Apache-2.0
"""What there is to compare with: our own scenes in tests/data, and the larger shared ones where they are present."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
OWN = ROOT / "tests" / "data"


def shared_data() -> Path:
    """Folder of the larger scenes: RELUME_TEST_DATA, by default beside the checkout. May not exist."""
    return Path(os.environ.get("RELUME_TEST_DATA", ROOT.parent / "shared" / "data")).resolve()


@dataclass(frozen=True)
class Material:
    name: str
    index: int  # the value of the material index pass
    kind: str  # "plain", or what is reported apart: "bump", "mirror", "gloss"
    lambert: bool  # a Diffuse BSDF in every variant


@dataclass(frozen=True)
class Scene:
    """A rendered scene. Keys of `gbuffers`: (camera, filter); of `images`: (camera, filter, light, variant)."""

    name: str
    generation: int  # of Blender's Principled BSDF: 3 or 5
    lights: dict[str, dict[str, Any]]
    materials: tuple[Material, ...]
    eyes: dict[str, list[float]]
    gbuffers: dict[tuple[str, str], Path]
    images: dict[tuple[str, str, str, str], Path] = field(repr=False)
    emits: bool = False  # some material does, and its images hold it

    @property
    def lambert_ids(self) -> tuple[int, ...]:
        return tuple(material.index for material in self.materials if material.lambert)

    @property
    def bump_ids(self) -> tuple[int, ...]:
        return tuple(material.index for material in self.materials if material.kind == "bump")

    def lights_of(self, camera: str, kind: str, variant: str) -> list[str]:
        """Lights that have an image of their own, in the scene's order."""
        return [light for light in self.lights if (camera, kind, light, variant) in self.images]


def _material(name: str, facts: dict[str, Any]) -> Material:
    kind = "plain"
    if "bump" in facts:
        kind = "bump"
    elif facts["roughness"] == 0:
        kind = "mirror"
    elif name == "gloss_black":  # a cone whose smooth normals Cycles bends; see docs/truth.md
        kind = "gloss"
    return Material(name, facts["pass_index"], kind, facts.get("bsdf", "").startswith("diffuse"))


def _eye(camera: dict[str, Any]) -> list[float]:
    return [row[3] for row in camera["matrix_world"][:3]]


def _own(path: Path) -> Scene:
    facts = json.loads(path.read_text(encoding="utf-8"))
    return Scene(
        name=facts["scene"],
        generation=facts["generation"],
        lights=facts["lights"],
        materials=tuple(_material(name, values) for name, values in facts["materials"].items()),
        eyes={name: _eye(camera) for name, camera in facts["cameras"].items()},
        gbuffers={(each["camera"], each["filter"]): path.parent / each["file"] for each in facts["gbuffers"]},
        images={
            (each["camera"], each["filter"], each["light"], each["variant"]): path.parent / each["file"]
            for each in facts["images"]
        },
    )


def _shared(path: Path, generation: int) -> Scene:
    facts = json.loads(path.read_text(encoding="utf-8"))
    name = facts["scene"]
    lights = {light["name"]: light for light in facts["lights"] if light["type"] in ("SUN", "POINT", "SPOT")}
    images = {}
    for light in lights:
        for kind, tail in (("point", ""), ("aa", "_aa")):
            for variant, end in (("principled", ""), ("lambertggx", "_lambertggx"), ("multiggx", "_multiggx")):
                file = path.parent / f"{name}_gt_{light}_noshadow{tail}{end}.exr"
                if file.exists():
                    images["main", kind, light, variant] = file
    return Scene(
        name=name,
        generation=generation,
        lights=lights,
        materials=tuple(_material(each["name"], each) for each in facts["materials"]),
        eyes={"main": _eye(facts["camera"])},
        gbuffers={("main", kind): path.parent / f"{name}_gbuf_{kind}.exr" for kind in ("point", "aa")},
        images=images,
        emits=any("emission" in each for each in facts["materials"]),
    )


def own_scenes() -> list[Scene]:
    return [_own(OWN / "blender3" / "orrery.json"), _own(OWN / "blender5" / "atelier.json")]


def shared_scenes() -> list[Scene]:
    """Empty where the shared data is not there."""
    known = (("blender/suzanne.json", 3), ("blender5/materials5.json", 5))
    return [_shared(shared_data() / name, generation) for name, generation in known if (shared_data() / name).exists()]
