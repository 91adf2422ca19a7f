"""Exploded views by calculation: the directions in which placed parts come off each other, from a scene's
contacts and the parts' boxes, without a kernel; and each piece's shift so that all are clear.

A screw leaves its thread along its own axis, on the side of its head; so does any turned part in a hole.
Other parts leave normal to their common faces, or else by the shortest way out of each other's boxes.

Along each axis the pieces' shifts u solve a linear program. A joint demands u[upper] - u[lower] >= length of
the way out + gap; across its axis its pieces should stay together. The objective is the sum of the joints'
excess lengths and, with a much larger weight, of the sideways separations. Pieces whose boxes overlap in the
solution get a joint of their own, and the program is solved again.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, product

import numpy as np

from tactcad.parts.language.description import Revolution
from tactcad.scenes.scene import Contact, Placement, Scene

from ..engine.boxes import Extent, box_of, moved_by

ROUNDS = 40  # rounds of finding overlaps and solving again
# cost of a millimetre: excess in a joint, sideways separation, deficit in a joint
SLACK, TORN, BROKEN = 1.0, 30.0, 1e4
TOUCH = 0.01  # mm: boxes that overlap by no more meet face to face


@dataclass(frozen=True)
class Piece:
    """A unit that moves as one in a view: a part, equal parts on each other, or a sub-assembly under its
    letter."""

    placements: tuple[Placement, ...]
    letter: str = ""

    def shifted(self, by: Sequence[float]) -> Piece:
        """Moved by a vector, mm."""
        return replace(self, placements=tuple(moved_by(p, by, 6) for p in self.placements))


@dataclass(frozen=True)
class _Limit:
    """u[upper] - u[lower] >= least (mm) along an axis."""

    lower: int
    upper: int
    axis: int
    least: float


def pieces_of(scene: Scene, placements: Sequence[Placement]) -> list[Piece]:
    """A piece for each part, equal parts that meet in one."""
    pieces: dict[str, list[Placement]] = {p.designator: [p] for p in placements}
    for c in scene.contacts:
        a, b = pieces.get(c.first), pieces.get(c.second)
        if a and b and a is not b and a[0].part.part_no == b[0].part.part_no:
            a += b
            pieces.update({p.designator: a for p in b})
    return [Piece(tuple(some)) for d, some in pieces.items() if some[0].designator == d]


def pulled_apart(scene: Scene, pieces: Sequence[Piece], gap: float, more: Mapping[int, float]) -> list[Piece]:
    """The pieces moved apart along their joints by `gap` mm or more, a piece (by index) by `more`."""
    owner = {p.designator: n for n, piece in enumerate(pieces) for p in piece.placements}
    boxes = {p.designator: box_of(p) for p in scene.placements}
    joints = joints_of(scene.placements, scene.contacts)
    own = [j for j in joints if j.lower in owner and j.upper in owner and owner[j.lower] != owner[j.upper]]
    kept = _kept_together(scene, pieces, owner, joints)

    def limit(lower: str, upper: str, axis: int) -> _Limit:
        i, k = owner[lower], owner[upper]
        extra = max(gap, more.get(i, 0.0), more.get(k, 0.0))
        return _Limit(i, k, axis, float(boxes[lower][1, axis] - boxes[upper][0, axis]) + extra)

    limits = [limit(j.lower, j.upper, j.axis) for j in own]
    count = len(pieces)
    for _ in range(ROUNDS):
        shifts = np.stack([_solved(count, axis, limits, kept) for axis in range(3)], axis=1)
        known = set(limits)
        fresh = []
        for a, b in _overlapping(pieces, boxes, shifts):
            lower, upper, axis = _sorted_out(a, b, boxes, own, owner)
            fresh.append(limit(lower.designator, upper.designator, axis))
        fresh = [p for p in fresh if p not in known]
        if not fresh:
            break
        limits += fresh
    return [piece.shifted(shift) for piece, shift in zip(pieces, shifts)]


def _kept_together(
    scene: Scene, pieces: Sequence[Piece], owner: Mapping[str, int], joints: Sequence[Joint]
) -> list[tuple[int, int, int]]:
    """Groups of pieces that move by the same along an axis: equal parts of a step that leave the same way."""
    at = {p.designator: p for p in scene.placements}
    pairs = []
    step = {d: n for n, s in enumerate(scene.steps) for d in s.designators}
    alike: dict[tuple, int] = {}
    for j in joints:
        for name, up in ((j.lower, False), (j.upper, True)):
            if name in owner and len(pieces[owner[name]].placements) == 1:
                key = (at[name].part.part_no, step.get(name), j.axis, up)
                first = alike.setdefault(key, owner[name])
                if first != owner[name]:
                    pairs.append((first, owner[name], j.axis))
    return pairs


def _solved(
    count: int, axis: int, limits: Sequence[_Limit], kept: Sequence[tuple[int, int, int]]
) -> np.ndarray:
    """Shifts along one axis, the first piece's zero."""
    from scipy.optimize import linprog

    along: dict[tuple[int, int], float] = {}
    for p in limits:
        if p.axis == axis:
            key = (p.lower, p.upper)
            along[key] = max(along.get(key, p.least), p.least)
    tied = {(p.lower, p.upper) for p in limits if p.axis != axis} - set(along)
    tied |= {(i, k) for i, k, a in kept if a == axis}
    ties = sorted({(min(t), max(t)) for t in tied})
    # unknowns: the shifts; each joint's deficit; each tie's separation, in both directions
    n, m, q = count, len(along), len(ties)
    cost = np.zeros(n + m + q)
    rows = np.zeros((m + 2 * q, n + m + q))
    most = np.zeros(m + 2 * q)
    for r, ((i, k), least) in enumerate(along.items()):
        cost[[i, k]] += -SLACK, SLACK
        cost[n + r] = BROKEN
        rows[r, [i, k, n + r]] = 1.0, -1.0, -1.0
        most[r] = -least
    for t, (i, k) in enumerate(ties):
        cost[n + m + t] = TORN
        for sign, r in ((1.0, m + 2 * t), (-1.0, m + 2 * t + 1)):
            rows[r, [i, k, n + m + t]] = sign, -sign, -1.0
    free = [(0.0, 0.0)] + [(-1e4, 1e4)] * (n - 1) + [(0.0, None)] * (m + q)
    limited = {"A_ub": rows, "b_ub": most} if len(rows) else {}
    solution = linprog(cost, **limited, bounds=free, method="highs")
    return np.round(solution.x[:n], 6)


def _overlapping(
    pieces: Sequence[Piece], boxes: Mapping[str, Extent], shifts: np.ndarray
) -> list[tuple[Placement, Placement]]:
    """One pair of parts for every two pieces whose boxes overlap, the earlier part first."""
    overlaps = []
    for i, k in combinations(range(len(pieces)), 2):
        for a, b in product(pieces[i].placements, pieces[k].placements):
            p, q = boxes[a.designator] + shifts[i], boxes[b.designator] + shifts[k]
            deep = np.minimum(p[1], q[1]) - np.maximum(p[0], q[0]) > TOUCH
            if deep.all() and a.part.part_no != b.part.part_no:
                overlaps.append((a, b))
                break
    return overlaps


def _sorted_out(
    a: Placement, b: Placement, boxes: Mapping[str, Extent], joints: Sequence[Joint], owner: Mapping[str, int]
) -> tuple[Placement, Placement, int]:
    """The lower one of two parts, and the axis.

    By a joint of their pieces; else as assembled, if one lies beyond the other along an axis on which either
    comes off (sideways it would leave its holding part behind); else the later one leaves along its own axis,
    as it came off.
    """
    ends = owner[a.designator], owner[b.designator]
    for j in joints:
        if (owner[j.lower], owner[j.upper]) in (ends, ends[::-1]):
            return (a, b, j.axis) if owner[j.lower] == ends[0] else (b, a, j.axis)
    p, q = boxes[a.designator], boxes[b.designator]
    beyond = np.maximum(q[0] - p[1], p[0] - q[1])
    ways = {j.axis for j in joints if not {owner[j.lower], owner[j.upper]}.isdisjoint(ends)} or {0, 1, 2}
    axis = max(ways, key=lambda k: beyond[k])
    if beyond[axis] >= -TOUCH:
        return (a, b, axis) if p[:, axis].sum() < q[:, axis].sum() else (b, a, axis)
    mine = [j for j in joints if ends[1] in (owner[j.lower], owner[j.upper])]
    axis, sign = way_off(a, b, boxes)
    if (turned := turning_axis(b)) is not None:
        axis = turned
    elif mine and axis not in {j.axis for j in mine}:
        axis = mine[0].axis
    along = next((j for j in mine if j.axis == axis), None)
    if along:
        sign = 1 if owner[along.upper] == ends[1] else -1
    return (a, b, axis) if sign > 0 else (b, a, axis)


@dataclass(frozen=True)
class Joint:
    """Part `upper` comes off part `lower` (designators) in the positive direction of an axis (0, 1, 2)."""

    lower: str
    upper: str
    axis: int


def joints_of(placements: Sequence[Placement], contacts: Sequence[Contact]) -> list[Joint]:
    """A joint for each contact. Touching parts of one number, such as stacked weights, have none."""
    at = {p.designator: p for p in placements}
    boxes = {name: box_of(p) for name, p in at.items()}
    leaving = {  # screws: axis and sign along which each leaves its thread
        c.first: (axis, 1 if boxes[c.first][:, axis].sum() > boxes[c.second][:, axis].sum() else -1)
        for c in contacts
        if c.kind == "thread" and (axis := turning_axis(at[c.first])) is not None
    }
    joints = []
    for c in contacts:
        if at[c.first].part.part_no == at[c.second].part.part_no:
            continue
        screw = next((name for name in (c.first, c.second) if name in leaving), None)
        pair = (c.second, c.first) if screw == c.first else (c.first, c.second)
        axis, sign = leaving[screw] if screw else way_off(at[c.first], at[c.second], boxes)
        joints.append(Joint(*(pair if sign > 0 else pair[::-1]), axis))
    return joints


def way_off(first: Placement, second: Placement, boxes: Mapping[str, Extent]) -> tuple[int, int]:
    """Axis and sign along which the second part comes off the first."""
    a, b = boxes[first.designator], boxes[second.designator]
    ways = np.array([a[1] - b[0], b[1] - a[0]])  # distance to go, up and down, along each axis
    axis = int(ways.min(axis=0).argmin())
    if ways[:, axis].min() > TOUCH:
        turned = [k for p in (first, second) if (k := turning_axis(p)) is not None and _inside(a, b, k)]
        axis = turned[-1] if turned else axis
    return axis, 1 if ways[0, axis] <= ways[1, axis] else -1


def turning_axis(p: Placement) -> int | None:
    """The scene's axis that is the axis of a turned part."""
    if not isinstance(p.part.body, Revolution):
        return None
    return int(np.abs([row[2] for row in p.rotation]).argmax())


def _inside(a: Extent, b: Extent, axis: int) -> bool:
    """Whether one's section across the axis lies inside the other's."""
    across = [k for k in range(3) if k != axis]
    return any(
        (p[0, across] >= q[0, across] - TOUCH).all() and (p[1, across] <= q[1, across] + TOUCH).all()
        for p, q in ((a, b), (b, a))
    )
