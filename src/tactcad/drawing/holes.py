"""Round holes as on a drawing: grouped by callout, with the dimensions in each callout's text."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import isclose

from tactcad.parts.description import Hole, Part, Vector
from tactcad.parts.limits import Characteristic

from .contours import axis_of
from .keys import Owner, Quantity, Values
from .measures import size
from .sheet_plan import Dimension

LEAST_ROW = 6  # equal holes in a line that count as a regular row
# What a hole's variables are called in characteristics.
WORDS = {Quantity.DIAMETER: "diameter"}
EVEN = 5e-6  # mm: steps of a row are equal within this; places are given to a nanometre


@dataclass(frozen=True)
class Round:
    """One round hole: what its variables belong to, middle on its face, direction, and what is made there."""

    owner: Owner
    label: str
    at: Vector
    axis: Vector
    hole: Hole


def rounds(part: Part) -> list[Round]:
    """Round openings and holes of an extruded part."""
    body = part.extrusion
    holes = []
    for i, opening in enumerate(body.openings):
        if circle := opening.as_circle():
            (x, y), r = circle
            label = opening.segments[0].name
            hole = Hole(label, (x, y, body.thickness), (0, 0, -1), 2 * r, body.thickness, True)
            holes.append(Round(Owner("opening", i), label.replace("_", " "), hole.at, hole.axis, hole))
    for k, f in enumerate(part.features):
        if isinstance(f, Hole):
            holes.append(Round(Owner("hole", k), f.name.replace("_", " "), f.at, f.axis, f))
    return holes


def widest(h: Hole) -> float:
    """Diameter of a hole, or of its counterbore, mm."""
    return max(h.diameter, h.counterbore[0] if h.counterbore else 0.0)


@dataclass(frozen=True)
class Group:
    """Equal holes, the lines of their callout, and the dimensions that stand in the lines."""

    holes: tuple[Round, ...]
    lines: tuple[str, ...]
    dimensions: tuple[Dimension, ...]

    @property
    def axis(self) -> Vector:
        return self.holes[0].axis


def groups(holes: Sequence[Round], values: Values, eye_of: Mapping[int, Vector], part: Part) -> list[Group]:
    """Equal holes of the part together; `eye_of` gives the eye of the view that shows the holes along axis 0,
    1, 2 as circles. Holes that geometric tolerances or datums tell apart are not equal."""
    kinds: dict[tuple, list[Round]] = {}
    for r in holes:
        h = r.hole
        side = h.axis if not _same_from_both_sides(h) else tuple(abs(a) for a in h.axis)
        kinds.setdefault((side, (*_spec(h), *_stated(part, h.name))), []).append(r)
    merged = _both_ends(kinds)
    own = {c.name: c for c in part.characteristics}
    return [_group(some, both, values, eye_of, own) for some, both in merged]


def _same_from_both_sides(h: Hole) -> bool:
    return h.through and not h.counterbore and (not h.thread or isclose(h.thread_depth, h.depth))


def _spec(h: Hole) -> tuple:
    return (
        round(h.diameter, 9),
        h.through,
        0.0 if h.through else round(h.depth, 9),
        h.counterbore,
        h.thread,
        round(h.thread_depth, 9),
        h.drill_point,
        h.tolerance,
    )


def _stated(part: Part, name: str) -> Iterator[str]:
    """What is stated of the holes of a name: geometric tolerances by their names, datums by their letters."""
    yield from (g.name for g in part.geometric if name in g.features)
    yield from (d.letter for d in part.datums if d.feature == name)


def _both_ends(kinds: dict[tuple, list[Round]]) -> list[tuple[list[Round], bool]]:
    """Groups that differ only in the face that they start from, at the same places, become one."""
    result: list[tuple[list[Round], bool]] = []
    left = dict(kinds)
    for (axis, spec), some in kinds.items():
        if (axis, spec) not in left:
            continue
        del left[(axis, spec)]
        opposite = (tuple(-a + 0.0 for a in axis), spec)
        other = opposite if opposite in left else None
        k = next(i for i, a in enumerate(axis) if a)

        def places(rounds_: Sequence[Round]) -> set[tuple]:
            return {tuple(round(v, 6) for i, v in enumerate(r.at) if i != k) for r in rounds_}

        if other and places(left[other]) == places(some):
            result.append((some + left.pop(other), True))
        else:
            result.append((some, False))
    return result


def _group(
    some: list[Round],
    both: bool,
    values: Values,
    eye_of: Mapping[int, Vector],
    own: Mapping[str, Characteristic],
) -> Group:
    h, label = some[0].hole, some[0].label

    def dimension(what: Quantity, sign: str, counted: bool = False) -> Dimension:
        rows = tuple(size(r.owner.size(what)) for r in some)
        return Dimension(f"{label} {WORDS.get(what, what)}", rows, sign, counted=counted)

    limits, modelled, words = _tolerance(h.tolerance)
    fit, _, remark = words.partition(", ")
    if fit:
        # a fit belongs to the nominal size; the model is made within its field, hundredths of a millimetre
        # away
        modelled = round(h.diameter - round(h.diameter, 1), 9)
    # the count of a thread stands before the thread, or before the counterbore that it is entered by
    bore = dimension(Quantity.DIAMETER, "⌀", counted=not h.thread)
    bore = replace(bore, limits=limits, modelled=modelled, fit=fit)
    if c := own.get(bore.name):  # it is modelled between its limits
        remark = words if fit else remark
        bore = replace(
            bore,
            limits=(c.upper - c.nominal, c.lower - c.nominal),
            modelled=round(h.diameter - c.nominal, 9),
            characteristic=c,
            fit="",
        )
    used = [bore]
    depth = None if h.through else dimension(Quantity.DEPTH, "↧")
    ending = " through" if depth is None else f" {depth.text(values)}"
    cone = ", point 118°" if h.drill_point else ""
    used += [depth] if depth else []
    count = f"{len(some)}× " if len(some) > 1 else ""
    lines: list[str] = []
    if h.counterbore:
        wide, deep = dimension(Quantity.WIDE, "⌀"), dimension(Quantity.DEEP, "↧")
        used += [wide, deep]
        wider = f"{wide.text(values)} {deep.text(values)}"
    if h.thread:
        thread = None if h.thread_depth >= h.depth else dimension(Quantity.THREAD, "↧")
        used += [thread] if thread else []
        deep_thread = thread.text(values) if thread else ""
        if h.counterbore:
            lines += [f"{count}{wider}, below it"]
            lines += [f"{h.thread}-6H, full thread {deep_thread.removeprefix('↧')} long"]
        else:
            lines.append(f"{count}{h.thread}-6H {deep_thread or 'through'}")
        lines.append(f"drill {bore.text(values)}{ending}{cone}")
    else:
        lines.append(f"{bore.text(values)}{ending}{cone}")
        if h.counterbore:
            lines.append(f"counterbore {wider}")
    if remark:
        lines.append(remark)
    if both:
        lines.append("from both sides alike")
    elif not _same_from_both_sides(h) and sum(a * e for a, e in zip(h.axis, eye_of[axis_of(h)])) > 0:
        lines.append("from the far side")
    return Group(tuple(some), tuple(lines), tuple(used))


def regular_rows(called: Sequence[Group], k: int) -> list[list[Round]]:
    """Rows of at least LEAST_ROW equal holes along z, evenly spaced along the part's axis k (0 or 1), in
    order."""
    rows = []
    for group in called:
        lines: dict[float, list[Round]] = {}
        for r in group.holes if group.axis[2] else ():
            lines.setdefault(round(r.at[1 - k], 6), []).append(r)
        for line in lines.values():
            line.sort(key=lambda r: r.at[k])
            steps = [b.at[k] - a.at[k] for a, b in pairwise(line)]
            if len(line) >= LEAST_ROW and max(steps) - min(steps) < EVEN:
                rows.append(line)
    return rows


def _tolerance(text: str) -> tuple[tuple[float, float] | None, float, str]:
    """Limits, how far the model lies from the number shown (it is made at the middle of them), or a fit in
    words."""
    upper, slash, lower = text.partition("/")
    try:
        limits = (float(upper), float(lower))
    except ValueError:
        return None, 0.0, text
    return (limits, round(sum(limits) / 2, 9), "") if slash else (None, 0.0, text)
