"""ISO 8734 parallel pins, hardened, and ground rod where the standard's lengths end (mm)."""

from __future__ import annotations

from tactcad.contour import circle

from ..description import Extrusion, Material, Part, Purchase
from .fits import deviations
from .tables import number, rows

# Least diametral play of a sliding pin, mm; chosen: what a plug gauge tells from none.
LEAST_PLAY = 0.002
HARDENED = Material("hardened steel", 7850)

_SERIES = (4, 5, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30, 32, 35, 40, 45, 50)
_ROWS = {row["size"]: row for row in rows("dowels")}


def dowel_lengths(size: str) -> tuple[float, ...]:
    """Preferred lengths, mm, of the pin of that diameter."""
    return tuple(float(n) for n in _SERIES if 2 * float(size) <= n <= number(_ROWS[size]["longest"]))


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
        else f"ground rod {size} m6, cut to {length:g} mm"
    )
    return Part(
        part_no=f"ISO8734-{size}x{length:g}-pin" if standard else f"GROUND-{size}m6x{length:g}-rod",
        name=f"Dowel pin {size}x{length:g}",
        process="bought",
        material=HARDENED,
        body=Extrusion(circle((0, 0), dowel_diameter(size)), length),
        colour="#6f7378",
        purchase=Purchase(designation, alternates="DIN 6325" if standard else "silver steel, ground"),
        spares=1 if standard else 0,
    )
