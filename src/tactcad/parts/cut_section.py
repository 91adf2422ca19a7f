"""The section of an extruded part, as it is cut from sheet or plate."""

from __future__ import annotations

from tactcad.contour import Contour, circle

from .description import Extrusion, Hole, Part, Pocket


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


def cut_section(part: Part) -> Extrusion | None:
    """The section that a part's cut file describes, extruded; None where the part has no cut file.

    Wire-cut parts are cut with all their holes. A part that is milled or ground from plate has a cut file of
    its blank: the outline, and the holes that may be cut to their final size or to the tap drill's. Holes
    with a fit are reamed afterwards; counterbores, threads and holes from the edges are left to the drawing.
    A part that has a pocket, or is thicker than it is wide, is milled from a block and has no cut file.
    """
    if part.process == "wire-cut":
        outer, openings = section(part)
        return Extrusion(outer, part.extrusion.thickness, openings)
    if part.process not in ("milled", "ground") or not _is_plate(part):
        return None
    reamed = {f.at[:2] for f in part.features if isinstance(f, Hole) and f.tolerance}
    outer, openings = section(part)
    return Extrusion(outer, part.extrusion.thickness, tuple(c for c in openings if c.centroid not in reamed))


def _is_plate(part: Part) -> bool:
    if not isinstance(part.body, Extrusion) or any(isinstance(f, Pocket) for f in part.features):
        return False
    x0, y0, x1, y1 = part.body.outer.box
    return part.body.thickness < min(x1 - x0, y1 - y0)
