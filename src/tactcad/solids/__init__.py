"""The only room that makes solids.

In: a part's description. Out: the CAD kernel's shape, made once, measured, meshed, and written as STEP.
"""

from __future__ import annotations

from dataclasses import dataclass

CHORD_MM = 0.05  # largest chord error; the turn governs small radii, this one those above 10 mm


@dataclass(frozen=True)
class Meshing:
    """`angular`: largest turn between facets, rad; `error`: largest promised relative error of a part's
    volume, None for the facets' own error."""

    angular: float = 0.2
    error: float | None = None


USUAL = Meshing()
