"""Bonding: an element in the fixture's nest, gauge face up, the clamp on its gauge; one for each kind of
hinge."""

from __future__ import annotations

from tactcad.design.tree import Design
from tactcad.parts import rigs
from tactcad.parts.consumables import bonding_supplies
from tactcad.parts.element import element
from tactcad.parts.layout import ElementPlace
from tactcad.parts.library.dowels import dowel
from tactcad.parts.rigs.bonding_layout import BASE, BondingLayout, bonding_rigs
from tactcad.parts.rigs.stiffness import bonding_lines
from tactcad.parts.rules.bonding_rules import FITS

from ..bonding_requirements import bonding_requirements
from ..builder import Builder
from ..rig import Rig, none
from ..scene import AGAINST_Y, REST, UPRIGHT, Placement, Pose, Rotation, Scene

FACE_UP: Rotation = ((1, 0, 0), (0, 0, 1), (0, -1, 0))  # local y runs along -z, the thickness along +y
BETWEEN = 20.0  # mm between the fixtures of several kinds of hinge; chosen: a hand's room
LIFTED = 40.0  # exploded view: what comes from above


def bonding(design: Design, pose: Pose = REST) -> Scene:
    """Scene `bonding`: every kind of hinge in its fixture, the first element of that kind; it has no pose
    but rest."""
    # loads numpy, which nothing needs that only asks which scenes there are
    from .. import bonding_text as text

    stations = bonding_rigs(design)
    b = Builder()
    b.supplies += bonding_supplies()
    middles = [n * (rig.width + BETWEEN) for n, rig in enumerate(stations)]
    for rig, y in zip(stations, middles):
        _nest(b, rig, y)
    b.step("Fixture", (0, 0, 0), text.fixture(stations), tools=text.FIXTURE_TOOLS)
    b.step("Surface", (0, 0, 0), text.surface(stations[0]), tools=text.SURFACE_TOOLS)
    for n, (rig, y) in enumerate(zip(stations, middles), start=1):
        _element(b, rig, y, n)
    b.step("Element on the tongue", (0, 0, LIFTED), text.element_in(stations[0]))
    b.step("Gauge", (0, 0, 0), text.gauge(stations), tools=text.GAUGE_TOOLS)
    pads = [_pad(b, rig, y) for rig, y in zip(stations, middles)]
    for rig, y, pad in zip(stations, middles, pads):
        _bar(b, rig, y, pad)
    b.step("Clamp and cure", (0, 0, 2 * LIFTED), text.clamp(stations), fan=len(stations))
    first = stations[0]
    b.step("Trim and terminals", (0, 0, 0), text.terminals(first), tools=text.TRIM_TOOLS)
    b.step("Solder", (0, 0, 0), text.solder(first), tools=text.SOLDER_TOOLS)
    b.step("Check resistance and insulation", (0, 0, 0), text.resistance(first), tools=text.OHMS_TOOLS)
    b.step("Coat", (0, 0, 0), text.coat(first))
    b.step("Check zero and sign", (0, 0, 0), text.zero(first), tools=text.SIGN_TOOLS)
    b.step("Check creep after 24 h", (0, 0, 0), text.creep(first))
    return b.scene("bonding", cover=[p.designator for p in b.placements if p.designator[:2] in ("CB", "RP")])


def _nest(b: Builder, rig: BondingLayout, y: float) -> None:
    foot = -(rig.rest + BASE)
    nest = b.place("BN", rigs.bonding_nest(rig), (0, y + rig.width / 2, foot), AGAINST_Y)
    pin = dowel(rig.design.clamp.dowel, rig.pin_length)
    for x in rig.pin_x:
        for side in (-1, 1):
            at = (x, y + side * rig.pin_y, -rig.rest - rig.pin_depth)
            b.meet(b.place("DW", pin, at, UPRIGHT), nest, "press")


def _element(b: Builder, rig: BondingLayout, y: float, station: int) -> None:
    place = _first(rig)
    at = (-place.hinge_x, y - rig.design.sheet.thickness / 2, 0.0)
    b.put(Placement(place.designator, element(rig.array, place), at, FACE_UP))
    b.meet(place.designator, f"BN{station}")


def _first(rig: BondingLayout) -> ElementPlace:
    return next(p for p in rig.array.elements if p.hinge == rig.hinge)


def _pad(b: Builder, rig: BondingLayout, y: float) -> str:
    pad = b.place("RP", rigs.bonding_pad(rig), (0, y, rig.gauge_face), UPRIGHT)
    b.meet(pad, _first(rig).designator)
    return pad


def _bar(b: Builder, rig: BondingLayout, y: float, pad: str) -> None:
    b.meet(pad, b.place("CB", rigs.bonding_clamp(rig), (0, y + rig.width / 2, rig.nose), AGAINST_Y))


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
