"""O-rings of ISO 3601-1, cross section 1.78 mm, and the groove of a static face seal against vacuum (mm)."""

from __future__ import annotations

from math import pi, sqrt

from tactcad.contour import chain

from ..description import Material, Part, Purchase, Revolution
from .tables import number, rows

NITRILE = Material("NBR 70", 1200)
SECTION = 1.78
# Inside diameter by size code, mm.
INSIDE = {row["code"]: number(row["inside"]) for row in rows("orings")}
# Groove of a static face seal for 1.78: depth 1.27 to 1.40, width 2.41 (makers' tables, as in bd_warehouse
# 0.4.0).
GROOVE_DEPTH = 1.32
GROOVE_WIDTH = 2.4


def size_around(diameter: float) -> str | None:
    """The smallest ring whose inside clears a circle of that diameter; None where the table ends."""
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
