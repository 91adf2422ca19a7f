"""Alloys of the sensing element: elastic constants and strength, each with where it is from."""

from __future__ import annotations

from dataclasses import dataclass

from .messages import InputError, one_of


@dataclass(frozen=True)
class Alloy:
    """A sheet alloy.

    youngs_modulus, yield_strength, fatigue_strength (fully reversed, 5e8 cycles) and tensile_strength in MPa,
    density in kg/m3. `tensile_strength` is None where it is not known; the Goodman line then ends at the
    yield strength, which is Soderberg's.
    """

    name: str
    youngs_modulus: float
    poisson: float
    density: float
    yield_strength: float
    fatigue_strength: float
    source: str
    tensile_strength: float | None = None


_TYPICAL = (
    "typical values: E, yield, fatigue (R = -1, 5e8 cycles) after aerodynamicmetals.com data sheets; "
    "density, Poisson's ratio and tensile strength after ASM Handbook vol. 2; not a guaranteed minimum"
)

ALLOYS = {
    alloy.name: alloy
    for alloy in (
        Alloy("6061-T6", 69000.0, 0.33, 2700.0, 275.0, 95.0, _TYPICAL, 310.0),
        Alloy("2024-T3", 73000.0, 0.33, 2780.0, 345.0, 140.0, _TYPICAL, 483.0),
        Alloy("7075-T6", 72000.0, 0.33, 2810.0, 505.0, 160.0, _TYPICAL, 572.0),
    )
}


def alloy(name: str) -> Alloy:
    """The alloy of that name; raises InputError naming the legal ones."""
    if name not in ALLOYS:
        raise InputError("material.alloy", "unknown alloy", value=name, legal=one_of(name, ALLOYS))
    return ALLOYS[name]
