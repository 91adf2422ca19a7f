"""What the array needs and is not modelled as a solid: gauges, adhesive, terminals; electronic_supplies.py
has what reads it.
"""

from __future__ import annotations

from dataclasses import dataclass

from tactcad.design.materials import family

from .electronic_parts import GAUGE, TERMINAL, bonded_spares
from .layout import Layout


@dataclass(frozen=True)
class Supply:
    """A bill-of-materials line without a solid. Quantities count the array once; spares come on top.

    verified: its figures were read in the maker's own sheet.
    """

    part_no: str
    description: str
    qty: float
    unit: str
    designation: str
    alternates: str = ""
    manufacturer: str = ""
    mpn: str = ""
    verified: bool = False
    spares: float = 0
    consumable: bool = True


def array_supplies(layout: Layout) -> tuple[Supply, ...]:
    """Gauge and bonding supplies of the array, none of them verified in a maker's own data."""
    g, material = layout.design.gauge, layout.design.material
    n = len(layout.elements)
    spare_gauges = bonded_spares(n)
    ohm = f"{g.resistance:g} ohm"
    return (
        Supply(
            GAUGE,
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
            TERMINAL,
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
    )
