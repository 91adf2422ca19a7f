"""What the array needs and is not modelled as a solid: gauges, adhesive, terminals, wire, bridge
resistors.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

from tactcad.design.materials import family

from .layout import Layout


@dataclass(frozen=True)
class Supply:
    """A bill-of-materials line without a solid. Quantities count the array once; spares come on top."""

    part_no: str
    description: str
    qty: float
    unit: str
    designation: str
    alternates: str = ""
    spares: float = 0
    consumable: bool = True


def array_supplies(layout: Layout) -> tuple[Supply, ...]:
    """Gauge, wiring and bonding supplies of the array, none of them verified in a maker's own data."""
    g, material = layout.design.gauge, layout.design.material
    n = len(layout.elements)
    spare_gauges = max(1, ceil(n / 5))  # chosen: one in five is lost in bonding or soldering
    ohm = f"{g.resistance:g} ohm"
    return (
        Supply(
            "STRAIN-GAUGE",
            f"foil strain gauge, {ohm}, grid {g.grid_length:g} x {g.grid_width:g} mm, "
            f"for {family(material.density) or material.alloy}",
            n,
            "pcs",
            f"strain gauge {ohm}, grid {g.grid_length:g} mm, carrier trimmed to "
            f"{g.carrier_arm_side + g.carrier_body_side:g} x {g.carrier_width:g} mm",
            alternates="any foil gauge of that grid and resistance",
            spares=spare_gauges,
            consumable=False,
        ),
        Supply(
            "BRIDGE-RESISTOR",
            f"bridge completion, {ohm}, or a reference gauge on the same alloy",
            3 * n,
            "pcs",
            f"precision resistor {ohm}, 0.1 %, 5 ppm/K",
            alternates="strain gauge as above, unloaded",
            spares=3,
            consumable=False,
        ),
        Supply(
            "TERMINAL",
            "solder terminal pair, self-adhesive",
            n,
            "pcs",
            "strain gauge terminal strip",
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
        Supply(
            "LEAD-WIRE",
            "lead wire, three per gauge",
            round(3 * 0.5 * n, 1),
            "m",
            "AWG 36 stranded, polyimide or PTFE insulated",
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
