"""Deep groove ball bearings with two shields, ISO 15 boundary dimensions (mm), each as one body."""

from __future__ import annotations

from dataclasses import dataclass

from tactcad.contour import chain

from ..description import Material, Part, Purchase, Revolution

BEARING_STEEL = Material("bearing steel 100Cr6", 7850)


@dataclass(frozen=True)
class Bearing:
    """Bore d, outside diameter D, width B (ISO 15:2017), and largest diameter that may press on the inner ring.

    `inner` is the shoulder's diameter where a maker's list was read (623, 624: SKF's d1 as in
    bd_warehouse 0.4.0), else d + 0.3 (D - d), which those two keep to within 0.1 mm. Mass in g, None: the body's.
    """

    d: float
    D: float
    B: float
    inner: float
    mass: float | None = None


BEARINGS = {
    "623-2Z": Bearing(3, 10, 4, 5.2, 1.5),
    "624-2Z": Bearing(4, 13, 5, 6.7, 3.1),
    "683-2Z": Bearing(3, 7, 3, 4.2),
    "682-2Z": Bearing(2, 5, 2.3, 2.9),
}


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
