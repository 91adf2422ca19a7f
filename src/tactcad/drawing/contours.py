"""The contours of a part, in its own x and y, by what their variables belong to."""

from __future__ import annotations

from tactcad.contour import Arc, Contour, Line
from tactcad.parts.description import Hole, Part, Pocket

from .keys import OUTER, Owner


def contours(part: Part) -> list[tuple[Owner, Contour]]:
    """Every contour of the part by what its variables belong to."""
    body = part.extrusion
    named = [(OUTER, body.outer), *((Owner("opening", i), c) for i, c in enumerate(body.openings))]
    for k, f in enumerate(part.features):
        if isinstance(f, Pocket):
            named.append((Owner("pocket", k), in_part(f, f.contour)))
            named += [(Owner("island", k, i), in_part(f, c)) for i, c in enumerate(f.island)]
    return named


def axis_of(feature: Hole | Pocket) -> int:
    """0, 1 or 2: the axis that a feature is sunk along. Raises ValueError for a slanting one."""
    along = [i for i, a in enumerate(feature.axis) if a]
    if len(along) != 1:
        raise ValueError(f"{feature.name}: axis {feature.axis} is not along x, y or z")
    return along[0]


def in_part(pocket: Pocket, contour: Contour) -> Contour:
    """A contour of a pocket along z, in the part's x and y."""
    if axis_of(pocket) != 2:
        raise ValueError(f"{pocket.name}: pockets in side faces have no sheet yet")
    (ux, uy, _), sign = pocket.x_axis, pocket.axis[2]
    vx, vy = -uy * sign, ux * sign  # y_axis = axis x x_axis

    def in_frame(p: tuple[float, float]) -> tuple[float, float]:
        # rounded to a picometre: turning may leave 1e-17 where a coordinate is 0
        return (
            round(pocket.at[0] + p[0] * ux + p[1] * vx, 12),
            round(pocket.at[1] + p[0] * uy + p[1] * vy, 12),
        )

    turned = ux * vy - uy * vx < 0
    return Contour(
        tuple(
            Line(in_frame(s.start), in_frame(s.end), s.name)
            if isinstance(s, Line)
            else Arc(in_frame(s.start), in_frame(s.end), in_frame(s.centre), s.ccw != turned, s.name)
            for s in contour
        )
    )
