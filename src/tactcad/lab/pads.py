"""Where the pads of an array stand, and how much they are coupled through the object they press on."""

from __future__ import annotations

from functools import lru_cache
from math import inf

import numpy as np

from tactcad.design.messages import InputError
from tactcad.design.tree import Design
from tactcad.lab.readings import GraspReadings
from tactcad.mechanics.sample_coupling import pad_stiffness, shares_between
from tactcad.parts.designs import load
from tactcad.parts.layout import Layout

INCOMPRESSIBLE = 0.5  # Poisson's ratio of soft tissue and rubber; a half-space's shares do not depend on it
# Layers thinner than this share of a pad's side cannot give way sideways, so that the even pressure which the
# relation between modulus and stiffness takes is no longer near what a rigid pad gives; chosen.
LEAST_LAYER = 0.5


def places(layout: Layout) -> tuple[np.ndarray, np.ndarray]:
    """x and y of the pads' centres, arrays [element], mm. Row two is row one turned by 180 degrees."""
    side = np.array([1.0 if p.row == 1 else -1.0 for p in layout.elements])
    y = np.array([p.y for p in layout.elements])
    return side * layout.design.array.row_pitch / 2, side * y


def stiffness_per_modulus(design: Design, thickness: float, where: str) -> float:
    """K_obj under one pad over the Young's modulus of an incompressible layer, N/mm for each MPa.

    Parameters
    ----------
    design
        Whose pads press.
    thickness
        Of the layer, bonded to a rigid base, mm; inf for a half-space.
    where
        What gave the thickness, for the message.

    Raises
    ------
    InputError
        The layer is thinner than LEAST_LAYER of a pad's side.
    """
    length, width = design.element.pad_length, design.sheet.thickness
    least = LEAST_LAYER * (length * width) ** 0.5
    if not thickness >= least:
        raise InputError(
            where,
            "too thin for the relation between modulus and stiffness",
            value=thickness,
            legal=f"at least {least:.3g} mm, {LEAST_LAYER:g} of a pad's side; inf for a half-space",
        )
    return pad_stiffness(1.0, length, width, thickness, INCOMPRESSIBLE)


def coupling(source: str, readings: GraspReadings, share: float) -> np.ndarray | None:
    """Displacement of each pad by the force on another, over that by the same force on itself.

    Parameters
    ----------
    source : str
        The design, by name or path.
    readings : GraspReadings
        Its elements, in their order.
    share : float
        Of the coupling by an elastic half-space, from 0 to 1.

    Returns
    -------
    array, [element, element], or None
        Ratios, in the order of `readings.element`; None where the share is 0.

    Raises
    ------
    InputError
        A share out of range, an element that the design does not have.
    """
    if not 0 <= share <= 1:
        raise InputError("coupling", "out of range", value=share, legal="from 0 to 1")
    if share == 0:
        return None
    x, y, number, length, width = _pads(source)
    place = {int(n): i for i, n in enumerate(number)}
    for n in readings.element:
        if int(n) not in place:
            raise InputError(
                f"{readings.path}: sample {readings.sample}, element",
                f"design {source} has no such element, so nobody knows where its pad stands",
                value=int(n),
                legal=f"{number.tolist()}, another --design, or --coupling 0",
            )
    rows = [place[int(n)] for n in readings.element]
    return share * shares_between(x[rows], y[rows], length, width, inf, INCOMPRESSIBLE)


@lru_cache(maxsize=4)
def _pads(source: str) -> tuple[np.ndarray, np.ndarray, np.ndarray, float, float]:
    design = load(source)
    layout = Layout(design)
    number = np.array([p.number for p in layout.elements])
    return *places(layout), number, design.element.pad_length, design.sheet.thickness
