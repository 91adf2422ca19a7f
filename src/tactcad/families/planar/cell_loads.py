"""Weights of the calibration: what each kind of cells bears, how near the loads come to their axes, and
whether cap and cradle take the array."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import floor, inf, log10

import numpy as np

from tactcad.parts.bought.standard_parts import LEAST_PLAY
from tactcad.parts.language.finding import Finding
from tactcad.parts.rigs.frame import STANDARD_GRAVITY
from tactcad.parts.rules.rule import at_least, at_most, fits
from tactcad.scenes.requirement import DimensionLimits, Requirement, summed, variable

from . import cell_cradle as cradle
from .cell import wrench
from .cell_cradle import CradleLayout
from .cell_layout import Kind, PlanarLayout
from .parts import PAD, PAD_FIELD
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
    stress = kind.cell.stress(wrench(np.array([1.0, 0.0, 0.0]), h)) * (1.0 + stress_error())
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
    d, rig = layout.design, CradleLayout(layout)
    least = cradle.CAP_OFF + rig.cap - rig.groove + 0.05
    yield from at_least("post.stand_out", "too little for the calibration's cap", d.post.stand_out, least)
    room = rig.arc + cradle.LEG + d.post.pad / 2.0 + NEAR
    if len(layout.elements) > 1:
        what = "the calibration's link meets the neighbours' posts"
        yield from at_least("planar.pitch", what, d.planar.pitch, round(room, 6))


@fits
def cradle_holds_array(layout: PlanarLayout) -> Iterator[Finding]:
    rig, p = CradleLayout(layout), layout.design.planar
    longest = 2.0 * max(layout.half)
    what = f"the array is {longest:g} mm long, and the calibration's hanger goes round {LONGEST:g} mm"
    yield from at_most("planar.pitch", what, p.pitch, p.pitch * LONGEST / longest)
    apart, d = rig.pins[1][0] - rig.pins[0][0], layout.design.housing
    least = d.border + max(2.0 * float(cradle.PIN) - apart, 0.0) / 2.0
    yield from at_least("housing.border", "the cradle's two pins meet", d.border, least)
    least = d.border + LEAST_LIP - rig.lip
    yield from at_least(
        "housing.border", "the cradle's clamp finds no cover beside the link", d.border, least
    )


@fits
def cells_bear_hangers(layout: PlanarLayout) -> Iterator[Finding]:
    """Link and hanger leave half of the load to weights."""
    rig = CradleLayout(layout)
    for along in "zx":
        for load in loads(rig, along):
            what = (
                f"the calibration's hanger alone loads a {load.kind} cell with {load.tare:.2g} N along "
                f"{along}"
            )
            yield from at_least(
                "rating.force", what, load.heaviest, 2.0 * load.tare, f"{2.0 * load.tare:.2g} N or more borne"
            )


FITS = (cap_fits_pads, cradle_holds_array, cells_bear_hangers)
BORE, OF_PAD, RUNS = "cap: bore diameter", f"post: {PAD}", "cap: dimple off its bore"
TABLE, SEAT, FEET, PINS = (
    "calibration table: level, mm/m",
    "cradle: seat",
    "cradle: feet",
    "cradle: pins' places",
)


def requirements(layout: PlanarLayout, known: dict[str, DimensionLimits]) -> list[Requirement]:
    """Loads along their axes and in the pad's middle; adds the variables to `known`."""
    rig, name = CradleLayout(layout), layout.design.name
    zone, x0, y0, x1, y1 = rig.zone, *rig.box
    of = f"{name}-cradle"
    bore, pad = rig.bore, layout.design.post.pad
    known[BORE] = variable(BORE, 0.0, bore.upper - bore.nominal, stated=((f"{name}-cap", bore.name),))
    known[OF_PAD] = variable(OF_PAD, -PAD_FIELD, 0.0, stated=((f"{name}-post", PAD),))
    known[RUNS] = variable(RUNS, -LATHE, LATHE)
    known[TABLE] = variable(TABLE, -LEVEL, LEVEL)
    known[SEAT] = variable(SEAT, -zone, zone, stated=((of, "seat"),))
    feet = ((of, "foot x"), (of, "foot y"))
    known[FEET] = variable(FEET, -zone, zone, stated=feet)
    half = cradle.PIN_ZONE / 2.0
    known[PINS] = variable(PINS, -half, half, 2, stated=((of, "pin hole holes"),))
    play = bore.nominal - pad
    apart, shorter = rig.pins[1][0] - rig.pins[0][0], min(x1 - x0, y1 - y0)

    def turned(who: str, *terms: tuple[str, float]) -> Requirement:
        """Deviations over their lengths and the table's level, mrad."""
        own = ((TABLE, 1.0), *((v, 1e3 / length) for v, length in terms))
        asked = summed(f"calibration: {who}", -OFF_AXIS, OFF_AXIS, 0.0, own)
        return replace(asked, unit="mrad", fields=("calibration.squareness",))

    return [
        summed("calibration: cap slips over the pads", LEAST_PLAY, inf, play, ((BORE, 1.0), (OF_PAD, -1.0))),
        summed(
            "calibration: load in the pad's middle",
            -inf,
            OFF_MIDDLE,
            play / 2.0,
            ((BORE, 0.5), (OF_PAD, -0.5), (RUNS, 1.0)),
        ),
        turned("load along z", (SEAT, shorter)),
        turned("load across, out of the pads' plane", (FEET, cradle.THICK)),
        turned("load across, in the pads' plane", (FEET, shorter), (PINS, apart)),
    ]
