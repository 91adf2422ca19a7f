"""Errors of rung solid's closed forms for strain and stress at a design, against solid elements.

`data/strain.json`, written by `benchmarks/strain_fit.py`, divides the range into zones, as data/accuracy.json
does for K.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from . import validity
from .constants import strain_data
from .section import Array, HingeSection

SIDES = {"two": True, "one": False}
# Slot lengths on the flat face (two-sided: lengths of flat part and one fillet) above which a grid is a long
# one, and above which none was measured.
LONG_GRID, LONGEST_GRID = 2.0, 5.0
# Of fem-solid, twice the most by which its meshes 2 to 4 were found to differ: under a grid 0.024 %, and
# 0.145 % where the slot is shorter than SHORT thicknesses; 0.70 % at the fillet of a narrow two-sided hinge
# (tests/fit/test_strain_errors.py).
OF_ELEMENTS, OF_ELEMENTS_SHORT, OF_ELEMENTS_AT_FILLET = 0.0005, 0.003, 0.015
SHORT = 1.0


@dataclass(frozen=True)
class StrainErrors:
    """Largest relative errors that are stated: of the mean under a grid of the gauge, of the peak strain and
    of the largest principal stress at the fillet, all at mid-width. NaN where nothing was measured."""

    gauge: Array
    fillet_strain: Array
    fillet_stress: Array


def stated(s: HingeSection, grid_length: float, rung: str) -> StrainErrors:
    """Stated errors of a rung at every design; NaN for rungs other than solid and fem-solid.

    Parameters
    ----------
    s
        One design or many.
    grid_length
        Of the gauge's grid, mm.
    rung
        The rung's name.
    """
    if rung != "solid":
        known = np.full(s.shape, 1.0 if rung == "fem-solid" else np.nan)
        short_slot = s.hinge_length < SHORT * s.hinge_thickness
        fillet = known * OF_ELEMENTS_AT_FILLET
        return StrainErrors(known * np.where(short_slot, OF_ELEMENTS_SHORT, OF_ELEMENTS), fillet, fillet)
    short, long, strain, stress = (
        _stated(s, name) for name in ("gauge", "long gauge", "fillet strain", "fillet stress")
    )
    grid = grid_length / np.broadcast_to(s.hinge_length, s.shape)
    gauge = np.where(grid <= LONG_GRID, short, np.where(grid <= LONGEST_GRID, long, np.nan))
    return StrainErrors(gauge, strain, stress)


def in_zone(bounds: dict[str, list[float | None]], s: HingeSection) -> np.ndarray:
    """Which designs have every group that bounds a zone between its ends (None: no end)."""
    groups, inside = validity.groups(s), np.ones(s.shape, dtype=bool)
    for name, (low, high) in bounds.items():
        inside &= (groups[name] >= (low or 0.0)) & (groups[name] < (np.inf if high is None else high))
    return inside


def _stated(s: HingeSection, name: str) -> Array:
    error = np.full(s.shape, np.nan)
    for zone in strain_data()["zones"]:
        inside = in_zone(zone["bounds"], s) & (s.two_sided == SIDES[zone["sides"]])
        error[inside] = np.nan if zone["stated"][name] is None else zone["stated"][name]
    return np.where(validity.reasons(s, "solid") == "", error, np.nan)
