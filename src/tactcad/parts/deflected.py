"""An element as it stands while its pad is pushed: the arm turned rigidly about the hinge's centre.

A reference shape for collision checks and pictures, never for manufacture. The hinge bends over its
length; here it kinks at its centre, which moves the arm alike to first order in the angle.
"""

from __future__ import annotations

from dataclasses import replace
from math import asin, atan2, hypot, inf, pi, sqrt, tan

from tactcad.contour import Contour, Line, Point, Segment
from tactcad.contour.segment import turned
from tactcad.design.messages import InputError

from .description import Extrusion, Part
from .element import element
from .layout import ElementPlace, Layout


def deflected_element(layout: Layout, place: ElementPlace, deflection: float, roller: float) -> Part:
    """The element while a roller has pushed its pad up.

    The arm turns until the pad's face touches the roller: seen from the turned arm, the roller's centre
    (u, v) from the hinge is then at the height -(pad height + radius), which is
    A sin(phi + atan2(v, u)) = w with A = hypot(u, v).

    Parameters
    ----------
    layout, place
        The array, and the element in it.
    deflection
        Way of the roller since it touched the pad, mm.
    roller
        Its radius, mm; its axis is under the pad's middle.

    Raises
    ------
    InputError
        Where the arm cannot turn so far.
    """
    part = element(layout, place)
    z, w = _heights(layout, place, roller)
    u = -place.load_arm
    v = w + deflection
    if hypot(u, v) < -w:
        raise InputError(
            "deflection",
            "the arm cannot turn so far",
            value=deflection,
            legal=f"up to {-w - sqrt(max(w**2 - u**2, 0.0)):.3g} mm",
        )
    # the arm's direction from the hinge lies in the left half-plane: phi + atan2(v, u) there too
    angle = -(-pi - asin(w / hypot(u, v)) - atan2(v, u))
    outer = _bent(part.extrusion.outer, (place.hinge_x, z), angle)
    return replace(
        part,
        part_no=f"{part.part_no}-at-{deflection:g}mm",
        name=f"{part.name}, deflected {deflection:g}",
        process="reference",
        body=Extrusion(outer, part.extrusion.thickness, part.extrusion.openings),
        notes=("deflected state, for collision checks only",),
        characteristics=(),
        geometric=(),
        datums=(),
        finish="",
    )


def deflection_at_pad_edge(layout: Layout, place: ElementPlace, roller: float) -> float:
    """Deflection (mm) at which the arm has turned so far that a roller (radius in mm) meets the pad's edge.

    Seen from the turned arm the roller's centre comes nearer to the hinge: to A' with A'^2 + w^2 = A^2 + (w +
    d)^2. It is on the pad while A - A' is at most half the pad's length p, so d^2 + 2 w d + A p - p^2/4 = 0.
    Infinite where no deflection moves it that far.
    """
    _, w = _heights(layout, place, roller)
    half = layout.design.element.pad_length / 2
    c = 2 * place.load_arm * half - half**2
    return -w - sqrt(w**2 - c) if c < w**2 else inf


def _heights(layout: Layout, place: ElementPlace, roller: float) -> tuple[float, float]:
    """The hinge's centre over the flat face, and the roller's over it while it touches the pad of the arm at
    rest, mm."""
    z = place.hinge.t / 2 if layout.design.element.sides == "one" else place.hinge.h / 2
    return z, -layout.design.element.pad_height - roller - z


def _bent(contour: Contour, hinge: Point, angle: float) -> Contour:
    """The contour with everything left of the hinge's centre turned about it.

    Where the contour passes the hinge, a stretch slightly longer than the rotation shortens becomes a chord.
    """
    pieces: list[Segment] = []
    for s in contour:
        left_first, left_last = s.start[0] < hinge[0], s.end[0] < hinge[0]
        if left_first == left_last:
            pieces.append(turned(s, hinge, angle) if left_first else s)
            continue
        half = 2 * abs(s.at(_where(s, hinge[0]))[1] - hinge[1]) * tan(abs(angle))
        sign = -1.0 if left_first else 1.0
        first = replace(s, end=s.at(_where(s, hinge[0] + sign * half)))
        last = replace(s, start=s.at(_where(s, hinge[0] - sign * half)))
        if left_first:
            first = turned(first, hinge, angle)
        else:
            last = turned(last, hinge, angle)
        pieces += [first, Line(first.end, last.start, s.name), last]
    return Contour(tuple(pieces))


def _where(s: Segment, x: float) -> float:
    """Parameter at which a segment that runs from one side of x to the other passes it."""
    low, high = 0.0, 1.0
    rising = s.end[0] > s.start[0]
    for _ in range(60):
        middle = (low + high) / 2
        if (s.at(middle)[0] < x) == rising:
            low = middle
        else:
            high = middle
    return (low + high) / 2
