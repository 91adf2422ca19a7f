"""ISO 8734 parallel pins, hardened, and ground rod where the standard's lengths end (mm)."""

from __future__ import annotations

from tactcad.contour import circle

from ..description import Extrusion, Material, Part, Purchase

HARDENED = Material("hardened steel", 7850)

_SERIES = (4, 5, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30, 32, 35, 40, 45, 50)
# Longest preferred length by diameter, ISO 8734:1997 table 1.
_LONGEST = {"2": 20, "2.5": 24, "3": 30, "4": 40, "5": 50}
# Deviations of m6 (ISO 286-2): +2/+8 um up to 3 mm, +4/+12 um above.
_M6 = {
    "2": (0.002, 0.008),
    "2.5": (0.002, 0.008),
    "3": (0.002, 0.008),
    "4": (0.004, 0.012),
    "5": (0.004, 0.012),
}


def dowel_lengths(size: str) -> tuple[float, ...]:
    """Preferred lengths, mm, of the pin of that diameter."""
    return tuple(float(n) for n in _SERIES if 2 * float(size) <= n <= _LONGEST[size])


def dowel_diameter(size: str) -> float:
    """Diameter as modelled, mm: the middle of tolerance m6."""
    return round(float(size) + sum(_M6[size]) / 2, 6)


def largest_dowel(size: str) -> float:
    """Upper limit of the diameter, mm."""
    return round(float(size) + _M6[size][1], 6)


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
