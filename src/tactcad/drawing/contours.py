"""The contours of a part, in its own x and y, by what their variables belong to."""

from __future__ import annotations

from tactcad.contour import Contour
from tactcad.parts.description import Part, Pocket

from .keys import OUTER, Owner
from .measure import in_part


def contours(part: Part) -> list[tuple[Owner, Contour]]:
    """Every contour of the part by what its variables belong to."""
    body = part.body
    named = [(OUTER, body.outer), *((Owner("opening", i), c) for i, c in enumerate(body.openings))]
    for k, f in enumerate(part.features):
        if isinstance(f, Pocket):
            named.append((Owner("pocket", k), in_part(f, f.contour)))
            named += [(Owner("island", k, i), in_part(f, c)) for i, c in enumerate(f.island)]
    return named
