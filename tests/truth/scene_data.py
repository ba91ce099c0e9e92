# SPDX-License-Identifier: Apache-2.0
"""The truth scenes as plain data: no Blender in here, so that every Python can read what was built.

Lengths in metres, powers in watts, angles in degrees, colours scene-linear Rec.709, +Z up. A material value is a number
or a colour, or ("noise", scale, low, high) for a procedural texture in object coordinates.
"""

from __future__ import annotations

from typing import Any

Object = dict[str, Any]

_ORRERY_OBJECTS: list[Object] = [
    {"name": "Floor", "shape": "plane", "size": 16, "at": (0, 0, 0), "material": "terrazzo"},
    {
        "name": "Drape",
        "shape": "waves",
        "size": (9, 3),
        "at": (-2.6, 3.4, 1.25),
        "turn": (0, 0, 38),
        "material": "silk",
    },
    {"name": "Ball_clay", "shape": "sphere", "radius": 0.62, "at": (2.3, -2.1, 0.62), "material": "clay"},
    {"name": "Ball_porcelain", "shape": "sphere", "radius": 0.8, "at": (0.2, -0.5, 0.8), "material": "porcelain"},
    {
        "name": "Ring_rubber",
        "shape": "torus",
        "radius": (0.9, 0.3),
        "at": (0.2, -0.5, 2.05),
        "turn": (62, 18, 0),
        "material": "rubber",
    },
    {"name": "Ball_brass", "shape": "icosphere", "radius": 0.55, "at": (-1.9, -1.3, 0.55), "material": "brass"},
    {
        "name": "Block_steel",
        "shape": "cube",
        "size": 1.1,
        "at": (2.5, 0.6, 0.55),
        "turn": (0, 0, 25),
        "material": "steel",
    },
    {"name": "Ball_mirror", "shape": "sphere", "radius": 0.42, "at": (0.9, -2.5, 0.42), "material": "mirror"},
    {"name": "Ball_hammered", "shape": "sphere", "radius": 0.7, "at": (-2.6, 0.9, 0.7), "material": "hammered"},
    {
        "name": "Drum_patina",
        "shape": "cylinder",
        "radius": 0.55,
        "depth": 1.5,
        "at": (1.2, 2.1, 0.75),
        "turn": (0, 0, 0),
        "material": "patina",
    },
    {
        "name": "Cone_enamel",
        "shape": "cone",
        "radius": 0.6,
        "depth": 1.4,
        "at": (-0.5, -2.4, 0.7),
        "turn": (0, 0, 11),
        "material": "enamel",
    },
    {"name": "Ball_lacquer", "shape": "sphere", "radius": 0.45, "at": (2.6, 0.6, 1.55), "material": "lacquer"},
    {"name": "Ball_tin", "shape": "sphere", "radius": 0.4, "at": (2.9, -0.9, 0.4), "material": "tin"},
]

_ORRERY_MATERIALS: dict[str, dict[str, Any]] = {
    "terrazzo": {"albedo": ("noise", 2.3, (0.18, 0.16, 0.15), (0.72, 0.66, 0.6)), "roughness": 0.55},
    "silk": {"albedo": (0.42, 0.12, 0.28), "roughness": 0.65},
    "clay": {"bsdf": "diffuse", "albedo": (0.55, 0.3, 0.2), "roughness": 1.0, "specular": 0.0},
    "porcelain": {"albedo": (0.82, 0.84, 0.8), "roughness": 0.2},
    "rubber": {"albedo": (0.08, 0.3, 0.12), "roughness": 0.8, "specular": 0.3},
    "brass": {"albedo": (0.91, 0.78, 0.42), "roughness": 0.35, "metallic": 1.0},
    "steel": {"albedo": (0.6, 0.58, 0.55), "roughness": 0.55, "metallic": 1.0},
    "mirror": {"albedo": (0.95, 0.93, 0.88), "roughness": 0.0, "metallic": 1.0},
    "hammered": {
        "albedo": (0.2, 0.45, 0.6),
        "roughness": 0.45,
        "bump": {"scale": 5.0, "strength": 0.3, "distance": 0.05},
    },
    "patina": {"albedo": (0.8, 0.5, 0.3), "roughness": ("noise", 3.0, 0.2, 0.9), "metallic": ("noise", 1.7, 0.0, 1.0)},
    "enamel": {"albedo": (0.05, 0.12, 0.5), "roughness": 0.3, "specular": 0.8},
    "lacquer": {"albedo": (0.03, 0.02, 0.02), "roughness": 0.09},
    "tin": {"albedo": (0.85, 0.86, 0.88), "roughness": 0.22, "metallic": 1.0},
}

_ATELIER_OBJECTS: list[Object] = [
    {"name": "Table", "shape": "plane", "size": 14, "at": (0, 0, 0), "material": "slate"},
    {
        "name": "Canvas",
        "shape": "waves",
        "size": (8, 2.6),
        "at": (2.6, 3.2, 1.1),
        "turn": (0, 0, -32),
        "material": "linen",
    },
    {"name": "Ball_plaster", "shape": "sphere", "radius": 0.55, "at": (-2.2, -1.9, 0.55), "material": "plaster"},
    {"name": "Ball_glaze", "shape": "sphere", "radius": 0.75, "at": (-0.3, 0.2, 0.75), "material": "glaze"},
    {
        "name": "Knot_cork",
        "shape": "torus",
        "radius": (0.75, 0.28),
        "at": (-0.3, 0.2, 1.85),
        "turn": (70, -24, 0),
        "material": "cork",
    },
    {"name": "Ball_gilt", "shape": "icosphere", "radius": 0.6, "at": (1.7, -1.2, 0.6), "material": "gilt"},
    {
        "name": "Block_lead",
        "shape": "cube",
        "size": 1.0,
        "at": (-2.3, 0.9, 0.5),
        "turn": (0, 0, -33),
        "material": "lead",
    },
    {"name": "Ball_mercury", "shape": "sphere", "radius": 0.38, "at": (-0.9, -2.3, 0.38), "material": "mercury"},
    {"name": "Ball_orange", "shape": "sphere", "radius": 0.65, "at": (2.2, 1.0, 0.65), "material": "orange"},
    {
        "name": "Drum_rust",
        "shape": "cylinder",
        "radius": 0.5,
        "depth": 1.7,
        "at": (-1.1, 2.2, 0.85),
        "turn": (0, 0, 0),
        "material": "rust",
    },
    {
        "name": "Cone_jade",
        "shape": "cone",
        "radius": 0.55,
        "depth": 1.3,
        "at": (0.6, -2.2, 0.65),
        "turn": (0, 0, 7),
        "material": "jade",
    },
    {"name": "Ball_ink", "shape": "sphere", "radius": 0.42, "at": (-2.3, 0.9, 1.42), "material": "ink"},
    {"name": "Ball_varnish", "shape": "sphere", "radius": 0.45, "at": (0.4, -0.6, 0.45), "material": "varnish"},
    {"name": "Ball_felt", "shape": "sphere", "radius": 0.5, "at": (3.3, -0.7, 0.5), "material": "felt"},
]

_ATELIER_MATERIALS: dict[str, dict[str, Any]] = {
    "slate": {"albedo": ("noise", 2.9, (0.08, 0.09, 0.11), (0.5, 0.52, 0.5)), "roughness": 0.5},
    "linen": {"albedo": (0.6, 0.55, 0.42), "roughness": 0.7, "diffuse_roughness": 0.6},
    "plaster": {"bsdf": "diffuse", "albedo": (0.75, 0.72, 0.68), "roughness": 1.0, "specular_ior_level": 0.0},
    "glaze": {"albedo": (0.12, 0.4, 0.42), "roughness": 0.18, "ior": 1.45},
    "cork": {"albedo": (0.4, 0.22, 0.1), "roughness": 0.85, "specular_ior_level": 0.3},
    "gilt": {"albedo": (1.0, 0.76, 0.34), "roughness": 0.3, "metallic": 1.0, "specular_tint": (1.0, 0.92, 0.7)},
    "lead": {"albedo": (0.43, 0.44, 0.47), "roughness": 0.6, "metallic": 1.0},
    "mercury": {"albedo": (0.9, 0.9, 0.92), "roughness": 0.0, "metallic": 1.0},
    "orange": {
        "albedo": (0.85, 0.35, 0.05),
        "roughness": 0.42,
        "bump": {"scale": 6.0, "strength": 0.3, "distance": 0.05},
    },
    "rust": {
        "albedo": (0.55, 0.25, 0.12),
        "roughness": ("noise", 3.4, 0.25, 0.85),
        "metallic": ("noise", 2.1, 0.0, 1.0),
    },
    "jade": {"albedo": (0.15, 0.5, 0.25), "roughness": 0.33, "specular_ior_level": 0.8, "ior": 1.6},
    "ink": {"albedo": (0.02, 0.02, 0.04), "roughness": 0.09},
    "varnish": {
        "albedo": (0.5, 0.15, 0.06),
        "roughness": 0.45,
        "coat_weight": 0.8,
        "coat_roughness": 0.15,
        "coat_ior": 1.55,
        "coat_tint": (1.0, 0.85, 0.55),
    },
    "felt": {
        "albedo": (0.2, 0.05, 0.12),
        "roughness": 0.9,
        "sheen_weight": 0.9,
        "sheen_roughness": 0.45,
        "sheen_tint": (1.0, 0.8, 0.9),
    },
}

# Layers of Blender 5's Principled on and under each other, stored as 32 bit: what is left is relume's own error.
_VITRINE_MATERIALS: dict[str, dict[str, Any]] = {
    "coat_on_bump": {
        "albedo": (0.6, 0.3, 0.1),
        "coat_weight": 1.0,
        "coat_roughness": 0.3,
        "bump": {"scale": 3.0, "strength": 0.6, "distance": 0.05},
    },
    "coat_on_bumped_mix": {
        "albedo": (0.1, 0.3, 0.5),
        "roughness": 0.3,
        "metallic": 0.4,
        "coat_weight": 0.6,
        "coat_roughness": 0.25,
        "coat_tint": (0.9, 0.6, 0.4),
        "coat_ior": 1.7,
        "bump": {"scale": 3.0, "strength": 0.5, "distance": 0.05},
    },
    "sheen_on_bump": {
        "albedo": (0.2, 0.1, 0.1),
        "roughness": 0.7,
        "sheen_weight": 0.8,
        "sheen_roughness": 0.3,
        "sheen_tint": (1.0, 0.8, 0.6),
        "bump": {"scale": 3.0, "strength": 0.5, "distance": 0.05},
    },
    "all_on_bump": {
        "albedo": (0.4, 0.5, 0.2),
        "roughness": 0.45,
        "metallic": 0.3,
        "sheen_weight": 0.5,
        "sheen_roughness": 0.6,
        "coat_weight": 0.7,
        "coat_roughness": 0.35,
        "diffuse_roughness": 0.5,
        "specular_tint": (0.9, 0.8, 0.5),
        "specular_ior_level": 0.7,
        "bump": {"scale": 3.0, "strength": 0.4, "distance": 0.05},
    },
    "lamp_under_lacquer": {
        "albedo": (0.3, 0.3, 0.3),
        "roughness": 0.4,
        "coat_weight": 1.0,
        "coat_roughness": 0.3,
        "coat_tint": (0.8, 0.5, 0.3),
        "sheen_weight": 0.6,
        "emission": (0.5, 0.3, 0.2),
    },
    "polished": {"albedo": (0.9, 0.8, 0.7), "roughness": 0.02, "metallic": 1.0},
    "polished_coat": {"albedo": (0.2, 0.5, 0.7), "roughness": 0.6, "coat_weight": 1.0},
    "brighter_than_white": {"albedo": (1.4, 1.1, 0.7), "roughness": 0.4, "metallic": 0.6, "diffuse_roughness": 0.8},
    "dark_at_82": {"albedo": (0.5, 0.4, 0.3), "roughness": 0.35, "metallic": 1.0, "specular_tint": (0.0, 0.1, 0.2)},
    "tinted_diamond": {
        "albedo": (0.2, 0.3, 0.3),
        "roughness": 0.3,
        "ior": 2.2,
        "specular_ior_level": 1.0,
        "specular_tint": (0.3, 1.0, 0.6),
    },
    "low_ior": {"albedo": (0.2, 0.3, 0.3), "roughness": 0.35, "ior": 1.2, "specular_ior_level": 0.6},
    "brushed_under_coat": {
        "albedo": (0.3, 0.6, 0.3),
        "roughness": 0.4,
        "metallic": 0.5,
        "anisotropic": 1.0,
        "anisotropic_rotation": 0.3,
        "tangent": "radial",
        "coat_weight": 0.4,
        "coat_roughness": 0.2,
    },
}

_VITRINE_OBJECTS: list[Object] = [
    {
        "name": f"Ball_{name}",
        "shape": "sphere",
        "radius": 0.9,
        "at": ((index % 4 - 1.5) * 2.1, -1.5 + index // 4 * 2.2, 0.9),
        "material": name,
    }
    for index, name in enumerate(_VITRINE_MATERIALS)
]

# Blender's own defaults for what a material leaves out; the keys are the names of the AOVs.
DEFAULTS: dict[int, dict[str, Any]] = {
    3: {"metallic": 0.0, "roughness": 0.5, "specular": 0.5},
    5: {
        "metallic": 0.0,
        "roughness": 0.5,
        "ior": 1.5,
        "specular_ior_level": 0.5,
        "specular_tint": (1, 1, 1),
        "diffuse_roughness": 0.0,
        "coat_weight": 0.0,
        "coat_roughness": 0.03,
        "coat_ior": 1.5,
        "coat_tint": (1, 1, 1),
        "sheen_weight": 0.0,
        "sheen_roughness": 0.5,
        "sheen_tint": (1, 1, 1),
    },
}

SCENES: dict[str, dict[str, Any]] = {
    "orrery": {
        "generation": 3,
        "objects": _ORRERY_OBJECTS,
        "materials": _ORRERY_MATERIALS,
        "lights": {
            "sun": {"type": "SUN", "energy": 2.4, "color": (1.0, 0.94, 0.82), "to": (-0.62, 0.35, -0.7)},
            "point": {"type": "POINT", "energy": 420.0, "color": (0.7, 1.0, 0.75), "at": (3.4, -2.7, 2.6)},
            "spot": {
                "type": "SPOT",
                "energy": 1900.0,
                "color": (1.0, 0.72, 0.9),
                "at": (-1.2, -4.8, 4.1),
                "to": (0.32, 0.72, -0.56),
                "cone": 58.0,
                "blend": 0.45,
            },
        },
        "cameras": {
            "main": {"at": (6.1, -6.6, 3.7), "look": (0.1, 0.0, 1.0), "roll": 3.0, "lens": 41.0, "size": (288, 162)},
            # A view camera: lens shift both ways, and an anamorphic pixel.
            "shift": {
                "at": (-4.6, -6.2, 2.2),
                "look": (-0.1, -0.3, 1.9),
                "roll": 0.0,
                "lens": 41.0,
                "size": (200, 150),
                "shift": (0.11, -0.17),
                "pixel_aspect": 1.25,
            },
        },
    },
    "atelier": {
        "generation": 5,
        "objects": _ATELIER_OBJECTS,
        "materials": _ATELIER_MATERIALS,
        "lights": {
            "sun": {"type": "SUN", "energy": 2.1, "color": (0.86, 0.95, 1.0), "to": (0.55, 0.48, -0.68)},
            "point": {"type": "POINT", "energy": 360.0, "color": (1.0, 0.62, 0.45), "at": (-3.1, -2.2, 2.9)},
            "spot": {
                "type": "SPOT",
                "energy": 1500.0,
                "color": (0.75, 0.85, 1.0),
                "at": (1.9, -4.4, 3.6),
                "to": (-0.38, 0.74, -0.55),
                "cone": 64.0,
                "blend": 0.6,
            },
        },
        "cameras": {
            "main": {"at": (-5.9, -6.3, 3.4), "look": (0.0, 0.1, 0.95), "roll": -2.0, "lens": 44.0, "size": (288, 162)},
            "shift": {
                "at": (4.4, -6.0, 2.0),
                "look": (0.1, -0.2, 1.9),
                "roll": 0.0,
                "lens": 50.0,
                "size": (200, 150),
                "shift": (-0.09, -0.15),
                "pixel_aspect": 0.8,
            },
        },
    },
    "vitrine": {
        "generation": 5,
        "objects": _VITRINE_OBJECTS,
        "materials": _VITRINE_MATERIALS,
        "lights": {
            "sun": {"type": "SUN", "energy": 3.0, "color": (1.0, 1.0, 1.0), "to": (-0.32, 0.61, -0.72)},
            "point": {"type": "POINT", "energy": 900.0, "color": (1.0, 0.8, 0.6), "at": (-3.0, -5.0, 5.0)},
            "spot": {
                "type": "SPOT",
                "energy": 2200.0,
                "color": (0.7, 0.85, 1.0),
                "at": (3.5, -6.0, 5.5),
                "to": (-0.4, 0.65, -0.62),
                "cone": 70.0,
                "blend": 0.4,
            },
        },
        "cameras": {"main": {"at": (0, -9, 4), "look": (0, 0, 0.4), "roll": 0.0, "lens": 40.0, "size": (320, 180)}},
        "filters": ("point",),
        "variants": ("principled",),
        "depth": "32",
        "layers": True,
    },
}
