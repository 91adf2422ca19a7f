"""A design issued again from its measured elements: spacers as thick as pitch less measured sheet, and a
place for each of the equal elements, so that the stop plate lies level on both rows' ledges.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace
from hashlib import sha256
from itertools import permutations, product
from math import factorial, prod
from pathlib import Path
from typing import Any

from tactcad.design.messages import InputError
from tactcad.design.tree import Design
from tactcad.parts.array.element import LEDGE, MEASURED, element_number
from tactcad.parts.array.layout import Layout

from .inspection_sheet import Reading, read_sheet

STEP = 0.001  # mm, rounding of a spacer's ordered thickness; its tolerance is separate
MOST_WAYS = 50_000  # orders of equal elements that are all tried; beyond, neighbours are exchanged


@dataclass(frozen=True)
class Reissued:
    """The design that follows from the readings.

    design      with sheet and spacer as measured, its revision followed by M
    sheet       mean thickness of the elements, mm, and their number
    elements    by place, the number of the measured element there
    lean        mean height of one row's ledges above the other's, mm; None if none was measured
    """

    design: Design
    sheet: float
    count: int
    elements: dict[int, int]
    lean: float | None

    @property
    def lines(self) -> list[str]:
        """The report's lines."""
        d = self.design
        moved = [f"E{m} at E{n}" for n, m in self.elements.items() if m != n]
        lean = "" if self.lean is None else f"; rows' ledges then differ by {abs(self.lean) * 1e3:.1f} um"
        return [
            f"{d.name} revision {d.design.revision}: sheet {self.sheet:.3f} mm (mean of {self.count}), so "
            f"spacers of "
            f"{Layout(d).spacer:.3f} mm",
            f"elements as measured: {', '.join(moved) if moved else 'each at its own number'}{lean}",
        ]

    @property
    def record(self) -> dict[str, Any]:
        return {
            "revision": self.design.design.revision,
            "sheet_mm": self.sheet,
            "of_elements": self.count,
            "spacer_mm": Layout(self.design).spacer,
            "elements": {f"E{place}": f"E{which}" for place, which in self.elements.items()},
            "ledges_lean_mm": self.lean,
        }


def reissued(design: Design, path: str | Path) -> Reissued:
    """The design, as the filled inspection sheet of its elements makes it.

    Raises
    ------
    InputError
        If the sheet is not this design's, cannot be read, or holds no sheet thickness.
    """
    layout = Layout(design)
    readings = read_sheet(path, layout)
    sheets = [
        r.measured for r in readings if r.dimension.name == "sheet thickness" and r.measured is not None
    ]
    if not sheets:
        raise InputError(
            str(path),
            "no sheet thickness is measured",
            legal="at least one element's row `sheet thickness`, mm",
        )
    sheet = round(sum(sheets) / len(sheets), 6)
    spacer = round(design.array.pitch - round(sheet / STEP) * STEP, 6)
    said = (
        f"{MEASURED} {Path(path).name}, SHA-256 {sha256(Path(path).read_bytes()).hexdigest()[:16]}, "
        f"sheet {sheet:.3f} mm (mean of {len(sheets)})"
    )
    made = replace(
        design,
        design=replace(design.design, revision=f"{design.design.revision[:1]}M"),
        sheet=replace(design.sheet, thickness=round(sheet / STEP) * STEP),
        array=replace(design.array, spacer=spacer),
        origin={**design.origin, "array.spacer": said, "sheet.thickness": said},
    )
    elements, lean = _paired(layout, readings)
    return Reissued(made, sheet, len(sheets), elements, lean)


def _paired(layout: Layout, readings: Sequence[Reading]) -> tuple[dict[int, int], float | None]:
    """The measured element for each place: equal ones are exchanged until the mean heights of the rows'
    ledges differ least; of equal ways the first. And that difference, mm."""
    ledge = {r.number: r.measured for r in readings if r.dimension.name == LEDGE and r.measured is not None}
    places = [p.number for p in layout.elements]
    row = {p.number: p.row for p in layout.elements}
    as_numbered = dict(zip(places, places))
    if len(ledge) < len(places) or len(set(row.values())) < 2:
        return as_numbered, None
    kinds: defaultdict[str, list[int]] = defaultdict(list)
    for p in layout.elements:
        kinds[element_number(layout.design, p)].append(p.number)

    def apart(way: dict[int, int]) -> float:
        means = [[ledge[way[n]] for n in places if row[n] == r] for r in sorted(set(row.values()))]
        first, second = (sum(v) / len(v) for v in means)
        return first - second

    groups = [*kinds.values()]
    if prod(factorial(len(g)) for g in groups) > MOST_WAYS:
        return _exchanged(as_numbered, groups, apart)
    ways = (
        as_numbered | {n: m for group, order in zip(groups, orders) for n, m in zip(group, order)}
        for orders in product(*(permutations(g) for g in groups))
    )
    best = min(ways, key=lambda way: round(abs(apart(way)), 9))
    return best, round(apart(best), 6)


def _exchanged(way: dict[int, int], groups: Sequence[list[int]], apart: Any) -> tuple[dict[int, int], float]:
    """Two equal elements after the other are exchanged while that levels the ledges."""
    better = True
    while better:
        better = False
        for group in groups:
            for i, a in enumerate(group):
                for b in group[i + 1 :]:
                    other = way | {a: way[b], b: way[a]}
                    if abs(apart(other)) < abs(apart(way)) - 1e-9:
                        way, better = other, True
    return way, round(apart(way), 6)
