"""Rungs fem-plane and fem-solid: elements on the reference contour."""

from __future__ import annotations

from tactcad.design.family import Late

from ..register import Rung

PLANE = Rung(
    "fem-plane",
    6,
    "a contour of your own, in plane stress",
    elements=Late("tactcad.fem.fem_ladder:converged_plane"),
)
SOLID = Rung(
    "fem-solid", 7, "the reference", elements=Late("tactcad.fem.fem_ladder:converged_solid"), meshes=(2, 3)
)
