"""Materials that no field of a design names, and the plates' alloy."""

from __future__ import annotations

from dataclasses import replace

from tactcad.design.materials import ALLOYS
from tactcad.design.tree import CommonTables

from .description import Material

# Densities in kg/m3: usual values of these materials.
ALUMINIUM = Material("aluminium", 2700, magnetic="no")
BRASS = Material("brass, nickel plated", 8500)
CARBON_STEEL = Material("steel", 7850)
PLAIN_STEEL = Material("S235JR steel", 7850, standard="EN 10025-2", magnetic="yes")
RUBBER = Material("rubber", 1200)
STAINLESS = Material("X5CrNi18-10 (1.4301)", 7900, standard="EN 10088-3", magnetic="weakly")  # bar
STAINLESS_PLATE = replace(STAINLESS, standard="EN 10088-2")
# Martensitic: a magnetic chuck holds it for grinding. Density after EN 10088-1.
MAGNETIC_STAINLESS = Material("X46Cr13 (1.4034)", 7700, "annealed (+A)", "EN 10088-2", magnetic="yes")
# Plate is stretched after quenching, so that it stays flat when one side is milled off (EN 515).
STRETCHED = {"-T6": "-T651", "-T3": "-T351"}


def plate_material(design: CommonTables) -> Material:
    """End plates, carrier and the rigs' plates: the design's `plate_alloy`."""
    alloy = bar_material(design)
    stem, temper = alloy.name[:-3], alloy.name[-3:]
    standard = ALLOYS[design.plate_alloy].standard
    return replace(alloy, name=stem + STRETCHED.get(temper, temper), standard=standard)


def bar_material(design: CommonTables) -> Material:
    """Extruded bar of the plates' alloy, for turned parts."""
    alloy = ALLOYS[design.plate_alloy]
    standard = alloy.standard.replace("EN 485-2", "EN 755-2")
    return Material(alloy.name, alloy.density, standard=standard, magnetic=alloy.magnetic or "")


def held_for_grinding(material: Material) -> str:
    """Workholding on a surface grinder: a magnetic chuck holds magnetic material only."""
    if material.magnetic == "yes":
        return "on a magnetic chuck, demagnetised afterwards"
    if material.magnetic:
        return "held by vacuum or wax: a magnetic chuck does not hold it"
    return "on a magnetic chuck only if a magnet draws it"
