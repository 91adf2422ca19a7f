"""Standard parts other than screws, from rows of their tables (mm): ISO 8734 pins, and ground rod beyond the
standard's lengths; ball bearings of ISO 15; O-rings of ISO 3601-1 in static face seals; linear stages.
"""

from __future__ import annotations

from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import cache
from math import pi, sqrt

from tactcad.contour import chain, circle
from tactcad.design.text_values import data_rows, number

from ..language.description import Extrusion, Material, Part, Purchase, Revolution
from ..language.limits import deviations

# Least diametral play of a sliding pin, mm; chosen: the least that a plug gauge shows.
LEAST_PLAY = 0.002
HARDENED = Material("hardened steel", 7850)

_SERIES = (4, 5, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30, 32, 35, 40, 45, 50)
_ROWS = {row["size"]: row for row in data_rows(__file__, "dowels")}


def dowel_lengths(size: str) -> tuple[float, ...]:
    """Preferred lengths, mm, of the pin of that diameter."""
    shortest, longest = (number(_ROWS[size][end]) for end in ("shortest", "longest"))
    return tuple(float(n) for n in _SERIES if shortest <= n <= longest)


@cache
def dowel_diameter(size: str) -> float:
    """Diameter as modelled, mm: the middle of tolerance m6."""
    return round(sum(dowel_limits(size)) / 2, 6)


def dowel_limits(size: str) -> tuple[float, float]:
    """Limits of the diameter, mm."""
    low, high = deviations("m6", float(size))
    return (round(float(size) + low, 6), round(float(size) + high, 6))


def dowel(size: str, length: float) -> Part:
    """ISO 8734 pin (or, beyond the standard's lengths, ground rod cut to length), along +z from 0."""
    standard = length in dowel_lengths(size)
    designation = (
        f"ISO 8734 {size} m6 x {length:g} - A - St"
        if standard
        else f"ground rod {size} m6, cut to {length:g} mm, ends square, edges broken 0.1"
    )
    return Part(
        part_no=f"ISO8734-{size}x{length:g}-pin" if standard else f"GROUND-{size}m6x{length:g}-rod",
        name=f"{'Dowel pin' if standard else 'Ground rod'} {size}x{length:g}",
        process="bought",
        material=HARDENED,
        body=Extrusion(circle((0, 0), dowel_diameter(size)), length),
        colour="#6f7378",
        purchase=Purchase(designation, alternates="DIN 6325" if standard else "silver steel, ground"),
        spares=1 if standard else 0,
    )


BEARING_STEEL = Material("bearing steel 100Cr6", 7850)


@dataclass(frozen=True)
class Bearing:
    """Bore d, outside diameter D, width B, and largest diameter that may press on the inner ring (mm).

    Mass in g, None: the body's. data/bearings.csv names each one's source.
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
    for row in data_rows(__file__, "bearings")
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


NITRILE = Material("NBR 70", 1200)
SECTION = 1.78
# Inside diameter by size code, mm.
INSIDE = {row["code"]: number(row["inside"]) for row in data_rows(__file__, "orings")}
# Groove of a static face seal for 1.78: depth 1.27 to 1.40 (here to 1.37, about what is drawn), width 2.41
# (makers' tables, as in bd_warehouse 0.4.0).
GROOVE_DEPTHS = (1.27, 1.37)
GROOVE_DEPTH = 1.32
GROOVE_WIDTH = 2.4


def size_around(diameter: float) -> str | None:
    """The smallest ring whose inside clears a circle of that diameter; None if the table ends."""
    return next((code for code, inside in INSIDE.items() if inside >= diameter), None)


def groove(code: str) -> tuple[float, float]:
    """Inner and outer diameter of the groove. Air presses from outside: the ring lies on the inner wall."""
    return INSIDE[code], round(INSIDE[code] + 2 * GROOVE_WIDTH, 6)


def o_ring(code: str) -> Part:
    """The ring as it lies squeezed in its groove: groove's height, the free ring's volume; z from 0 up."""
    inner = INSIDE[code] / 2 + 0.05
    rubber = pi * SECTION**2 / 4 * pi * (INSIDE[code] + SECTION)
    outer = sqrt(inner**2 + rubber / (pi * GROOVE_DEPTH))
    return Part(
        part_no=f"ISO3601-{code}-{INSIDE[code]:.2f}x{SECTION:g}-NBR70-ring",
        name=f"O-ring {INSIDE[code]:.2f}x{SECTION:g}",
        process="bought",
        material=NITRILE,
        body=Revolution(chain([(inner, 0), (outer, 0), (outer, GROOVE_DEPTH), (inner, GROOVE_DEPTH)])),
        colour="#2b2b2e",
        notes=("modelled as squeezed",),
        purchase=Purchase(
            f"ISO 3601-1 {code}A {INSIDE[code]:.2f}x{SECTION:g} NBR 70", alternates="FKM 75, same size"
        ),
        spares=1,
    )


@dataclass(frozen=True)
class Stage:
    """Two square plates of `size` and thickness `plate`, M4 at +-`hole`, moving +-`travel` (mm)."""

    size: float
    plate: float
    hole: float
    travel: float

    @property
    def height(self) -> float:
        return 2 * self.plate


STAGES = tuple(
    Stage(**{name: number(row[name]) for name in ("size", "plate", "hole", "travel")})
    for row in data_rows(__file__, "stages")
)


MAKES = data_rows(__file__, "example_makes")
STANDARDS = ("ISO ", "DIN ")


def example(part: Part) -> str:
    """The bill's words on a make of the part and on its drawing; "" if a standard or a maker's number names
    the part, or nobody sells it by itself."""
    order = part.purchase
    if part.process != "bought" or order is None or order.mpn or order.designation.startswith(STANDARDS):
        return ""
    row = next((row for row in MAKES if fnmatchcase(part.part_no, row["part_no"])), None)
    return f"example: {row['example']}; drawing {row['drawing']}" if row else "no example found"
