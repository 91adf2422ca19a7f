"""Measurements on every numbered element as cut: the part's characteristics, and inputs of the estimator."""

from __future__ import annotations

from dataclasses import dataclass

from ..language.limits import Characteristic
from .element import LEDGE, PAD_HEIGHT, element, element_number
from .layout import ElementPlace, Layout


@dataclass(frozen=True)
class Measurement:
    """One dimension of one element, mm. `enters` is the field of HingeSection that it sets, "" if none."""

    name: str
    nominal: float
    lower: float
    upper: float
    key: bool
    enters: str
    where: str
    how: str


# By name: the field of HingeSection, the place of measurement, and the instrument.
MICROSCOPE = "measuring microscope, 0.001 or better"
WAYS = {
    "hinge thickness": (
        "hinge_thickness",
        "thinnest place between the hinge's two faces (mean of both edges of the sheet)",
        MICROSCOPE,
    ),
    PAD_HEIGHT: (
        "",
        "pad face over the centre of the dowel hole, square to the flat face",
        "coordinate measuring machine, or height gauge over a pin in the dowel hole",
    ),
    LEDGE: ("", "ledge over the pad's face, square to the flat face", MICROSCOPE),
    "stop gap": ("", "stop land below the ledge, square to the flat face", MICROSCOPE),
    "slot length": ("hinge_length", "between the slot's two walls, along the arm", MICROSCOPE),
    "load arm": ("load_arm", "middle of the slot to middle of the pad's face, along the arm", MICROSCOPE),
    "fillet radius": ("fillet_radius", "both fillets at the slot's floor (mean)", MICROSCOPE),
    "arm height": (
        "arm_height",
        "arm's back over its flat face, beside the slot",
        "micrometer or measuring microscope, 0.002",
    ),
    "arm length": ("", "arm's tip to the middle of the slot, along the arm", MICROSCOPE),
    "pad length": ("", "pad's face, along the arm", MICROSCOPE),
    "tip from dowel hole": ("", "arm's tip to the centre of the dowel hole, along the arm", MICROSCOPE),
    "dowel hole diameter": ("", "across the hole, at both faces", "plug gauges, or measuring microscope"),
    "sheet thickness": ("width", "across the element, on arm and body beside the slot", "micrometer, 0.002"),
}
AS_DRAWN = ("", "as dimensioned on the part's drawing sheet", "as its tolerance asks for")


def measurements(layout: Layout) -> list[tuple[ElementPlace, str, tuple[Measurement, ...]]]:
    """Every element by number: its place, its part number, and its measurements.

    These are its part's characteristics, and the load arm that follows from two of them.
    """
    known: dict[str, tuple[Measurement, ...]] = {}  # a long row has few kinds of element
    measured = []
    for place in layout.elements:
        part_no = element_number(layout.design, place)
        if part_no not in known:
            own = element(layout, place).characteristics
            known[part_no] = tuple(_measurement(c) for c in (*own, _load_arm(own)))
        measured.append((place, part_no, known[part_no]))
    return measured


def _load_arm(limits: tuple[Characteristic, ...]) -> Characteristic:
    """The arm's length less half the pad's, with limits that follow from theirs."""
    named = {c.name: c for c in limits}
    arm, pad = named["arm length"], named["pad length"]
    return Characteristic(
        "load arm", arm.nominal - pad.nominal / 2, arm.upper - pad.lower / 2, arm.lower - pad.upper / 2
    )


def _measurement(c: Characteristic) -> Measurement:
    # to a nanometre: 0.25 - 0.005 is a binary fraction
    nominal, lower, upper = (round(value, 6) for value in (c.nominal, c.lower, c.upper))
    enters, where, how = WAYS.get(c.name, AS_DRAWN)
    return Measurement(c.name, nominal, lower, upper, c.key, enters, where, how)
