"""Places of an array's pads, and their coupling through the object."""

from __future__ import annotations

from functools import lru_cache
from math import inf, isinf

import numpy as np

from tactcad.contact.press import THINNEST, Pads
from tactcad.design.family import family_of
from tactcad.design.messages import CheckFailure, InputError
from tactcad.design.text_values import with_limits
from tactcad.design.tree import CommonTables, Design
from tactcad.lab.layer_fit import LAYERS, LayeredArray, layer
from tactcad.lab.readings import GraspReadings
from tactcad.mechanics import gauge_signal, ladder, readout
from tactcad.mechanics.lumped import shares_between
from tactcad.mechanics.strength import tip_compliance
from tactcad.parts.array.hinge_section import arms, design_gauge, design_readout, hinge_section, not_reached
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.stop_gap import stop_gaps
from tactcad.parts.rules import load

SOFT = 0.49  # Poisson's ratio of rubber and tissue as layers: the paper's samples
INCOMPRESSIBLE = 0.5  # Poisson's ratio of soft tissue and rubber; a half-space's shares do not depend on it


def places(layout: Layout) -> tuple[np.ndarray, np.ndarray]:
    """x and y of the pads' centres, arrays [element], mm. Row two is row one turned by 180 degrees."""
    side = np.array([1.0 if p.row == 1 else -1.0 for p in layout.elements])
    y = np.array([p.y for p in layout.elements])
    return side * layout.design.array.row_pitch / 2, side * y


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
        Ratios, in the order of `readings.element`; None if the share is 0.

    Raises
    ------
    InputError
        A share out of range, an element that the design does not have.
    """
    if not 0 <= share <= 1:
        raise InputError("coupling", "out of range", value=share, legal="from 0 to 1")
    if share == 0:
        return None
    refuse_strangers(source, readings)
    x, y, number, length, width = _pads(source)
    place = {int(n): i for i, n in enumerate(number)}
    rows = [place[int(n)] for n in readings.element]
    return share * shares_between(x[rows], y[rows], length, width, inf, INCOMPRESSIBLE)


def refuse_strangers(source: str, readings: GraspReadings) -> None:
    """Raise InputError if the design has no such element."""
    number = _pads(source)[2]
    for n in readings.element:
        if n not in number:
            where = f"{readings.path}: sample {readings.sample}, element"
            what = f"design {source} has no such element, so the place of its pad is unknown"
            legal = f"{number.tolist()}, another --design, or --coupling 0"
            raise InputError(where, what, value=int(n), legal=legal)


def layers(design: CommonTables, thickness: str | None, poisson: float | None) -> list[LayeredArray]:
    """The array on the layer that is named, "6" or "6+-0.3" mm (inf: a half-space), else on layers from the
    thinnest that rigid pads take to the half-space.

    Raises
    ------
    InputError
        Not a thickness; a layer too thin; a Poisson's ratio out of range.
    CheckFailure
        An element is out of the estimator's range.
    """
    of = family_of(design).must("pads", "stiffness")
    pads, _ = of.springs(design)
    number = of.places(design)[2]
    side = (pads.length * pads.width) ** 0.5
    pairs = [(h * side, 0.0) for h in LAYERS]
    if thickness is not None:
        try:
            h, given = with_limits(thickness)
        except ValueError:
            legal = "mm with its limits, as in 6+-0.3 or 6+-5%, or inf"
            raise InputError("--thickness", "not a thickness", value=thickness, legal=legal) from None
        if not THINNEST * side <= h or not 0 <= (given or 0.0) < h or isinf(h) and given is not None:
            legal = (
                f"at least {THINNEST * side:.3g} mm (a quarter of a pad's side), limits below it; inf without"
            )
            raise InputError("--thickness", "out of range", value=thickness, legal=legal)
        pairs = [(h, given or 0.0)]
    nu = SOFT if poisson is None else poisson
    return [layer(number, pads, of.limit(design), nu, h, half) for h, half in pairs]


@lru_cache(maxsize=4)
def _pads(source: str) -> tuple[np.ndarray, np.ndarray, np.ndarray, float, float]:
    design = load(source)
    return family_of(design).must("pads", f"{source}: its contact with an object").places(design)


def pads_of(design: Design) -> tuple[np.ndarray, np.ndarray, np.ndarray, float, float]:
    """x, y and number of every pad of facing rows, and all pads' length and width, mm."""
    layout = Layout(design)
    number = np.array([p.number for p in layout.elements])
    return *places(layout), number, design.element.pad_length, design.sheet.thickness


def limit_of(design: Design) -> float:
    """Largest height of facing rows' pads above or below their plane, mm."""
    return design.tolerance.pad_height


def springs_of(design: Design) -> tuple[Pads, np.ndarray]:
    """The pads of facing rows on their elements, and the signal of each element over its pad's sink, V/mm.

    A pad turns about its hinge as it sinks: a newton at its middle sinks it by 1/K and slopes it by 1/(K L),
    up towards the hinge; a newton s further from the hinge does so (L + s)/L times. Its stop closes at the
    nominal gap and is taken as rigid.

    Raises
    ------
    CheckFailure
        An element is out of the estimator's range.
    """
    layout = Layout(design)
    at = layout.elements
    section = hinge_section(layout, at)
    if why := not_reached(layout, at, section, ladder.DEFAULT_RUNG):
        raise CheckFailure(why)
    K = np.broadcast_to(ladder.stiffness(section, ladder.DEFAULT_RUNG), len(at))
    x, y = places(layout)
    away = np.sign(x) / section.load_arm  # hinges lie outside the pads
    move = np.stack([np.ones(len(at)), -away, np.zeros(len(at))], axis=1)
    compliance = move[:, :, None] * move[:, None, :] / K[:, None, None]
    tip = tip_compliance(section, K, arms(layout))
    stop = np.array(stop_gaps(layout)) / tip / K
    height = np.zeros(len(at))
    pads = Pads(x, y, design.element.pad_length, design.sheet.thickness, compliance, height, stop)
    foil = gauge_signal.foil_strain_per_deflection(section, design_gauge(design))
    volts = readout.volts_per_strain(design.gauge.factor, design_readout(design))
    return pads, np.broadcast_to(volts * foil, len(at))
