"""What is ordered: every line of the bills with its quantity and spares, for one set or for all."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import dataclass
from typing import Literal

from tactcad.parts.description import NOT_ORDERED, Part
from tactcad.scenes.bom import BomRow, bom_rows
from tactcad.scenes.scene import Scene

Sets = Literal["one", "all"]
SETS: Mapping[Sets, str] = {
    "one": "one set: what several set-ups need is ordered once, and moves from one to the next",
    "all": "all set-ups, side by side: what several of them need is ordered for each; the array once",
}
SPARES = (
    "Spares come on top. Of elements: one of every ten of a kind, and one of every kind (of the ten "
    "published ones no. 5 did not work). Of gauges, terminals and wire: one of every five, and at least one; "
    "of boards and what stands on them: one of every ten, and at least one. Of screws and pins: one or two "
    "of every size. Of plates and spacers: none."
)


@dataclass(frozen=True)
class OrderLine:
    """A line of the order: the bill's row, how many the set-ups hold, and the part (None: without solid)."""

    row: BomRow
    qty: float
    part: Part | None

    @property
    def order(self) -> float:
        """With spares."""
        return round(self.qty + self.row.spares, 6)


def ordered(scenes: Sequence[Scene], revision: str, sets: Sets) -> tuple[OrderLine, ...]:
    """The lines that the scenes need, in order of first placement; what comes with another part, and
    reference parts, need no order.

    Parameters
    ----------
    scenes, revision
        Of the design.
    sets
        What is ordered (SETS).
    """
    parts = {part.part_no: part for scene in scenes for part in scene.parts}
    bills = {scene.name: {row.part_no: row for row in bom_rows(scene, revision, {})} for scene in scenes}
    rows = {number: row for bill in bills.values() for number, row in reversed(bill.items())}
    array = {n for n, row in bills.get("array", {}).items() if row.make_buy == "make"}
    own = [dict(_own(scene, bills[scene.name], array)) for scene in scenes]
    lines = []
    for number in dict.fromkeys(n for bill in bills.values() for n in bill):
        each = [bill[number].qty for bill in bills.values() if number in bill]
        qty = max(each) if sets == "one" else round(sum(counts.get(number, 0) for counts in own), 6)
        if rows[number].process not in NOT_ORDERED:
            lines.append(OrderLine(rows[number], qty, parts.get(number)))
    return tuple(lines)


def _own(scene: Scene, bill: Mapping[str, BomRow], array: Set[str]) -> Iterator[tuple[str, float]]:
    """Quantities of a scene without those of the scenes that were put together before and stand in it, and
    without the array's own parts (`array`), one of which is in the bonding fixture."""
    ready = [{row.part_no: row.qty for row in bom_rows(s, "", {})} for s in scene.ready]
    for number, row in bill.items():
        if scene.name == "array" or number not in array:
            yield number, row.qty - sum(counts.get(number, 0) for counts in ready)
