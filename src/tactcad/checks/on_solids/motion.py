"""Whether anything collides while a scene moves: along the whole way of every stated motion, not only in
poses.

A pair that moves against each other is skipped while its boxes stay apart. For the rest the kernel gives the
distance d at a place of the way, and the pair cannot meet before it has moved by d: steps of that length
cover the whole way without gaps, however thin the parts are. Distances are first taken between envelopes
(parts without their holes and pockets), which can only be smaller.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from math import hypot

import numpy as np
from OCP.BRepAlgoAPI import BRepAlgoAPI_Common
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.TopoDS import TopoDS_Shape

from tactcad.checks.on_solids.interference import OVERLAP_MM3, TOUCH_MM, placed_box, relative
from tactcad.parts.language.description import Vector, envelope, vector
from tactcad.parts.language.finding import Finding
from tactcad.scenes.scene import Motion, Placement, Scene
from tactcad.solids.build import build
from tactcad.solids.measure import bounding_box, volume
from tactcad.solids.occt import location

from ..check import Check, Job

# A pair that slides along at less than its way over this many steps is reported as not shown to be free.
MOST_STEPS = 400
# Places at which parts that are meant to touch are looked at: both ends, and in between.
SLIDING = 5

Shapes = Mapping[str, TopoDS_Shape]


@dataclass(frozen=True)
class _Meeting:
    first: Placement
    second: Placement
    start: Vector  # second's offset as first sees it, in scene directions
    end: Vector

    def offset(self, t: float) -> Vector:
        return vector(a + t * (b - a) for a, b in zip(self.start, self.end))

    @property
    def way(self) -> float:
        return hypot(*(b - a for a, b in zip(self.start, self.end)))


def check_motions(scene: Scene, full: Shapes, envelope: Shapes) -> list[Finding]:
    """Findings on every motion of the scene; `full` and `envelope` are shapes by part number in their own
    frames."""
    boxes = {part.part_no: bounding_box(full[part.part_no]) for part in scene.parts}
    placed = {p.designator: placed_box(p, boxes[p.part.part_no]) for p in scene.placements}
    meant = {frozenset((c.first, c.second)): c.kind for c in scene.contacts}
    known: dict[tuple, tuple[float, str] | None] = {}
    findings = []
    for motion in scene.motions:
        for pair in _moving_pairs(scene, motion):
            span = _span(placed[pair.first.designator], placed[pair.second.designator], pair)
            if span is None:
                continue
            kind = meant.get(frozenset((pair.first.designator, pair.second.designator)), "")
            key = (
                pair.first.part.part_no,
                pair.second.part.part_no,
                relative(pair.first, pair.second),
                kind,
                pair.start,
                pair.end,
                pair.first.rotation,
            )
            if key not in known:
                known[key] = _slides(pair, full) if kind else _meets(pair, span, full, envelope)
            hit = known[key]
            if hit:
                findings.append(_finding(motion, pair, *hit))
    return findings


def _moving_pairs(scene: Scene, motion: Motion) -> Iterator[_Meeting]:
    """Pairs of different groups that are not at rest, as placed, over the whole motion."""
    group = {d: name for name, members in scene.groups for d in members}
    still = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    ways: dict[str | None, tuple[Vector, Vector]] = {name: (start, end) for name, start, end in motion.ways}
    for i, a in enumerate(scene.placements):
        for b in scene.placements[i + 1 :]:
            ga, gb = group.get(a.designator), group.get(b.designator)
            if ga == gb:
                continue
            (a0, a1), (b0, b1) = ways.get(ga, still), ways.get(gb, still)
            start = vector(q - p for p, q in zip(a0, b0))
            end = vector(q - p for p, q in zip(a1, b1))
            if any(start) or any(end):
                yield _Meeting(a, b, start, end)


def _span(a: np.ndarray, b: np.ndarray, pair: _Meeting) -> tuple[float, float] | None:
    """The part of the way, within 0 to 1, in which the boxes meet; None if they never do."""
    low, high = 0.0, 1.0
    for axis in range(3):
        gap0 = a[0, axis] - b[1, axis] - TOUCH_MM  # they meet while gap0 <= offset <= gap1
        gap1 = a[1, axis] - b[0, axis] + TOUCH_MM
        p, v = pair.start[axis], pair.end[axis] - pair.start[axis]
        if v == 0:
            if not gap0 <= p <= gap1:
                return None
            continue
        t0, t1 = sorted(((gap0 - p) / v, (gap1 - p) / v))
        low, high = max(low, t0), min(high, t1)
    return (low, high) if low <= high else None


def _meets(
    pair: _Meeting, span: tuple[float, float], full: Shapes, envelope: Shapes
) -> tuple[float, str] | None:
    """Place on the way of an unintended meeting of the pair; None if it is shown not to meet."""
    t, end = span
    for _ in range(MOST_STEPS):
        free = _distance(pair, t, envelope)
        if free <= 10 * TOUCH_MM:
            free = _distance(pair, t, full)
        if free < TOUCH_MM:
            return t, "meet"
        if pair.way == 0 or t >= end:
            return None
        t = min(end, t + free / pair.way)
    return t, f"run closer than {pair.way / MOST_STEPS:.2g} mm: not shown to stay apart"


def _slides(pair: _Meeting, full: Shapes) -> tuple[float, str] | None:
    """Parts that are meant to touch somewhere: they may slide on each other, and may not cut into each
    other."""
    for n in range(SLIDING):
        t = n / (SLIDING - 1)
        a, b = _shapes(pair, t, full)
        if volume(BRepAlgoAPI_Common(a, b).Shape()) > OVERLAP_MM3:
            return t, "cut into each other"
    return None


def _distance(pair: _Meeting, t: float, shapes: Shapes) -> float:
    return BRepExtrema_DistShapeShape(*_shapes(pair, t, shapes)).Value()


def _shapes(pair: _Meeting, t: float, shapes: Shapes) -> tuple[TopoDS_Shape, TopoDS_Shape]:
    a, b = pair.first, pair.second
    moved = vector(o + d for o, d in zip(b.origin, pair.offset(t)))
    return (
        shapes[a.part.part_no].Located(location(a.origin, a.rotation)),
        shapes[b.part.part_no].Located(location(moved, b.rotation)),
    )


def _finding(motion: Motion, pair: _Meeting, t: float, what: str) -> Finding:
    a, b = pair.first, pair.second
    message = (
        f"{a.designator} ({a.part.part_no}) and {b.designator} ({b.part.part_no}) {what} at {100 * t:.0f} % "
        f"of the motion '{motion.name}'"
    )
    return Finding("motion", "fail", a.designator, pair.offset(t), t, 0.0, message)


def _with_envelopes(scene: Scene, job: Job) -> list[Finding]:
    """Findings on the scene's motions, its parts' envelopes made if they are not known; a part that
    nothing is cut into is its own."""
    for part in scene.parts:
        if part.part_no not in job.envelopes:
            outside = replace(envelope(part), part_no=f"{part.part_no}, envelope")
            own = outside.body == part.body and not part.features
            job.envelopes[part.part_no] = job.shapes[part.part_no] if own else build(outside)
    return check_motions(scene, job.shapes, job.envelopes)


CHECKS = (Check("motion", "scene", _with_envelopes, place=30, applies=lambda scene: bool(scene.motions)),)
