"""An element as it stands while its pad is pushed: the arm turned rigidly about the hinge's centre.

A reference shape for collision checks and pictures, never for manufacture. The hinge bends over its
length; here it kinks at its centre, which moves the arm alike to first order in the angle.
"""

from __future__ import annotations

from dataclasses import replace
from math import asin, atan2, cos, hypot, pi, sin

from tactcad.contour import Arc, Contour, Line, Point, Segment

from .description import Extrusion, Part
from .element import element
from .layout import ElementPlace, Layout


def deflected_element(layout: Layout, place: ElementPlace, deflection: float, roller: float) -> Part:
    """The element while a roller (radius in mm, its axis under the pad's middle) has come up by `deflection` mm.

    The arm turns until the pad's face touches the roller: seen from the turned arm, the roller's centre
    (u, v) from the hinge has come to the height -(pad height + radius) that touching means, which is
    A sin(phi + atan2(v, u)) = w with A = hypot(u, v).
    """
    part = element(layout, place)
    t, h = place.hinge.t, place.hinge.h
    z = t / 2 if layout.design.element.sides == "one" else h / 2
    u = -place.load_arm
    w = -layout.design.element.pad_height - roller - z
    v = w + deflection
    # the arm's direction from the hinge lies in the left half-plane: phi + atan2(v, u) there too
    angle = -(-pi - asin(w / hypot(u, v)) - atan2(v, u))
    outer = _bent(part.body.outer, (place.hinge_x, z), angle)
    return replace(
        part,
        part_no=f"{part.part_no}-at-{deflection:g}mm",
        name=f"{part.name}, deflected {deflection:g}",
        process="reference",
        body=Extrusion(outer, part.body.thickness, part.body.openings),
        notes=("deflected state, for collision checks only",),
        characteristics=(),
        finish="",
    )


def _bent(contour: Contour, hinge: Point, angle: float) -> Contour:
    """The contour with everything left of the hinge's centre turned about it."""
    pieces: list[Segment] = []
    for s in contour:
        a, b = s.start[0] < hinge[0], s.end[0] < hinge[0]
        if a == b:
            pieces.append(_turned(s, hinge, angle) if a else s)
            continue
        if isinstance(s, Arc):  # both fillets meet at the hinge's centre: a full round is split there
            middle = s.at(0.5)
            first, second = replace(s, end=middle), replace(s, start=middle)
        else:
            share = (hinge[0] - s.start[0]) / (s.end[0] - s.start[0])
            middle = (hinge[0], s.start[1] + share * (s.end[1] - s.start[1]))
            first, second = replace(s, end=middle), replace(s, start=middle)
        kept, turned = (second, first) if a else (first, second)
        moved = _turned(turned, hinge, angle)
        joint = _rotated(middle, hinge, angle)
        bridge = Line(joint, middle) if a else Line(middle, joint)
        pieces += [moved, bridge, kept] if a else [kept, bridge, moved]
    return Contour(tuple(pieces))


def _turned(s: Segment, centre: Point, angle: float) -> Segment:
    ends = {"start": _rotated(s.start, centre, angle), "end": _rotated(s.end, centre, angle)}
    if isinstance(s, Arc):
        return replace(s, centre=_rotated(s.centre, centre, angle), **ends)
    return replace(s, **ends)


def _rotated(p: Point, centre: Point, angle: float) -> Point:
    x, y = p[0] - centre[0], p[1] - centre[1]
    return (centre[0] + x * cos(angle) - y * sin(angle), centre[1] + x * sin(angle) + y * cos(angle))
