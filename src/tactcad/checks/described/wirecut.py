"""Whether a wire-EDM shop can cut a part: rules on its exact contour, with limits from the shop's own file.

A hinge is intentionally thinner than any general wall: that is a flag for the quotation, not a failure.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import combinations
from math import dist

from tactcad.checks.shop import Shop
from tactcad.contour import Arc, Contour, Point
from tactcad.contour.contour import ROUNDING_MM
from tactcad.contour.inside import (
    crossings,
    encloses,
    place_for_circle,
    self_intersections,
    smallest_distance,
)
from tactcad.contour.necks import SAME_DIRECTION, Neck, direction, necks
from tactcad.design.materials import family
from tactcad.parts.language.description import Part, section
from tactcad.parts.language.finding import Finding

from ..check import Check

# The CAD kernel fuses points closer than this (measured), and no shop resolves it.
TOUCHING_MM = 1e-6
# Contour pieces that bound a hinge, as the element names them.
_HINGE_FACE = re.compile(r"(front_)?slot_(floor|(arm|body)_fillet)|hinge_face")


@dataclass(frozen=True)
class _Cut:
    """A part as the wire sees it: contours with the material on their left."""

    part: Part
    shop: Shop
    outer: Contour
    openings: tuple[Contour, ...]

    @property
    def contours(self) -> tuple[Contour, ...]:
        return (self.outer, *self.openings)

    def fail(self, check: str, place: Point, value: float, limit: float, message: str) -> Finding:
        return Finding(check, "fail", self.part.part_no, place, value, limit, message)

    def flag(self, check: str, place: Point, value: float, limit: float, message: str) -> Finding:
        return Finding(check, "flag", self.part.part_no, place, value, limit, message)


def check_wirecut(part: Part, shop: Shop) -> list[Finding]:
    """Findings of every rule for a wire-cut part; an empty list if there is nothing to say.

    Rules on widths are tried only on simple contours: otherwise widths have no meaning. Raises TypeError if
    the part is not an extrusion.
    """
    outer, openings = section(part)
    cut = _Cut(
        part,
        shop,
        outer if outer.ccw else outer.reversed(),
        tuple(c.reversed() if c.ccw else c for c in openings),
    )
    shape = [finding for rule in (closed_chain, simple_contour, openings_inside) for finding in rule(cut)]
    return shape or [finding for rule in RULES for finding in rule(cut)]


def closed_chain(cut: _Cut) -> Iterator[Finding]:
    """Every arc ends on its own circle: only then does the written file close."""
    for contour in cut.contours:
        for s in contour:
            gap = abs(dist(s.end, s.centre) - s.radius) if isinstance(s, Arc) else 0.0
            if gap > ROUNDING_MM:
                yield cut.fail(
                    "closed chain", s.end, gap, ROUNDING_MM, f"the arc misses its end point by {gap:.3g} mm"
                )


def simple_contour(cut: _Cut) -> Iterator[Finding]:
    """No contour crosses or touches itself."""
    for contour in cut.contours:
        crossed = self_intersections(contour)
        if crossed:
            yield cut.fail(
                "simple contour", crossed[0], 0.0, TOUCHING_MM, "the contour crosses or touches itself"
            )
        elif (gap := smallest_distance(contour)) < TOUCHING_MM:
            at = contour.segments[0].start
            yield cut.fail(
                "simple contour", at, gap, TOUCHING_MM, f"the contour comes within {gap:.3g} mm of itself"
            )


def openings_inside(cut: _Cut) -> Iterator[Finding]:
    """Openings lie inside the outline and outside each other."""
    for opening in cut.openings:
        if not encloses(cut.outer, opening):
            at = opening.segments[0].start
            yield cut.fail("openings inside", at, 0.0, 0.0, "the opening is not inside the outline")
    for a, b in combinations(cut.openings, 2):
        if crossings(a, b) or encloses(a, b) or encloses(b, a):
            at = b.segments[0].start
            yield cut.fail("openings inside", at, 0.0, 0.0, "the opening meets another opening")


def inside_corners(cut: _Cut) -> Iterator[Finding]:
    """An inside corner is at least as round as the wire with its spark gap."""
    limit = cut.shop.limits.corner_radius
    for contour in cut.contours:
        for before, s in zip((contour.segments[-1], *contour), contour):
            a, b = direction(before, s.start), direction(s, s.start)
            if a[0] * b[1] - a[1] * b[0] < -SAME_DIRECTION:
                yield _corner(cut, s.start, 0.0, limit)
            if isinstance(s, Arc) and not s.ccw and s.radius < limit - ROUNDING_MM:
                yield _corner(cut, s.at(0.5), s.radius, limit)


def _corner(cut: _Cut, at: Point, radius: float, limit: float) -> Finding:
    what = f"inside radius {radius:.3f} mm" if radius else "sharp inside corner"
    wire = f"wire/2 + spark gap = {limit:.3f} mm ({cut.shop.source['wire_diameter']})"
    return cut.fail("inside corner", at, radius, limit, f"{what}, but the wire leaves {wire}")


def slots(cut: _Cut) -> Iterator[Finding]:
    """Slots and openings are at least one cut wide, and better a little wider."""
    limits, source = cut.shop.limits, cut.shop.source
    for neck in _necks(cut, "void", max(limits.slot, limits.advised_slot)):
        width = f"{neck.width:.3f} mm wide{_between(neck)}"
        if neck.width < limits.slot - ROUNDING_MM:
            text = f"{width}, but one cut takes {limits.slot:.3f} mm ({source['wire_diameter']})"
            yield cut.fail("slot width", neck.middle, neck.width, limits.slot, text)
        else:
            text = f"{width}: design for {limits.advised_slot:.3f} mm ({source['advised_slot']})"
            yield cut.flag("slot width", neck.middle, neck.width, limits.advised_slot, text)


def walls(cut: _Cut) -> Iterator[Finding]:
    """Free-standing walls are thick enough; a hinge is flagged with the note for its quotation."""
    limits, source = cut.shop.limits, cut.shop.source
    field = "wall_aluminium" if family(cut.part.material.density) == "aluminium" else "wall"
    limit = getattr(limits, field)
    hinges = []
    for neck in _necks(cut, "material", limit):
        if any(map(_HINGE_FACE.fullmatch, neck.names)):
            hinges.append(neck)
        else:
            text = f"{neck.width:.3f} mm thick{_between(neck)}, walls need {limit:.3f} mm ({source[field]})"
            yield cut.fail("wall", neck.middle, neck.width, limit, text)
    if hinges:
        yield _hinge(cut, hinges[0], limit)


def _hinge(cut: _Cut, neck: Neck, wall: float) -> Finding:
    thinnest = cut.shop.limits.thinnest_published_web
    text = (
        f"hinge {neck.width:.3f} mm thick, slot {_slot_length(cut):.3f} mm long, under the general wall "
        f"of {wall:.3f} mm: quote the passes that its limits ask for, both hinge faces skimmed, the order of "
        "cuts, and the holding tab"
    )
    if neck.width < thinnest:
        published = cut.shop.source["thinnest_published_web"]
        text += f"; thinner than any published web known here ({thinnest:.3f} mm, {published})"
    return cut.flag("hinge", neck.middle, neck.width, wall, text)


def _slot_length(cut: _Cut) -> float:
    """Length of the slot's bottom along the arm (x), mm."""
    xs = [p[0] for s in cut.outer if _HINGE_FACE.fullmatch(s.name) for p in (s.start, s.end)]
    return max(xs) - min(xs)


def start_holes(cut: _Cut) -> Iterator[Finding]:
    """The wire can be threaded through every opening."""
    needed = cut.shop.limits.start_hole
    for opening in cut.openings:
        if place_for_circle(opening, needed) is None:
            at, source = opening.centroid, cut.shop.source["start_hole"]
            text = f"no start hole of {needed:.3f} mm fits into the opening ({source})"
            yield cut.fail("start hole", at, 0.0, needed, text)


RULES: tuple[Callable[[_Cut], Iterator[Finding]], ...] = (inside_corners, slots, walls, start_holes)


def _necks(cut: _Cut, within: str, below: float) -> list[Neck]:
    narrow = necks(cut.outer, cut.openings, below - ROUNDING_MM)
    return [neck for neck in narrow if neck.within == within]


def _between(neck: Neck) -> str:
    names = [name for name in neck.names if name]
    return f" between {' and '.join(names)}" if len(names) == 2 else ""


CHECKS = (
    Check(
        "wire-cut",
        "part",
        lambda part, job: check_wirecut(part, job.shop),
        place=40,
        applies=lambda part: part.process == "wire-cut",
    ),
)
