"""Do pressed arms stay clear of their own body and of the opposite arm?

Exact on the contours, no kernel. A pressed arm is turned rigidly about the hinge's centre, as far as its stop
lets it: to its gap and tolerance at the tip. It moves in its own plane: from its neighbours and the end plates
it stays as far as it stands, which is the spacer's thickness and part of the check of interference.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import cache
from math import asin, cos, sin

from tactcad.contour import Arc, Contour, Point, Segment
from tactcad.contour.nearest import distance
from tactcad.design.tree import Design
from tactcad.parts.element import outline
from tactcad.parts.layout import ElementPlace, Layout
from tactcad.parts.stop_gap import stop_gap

from .finding import Finding


def check_clearance(design: Design) -> list[Finding]:
    """Findings on every element, pressed and at rest, against its body and the opposite arms.

    Nearer than the design's tolerances is too near: two pad edges may each be off by [tolerance] load_arm.
    """
    layout = Layout(design)
    arms = _Arms(layout)
    return [*_own_body(layout, arms), *_opposite(layout, arms)]


class _Arms:
    """Arms of the layout's elements, each shape cut off and turned once."""

    def __init__(self, layout: Layout) -> None:
        self.layout = layout
        self.contour = cache(lambda arm, hinge, gap: outline(layout, arm, hinge, gap))

    def of(self, place: ElementPlace, pressed: bool) -> tuple[Segment, ...]:
        """Every segment that moves with the arm, in (x, z) of row one."""
        layout = self.layout
        gap = stop_gap(layout, place)
        arm = _left_of(self.contour(place.arm, place.hinge, gap), place.hinge_x)
        if not pressed:
            return tuple(arm)
        two = layout.design.element.sides == "two"
        centre = (place.hinge_x, place.hinge.h / 2 if two else place.hinge.t / 2)
        turn = asin((gap + layout.design.stop.tolerance) / place.arm)
        return tuple(_turned(s, centre, turn) for s in arm)

    def body(self, place: ElementPlace) -> list[Segment]:
        contour = self.contour(place.arm, place.hinge, stop_gap(self.layout, place))
        return [s for s in contour if s.name in ("slot_body_wall", "ledge", "front_slot_body_wall", "clamp_edge")]


def _left_of(contour: Contour, x: float) -> Iterable[Segment]:
    """Segments wholly on the arm's side; what bends with the hinge itself is left out."""
    hinge = ("slot_floor", "hinge_face", "slot_arm_fillet", "front_slot_arm_fillet")
    return (s for s in contour if s.start[0] < x and s.end[0] < x and s.name not in hinge)


def _turned(s: Segment, centre: Point, angle: float) -> Segment:
    """Turned clockwise: an arm that points towards - x goes up."""
    ends = {"start": _point(s.start, centre, angle), "end": _point(s.end, centre, angle)}
    return replace(s, centre=_point(s.centre, centre, angle), **ends) if isinstance(s, Arc) else replace(s, **ends)


def _point(p: Point, centre: Point, angle: float) -> Point:
    x, z = p[0] - centre[0], p[1] - centre[1]
    return (centre[0] + x * cos(angle) + z * sin(angle), centre[1] - x * sin(angle) + z * cos(angle))


def _mirrored(s: Segment) -> Segment:
    """Row two as row one sees it: x to the other side."""
    flip = lambda p: (-p[0], p[1])  # noqa: E731
    if isinstance(s, Arc):
        return Arc(flip(s.start), flip(s.end), flip(s.centre), not s.ccw, s.name)
    return replace(s, start=flip(s.start), end=flip(s.end))


def _nearest(some: Iterable[Segment], others: Iterable[Segment]) -> float:
    others = tuple(others)
    return min(distance(a, b) for a in some for b in others)


def _own_body(layout: Layout, arms: _Arms) -> Iterable[Finding]:
    seen: dict[tuple, float] = {}
    for place in layout.elements:
        key = (place.arm, place.hinge)
        if key not in seen:
            seen[key] = _nearest(arms.of(place, pressed=True), arms.body(place))
        limit = layout.design.tolerance.hinge_length
        if seen[key] <= limit:
            yield _finding(place, seen[key], limit, "its own body: the slot closes before the stop does")


def _opposite(layout: Layout, arms: _Arms) -> Iterable[Finding]:
    limit = 2 * layout.design.tolerance.load_arm
    seen: dict[tuple, float] = {}
    first, second = ([p for p in layout.elements if p.row == row] for row in (1, 2))
    thickness = layout.design.sheet.thickness
    for a in first:
        for b in (b for b in second if abs(a.y - b.y) < thickness):
            key = (a.arm, a.hinge, b.arm, b.hinge)
            if key not in seen:
                seen[key] = min(
                    _nearest(arms.of(a, one), map(_mirrored, arms.of(b, other)))
                    for one in (False, True) for other in (False, True)
                )
            if seen[key] <= limit:
                yield _finding(a, seen[key], limit, f"the opposite arm of {b.designator}")


def _finding(place: ElementPlace, value: float, limit: float, what: str) -> Finding:
    message = f"pressed onto its stop the arm comes within {value:.3f} mm of {what}; tolerances take {limit:.3f} mm"
    return Finding("clearance", "fail", place.designator, (place.hinge_x - place.arm, 0.0), value, limit, message)
