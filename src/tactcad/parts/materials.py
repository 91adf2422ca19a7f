"""Materials of the plates."""

from __future__ import annotations

from tactcad.design.materials import ALLOYS
from tactcad.design.tree import Design

from .description import Material


def plate_material(design: Design) -> Material:
    """End plates and carrier: the alloy of [clamp] plate_alloy."""
    return Material(design.clamp.plate_alloy, ALLOYS[design.clamp.plate_alloy].density)
