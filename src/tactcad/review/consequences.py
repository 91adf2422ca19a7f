"""Consequences of a design's changes: every cause alone, ordered by its effect on the sensor.

By the present code and in closed form. Each cause is applied on its own to the old design; if that is
refused, it is reverted on its own in the new one.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from math import log, prod
from typing import Any, Literal

from tactcad.design.load import from_table
from tactcad.design.messages import CheckFailure, InputError
from tactcad.design.tree import CommonTables
from tactcad.export.board_files import board_record
from tactcad.export.difference import Change
from tactcad.export.golden_file import lines_since
from tactcad.export.sides import Side, comparable
from tactcad.parts.rules import refuse_broken

from .causes import Cause, Table, causes
from .effect import Reviewed, SensorEffect, by_name, effect, recorded_state, reviewed_effect

How = Literal["alone", "taken back", "together only", "code"]
# What the causes do together beyond what each does alone, as a share of K; chosen: a tenth of what 5 um of a
# hinge of 0.25 mm do.
INTERACTION = 0.005


@dataclass(frozen=True)
class Consequence:
    """One cause and its consequences.

    what   the cause in words
    how    `alone` made in the old design; `taken back` from the new one; `together only`: refused either way,
           `why`; `code`: other code, the same design
    """

    what: str
    kind: str
    how: How
    effect: SensorEffect
    why: str = ""

    @property
    def weight(self) -> tuple[float, ...]:
        """Order of the causes: failures, unknown effects, K and rated force and yield, the other figures of
        elements, mass and cut, parts, and the rest; each by its largest relative change."""
        e = self.effect
        share = abs(e.yield_share.new - e.yield_share.old) if e.yield_share else 0.0
        array = [abs(f.change) for f in (e.mass, e.cut_length) if f]
        return (
            float(e.now_fails),
            float(self.how == "together only"),
            max(share, e.largest("stiffness", "rated_force")),
            float(len(e.elements_added) + len(e.elements_removed)),
            e.largest("signal_per_force", "stop_gap"),
            max(array, default=0.0),
            float(len(e.parts_added) + len(e.parts_removed) + len(e.parts_revised)),
            float(len(e.now)),
            float(self.kind != "note"),
        )


@dataclass(frozen=True)
class Meaning:
    """Consequences of all that changed, largest first.

    together      all causes at once; None if the sides' records lack the data
    checked       whether `together` includes checks: both sides have their design
    interactions  elements on which the causes act differently together than one by one, one line each
    unchanged     lines by which parts that did not change keep their letters, where the design's rises
    untold        reasons for missing consequences, one line each
    """

    consequences: tuple[Consequence, ...] = ()
    together: SensorEffect | None = None
    checked: bool = False
    interactions: tuple[str, ...] = ()
    unchanged: tuple[str, ...] = ()
    untold: tuple[str, ...] = ()

    @property
    def effects(self) -> tuple[SensorEffect, ...]:
        """Effects of the whole: of the design, and of the code if that differs."""
        code = [c.effect for c in self.consequences if c.how == "code"]
        return (self.together, *code) if self.together is not None else tuple(code)


def meaning(old: Side, new: Side) -> Meaning:
    """Consequences of the change from one side to the other.

    Sides without a design (golden files) are compared by their records; so are the results of a revision's
    code and of the present code for the same design.
    """
    designs = [_loaded(side) for side in (old, new)]
    untold = tuple(d for d in designs if isinstance(d, str))
    if old.table is None or new.table is None or untold:
        return _recorded(old, new, untold)
    # A record that the present code made of the whole design.
    before, after = (
        Reviewed(
            d,
            told=side.record if side.kind in ("design", "revision") and not side.own_code else None,
            placed=side.scenes,
        )
        for d, side in zip(designs, (old, new))
        if d is not None and not isinstance(d, str)
    )
    code = _of_code(old, new, before)
    if before.design == after.design:
        return Meaning(tuple(code), SensorEffect(), True)
    build = _other_arrays(before.design, after.design)
    together = reviewed_effect(before, after, build)
    found = causes(old.table, new.table)
    each = _Each(old.table, new.table, before, after, together)
    told = each.grouped(found)
    # the letters are those after all causes, whichever one is told
    of = [r.design.design.of_part for r in (before, after)]
    same = {n for n in after.parts if of[0](n).revision == of[1](n).revision}
    together = _with_letters(together, same)
    told = [replace(c, effect=_with_letters(c.effect, same)) for c in told]
    ranked = sorted([*code, *told], key=lambda c: c.weight, reverse=True)
    return Meaning(
        tuple(ranked), together, True, tuple(_interactions(told, together)), tuple(_unchanged(before, after))
    )


def _with_letters(effect: SensorEffect, same: Collection[str]) -> SensorEffect:
    """With the revised parts that have the same letter before and after."""
    return replace(effect, same_letter=tuple(n for n in effect.parts_revised if n in same))


def _unchanged(before: Reviewed, after: Reviewed) -> list[str]:
    """Lines for the new design's file, by which parts that did not change keep their letters."""
    old, new = before.design.design, after.design.design
    if (old.name, old.title) != (new.name, new.title) or old.revision == new.revision:
        return []
    records = [r.record | {"boards": board_record(r.design)} for r in (before, after)]
    return lines_since(records[0], old, records[1], new)


def kept_designs(old: Side, new: Side) -> tuple[CommonTables, CommonTables]:
    """Both sides' designs by the present code. Raises InputError if one has none, or breaks a rule."""
    for side in (old, new):
        if side.table is None:
            raise InputError(
                side.source, "does not tell its design", legal="a design, an export or a revision"
            )
    return _design_of(old.table or {}), _design_of(new.table or {})


def _loaded(side: Side) -> CommonTables | str | None:
    """The side's design by the present code, None if it has none; the reason for a refusal."""
    if side.table is None:
        return None
    try:
        return _design_of(side.table)
    except InputError as error:
        return f"the present code refuses the design of {side.source}: {error}"


def _design_of(table: Table) -> CommonTables:
    """A design that keeps its rules. Raises InputError if it does not."""
    design = from_table(table)
    refuse_broken(design)
    return design


def _other_arrays(old: CommonTables, new: CommonTables) -> bool:
    """Whether virtual arrays may differ: more has changed than names, sources, read-out and leads."""

    def rest(design: CommonTables) -> dict[str, Any]:
        return {k: v for k, v in vars(design).items() if k not in ("design", "origin", "readout", "wiring")}

    return rest(old) != rest(new)


@dataclass(frozen=True)
class _Each:
    """The causes one by one, between these designs."""

    old: Table
    new: Table
    before: Reviewed
    after: Reviewed
    together: SensorEffect

    def of(self, cause: Cause, only: bool) -> Consequence:
        """The consequence of one cause; of the `only` value that changed it is that of all together."""
        said = str(cause)
        if cause.kind == "note":
            return Consequence(said, cause.kind, "alone", SensorEffect())
        if cause.kind == "title block":
            old, new = (r.design.design for r in (self.before, self.after))
            made = [n for n in self.after.state.made if old.of_part(n) != new.of_part(n)]
            sheets = (*made, *(f"assembly {name}" for name in self.after.state.scenes))
            return Consequence(said, cause.kind, "alone", SensorEffect(sheets=sheets))
        if only:
            return Consequence(said, cause.kind, "alone", self.together)
        refused = ""
        ways: tuple[tuple[How, Callable[[], SensorEffect]], ...] = (
            ("alone", lambda: self._effect(self.before, self._reviewed(cause.applied(self.old)))),
            ("taken back", lambda: self._effect(self._reviewed(cause.reverted(self.new)), self.after)),
        )
        for how, way in ways:
            try:
                return Consequence(said, cause.kind, how, way(), refused)
            except (InputError, CheckFailure) as error:
                refused = refused or str(error)
        return Consequence(said, cause.kind, "together only", SensorEffect(), refused)

    def grouped(self, found: Sequence[Cause]) -> list[Consequence]:
        """Consequences of every cause; causes refused alone are applied in accepted pairs, or else all
        together."""
        one_by_one = [(cause, self.of(cause, len(found) == 1)) for cause in found]
        told = [c for _, c in one_by_one if c.how != "together only"]
        stuck = [cause for cause, c in one_by_one if c.how == "together only"]
        while stuck:
            pairs = [[stuck[0], other] for other in stuck[1:]]
            for group in (*pairs, stuck):
                edits = tuple(edit for cause in group for edit in cause.edits)
                made = self.of(Cause("value", edits), len(group) == len(found))
                if made.how != "together only" or group is stuck:
                    break
            told.append(made)
            stuck = [cause for cause in stuck if cause not in group]
        return told

    def _effect(self, old: Reviewed, new: Reviewed) -> SensorEffect:
        """Arrays are built for single causes only if they differ for all together."""
        return reviewed_effect(old, new, self.together.yield_share is not None)

    def _reviewed(self, table: Table) -> Reviewed:
        return Reviewed(_design_of(table), self.before.known)


def _recorded(old: Side, new: Side, untold: Sequence[str]) -> Meaning:
    """Differences of the sides' records, without causes."""
    found = _difference(old, new, None)
    if found is None:
        untold = (*untold, "consequences: not both sides tell the array's parts and bill of materials")
    return Meaning(together=found, untold=tuple(untold))


def _difference(old: Side, new: Side, design: CommonTables | None) -> SensorEffect | None:
    """Difference of two records, of one design if it is given; None if one of them lacks the data."""
    try:
        before, after = (recorded_state(record, design) for record in comparable(old, new))
        found = effect(before, after, by_name(before, after))
        return _with_letters(found, after.made if old.revision == new.revision else ())
    except (LookupError, TypeError, AttributeError):  # a file may hold less than this code writes
        return None


def _of_code(old: Side, new: Side, before: Reviewed) -> list[Consequence]:
    """Difference between the new side's code and the old one's for the old side's design."""
    made = new.of_other if new.own_code else before.record
    if not (old.own_code or new.own_code) or made is None:
        return []
    found = _difference(old, replace(new, record=made), before.design)
    ways = [side.source.rsplit(":", 1)[0] if side.own_code else "the present one" for side in (old, new)]
    return [Consequence(f"code: {ways[0]} -> {ways[1]}", "code", "code", found)] if found else []


def _interactions(told: Sequence[Consequence], together: SensorEffect) -> list[str]:
    """Elements whose K changes differently by all causes together than one by one."""
    lines = []
    for element in together.elements:
        if element.stiffness is None:
            continue
        singles = [
            e.stiffness.new / e.stiffness.old
            for c in told
            for e in c.effect.elements
            if e.stiffness and (e.new == element.new if c.how == "taken back" else e.old == element.old)
        ]
        whole, product = element.stiffness.new / element.stiffness.old, prod(singles)
        if abs(log(whole / product)) > INTERACTION:
            lines.append(
                f"{element.new}: K {100 * (product - 1):+.3g} % by the causes one by one, "
                f"{100 * (whole - 1):+.3g} % together"
            )
    return lines


@dataclass(frozen=True)
class Compared:
    """Two sides with their changes and consequences."""

    old: Side
    new: Side
    changes: Sequence[Change]
    meaning: Meaning


def _geometry(c: Compared) -> bool:
    """A part, a placement or a line of a bill."""
    return any(change.path[0] in ("parts", "scenes") for change in c.changes)


def _stiffness(c: Compared) -> bool:
    """K of an element."""
    for side in (c.old, c.new):
        if "elements" not in side.record and not c.meaning.checked:
            raise InputError("--fail-on", f"{side.source} holds no stiffness", value="stiffness")
    return any(element.stiffness for effect in c.meaning.effects for element in effect.elements)


def _checks(c: Compared) -> bool:
    """A check or rule fails that did not."""
    if not c.meaning.checked:
        legal = "sides that hold a design which keeps its rules"
        raise InputError("--fail-on", "nothing to check on both sides", value="checks", legal=legal)
    return any(effect.now_fails for effect in c.meaning.effects)


def _revision(c: Compared) -> bool:
    """The letter identifies one content of every part number."""
    return c.old.design == c.new.design and any(effect.same_letter for effect in c.meaning.effects)


KINDS: dict[str, Callable[[Compared], bool]] = {
    "changes": lambda c: bool(c.changes),
    "geometry": _geometry,
    "stiffness": _stiffness,
    "checks": _checks,
    "revision": _revision,
}


def held(kinds: Collection[str], compared: Compared) -> list[str]:
    """Those of the kinds that the comparison holds. Raises InputError if the sides do not tell."""
    return [kind for kind in kinds if KINDS[kind](compared)]
