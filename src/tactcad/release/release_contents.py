"""A release's owner, scenes, order with spares, and status."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

from tactcad.design.messages import InputError
from tactcad.design.tree import CommonTables, Identity
from tactcad.parts.language.description import NOT_ORDERED, Part
from tactcad.parts.language.finding import Finding
from tactcad.scenes.bom import BomRow, bom_rows
from tactcad.scenes.scene import Scene

PROCESSES = {
    "wire-cut": "Wire-cut from sheet",
    "etched": "Photo-etched from foil",
    "milled": "Milled",
    "turned": "Turned",
    "ground": "Ground",
}


@dataclass(frozen=True)
class ReleaseContents:
    """Subject of a release: its scenes, what the checks flagged, why it is only a draft (empty if it is
    not), whether it is a sample without owner, and how many sets are ordered.
    """

    design: CommonTables
    scenes: Sequence[Scene]
    flags: Sequence[Finding]
    failures: Sequence[str]
    draft: bool
    sample: bool = False
    sets: Sets = "one"

    @property
    def made(self) -> list[Part]:
        """Every part that a shop makes, once; grouped by process, in the order of first placement."""
        parts = {p.part_no: p for scene in self.scenes for p in scene.parts if p.process in PROCESSES}
        return sorted(parts.values(), key=lambda p: list(PROCESSES).index(p.process))

    @cached_property
    def lines(self) -> tuple[OrderLine, ...]:
        """The order, made and bought."""
        return ordered(self.scenes, self.design.design, self.sets)

    def quantity(self, part: Part) -> float:
        """Number of a made part that the set-ups need; spares come on top."""
        return next(line.qty for line in self.lines if line.row.part_no == part.part_no)

    @property
    def stem(self) -> str:
        """Name of the whole zip, without ending."""
        marks = [*(["SAMPLE"] if self.sample else []), *(["PRELIMINARY"] if self.draft else [])]
        return "-".join([self.design.name, self.design.design.revision, *marks])


Sets = Literal["one", "all"]
SETS: Mapping[Sets, str] = {
    "one": "one set: what several set-ups need is ordered once, and moves from one to the next",
    "all": "all set-ups, side by side: what several of them need is ordered for each; the array once",
}
SPARES = (
    "Spares come on top. Of elements: one of every ten of a kind, and one of every kind (of the ten "
    "published ones no. 5 did not work). Of gauges, terminals and wire: one of every five, and at least one; "
    "of boards and their parts: one of every ten, and at least one. Of screws and pins: one or two "
    "of every size. Of plates and spacers: none."
)


@dataclass(frozen=True)
class OrderLine:
    """A line of the order: the bill's row, the set-ups' count, and the part (None: without solid)."""

    row: BomRow
    qty: float
    part: Part | None

    @property
    def order(self) -> float:
        """With spares."""
        return round(self.qty + self.row.spares, 6)


def ordered(scenes: Sequence[Scene], identity: Identity | None, sets: Sets) -> tuple[OrderLine, ...]:
    """The lines that the scenes need, in order of first placement; what comes with another part, and
    reference parts, need no order.

    Parameters
    ----------
    scenes, identity
        Of the design; None: without letters.
    sets
        What is ordered (SETS).
    """
    parts = {part.part_no: part for scene in scenes for part in scene.parts}
    bills = {scene.name: {row.part_no: row for row in bom_rows(scene, identity, {})} for scene in scenes}
    rows = {number: row for bill in bills.values() for number, row in reversed(bill.items())}
    array = {n for n, row in bills.get("array", {}).items() if row.make_buy == "make"}
    whole = {(p.designator, p.part.part_no) for s in scenes if s.name == "array" for p in s.placements}
    own = [dict(_own(scene, bills[scene.name], array, whole)) for scene in scenes]
    lines = []
    for number in dict.fromkeys(n for bill in bills.values() for n in bill):
        each = [bill[number].qty for bill in bills.values() if number in bill]
        qty = max(each) if sets == "one" else round(sum(counts.get(number, 0) for counts in own), 6)
        if rows[number].process not in NOT_ORDERED:
            lines.append(OrderLine(rows[number], qty, parts.get(number)))
    return tuple(lines)


def _own(
    scene: Scene, bill: Mapping[str, BomRow], array: Set[str], whole: Set[tuple[str, str]]
) -> Iterator[tuple[str, float]]:
    """Quantities of a scene without those of its ready scenes, and without the array's own parts: those made
    (`array`), one of which is in the bonding fixture, and those in the setting fixture (`whole`: designators
    and part numbers) while the array is screwed."""
    ready: list[Mapping[str, float]] = [
        {row.part_no: row.qty for row in bom_rows(s, None, {})} for s in scene.ready
    ]
    if scene.ready and scene.name != "array":
        there = {(p.designator, p.part.part_no) for s in scene.ready for p in s.placements}
        placed = {(p.designator, p.part.part_no) for p in scene.placements}
        ready.append(Counter(number for _, number in (placed & whole) - there))
    for number, row in bill.items():
        if scene.name == "array" or number not in array:
            yield number, row.qty - sum(counts.get(number, 0) for counts in ready)


def owned(design: CommonTables, owner: str | None, contact: str | None, sample: bool) -> CommonTables:
    """The design with the owner and contact that are given in place of its own.

    Raises InputError if one of them is unusable as text, or missing without a sample.
    """
    given = {"organisation": ("--owner", owner), "contact": ("--contact", contact)}
    specs = Identity.__dataclass_fields__
    texts = {
        name: specs[name].metadata["spec"].read(text, option)
        for name, (option, text) in given.items()
        if text is not None
    }
    identity = replace(design.design, **texts)
    missing = [name for name in given if getattr(identity, name) is None]
    if missing and not sample:
        raise InputError(
            " and ".join(f"design.{name}" for name in missing),
            f"{design.name} names no owner for the release",
            legal=f"in [design], or {' and '.join(given[name][0] for name in missing)}; "
            "or --sample, which is not for order",
        )
    return replace(design, design=identity)
