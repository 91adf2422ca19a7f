"""The contours of a part, in its own x and y, by the names of their variables."""

from __future__ import annotations

from tactcad.contour import Contour
from tactcad.parts.description import Part, Pocket

from .measure import in_part


def contours(part: Part) -> list[tuple[str, Contour]]:
    """Every contour of the part by its variables' name."""
    body = part.body
    named = [("outer", body.outer), *((f"opening{i}", c) for i, c in enumerate(body.openings))]
    for k, f in enumerate(part.features):
        if isinstance(f, Pocket):
            named.append((f"pocket{k}", in_part(f, f.contour)))
            named += [(f"island{k}.{i}", in_part(f, c)) for i, c in enumerate(f.island)]
    return named
