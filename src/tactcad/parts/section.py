"""The section of an extruded part, as it is cut."""

from __future__ import annotations

from tactcad.contour import Contour, circle

from .description import Extrusion, Hole, Part


def section(part: Part) -> tuple[Contour, tuple[Contour, ...]]:
    """Outline and openings of an extruded part, its through holes along the thickness included.

    Raises TypeError where the part is not an extrusion.
    """
    if not isinstance(part.body, Extrusion):
        raise TypeError(f"{part.part_no} is not an extrusion: it has no one section to cut")
    holes = tuple(
        circle(f.at[:2], f.diameter, f.name)
        for f in part.features
        if isinstance(f, Hole) and f.through and f.axis[:2] == (0.0, 0.0)
    )
    return part.body.outer, part.body.openings + holes


def cut_section(part: Part) -> Extrusion:
    """What the wire leaves of a wire-cut part before anything else is done to it: its section, extruded."""
    outer, openings = section(part)
    return Extrusion(outer, part.body.thickness, openings)
