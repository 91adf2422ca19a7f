"""Deep groove ball bearings with two shields, ISO 15 boundary dimensions (mm), each as one body."""

from __future__ import annotations

from dataclasses import dataclass

from tactcad.contour import chain

from ..description import Material, Part, Purchase, Revolution
from .tables import number, rows

BEARING_STEEL = Material("bearing steel 100Cr6", 7850)


@dataclass(frozen=True)
class Bearing:
    """Bore d, outside diameter D, width B, and largest diameter that may press on the inner ring (mm).

    Mass in g, None: the body's. data/bearings.csv says where each is from.
    """

    d: float
    D: float
    B: float
    inner: float
    mass: float | None = None


BEARINGS = {
    row["size"]: Bearing(
        **{name: number(row[name]) for name in ("d", "D", "B", "inner")},
        mass=number(row["mass"]) if row["mass"] else None,
    )
    for row in rows("bearings")
}


# Deviations of bore and outside diameter, mm: ISO 492, class Normal, d from 2.5 to 10, D from 6 to 18.
BORE = OUTSIDE = (-0.008, 0.0)


def bearing(size: str) -> Part:
    """The bearing of that designation; axis z, from z = 0 to its width."""
    b = BEARINGS[size]
    return Part(
        part_no=f"ISO15-{size}",
        name=f"Ball bearing {size}",
        process="bought",
        material=BEARING_STEEL,
        body=Revolution(chain([(b.d / 2, 0), (b.D / 2, 0), (b.D / 2, b.B), (b.d / 2, b.B)])),
        colour="#a7adb5",
        purchase=Purchase(
            f"ISO 15 {size}", alternates=f"{size.split('-')[0]}-2RS, same dimensions, more drag"
        ),
        mass_override=b.mass,
        spares=1,
    )
