"""Weights of the calibration: what each kind of cells bears, how near the loads come to their axes, and
whether cap and cradle take the array."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import ceil, floor, inf, log10

import numpy as np

from tactcad.parts.bought.standard_parts import LEAST_PLAY
from tactcad.parts.language.finding import Finding
from tactcad.parts.rigs.frame import STANDARD_GRAVITY
from tactcad.parts.rules.rule import at_least, fits
from tactcad.scenes.requirement import DimensionLimits, Requirement, summed, variable

from . import cell_cradle as cradle
from .cell import wrench
from .cell_cradle import CradleLayout
from .cell_layout import Kind, PlanarLayout
from .parts import PAD, PAD_FIELD
from .rules import no_less, no_more
from .sensor import rated_force, stress_error

STEPS = 5  # of weights; chosen: two more than `calibrate` asks for
STOP_SHARE = 0.8  # of the force at which a post or an island meets a stop; chosen
LONGEST = 100.0  # mm, array; chosen: a longer one's hanger of 0.5 mm bends in the hand
LEAST_LIP = 0.7  # mm of clamp on the cover; chosen: what M3 screws press aluminium with, and do not dent
NEAR = 0.2  # mm that cap and link keep from neighbours' posts; chosen: the eye sees it
LEVEL = 0.2  # mm/m: the table by a spirit level of 0.1 mm/m, two divisions; chosen
OFF_AXIS = 2.0  # mrad: 0.2 % of a load acts across its axis, a fifth of the 1 % that K_obj asks of matrices
OFF_MIDDLE = 0.03  # mm, load from the pad's middle; chosen: bore's play, and a lathe's true running
OFF_LEVEL = 0.02  # mm, of the groove from its pad's face: the cap's sheet
LATHE = 0.01  # mm, radial: half of the true running that the cap's sheet asks for


@dataclass(frozen=True)
class Loads:
    """Of a kind of cells along one axis: the hanger's own with the cap, N; a step's weight, g."""

    kind: str
    heaviest: float
    tare: float
    step: float

    @property
    def most(self) -> float:
        """N, all steps on."""
        return self.tare + STEPS * self.step * 1e-3 * STANDARD_GRAVITY


def across(layout: PlanarLayout, kind: Kind) -> float:
    """Largest load across a pad alone, N: yield over its factor, or STOP_SHARE of what closes a stop."""
    d, h, reach = layout.design, layout.pad_height, kind.reach
    stress = kind.cell.stress(wrench(np.array([1.0, 0.0, 0.0]), h)) * (1.0 + stress_error(kind.bevel))
    cover = d.housing.cover_thickness + layout.cover_z - d.planar.thickness / 2.0
    tip = min(kind.table.stop_gap / reach, d.housing.lift / reach, d.housing.side_gap / cover)
    stop = tip / float(kind.cell.compliance[4, 4]) / h
    return float(min(d.material.yield_strength / stress / d.rating.yield_factor, STOP_SHARE * stop))


def loads(rig: CradleLayout, along: str) -> Iterator[Loads]:
    """Of every kind, along "z" or across."""
    layout = rig.layout
    hung = cradle.hanger(rig) if along == "z" else cradle.link(rig)
    tare = (cradle.cap(rig).mass + hung.mass) * 1e-3 * STANDARD_GRAVITY
    for kind in layout.used:
        rated = rated_force(layout, kind)[1]
        heaviest = rated if along == "z" else across(layout, kind)
        room = max((heaviest - tare) / STANDARD_GRAVITY * 1e3 / STEPS, 0.0)
        yield Loads(kind.name, heaviest, tare, _preferred(room))


def _preferred(most: float) -> float:
    """The largest of 1, 2, 5, 10 ... that is not more; 0 for nothing."""
    if most <= 0.0:
        return 0.0
    ten = 10.0 ** floor(log10(most) + 1e-9)
    return round(max(n * ten for n in (1, 2, 5) if n * ten <= most * (1.0 + 1e-9)), 9)


@fits
def cap_fits_pads(layout: PlanarLayout) -> Iterator[Finding]:
    """The cap's groove is on its skirt, and cap and link pass the neighbours' posts."""
    rig = CradleLayout(layout)
    least = cradle.CAP_OFF + rig.cap - rig.groove + 0.05
    yield from no_less(layout, "post.stand_out", "too little for the calibration's cap", least)
    room = rig.arc + cradle.LEG + layout.design.post.pad / 2.0 + NEAR
    if len(layout.elements) > 1:
        what = "the calibration's link meets the neighbours' posts"
        yield from no_less(layout, "planar.pitch", what, round(room, 6))


@fits
def cradle_holds_array(layout: PlanarLayout) -> Iterator[Finding]:
    rig, longest = CradleLayout(layout), 2.0 * max(layout.half)
    what = f"the array is {longest:g} mm long, and the calibration's hanger goes round {LONGEST:g} mm"
    yield from no_more(layout, "planar.pitch", what, layout.design.planar.pitch * LONGEST / longest)
    apart, border = rig.pins[1][0] - rig.pins[0][0], layout.design.housing.border
    x0, y0, x1, y1 = rig.box
    rest = OFF_AXIS - LEVEL - 1e3 * rig.zone / min(x1 - x0, y1 - y0)  # mrad that the pins' places may take
    lacking = max(1e3 * cradle.PIN_ZONE / rest - apart, 0.0) / 2.0
    what = f"{apart:g} mm between the cradle's two pins do not hold the array square"
    yield from no_less(layout, "housing.border", what, border + ceil(1e3 * lacking) / 1e3)
    what = "the cradle's clamp finds no cover beside the link"
    yield from no_less(layout, "housing.border", what, border + LEAST_LIP - rig.lip)


@fits
def cells_bear_hangers(layout: PlanarLayout) -> Iterator[Finding]:
    """Link and hanger leave half of the load to weights."""
    rig = CradleLayout(layout)
    for along in "zx":
        for load in loads(rig, along):
            least, whose = 2.0 * load.tare, f"a {load.kind} cell with {load.tare:.2g} N along {along}"
            what = f"the calibration's hanger alone loads {whose}"
            yield from at_least("rating.force", what, load.heaviest, least, f"{least:.2g} N or more borne")


FITS = (cap_fits_pads, cradle_holds_array, cells_bear_hangers)
BORE, OF_PAD, RUNS = "cap: bore diameter", f"post: {PAD}", "cap: dimple off its bore"
TABLE, SEAT = "calibration table: level, mm/m", "cradle: seat"
FEET, PINS = "cradle: feet", "cradle: pins' places"


def requirements(layout: PlanarLayout, known: dict[str, DimensionLimits]) -> list[Requirement]:
    """Loads along their axes and in the pad's middle; adds the variables to `known`."""
    rig, name = CradleLayout(layout), layout.design.name
    zone, x0, y0, x1, y1 = rig.zone, *rig.box
    of = f"{name}-cradle"
    bore, half = rig.bore, cradle.PIN_ZONE / 2.0
    field, play = bore.upper - bore.nominal, bore.nominal - layout.design.post.pad
    own = (
        variable(BORE, 0.0, field, stated=((f"{name}-cap", bore.name),)),
        variable(OF_PAD, -PAD_FIELD, 0.0, stated=((f"{name}-post", PAD),)),
        variable(RUNS, -LATHE, LATHE),
        variable(TABLE, -LEVEL, LEVEL),
        variable(SEAT, -zone, zone, stated=((of, "seat"),)),
        variable(FEET, -zone, zone, stated=((of, "foot x"), (of, "foot y"))),
        variable(PINS, -half, half, 2, stated=((of, "pin hole holes"),)),
    )
    known |= {v.name: v for v in own}
    apart, shorter = rig.pins[1][0] - rig.pins[0][0], min(x1 - x0, y1 - y0)

    def turned(who: str, *terms: tuple[str, float]) -> Requirement:
        """Deviations over their lengths and the table's level, mrad."""
        own = ((TABLE, 1.0), *((v, 1e3 / length) for v, length in terms))
        asked = summed(f"calibration: {who}", -OFF_AXIS, OFF_AXIS, 0.0, own)
        return replace(asked, unit="mrad", fields=("calibration.squareness",))

    off = ((BORE, 0.5), (OF_PAD, -0.5), (RUNS, 1.0))
    return [
        summed("calibration: cap slips over the pads", LEAST_PLAY, inf, play, ((BORE, 1.0), (OF_PAD, -1.0))),
        summed("calibration: load in the pad's middle", -inf, OFF_MIDDLE, play / 2.0, off),
        turned("load along z", (SEAT, shorter)),
        turned("load across, out of the pads' plane", (FEET, cradle.THICK)),
        turned("load across, in the pads' plane", (FEET, shorter), (PINS, apart)),
    ]
