"""Bonding: an element in the fixture's nest, gauge face up, the clamp on its gauge; one for each kind of
hinge. The guide's words have their figures from design, fixture and elements."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from functools import lru_cache
from math import floor

from tactcad.design.messages import CheckFailure
from tactcad.design.tree import Design
from tactcad.parts import rigs
from tactcad.parts.array.element import element
from tactcad.parts.array.layout import ElementPlace
from tactcad.parts.array.leads import AHEAD_OF_LEADS, leads
from tactcad.parts.array.supplies import supplies
from tactcad.parts.bought.standard_parts import dowel
from tactcad.parts.rigs.bonding_fixture import BASE, BondingLayout, bonding_rigs
from tactcad.parts.rigs.frame import STANDARD_GRAVITY
from tactcad.parts.rigs.stiffness import bonding_lines
from tactcad.parts.rules.bonding_rules import FITS

from ..builder import Builder, telling
from ..moves import PRESS
from ..rig import Rig, none
from ..rig_requirements import bonding_requirements
from ..scene import AGAINST_Y, REST, STILL, UPRIGHT, Move, Placement, Pose, Rotation, Scene, Vector
from .array import laying_leads

said = telling(__file__)

FACE_UP: Rotation = ((1, 0, 0), (0, 0, 1), (0, -1, 0))  # local y runs along -z, the thickness along +y
BETWEEN = 20.0  # mm between the fixtures of several kinds of hinge; chosen: a hand's room
LIFTED = 40.0  # exploded view: what comes from above
OVER: Vector = (0.0, 0.0, LIFTED)  # the clamp bar over its pins
ASIDE: Vector = (-120.0, 0.0, LIFTED)  # and beside the nest
FINGER = 20.0  # mm of a fingertip's length; chosen: to its first joint


def bonding(design: Design, pose: Pose = REST) -> Scene:
    """Scene `bonding`: every kind of hinge in its fixture, the first element of that kind; it has no pose
    but rest."""
    stations = bonding_rigs(design)
    b = Builder()
    b.supplies += supplies("bonding", {})
    middles = [n * (rig.width + BETWEEN) for n, rig in enumerate(stations)]
    for rig, y in zip(stations, middles):
        foot = -(rig.rest + BASE)
        nest = b.place("BN", rigs.bonding_nest(rig), (0, y + rig.width / 2, foot), AGAINST_Y)
        pin = dowel(rig.design.clamp.dowel, rig.pin_length)
        for x in rig.pin_x:
            for side in (-1, 1):
                at = (x, y + side * rig.pin_y, -rig.rest - rig.pin_depth)
                b.meet(b.place("DW", pin, at, UPRIGHT), nest, "press")
    stop = stations[0].pin_length - stations[0].pin_depth
    b.step("Fixture", (0, 0, 0), fixture(stations), tools=(PRESS, f"a sleeve {stop:g} mm long as stop"))
    pads = [_pad(b, rig, y) for rig, y in zip(stations, middles)]
    bars = []
    for rig, y, pad in zip(stations, middles, pads):
        bars.append(b.place("CB", rigs.bonding_clamp(rig), (0, y + rig.width / 2, rig.nose), AGAINST_Y))
        b.meet(pad, bars[-1])
    clamps = [*zip(pads, bars)]
    b.step(
        "Clamp bar",
        (0, 0, 2 * LIFTED),
        said("clamp bar", rig=stations[0]),
        fan=len(stations),
        order=[m for pair in clamps for m in (Move(pair, OVER, (STILL,)), Move(pair, STILL, (OVER, ASIDE)))],
        tools=("balance, 1 g",),
        sets=tuple(f"{pad} on {bar}: all, by adhesive" for pad, bar in clamps),
        leaves=tuple(f"{bar}: slides along z" for bar in bars),
    )
    b.step("Surface", (0, 0, 0), surface(stations[0]), tools=SURFACE_TOOLS)
    for n, (rig, y) in enumerate(zip(stations, middles), start=1):
        _element(b, rig, y, n)
    elements = tuple(_first(rig).designator for rig in stations)
    b.step(
        "Element on the tongue",
        (0, 0, LIFTED),
        said("element in", rig=stations[0]),
        sets=tuple(f"{e} on its tongue: along z, turn about x and y; by pins along y" for e in elements),
        leaves=tuple(f"{e}: along x, by {rig.play:g} mm of play" for e, rig in zip(elements, stations)),
    )
    fingers = [_finger(b, rig, y) for rig, y in zip(stations, middles)]
    b.step(
        "Gauge",
        (0, 0, 0),
        gauge(stations),
        tools=GAUGE_TOOLS,
        order=[Move((finger,), OVER, (STILL, OVER)) for finger in fingers],
        sets=("gauge on its hinge: along x and y, by eye; along z",),
    )
    b.step(
        "Clamp and cure",
        (0, 0, 0),
        clamp(stations),
        order=[
            m for pair in clamps for m in (Move(pair, ASIDE, (OVER, STILL)), Move(pair, STILL, (OVER, ASIDE)))
        ],
        sets=("gauge on its hinge: all, by adhesive",),
        apart=True,
    )
    first = stations[0]
    b.step(
        "Trim and terminals",
        (0, 0, 0),
        said("terminals", rig=first, ahead_of_leads=AHEAD_OF_LEADS),
        tools=TRIM_TOOLS,
        order=[Move((e,), STILL, (OVER,)) for e in elements],
        apart=True,
    )
    b.step("Solder", (0, 0, 0), solder(first), tools=SOLDER_TOOLS)
    b.step("Check resistance and insulation", (0, 0, 0), resistance(first), tools=OHMS_TOOLS)
    b.step("Coat", (0, 0, 0), coat(first))
    b.step("Check zero and sign", (0, 0, 0), zero(first), tools=SIGN_TOOLS)
    b.step("Check creep after 24 h", (0, 0, 0), creep(first))
    return b.scene("bonding", cover=[p.designator for p in b.placements if p.designator[:2] in ("CB", "RP")])


def _element(b: Builder, rig: BondingLayout, y: float, station: int) -> None:
    place = _first(rig)
    at = (-place.hinge_x, y - rig.design.sheet.thickness / 2, 0.0)
    b.put(Placement(place.designator, element(rig.array, place), at, FACE_UP))
    b.meet(place.designator, f"BN{station}")


def _first(rig: BondingLayout) -> ElementPlace:
    return next(p for p in rig.array.elements if p.hinge == rig.hinge)


def _finger(b: Builder, rig: BondingLayout, y: float) -> str:
    """A fingertip with gauge, tape and film under it."""
    (before, behind), half = rig.pad_x, rig.pad_width / 2
    low = (before, y - half, rig.gauge_face)
    return b.aid("fingertip on the gauge", low, (behind, y + half, rig.gauge_face + FINGER))


def _pad(b: Builder, rig: BondingLayout, y: float) -> str:
    return b.place("RP", rigs.bonding_pad(rig), (0, y, rig.gauge_face), on=_first(rig).designator)


LOUPE = "stereo microscope or loupe, 20x"
SURFACE_TOOLS = ("nitrile gloves",)
GAUGE_TOOLS = (LOUPE, "tweezers", "clear tape for gauges")
TRIM_TOOLS = ("scalpel",)
SOLDER_TOOLS = ("soldering iron with a 0.4 mm tip, temperature controlled",)
OHMS_TOOLS = ("ohmmeter, four wires, 0.01 ohm", "insulation tester, 50 V at most")
SIGN_TOOLS = ("a small weight", "the array's read-out, or a bridge amplifier")
THUMB = 20.0  # N; chosen: a thumb that presses hard


def fixture(rigs: Sequence[BondingLayout]) -> str:
    """Assembly of the nest."""
    rig = rigs[0]
    kinds = (
        f" There are {len(rigs)} nests: each is for the elements with its own hinge, as its number says."
        if len(rigs) > 1
        else ""
    )
    return said("fixture", rig=rig, out=rig.pin_length - rig.pin_depth, kinds=kinds)


def surface(rig: BondingLayout) -> str:
    d = rig.design
    face = "flat face" if d.element.sides == "one" else "floor of the slot on the pads' side"
    thinnest = min(place.hinge.t for place in rig.array.elements)
    return said("surface", thinnest=thinnest, face=face)


def gauge(rigs: Sequence[BondingLayout]) -> str:
    """Instructions for setting the gauge on the hinge, with the tolerance."""
    from tactcad.parts.array.measurements import allowed_places

    rig = rigs[0]
    d, table = rig.design, rig.table
    allowed = float(allowed_places(rig.array).min())
    return said("gauge", d=d, table=table, within=floor(1e3 * allowed) / 1e3, share=100 * table.signal_share)


def clamp(rigs: Sequence[BondingLayout]) -> str:
    """Instructions for clamping: weight, time, and the leaf's load."""
    rig = rigs[0]
    return said("clamp", rig=rig, bears=_bears(rigs))


def _bears(rigs: Sequence[BondingLayout]) -> str:
    try:
        backed, free = (min(borne(rig, by) for rig in rigs) for by in (True, False))
    except CheckFailure:  # far thinner than long: the elements say so
        return "press on it no harder: plane elements do not tell what so thin a leaf bears."
    thumb = THUMB / rigs[0].pad_area
    safe = "the leaf on its tongue bears that too." if thumb < backed else "do not press so hard."
    return (
        f"the leaf yields at {backed:.2g} MPa on its tongue, and at {free:.2g} MPa if the tongue is "
        f"forgotten (plane elements). A thumb of {THUMB:g} N on the bar is {thumb:.2g} MPa: {safe}"
    )


def borne(rig: BondingLayout, backed: bool) -> float:
    """Pressure on the gauge at which a leaf of this kind yields, MPa, in the fixture or without its tongue.
    Raises CheckFailure if elements do not reach it."""
    from tactcad.parts.array.hinge_section import hinge_section

    place = next(p for p in rig.array.elements if p.hinge == rig.hinge)
    s = hinge_section(rig.array, (place,)).rows(0)
    before, behind = rig.pad_x
    if backed:
        s = s.with_(body_length=rig.rear_ends[0] - rig.hinge.l / 2)
    tongue = rig.tongue - 2 * rig.tongue_radius if backed else None
    numbers = tuple(float(getattr(s, each.name)) for each in fields(s))
    stress = _stress(numbers, (-before, behind), rig.pad_width, rig.design.gauge.grid_length, tongue)
    return rig.design.material.yield_strength / stress


@lru_cache(maxsize=64)
def _stress(
    section: tuple[float, ...], rubber: tuple[float, float], width: float, grid: float, tongue: float | None
) -> float:
    """Of one clamped leaf, by its section's numbers: two designs that are compared mostly have the same."""
    import numpy as np

    from tactcad.fem.bonded_leaf import clamped
    from tactcad.mechanics.section import HingeSection

    return clamped(HingeSection(*map(np.asarray, section)), rubber, width, grid, tongue).stress


def solder(rig: BondingLayout) -> str:
    to_terminals = "one lead to each terminal. "
    if leads(rig.array) == 3:
        to_terminals = (
            "three leads to the terminals, two on one of them: the third takes the leads' own resistance out "
            "of the bridge. "
        )
    return said("solder", to_terminals=to_terminals, laying_leads=laying_leads(rig.array))


def resistance(rig: BondingLayout) -> str:
    from tactcad.parts.array.measurements import gauge_checks

    c = gauge_checks(rig.array)
    low, high = c.resistance
    return said(
        "resistance", low=low, high=high, hurt=100 * c.hurt, insulation=c.insulation / 1e9, leak=c.leak / 1e6
    )


def coat(rig: BondingLayout) -> str:
    """Half of the pads' height over the face, at most a tenth of a millimetre, since a coating also
    stiffens."""
    thick = min(0.1, rig.design.element.pad_height / 2)
    return (
        f"Coat gauge, jumpers and terminals, no thicker than {thick:.2g} mm over the face and clear of the "
        "slot's walls and of the contact pad. Let it cure as its own sheet says."
    )


def _millivolts(volts: float) -> str:
    return f"{1e3 * volts:.0f} mV" if volts >= 0.01 else f"{1e3 * volts:.2g} mV"


def zero(rig: BondingLayout) -> str:
    from tactcad.parts.array.measurements import gauge_checks, volts

    c = gauge_checks(rig.array)
    arms = ", ".join(
        f"{1e3 * rise:.2g} permille ({_millivolts(volts(rig.array, rise))}) at arm {arm:g}"
        for arm, rise in c.rise
    )
    return said("zero", zero=100 * c.zero, grams=1e3 * c.push / STANDARD_GRAVITY, c=c, arms=arms)


def creep(rig: BondingLayout) -> str:
    from tactcad.parts.array.measurements import CREEP_FROM, CREEP_TO, gauge_checks

    c, d = gauge_checks(rig.array), rig.design
    return said(
        "creep",
        creep_from=CREEP_FROM,
        creep_to=CREEP_TO,
        creep=100 * c.creep,
        a_decade=100 * d.tolerance.creep,
    )


RIG = Rig(
    name="bonding",
    tables=("bonding",),
    make=bonding,
    poses=none,
    under_sensor=none,
    rules=FITS,
    deflections=bonding_lines,
    requirements=bonding_requirements,
    checks=(),
)
