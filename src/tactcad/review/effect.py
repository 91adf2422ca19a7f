"""From one state of a sensor to another: what becomes of each element, the array, its parts and sheets."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from difflib import SequenceMatcher
from math import isclose

from tactcad.assembly.virtual_build import LEAST_YIELD
from tactcad.design.tree import Design
from tactcad.export.difference import SHARE, differences
from tactcad.parts.finding import Finding
from tactcad.parts.layout import Layout

from .sensor_state import ElementFigures, Reviewed, SensorState, too_few

# What is compared of an element, with the name that a reader sees.
FIGURES = {
    "stiffness": "K",
    "rated_force": "rated force",
    "signal_per_force": "signal per force",
    "stop_gap": "stop gap",
}
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
    """What becomes of one element, by its designator before and after: the figures that change.

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
    """What one change, or several together, means.

    elements         those of which a figure changes
    elements_added, elements_removed
                     designators after and before
    mass, cut_length of the array, g and mm; None unchanged
    yield_share      share of virtual arrays that meet every requirement; None unchanged or not built
    bill             part number -> pieces before and after, the most that one scene holds
    parts_added, parts_removed
                     part numbers of parts that are made
    parts_revised    made, under the same number with other content: their revision must change
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
    yield_share: ChangedFigure | None = None
    bill: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    parts_added: tuple[str, ...] = ()
    parts_removed: tuple[str, ...] = ()
    parts_revised: tuple[str, ...] = ()
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


def same_elements(old: Design, new: Design) -> Pairs:
    """Which element of the new array is which of the old one, in their order: place by place in rows that are
    as long as they were; else by their arms, so that one put in between moves no other."""
    before, after = (Layout(d).elements for d in (old, new))
    pairs: list[tuple[str | None, str | None]] = []
    for row in (1, 2):
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
    """Elements paired by designator, where no layout is known."""
    names = dict.fromkeys([*old.elements, *new.elements])
    return [(n if n in old.elements else None, n if n in new.elements else None) for n in names]


def effect(old: SensorState, new: SensorState, pairs: Pairs) -> SensorEffect:
    """What two states tell of each other, whichever code they come from."""
    shared = [n for n in new.made if n in old.made]
    revised = [n for n in shared if not _same(old.made[n].sheet, new.made[n].sheet)]
    added = [n for n in new.made if n not in old.made]
    return SensorEffect(
        elements=tuple(_elements(old.elements, new.elements, pairs)),
        elements_added=tuple(b for a, b in pairs if a is None and b is not None),
        elements_removed=tuple(a for a, b in pairs if b is None and a is not None),
        mass=_changed(old.mass, new.mass),
        cut_length=_changed(old.cut_length, new.cut_length),
        bill=_bill(old, new),
        parts_added=tuple(added),
        parts_removed=tuple(n for n in old.made if n not in new.made),
        parts_revised=tuple(revised),
        sheets=(*added, *revised, *_assemblies(old, new)),
        scenes_added=tuple(s for s in new.scenes if s not in old.scenes),
        scenes_removed=tuple(s for s in old.scenes if s not in new.scenes),
    )


def reviewed_effect(old: Reviewed, new: Reviewed, build: bool) -> SensorEffect:
    """What two designs mean by the present code; with `build`, arrays are built virtually too."""
    pairs = same_elements(old.design, new.design)
    found = effect(old.state, new.state, pairs)
    share = _changed(old.yield_share, new.yield_share) if build else None
    numbers = {*found.parts_added, *found.parts_removed}
    names = {a: b for a, b in pairs if a is not None and b is not None}
    before, after = {_who(f, names): f for f in old.findings}, {_who(f, {}): f for f in new.findings}
    now = [f for who, f in after.items() if who not in before and not _comes_or_goes(f, numbers)]
    gone = [f for who, f in before.items() if who not in after and not _comes_or_goes(f, numbers)]
    said, silent = [str(f) for f in now], [str(f) for f in gone]
    if share is not None and too_few(share.old) != too_few(share.new):
        line = f"fail: assembly: fewer than {100 * LEAST_YIELD:g} % of virtual arrays meet all requirements"
        (said if too_few(share.new) else silent).append(line)
    fails = any(line.startswith("fail: ") for line in said)
    return replace(found, yield_share=share, now=tuple(said), no_longer=tuple(silent), now_fails=fails)


def _who(finding: Finding, names: Mapping[str, str]) -> tuple[str, str, str]:
    """What a finding is about: of an element its designator, as it is called now, whatever its part is."""
    about = finding.part.split(" (")[0]
    return finding.check, finding.severity, names.get(about, about)


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
    """Both numbers where they differ by more than rounding; None where one is not known."""
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
    """Scenes whose assembly drawing shows something else."""
    kept = {n for n, part in new.made.items() if n in old.made and _same(old.made[n].shape, part.shape)}
    for name, scene in new.scenes.items():
        shown = [n for n in scene["bom"] if n in new.made]
        if name not in old.scenes or differences(old.scenes[name], scene) or not kept.issuperset(shown):
            yield f"assembly {name}"


def _same(old: object, new: object) -> bool:
    """Descriptions are equal; records agree within their tolerances."""
    if isinstance(old, dict) and isinstance(new, dict):
        return not differences(old, new)
    return old == new
