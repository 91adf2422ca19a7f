"""Whole commands as grades: what each choice promises, and what all of the command costs with it here.

Checks and exports by meshing: the error of a part's volume. Builds and syntheses by the number of arrays: the
half-width of the yield's interval. Counted from the description; the kernel is not loaded.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from tactcad.assembly.yield_interval import widest
from tactcad.design.allowance import Grade
from tactcad.design.tree import Design
from tactcad.parts.description import Part
from tactcad.scenes import make_scene
from tactcad.solids.meshing import USUAL, Meshing

from .this_machine import here, linear, power_law, published

ANGULAR = (1.0, 0.5, 0.35, 0.2, 0.1, 0.05, 0.02)  # rad, largest turn between facets; 0.2 is the usual
COUNTS = tuple(first * 10**power for power in range(2, 6) for first in (1, 2, 5)) + (1_000_000,)  # arrays
YIELD = "half of the yield's 95 % interval"
VOLUME = "each meshed volume"


def check_grades(checked: Sequence[tuple[Design, Sequence[str]]]) -> list[Grade]:
    """Every check of these designs' scenes, the parts meshed by ANGULAR."""
    fixed = published()["check"]["start"]
    counted = [counts(*each) for each in checked]
    base = fixed + sum(linear(published()["check"], c) - fixed for c, _ in counted)
    parts = [part for _, some in counted for part in some]
    usual = _meshing_seconds(parts, USUAL.angular)
    return [_meshed(a, base - usual + _meshing_seconds(parts, a)) for a in ANGULAR]


def export_grades(
    design: Design, scenes: Sequence[str], drawings: bool = False, guides: bool = False
) -> list[Grade]:
    """An export with nothing in the cache, the parts made written as STL, too, meshed by ANGULAR."""
    count, parts = counts(design, scenes)
    made = [part for part in parts if not part.bought]
    base = linear(published()["export"], count)
    base += drawings * linear(published()["drawings"], count) + guides * linear(published()["guides"], count)
    return [_meshed(a, base + _meshing_seconds(made, a)) for a in ANGULAR]


def meshing_of(grade: Grade) -> Meshing:
    """The meshing that a grade stands for."""
    return next(Meshing(a, grade.error) for a in ANGULAR if _triangles(a) == grade.name)


def counts(design: Design, scenes: Sequence[str]) -> tuple[Mapping[str, float], list[Part]]:
    """How many elements, scenes, parts, parts made and placed parts; and the parts, each once."""
    made = [make_scene(design, name) for name in scenes]
    parts = list({part.part_no: part for scene in made for part in scene.parts}.values())
    numbers = {
        "element": sum(map(len, design.array.row_arms)),
        "part": len(parts),
        "made": sum(not part.bought for part in parts),
        "place": sum(len(scene.placements) for scene in made),
    }
    return numbers, parts


def promised(angular: float) -> float:
    """Largest relative error of a part's volume: the largest measured share of w^2/24, a chord's of a turn w,
    with its margin."""
    return float(f"{published()['mesh']['share'] * angular**2 / 24.0:.2g}")


def _meshed(angular: float, seconds: float) -> Grade:
    return Grade(_triangles(angular), promised(angular), here(seconds))


def _triangles(angular: float) -> str:
    return f"triangles of {angular:g} rad"


def _meshing_seconds(parts: Sequence[Part], angular: float) -> float:
    """By each part's features: a face with many holes costs more than as many faces."""
    features = np.array([1.0 + len(part.features) for part in parts])
    return float(power_law(published()["mesh"]["seconds"][f"{angular:g}"], features).sum())


def build_grades(design: Design) -> list[Grade]:
    """`tactcad build` of so many arrays of each distribution, its stack included."""
    elements = {"element": sum(map(len, design.array.row_arms))}
    return _built(linear(published()["build"], elements), linear(published()["array"], elements))


def synthesis_grades(work: Mapping[str, float]) -> list[Grade]:
    """`tactcad design` whose search looks at so many candidates and whose yield is found so many times, as
    `synthesis.work_ahead` counts them."""
    each = work["yield"] * linear(published()["array tried"], work)
    return _built(linear(published()["synthesis"], work), each)


def arrays_of(grade: Grade) -> int:
    """How many arrays a grade stands for."""
    return next(count for count in COUNTS if _arrays(count) == grade.name)


def _built(fixed: float, each: float) -> list[Grade]:
    return [Grade(_arrays(n), widest(n), here(fixed + n * each)) for n in COUNTS]


def _arrays(count: int) -> str:
    return f"{count} arrays"
