"""Every dimension of an array that may differ from its drawing, with the limits that the parts state, and the
virtual shop, which makes each somewhere within its limits."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from typing import Literal

import numpy as np
from scipy.special import ndtr, ndtri

from tactcad.design.fields import present
from tactcad.mechanics.section import Array
from tactcad.parts.array.clamp import OVER_EDGE, STACK, end_plate, stop_plate
from tactcad.parts.array.element import (
    DOWEL_HOLE,
    LEAN,
    LEDGE,
    PAD_HEIGHT,
    SEAT_LEAN,
    WIRE,
    blank,
    element,
    spacer,
)
from tactcad.parts.array.layout import Layout
from tactcad.parts.bought.standard_parts import dowel_limits
from tactcad.parts.language.description import Part
from tactcad.parts.rigs.setting_fixture import FLOOR, SettingLayout, setting_fixture
from tactcad.scenes.requirement import SHEET, Deviations, DimensionLimits, Matters, of_element, variable

# The stack's length once its spacers are chosen to the measured sheet.
STACK_LENGTH = "stack: length, spacers to suit"
IN_PLAY, MODULUS = "element: place in its dowel hole's play, share", "sheet: Young's modulus, relative"
STEPS = "setting fixture: steps over the floor"
FLOOR_FLAT, STEPS_LEAN = "setting fixture: floor's flatness", "setting fixture: steps' lean"
PAD_LEAN = of_element("pad's lean")
PIN, BLANK_LEDGE = "dowel pin: diameter", "blank: ledge over the dowel hole"
SPACER, STOP_PLATE, FLATNESS = "spacer: thickness", "stop plate: thickness", "stop plate: flatness"
Plate = Literal["tapped", "head"]
Axis = Literal["x", "z"]
AXES: tuple[Axis, Axis] = ("x", "z")


def pair_holes(axis: Axis) -> str:
    """Both end plates' dowel holes, which are made together."""
    return f"end plates: dowel holes along {axis}"


def squareness(axis: Axis) -> str:
    """The tapped end plate's dowel holes."""
    return f"end plate, tapped: dowel holes' squareness along {axis}"


def own_holes(which: Plate, axis: Axis) -> str:
    """An end plate's dowel holes against the pair's."""
    return f"end plate, {which}: dowel holes against the pair's along {axis}"


def over_edge(which: Plate) -> str:
    """An end plate's dowel holes over its lower edge."""
    return f"end plate, {which}: {OVER_EDGE}"


def bore_in(which: Plate) -> str:
    """The diameter of an end plate's dowel holes."""
    return f"end plate, {which}: dowel hole diameter"


# What an element's limits matter to, by the limit; the others matter to neither contact.
OF_ELEMENT: dict[str, Matters] = {PAD_HEIGHT: "pads", DOWEL_HOLE: "pads", LEDGE: "plate"}


def array_variables(layout: Layout) -> dict[str, DimensionLimits]:
    """Variables of the array by name; parts of one sheet share one thickness, a single piece."""
    return {v.name: v for v in _array(layout)}


def _array(layout: Layout) -> Iterable[DimensionLimits]:
    d, places = layout.design, layout.elements
    kinds: dict[tuple, dict[str, tuple[float, float]]] = {}
    for p in places:  # a long row has few kinds of element
        if (p.arm, p.hinge) not in kinds:
            own_limits = element(layout, p).characteristics
            kinds[p.arm, p.hinge] = {c.name: (c.lower - c.nominal, c.upper - c.nominal) for c in own_limits}
    limits = [kinds[p.arm, p.hinge] for p in places]
    for name in dict.fromkeys(name for each in kinds.values() for name in each):
        own = [each.get(name, (0.0, 0.0)) for each in limits]
        if name == "sheet thickness":
            yield variable(SHEET, *own[0])
        else:
            lower, upper = np.array(own).T
            matters = OF_ELEMENT.get(name, "neither")
            wire = WIRE.get(name, 0)
            yield DimensionLimits(of_element(name), lower, upper, element=name, matters=matters, wire=wire)
    lean = np.full(len(places), LEAN / 2)
    yield DimensionLimits(PAD_LEAN, -lean, lean, element=SEAT_LEAN, matters="pads")
    yield variable(IN_PLAY, -1.0, 1.0, len(places))
    modulus = present(d.tolerance.youngs_modulus)
    yield variable(MODULUS, -modulus, modulus)
    if layout.blanks():
        yield _zone(BLANK_LEDGE, "ledge", len(layout.blanks()), "plate", blank(layout))
    yield _characteristic(SPACER, spacer(layout), "thickness")
    yield variable(STACK_LENGTH, -STACK, STACK)
    pins = 2 * len(layout.dowel_x)
    low, high = (limit - float(d.clamp.dowel) for limit in dowel_limits(d.clamp.dowel))
    yield variable(PIN, low, high, pins, matters="pads")
    pair = (end_plate(layout, False), end_plate(layout, True))
    plates: tuple[tuple[Plate, Part], ...] = (("tapped", pair[0]), ("head", pair[1]))
    for which, part in plates:
        on: Matters = "pads" if which == "tapped" else "neither"
        # the pair is made together: its common error is in one zone, its difference in another
        if part is pair[0]:
            for axis in AXES:
                yield _zone(pair_holes(axis), "dowel holes", pins, "pads", *pair)
                yield _zone(squareness(axis), "dowel holes' squareness", pins, "pads", part)
        yield _zone(over_edge(which), OVER_EDGE, pins, "pads", part)
        for axis in AXES:
            yield _zone(own_holes(which, axis), "dowel holes of the pair", pins, on, part)
        bore = next(c for c in part.characteristics if c.name == DOWEL_HOLE)
        size = float(d.clamp.dowel)  # pin and hole both refer to it
        of = ((part.part_no, bore.name),)
        yield variable(bore_in(which), bore.lower - size, bore.upper - size, pins, of, on)
    fixture = setting_fixture(SettingLayout(d))
    steps = [c for c in fixture.characteristics if c.name.startswith(FLOOR)]
    low, high = (limit - steps[0].nominal for limit in (steps[0].lower, steps[0].upper))
    yield variable(STEPS, low, high, 2, tuple((fixture.part_no, c.name) for c in steps), "pads")
    yield _zone(STEPS_LEAN, "steps", 2, "pads", fixture)
    yield _below(FLOOR_FLAT, "floor", len(places), "pads", fixture)
    plate = stop_plate(layout)
    flat = next(g for g in plate.geometric if g.name == "flatness")
    of = ((plate.part_no, flat.name),)
    yield variable(FLATNESS, 0.0, flat.zone, len(places), of)
    yield _characteristic(STOP_PLATE, plate, "thickness")


def _zone(name: str, limit: str, pieces: int, matters: Matters, *parts: Part) -> DimensionLimits:
    """Deviations within a zone that every one of these parts states."""
    half = next(g.zone for g in parts[0].geometric if g.name == limit) / 2
    return variable(name, -half, half, pieces, tuple((p.part_no, limit) for p in parts), matters)


def _below(name: str, limit: str, pieces: int, matters: Matters, part: Part) -> DimensionLimits:
    """A flat datum face's own depths: its plane lies on the highest points (ISO 5459)."""
    zone = next(g.zone for g in part.geometric if g.name == limit)
    return variable(name, -zone, 0.0, pieces, ((part.part_no, limit),), matters)


def _characteristic(variable_name: str, part: Part, name: str) -> DimensionLimits:
    c = next(c for c in part.characteristics if c.name == name)
    of = ((part.part_no, name),)
    return variable(variable_name, c.lower - c.nominal, c.upper - c.nominal, 1, of)


Distribution = Literal["normal", "uniform", "corners"]
# Limits are at two standard deviations; parts beyond are sorted out.
SIGMAS = 2.0
# Share of a dimension's variance by one machine's offset, common to a batch; chosen: as much as each piece's
# own.
OFFSET_SHARE = 0.5
# Share of the variance of a wire-cut piece's tightest size by the wire's offset; the other sizes move with
# it. Chosen: the rest is the machine's path and the skimming cuts.
WIRE_SHARE = 0.5


def made(
    variables: Mapping[str, DimensionLimits],
    count: int,
    distribution: Distribution,
    rng: np.random.Generator,
    only: Collection[str] | None = None,
    alike: bool = True,
) -> Deviations:
    """Deviations of the parts of `count` arrays.

    Parameters
    ----------
    variables
        Every dimension with its limits.
    count
        Arrays to make parts for.
    distribution
        `normal`, cut at its limits, which are at SIGMAS standard deviations; `uniform` between them;
        `corners`: on one of them.
    rng
        Source of chance.
    only
        Names of the variables that vary; the others are at the middle of their limits.
    alike
        Whether pieces of one array share their machine's offset, and sizes of a piece their wire's.

    Returns
    -------
    dict of str to Array
        By variable, of shape (count, pieces). Pieces of one array share an offset: a Gaussian copula with a
        correlation of OFFSET_SHARE, so that each piece's own distribution is exactly the one asked for. Sizes
        of a wire-cut piece share the wire's offset likewise, each by its own growth.
    """
    out = {}
    own_chance, wire_chance = rng.spawn(2)  # which draw nothing from rng itself
    by_wire = _by_wire(variables.values()) if alike else {}
    wire = _correlated(wire_chance, count, max((v.pieces for v in variables.values() if v.wire), default=0))
    for name, v in variables.items():
        chance = own_chance if v.apart else rng
        middle, half = (v.upper + v.lower) / 2, (v.upper - v.lower) / 2
        if only is not None and name not in only:
            out[name] = np.broadcast_to(middle, (count, v.pieces))
            continue
        z = _correlated(chance, count, v.pieces, OFFSET_SHARE if alike else 0.0)
        if name in by_wire:
            z = by_wire[name] * wire + np.sqrt(1.0 - by_wire[name] ** 2) * z
        out[name] = middle + half * within_limits(z, distribution)
    return out


def _correlated(chance: np.random.Generator, count: int, pieces: int, share: float = OFFSET_SHARE) -> Array:
    """Standard normal numbers of which the pieces of an array share so much of the variance."""
    shared, own = chance.standard_normal((count, 1)), chance.standard_normal((count, pieces))
    return np.sqrt(share) * shared + np.sqrt(1.0 - share) * own


def _by_wire(variables: Collection[DimensionLimits]) -> dict[str, Array]:
    """Correlation of each size of a wire-cut piece with the wire's offset, by variable and piece."""
    reach = {v.name: (v.upper - v.lower) / 2 / abs(v.wire) for v in variables if v.wire}
    least = min((float(r[r > 0.0].min(initial=np.inf)) for r in reach.values()), default=np.inf)
    ways = {v.name: np.sign(v.wire) for v in variables}
    share = np.sqrt(WIRE_SHARE)
    return {
        name: ways[name] * share * np.divide(least, r, out=np.zeros(len(r)), where=r > 0.0)
        for name, r in reach.items()
    }


def within_limits(z: Array, distribution: Distribution) -> Array:
    """Standard normal numbers as shares of the way from the middle (0) to the limits (-1, 1)."""
    if distribution == "corners":
        return np.where(z < 0.0, -1.0, 1.0)
    share = ndtr(z)
    if distribution == "uniform":
        return 2.0 * share - 1.0
    least = ndtr(-SIGMAS)
    return ndtri(least + share * (1.0 - 2.0 * least)) / SIGMAS
