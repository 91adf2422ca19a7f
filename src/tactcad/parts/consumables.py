"""What the array needs and is not modelled as a solid: gauges, adhesive, terminals; electronic_supplies.py
has what reads it.
"""

from __future__ import annotations

from tactcad.design.materials import family

from .electronic_parts import GAUGE, TERMINAL
from .layout import Layout
from .spares import bonded_spares
from .supply import Supply


def array_supplies(layout: Layout) -> tuple[Supply, ...]:
    """Gauge and bonding supplies of the array, none of them verified in a maker's own data."""
    g, material = layout.design.gauge, layout.design.material
    n = len(layout.elements)
    bonding = layout.design.bonding
    longest = f", at most {bonding.terminal_length:g} mm long" if bonding else ""
    spare_gauges = bonded_spares(n)
    ohm, metal = f"{g.resistance:g} ohm", family(material.density) or material.alloy
    return (
        Supply(
            GAUGE,
            f"foil strain gauge, {ohm}, grid {g.grid_length:g} x {g.grid_width:g} mm, for {metal}",
            n,
            "pcs",
            f"foil strain gauge {ohm}, grid {g.grid_length:g} x "
            f"{g.grid_width:g} mm, self-compensated for {metal}, tabs at one end; carrier trimmed to "
            f"{g.carrier_arm_side + g.carrier_body_side:g} x {g.carrier_width:g} mm; any maker's",
            alternates="any foil gauge of that grid and resistance",
            spares=spare_gauges,
            consumable=False,
        ),
        Supply(
            TERMINAL,
            "solder terminal pair, self-adhesive",
            n,
            "pcs",
            f"solder terminal for strain gauges, two pads{longest}; any maker's",
            spares=spare_gauges,
        ),
        Supply("ADHESIVE", "strain gauge adhesive, cold curing", 1, "pack", "cyanoacrylate gauge adhesive"),
        Supply(
            "COATING",
            "protective coating over gauge and terminals",
            1,
            "pack",
            "polyurethane or silicone gauge coating",
        ),
    )


def bonding_supplies() -> tuple[Supply, ...]:
    """What the bonding fixture's guide uses up beside the array's gauges, adhesive, terminals and coating."""
    return (
        Supply(
            "SURFACE-PREPARATION",
            "solvent, acid conditioner and neutraliser for the elements' metal, lint-free swabs",
            1,
            "set",
            "surface preparation set for strain gauges",
        ),
        Supply(
            "ABRASIVE",
            "silicon carbide paper, strips of 3 mm on a flat stick",
            1,
            "sheet",
            "silicon carbide paper P400, wet and dry",
        ),
        Supply("GAUGE-TAPE", "clear tape that leaves no residue", 1, "roll", "strain gauge mounting tape"),
        Supply(
            "RELEASE-FILM", "film between gauge and rubber", 1, "sheet", "PTFE film 0.05 mm, or polyethylene"
        ),
    )
