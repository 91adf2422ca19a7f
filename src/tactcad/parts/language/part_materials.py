"""Materials that no field of a design names, and the plates' alloy."""

from __future__ import annotations

from tactcad.design.materials import ALLOYS
from tactcad.design.tree import CommonTables

from .description import Material

# Densities in kg/m3: usual values of these materials.
ALUMINIUM = Material("aluminium", 2700, magnetic="no")
BRASS = Material("brass, nickel plated", 8500)
CARBON_STEEL = Material("steel", 7850)
PLAIN_STEEL = Material("S235JR steel", 7850, standard="EN 10025-2", magnetic="yes")
RUBBER = Material("rubber", 1200)
STAINLESS = Material("X5CrNi18-10 (1.4301)", 7900, standard="EN 10088-3", magnetic="weakly")
# Martensitic: a magnetic chuck holds it for grinding. Density after EN 10088-1.
MAGNETIC_STAINLESS = Material("X46Cr13 (1.4034)", 7700, standard="EN 10088-3", magnetic="yes")


def plate_material(design: CommonTables) -> Material:
    """End plates, carrier and the rigs' plates: the design's `plate_alloy`."""
    alloy = ALLOYS[design.plate_alloy]
    return Material(alloy.name, alloy.density, standard=alloy.standard, magnetic=alloy.magnetic or "")


def held_for_grinding(material: Material) -> str:
    """How a piece is held on a surface grinder: a magnetic chuck holds what a magnet draws, and that only."""
    if material.magnetic == "yes":
        return "on a magnetic chuck, demagnetised afterwards"
    if material.magnetic:
        return "held by vacuum or wax: a magnetic chuck does not hold it"
    return "on a magnetic chuck only if a magnet draws it"
