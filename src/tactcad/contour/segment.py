"""Exact plane segments: lines and circular arcs, in mm.

End points are stored, never computed, so that neighbours in a chain share them bit for bit.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import atan2, cos, hypot, pi, sin, tau

Point = tuple[float, float]
# mm: a tenth of the finest step that any shop works to (0.01 mm), with room for the rounding of sums of
# decimals.
LEAST_EDGE, LOST = 1e-3, 1e-9


def is_sliver(length: float) -> bool:
    """Whether an edge of that length (mm) is too short for wire and kernel; rules and checks both ask
    here.
    """
    return length < LEAST_EDGE - LOST


@dataclass(frozen=True)
class Line:
    """Straight segment from start to end (mm); `name` is the feature that it bounds."""

    start: Point
    end: Point
    name: str = ""

    @property
    def length(self) -> float:
        """Length in mm."""
        return hypot(self.end[0] - self.start[0], self.end[1] - self.start[1])

    def at(self, u: float) -> Point:
        """Point at parameter u, 0 at the start and 1 at the end."""
        (x0, y0), (x1, y1) = self.start, self.end
        return (x0 + u * (x1 - x0), y0 + u * (y1 - y0))

    def reversed(self) -> Line:
        return Line(self.end, self.start, self.name)


@dataclass(frozen=True)
class Arc:
    """Circular arc from start to end about centre (mm), counter-clockwise where ccw is true.

    Sweep is more than 0 and at most 360 degrees; equal ends mean the full circle.
    """

    start: Point
    end: Point
    centre: Point
    ccw: bool
    name: str = ""

    @cached_property
    def radius(self) -> float:
        """Radius in mm, measured at the start."""
        return hypot(self.start[0] - self.centre[0], self.start[1] - self.centre[1])

    @cached_property
    def start_angle(self) -> float:
        """Direction from centre to start, radians in (-pi, pi]."""
        return atan2(self.start[1] - self.centre[1], self.start[0] - self.centre[0])

    @cached_property
    def end_angle(self) -> float:
        """Direction from centre to end, radians in (-pi, pi]."""
        return atan2(self.end[1] - self.centre[1], self.end[0] - self.centre[0])

    @cached_property
    def sweep(self) -> float:
        """Signed angle in radians: positive counter-clockwise, of magnitude in (0, 2 pi]."""
        if self.start == self.end:
            return tau if self.ccw else -tau
        turn = (self.end_angle - self.start_angle) % tau
        return turn if self.ccw else turn - tau

    @cached_property
    def length(self) -> float:
        """Arc length in mm."""
        return self.radius * abs(self.sweep)

    def at(self, u: float) -> Point:
        """Point at parameter u, 0 at the start and 1 at the end; the ends are exact."""
        if u in (0.0, 1.0):
            return self.end if u else self.start
        angle, r = self.start_angle + u * self.sweep, self.radius
        return (self.centre[0] + r * cos(angle), self.centre[1] + r * sin(angle))

    def spans(self, angle: float) -> bool:
        """Whether the direction `angle` (radians) lies on the arc, its ends included."""
        turn = (angle - self.start_angle) % tau if self.ccw else (self.start_angle - angle) % tau
        return turn <= abs(self.sweep) or tau - turn < 1e-12 * pi

    def reversed(self) -> Arc:
        return Arc(self.end, self.start, self.centre, not self.ccw, self.name)


Segment = Line | Arc


def rotated(p: Point, centre: Point, angle: float) -> Point:
    """The point turned counter-clockwise about a centre, radians."""
    x, y = p[0] - centre[0], p[1] - centre[1]
    return (centre[0] + x * cos(angle) - y * sin(angle), centre[1] + x * sin(angle) + y * cos(angle))


def turned(s: Segment, centre: Point, angle: float) -> Segment:
    """The segment turned counter-clockwise about a centre, radians."""
    return mapped(s, lambda p: rotated(p, centre, angle))


def mapped(s: Segment, at: Callable[[Point], Point], mirrored: bool = False) -> Segment:
    """The segment with its points moved by a motion of the plane, which may turn it over."""
    if isinstance(s, Line):
        return Line(at(s.start), at(s.end), s.name)
    return Arc(at(s.start), at(s.end), at(s.centre), s.ccw != mirrored, s.name)


def direction(s: Segment, p: Point) -> Point:
    """Unit direction in which the segment runs at one of its points."""
    if isinstance(s, Line):
        dx, dy = s.end[0] - s.start[0], s.end[1] - s.start[1]
    else:
        turn = 1 if s.ccw else -1
        dx, dy = -turn * (p[1] - s.centre[1]), turn * (p[0] - s.centre[0])
    size = hypot(dx, dy)
    return (dx / size, dy / size)
