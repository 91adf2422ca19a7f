"""A sensor as a reviewer sees it, and from one state to another what becomes of each element, the array, its
parts and sheets.

Closed forms only: no kernel. Parts and scenes are those of the record of geometry (`export.geometry`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from difflib import SequenceMatcher
from functools import cached_property
from math import isclose
from typing import Any

from tactcad.checks.check import Job, described, of_rigs, run_each
from tactcad.checks.check_report import Report
from tactcad.checks.described.goes_together import COUNT
from tactcad.design.family import family_of
from tactcad.design.messages import CheckFailure
from tactcad.design.tree import CommonTables, Design
from tactcad.export.difference import SHARE, differences
from tactcad.export.geometry import Record, all_scenes, geometry
from tactcad.export.golden_file import with_letters
from tactcad.mechanics import readout
from tactcad.mechanics.ladder import DEFAULT_RUNG
from tactcad.parts.array.hinge_section import design_gauge, design_readout, hinge_section
from tactcad.parts.array.layout import Layout
from tactcad.parts.language.description import Part, Vector
from tactcad.parts.language.finding import Finding
from tactcad.scenes import left_out
from tactcad.scenes.rig import ARRAY
from tactcad.scenes.scene import Scene
from tactcad.stacks.stack import LEAST_YIELD
from tactcad.stacks.virtual_build import sensor

# Figures of an element that are compared, with their displayed names.
FIGURES = {
    "stiffness": "K",
    "rated_force": "rated force",
    "signal_per_force": "signal per force",
    "stop_gap": "stop gap",
}


@dataclass(frozen=True)
class ElementFigures:
    """One element; None if it is out of the models' range, or the side lacks it."""

    stiffness: float | None  # N/mm
    rated_force: float | None  # N, in use
    signal_per_force: float | None  # V/N; of cells in a plane mT/N
    stop_gap: float | None  # mm


SHAPE = ("contours", "holes", "pockets", "volume_mm3", "box_mm")


@dataclass(frozen=True)
class SensorState:
    """One state of a sensor.

    elements     by designator
    mass         of the array with its fasteners, g
    cut_length   of all wire-cut pieces of the array, mm
    made         every part that is made and has a sheet, by number: its record without its count
    scenes       by name: placements and bill of the record of geometry
    size         of the array as built, mm; None if only a record of geometry is there
    """

    elements: Mapping[str, ElementFigures]
    mass: float
    cut_length: float
    made: Mapping[str, Record]
    scenes: Mapping[str, Record]
    size: Vector | None = None


def recorded_state(record: Record, design: CommonTables | None) -> SensorState:
    """State from a record of geometry; the rated force follows with the design's rating."""
    parts, rating = record["parts"], getattr(design, "rating", None)

    def figures(element: Mapping[str, Any]) -> ElementFigures:
        at_yield, rated = element.get("yield_force_n"), None
        if rating is not None and at_yield is not None:
            rated = min(rating.force, at_yield / rating.yield_factor)
        gap = parts[element["part_no"]].get("limits", {}).get("stop gap", {}).get("nominal_mm")
        return ElementFigures(element.get("stiffness_n_per_mm"), rated, None, gap)

    scenes = record["scenes"]
    rows = scenes["array"]["bom"]
    return SensorState(
        {name: figures(element) for name, element in record.get("elements", {}).items()},
        sum(row["qty"] * (row["mass_g"] or 0.0) for row in rows.values()),
        sum(row["qty"] * (parts[n]["cut_length_mm"] or 0.0) for n, row in rows.items() if n in parts),
        with_letters({"parts": parts}),
        scenes,
    )


@dataclass(frozen=True)
class Reviewed:
    """A design that keeps its rules, by the present code; `known` keeps findings of parts that designs share,
    `told` is its record of geometry if already made, `placed` its scenes."""

    design: CommonTables
    known: dict[str, tuple[Part, list[Finding]]] = field(default_factory=dict, repr=False)
    told: Record | None = None
    placed: Sequence[Scene] = field(default=(), repr=False)

    @cached_property
    def scenes(self) -> Sequence[Scene]:
        return self.placed or all_scenes(self.design)

    @cached_property
    def parts(self) -> dict[str, Part]:
        """By number."""
        return {part.part_no: part for scene in self.scenes for part in scene.parts}

    @cached_property
    def record(self) -> Record:
        """Of geometry."""
        return geometry(self.design, self.scenes) if self.told is None else self.told

    @cached_property
    def state(self) -> SensorState:
        told = recorded_state(self.record, self.design)
        return replace(
            told,
            elements={
                name: replace(figures, signal_per_force=volts)
                for (name, figures), volts in zip(told.elements.items(), self._signals(len(told.elements)))
            },
            size=next(scene.size for scene in self.scenes if scene.name == ARRAY),
        )

    def _signals(self, count: int) -> list[float | None]:
        """V/N of every element, or what its estimate calls its signal; None for all if one is out of the
        model's range, or nothing reads them."""
        family = family_of(self.design)
        try:
            if family.readout:
                return list(family.readout.signals(self.design))
            rows = family.estimate.rows(family.layout(self.design), DEFAULT_RUNG, None)
            return [getattr(row, "signal", None) for row in rows]
        except CheckFailure:
            return [None] * count

    @cached_property
    def yield_share(self) -> float:
        """Share of virtual arrays that meet every requirement, as `tactcad check` builds them."""
        return sensor(self.design, self.scenes).built(COUNT).share

    @cached_property
    def findings(self) -> list[Finding]:
        """Findings of every check that needs no kernel and no virtual builds."""
        report, design = Report(), self.design
        job = Job(design, [scene.name for scene in self.scenes], self.scenes)
        quick = [check for check in described(design) if check.quick]
        run_each(report, [*quick, *of_rigs(design, self.scenes)], "design", design, job)
        of_parts = [f for part in self.parts.values() for f in self._about(part, job)]
        missing = [
            Finding("scene", "flag", f"scene {left.scene} left out", (), 0, 0, left.reason)
            for left in left_out(design)
        ]
        return [*report.findings, *of_parts, *missing]

    def _about(self, part: Part, job: Job) -> list[Finding]:
        if part.part_no not in self.known or self.known[part.part_no][0] != part:
            report = Report()
            run_each(report, described(self.design), "part", part, job)
            self.known[part.part_no] = (part, report.findings)
        return self.known[part.part_no][1]


def signals(design: Design) -> list[float]:
    """V/N of every element of facing rows. Raises CheckFailure if one is out of the model's range."""
    layout, gauge, electronics = Layout(design), design_gauge(design), design_readout(design)
    read = readout.predict(hinge_section(layout, layout.elements), gauge, electronics, 0.0)
    return [float(volts) for volts in read.per_force]


def too_few(share: float) -> bool:
    """Whether `tactcad check` fails at that share of arrays."""
    return share < LEAST_YIELD


Pairs = Sequence[tuple[str | None, str | None]]  # designators before and after


@dataclass(frozen=True)
class ChangedFigure:
    """A number before and after."""

    old: float
    new: float

    @property
    def change(self) -> float:
        """Relative: 0.05 for 5 % more."""
        return (self.new - self.old) / abs(self.old) if self.old else 0.0


@dataclass(frozen=True)
class ElementEffect:
    """Changed figures of one element, by its designator before and after.

    Units as in `ElementFigures`. A figure that only one of the sides knows is left out.
    """

    old: str
    new: str
    stiffness: ChangedFigure | None = None
    rated_force: ChangedFigure | None = None
    signal_per_force: ChangedFigure | None = None
    stop_gap: ChangedFigure | None = None

    @property
    def figures(self) -> dict[str, ChangedFigure]:
        """Those that change."""
        return {name: f for name in FIGURES if (f := getattr(self, name)) is not None}


@dataclass(frozen=True)
class SensorEffect:
    """Effects of one change, or of several together.

    elements         those of which a figure changes
    elements_added, elements_removed
                     designators after and before
    mass, cut_length of the array, g and mm; None unchanged
    size             of the array as built before and after, mm; None unchanged or unknown
    yield_share      share of virtual arrays that meet every requirement; None unchanged or not built
    bill             part number -> pieces before and after, the most that one scene holds
    parts_added, parts_removed
                     part numbers of parts that are made
    parts_revised    made, under the same number with other content
    same_letter      those of them whose letter is the same too: it must change
    sheets           drawings that must be issued anew, by name without revision
    scenes_added, scenes_removed
                     what the array has rigs for
    now, no_longer   what checks and rules say and did not, and the other way round
    now_fails        whether one of `now` fails
    """

    elements: tuple[ElementEffect, ...] = ()
    elements_added: tuple[str, ...] = ()
    elements_removed: tuple[str, ...] = ()
    mass: ChangedFigure | None = None
    cut_length: ChangedFigure | None = None
    size: tuple[Vector, Vector] | None = None
    yield_share: ChangedFigure | None = None
    bill: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    parts_added: tuple[str, ...] = ()
    parts_removed: tuple[str, ...] = ()
    parts_revised: tuple[str, ...] = ()
    same_letter: tuple[str, ...] = ()
    sheets: tuple[str, ...] = ()
    scenes_added: tuple[str, ...] = ()
    scenes_removed: tuple[str, ...] = ()
    now: tuple[str, ...] = ()
    no_longer: tuple[str, ...] = ()
    now_fails: bool = False

    def __bool__(self) -> bool:
        return any(getattr(self, f.name) for f in fields(self))

    def largest(self, *names: str) -> float:
        """Largest relative change of these figures over all elements."""
        changes = (e.figures[n].change for e in self.elements for n in names if n in e.figures)
        return max(map(abs, changes), default=0.0)


def same_elements(old: CommonTables, new: CommonTables) -> Pairs:
    """Pairs of the new and old arrays' elements, in order: by place in rows of unchanged length; else by
    their arms, so that an inserted one shifts no other."""
    before, after = (family_of(d).layout(d).elements for d in (old, new))
    if type(old) is not type(new):
        return [*((p.designator, None) for p in before), *((None, p.designator) for p in after)]
    pairs: list[tuple[str | None, str | None]] = []
    for row in sorted({p.row for p in (*before, *after)}):
        was, now = ([p for p in places if p.row == row] for places in (before, after))
        if len(was) == len(now):
            pairs += [(a.designator, b.designator) for a, b in zip(was, now)]
            continue
        match = SequenceMatcher(None, [p.arm for p in was], [p.arm for p in now], autojunk=False)
        for _, i0, i1, j0, j1 in match.get_opcodes():
            kept = min(i1 - i0, j1 - j0)
            pairs += [(was[i0 + n].designator, now[j0 + n].designator) for n in range(kept)]
            pairs += [(p.designator, None) for p in was[i0 + kept : i1]]
            pairs += [(None, p.designator) for p in now[j0 + kept : j1]]
    return pairs


def by_name(old: SensorState, new: SensorState) -> Pairs:
    """Elements paired by designator, if no layout is known."""
    names = dict.fromkeys([*old.elements, *new.elements])
    return [(n if n in old.elements else None, n if n in new.elements else None) for n in names]


def effect(old: SensorState, new: SensorState, pairs: Pairs) -> SensorEffect:
    """Effects between two states, from any code."""
    shared = [n for n in new.made if n in old.made]
    revised = [n for n in shared if differences(old.made[n], new.made[n])]
    added = [n for n in new.made if n not in old.made]
    return SensorEffect(
        elements=tuple(_elements(old.elements, new.elements, pairs)),
        elements_added=tuple(b for a, b in pairs if a is None and b is not None),
        elements_removed=tuple(a for a, b in pairs if b is None and a is not None),
        mass=_changed(old.mass, new.mass),
        cut_length=_changed(old.cut_length, new.cut_length),
        size=(old.size, new.size) if old.size and new.size and old.size != new.size else None,
        bill=_bill(old, new),
        parts_added=tuple(added),
        parts_removed=tuple(n for n in old.made if n not in new.made),
        parts_revised=tuple(revised),
        sheets=(*added, *revised, *_assemblies(old, new)),
        scenes_added=tuple(s for s in new.scenes if s not in old.scenes),
        scenes_removed=tuple(s for s in old.scenes if s not in new.scenes),
    )


def reviewed_effect(old: Reviewed, new: Reviewed, build: bool) -> SensorEffect:
    """Effects between two designs by the present code; with `build`, arrays are also built virtually."""
    pairs = same_elements(old.design, new.design)
    found = effect(old.state, new.state, pairs)
    share = _changed(old.yield_share, new.yield_share) if build else None
    numbers = {*found.parts_added, *found.parts_removed}
    names = {a: b for a, b in pairs if a is not None and b is not None}
    before, after = {_who(f, names): f for f in old.findings}, {_who(f, {}): f for f in new.findings}
    now = [f for who, f in after.items() if who not in before and not _comes_or_goes(f, numbers)]
    gone = [f for who, f in before.items() if who not in after and not _comes_or_goes(f, numbers)]
    said, silent = [str(f) for f in now], [str(f) for f in gone]
    fails = any(f.severity == "fail" for f in now)
    if share is not None and too_few(share.old) != too_few(share.new):
        line = f"fail: assembly: fewer than {100 * LEAST_YIELD:g} % of virtual arrays meet all requirements"
        (said if too_few(share.new) else silent).append(line)
        fails |= too_few(share.new)
    return replace(found, yield_share=share, now=tuple(said), no_longer=tuple(silent), now_fails=fails)


def _who(finding: Finding, names: Mapping[str, str]) -> tuple[str, str, str]:
    """A finding's subject: of an element its present designator, for any part."""
    return finding.check, finding.severity, names.get(finding.part, finding.part)


def _comes_or_goes(finding: Finding, numbers: set[str]) -> bool:
    """Whether a flag came or went with its part, and so did not turn."""
    return finding.severity == "flag" and finding.part in numbers


def _elements(
    old: Mapping[str, ElementFigures], new: Mapping[str, ElementFigures], pairs: Pairs
) -> Iterator[ElementEffect]:
    for before, after in pairs:
        if before is None or after is None:
            continue
        was, now = old[before], new[after]
        found = {name: _changed(getattr(was, name), getattr(now, name)) for name in FIGURES}
        if any(found.values()):
            yield ElementEffect(before, after, **found)


def _changed(old: float | None, new: float | None) -> ChangedFigure | None:
    """Both numbers if they differ by more than rounding; None if one is not known."""
    if old is None or new is None or isclose(old, new, rel_tol=SHARE, abs_tol=0.0):
        return None
    return ChangedFigure(old, new)


def _bill(old: SensorState, new: SensorState) -> dict[str, tuple[float, float]]:
    """Pieces before and after of each line, the most that one scene holds: an array moves between rigs."""
    most: list[dict[str, float]] = [{}, {}]
    for pieces, state in zip(most, (old, new)):
        for scene in state.scenes.values():
            for number, line in scene["bom"].items():
                pieces[number] = max(line["qty"], pieces.get(number, 0))
    before, after = most
    counts = {n: (before.get(n, 0), after.get(n, 0)) for n in {**before, **after}}
    return {n: (a, b) for n, (a, b) in counts.items() if a != b}


def _assemblies(old: SensorState, new: SensorState) -> Iterator[str]:
    """Scenes whose assembly drawing changes."""
    shapes = [{n: {k: p[k] for k in SHAPE if k in p} for n, p in s.made.items()} for s in (old, new)]
    kept = {n for n, shape in shapes[1].items() if n in shapes[0] and not differences(shapes[0][n], shape)}
    for name, scene in new.scenes.items():
        shown = [n for n in scene["bom"] if n in new.made]
        if name not in old.scenes or differences(old.scenes[name], scene) or not kept.issuperset(shown):
            yield f"assembly {name}"
