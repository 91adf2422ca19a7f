"""Arrays built virtually as grades: the half-width of the yield's interval that so many promise, and what
they cost here."""

from __future__ import annotations

from collections.abc import Mapping

from tactcad.assembly.yield_interval import widest
from tactcad.design.allowance import Grade
from tactcad.design.tree import Design

from .costs import here, linear, published

YIELD = "half of the yield's 95 % interval"
COUNTS = tuple(first * 10**power for power in range(2, 6) for first in (1, 2, 5)) + (1_000_000,)


def build_grades(design: Design) -> list[Grade]:
    """`tactcad build` of so many arrays of each distribution, its stack included."""
    elements = {"element": sum(map(len, design.array.row_arms))}
    return _grades(linear(published()["build"], elements), linear(published()["array"], elements))


def synthesis_grades(work: Mapping[str, float]) -> list[Grade]:
    """`tactcad design` whose search looks at so many candidates and whose yield is found so many times, as
    `synthesis.work_ahead` counts them."""
    each = work["yield"] * linear(published()["array tried"], work)
    return _grades(linear(published()["synthesis"], work), each)


def arrays_of(grade: Grade) -> int:
    """How many arrays a grade stands for."""
    return next(count for count in COUNTS if _name(count) == grade.name)


def _grades(fixed: float, each: float) -> list[Grade]:
    return [Grade(_name(n), widest(n), here(fixed + n * each)) for n in COUNTS]


def _name(count: int) -> str:
    return f"{count} arrays"
