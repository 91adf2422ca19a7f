"""A part's surface area in closed form, so that it can be compared without a CAD kernel."""

from __future__ import annotations

from math import hypot, pi, sin

from tactcad.contour import Contour, Line, Point, Segment
from tactcad.contour.nearest import distance_to

from .description import Extrusion, Hole, ModelFile, Part, Pocket, Revolution, drill_point_height

ON_OUTLINE = 1e-9  # mm: a pocket whose side is nearer than this to the outline is open on that side


def surface_area(part: Part) -> float | None:
    """Area of the whole surface, mm2; None for a part whose shape is only known from a file.

    Features start and end on flat faces and do not meet each other, as for the volume; a pocket along the
    thickness may be open at the outline.
    """
    body = part.body
    if isinstance(body, ModelFile):
        return None
    stock = _extruded(body) if isinstance(body, Extrusion) else _revolved(body)
    return stock + sum(_hole(f) if isinstance(f, Hole) else _pocket(f, body) for f in part.features)


def _extruded(body: Extrusion) -> float:
    return 2 * body.section_area + body.cut_length * body.thickness


def _revolved(body: Revolution) -> float:
    """Pappus: 2 pi times the profile's integral of r along its length; what lies on the axis adds nothing."""
    return 2 * pi * sum(_radius_integral(s) for s in body.profile)


def _radius_integral(s: Segment) -> float:
    if isinstance(s, Line):
        return s.length * (s.start[0] + s.end[0]) / 2
    first, last = s.start_angle, s.start_angle + s.sweep
    r, turn = s.radius, 1.0 if s.sweep > 0 else -1.0
    return turn * (s.centre[0] * r * (last - first) + r * r * (sin(last) - sin(first)))


def _hole(hole: Hole) -> float:
    """Walls added less discs taken off the faces: a blind hole's flat floor replaces the disc it took."""
    r = hole.diameter / 2
    area = 2 * pi * r * hole.depth
    if hole.counterbore:
        wide, deep = hole.counterbore
        area += pi * (wide - hole.diameter) * deep  # its ring-shaped floor replaces what it took
    if hole.drill_point:
        area += pi * r * (hypot(r, drill_point_height(hole.diameter)) - r)
    if hole.through:
        area -= 2 * pi * r * r
    return area


def _pocket(pocket: Pocket, body: Extrusion | Revolution) -> float:
    """Walls added, less the stock's own wall where the pocket is open; its floor replaces what it took."""
    walls = sum(c.length for c in pocket.island) + pocket.contour.length
    if isinstance(body, Extrusion) and abs(pocket.axis[2]) == 1.0:
        walls -= 2 * sum(s.length for s in pocket.contour if _on_outline(s, pocket, body.outer))
    return walls * pocket.depth


def _on_outline(s: Segment, pocket: Pocket, outline: Contour) -> bool:
    """Whether the pocket's side lies on the stock's outline: both ends and the middle do, on one segment."""
    points = [_in_section(s.at(u), pocket) for u in (0.0, 0.5, 1.0)]
    return any(all(distance_to(o, p) < ON_OUTLINE for p in points) for o in outline)


def _in_section(p: Point, pocket: Pocket) -> Point:
    """A point of the pocket's contour in the stock's x and y: at + p_x x_axis + p_y (axis x x_axis)."""
    (x0, y0, _), (ux, uy, _), up = pocket.at, pocket.x_axis, pocket.axis[2]
    return (x0 + p[0] * ux - p[1] * up * uy, y0 + p[0] * uy + p[1] * up * ux)
