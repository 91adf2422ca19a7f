"""Designs constructed to keep every rule, by their own geometry: each dimension is chosen to leave room for
the next.

The bounds are worked out here from the standards' tables and the layout as described, not from the rules'
code. Every number goes over its whole legal range, as far as the ones chosen before it leave room, by the
logarithm where that spans decades. What a shop can make bounds some of them: a wire of 0.25 mm, drills, taps.
"""

from __future__ import annotations

from dataclasses import fields
from math import ceil, cos, degrees, exp, floor, hypot, log, log10, pi, sqrt, tan
from random import Random
from typing import Any

from hypothesis import strategies as st

from tactcad.design.family import section_types
from tactcad.design.fields import Number
from tactcad.design.load import from_table
from tactcad.design.materials import PLATE_ALLOYS
from tactcad.design.tree import Design
from tactcad.parts.bought.screws import SET_SCREW_LENGTHS
from tactcad.parts.language.metric import METRIC

CAP_LENGTHS = (2, 2.5, 3, 4, 5, 6, 8, 10, 12, 16, 20, 25, 30)
M6_UPPER = {"2": 0.008, "2.5": 0.008, "3": 0.008, "4": 0.012, "5": 0.012}  # ISO 286-2
# The shop that comes with tactcad: wire/2 + gap, one cut, aluminium's wall, drills' and taps' reach in
# diameters.
CORNER, CUT, WALL, DRILL_REACH, TAP_REACH = 0.15, 0.3, 0.8, 10.0, 3.0
LEAST_SPACER = 0.1
LEAD = 0.25  # mm, AWG 36 with its insulation

# Numbers by path: what the design file may hold; stop.gaps holds several.
LEGAL: dict[str, Number] = {
    f"{section}.{f.name}": f.metadata["spec"]
    for section, kind in section_types(Design).items()
    if section != "origin"
    for f in fields(kind)
    if isinstance(f.metadata.get("spec"), Number)
}


SEEDS = st.integers(0, 2**48)


class Draw:
    """Draws for one design; a number by its path, within its legal range and the room that is left.

    hypothesis draws the seed of a design, not its numbers: of a hundred numbers it would draw four in five in
    the lowest tenth of their ranges (measured), which is no way to cover them.
    """

    def __init__(self, seed: int, ends: int = 20) -> None:
        """An end of a range is drawn once in `ends` draws."""
        self.random, self.ends = Random(seed), ends
        self.table: dict[str, Any] = {}
        self.most: dict[str, float] = {}  # by path, of numbers that `rest` chooses

    def choose_fasteners(self) -> None:
        screw, dowel = (
            self.put("clamp.screw", self.choice(*METRIC)),
            self.put("clamp.dowel", self.choice(*M6_UPPER)),
        )
        self.m, self.dowel = METRIC[screw], float(dowel)
        # full thread through the carrier: 1.5 d of the mount's in 3 d of the screw's
        mounts = [name for name in ("M3", "M4", "M5") if METRIC[name].d <= 2 * self.m.d]
        self.mounted = METRIC[self.put("clamp.mount_thread", self.choice(*mounts))]

    def choice(self, *options):
        return self.random.choice(options)

    def once_in(self, draws: int) -> bool:
        return self.random.randrange(draws) == 0

    def between(self, low: float, high: float) -> float:
        """By the logarithm where that is more than a decade, an end every now and then; in whole micrometres,
        or four digits if smaller."""
        if high <= low:
            return ceil(low * 1e6 - 1e-6) / 1e6
        u = self.random.choice((0.0, 1.0)) if self.once_in(self.ends) else self.random.random()
        value = exp(log(low) + u * log(high / low)) if 0 < 10 * low < high else low + u * (high - low)
        steps = 1000.0 if abs(value) >= 0.1 or value == 0 else 10 ** (3 - floor(log10(abs(value))))
        first, last = ceil(low * steps - 1e-6), floor(high * steps + 1e-6)
        return min(max(first, round(value * steps)), max(first, last)) / steps

    def number(self, path: str, low: float | None = None, high: float | None = None) -> float:
        """A value for the field at `path`, in its legal range and between the bounds; kept in the table."""
        legal = LEGAL[path]
        low = legal.low if low is None else min(max(low, legal.low), legal.high)
        high = legal.high if high is None else max(min(high, legal.high), low)
        self.table[path] = self.between(low, high)
        return self.table[path]

    def put(self, path: str, value: Any) -> Any:
        self.table[path] = value
        return value

    def rest(self, section: str) -> None:
        """Every number of a section that was not chosen yet, over its whole range."""
        for path in LEGAL:
            if path.startswith(f"{section}.") and path not in self.table:
                self.number(path, high=self.most.get(path))


def sound_table(seed: int, row_lengths: tuple[int, ...], rigs: bool = False) -> dict[str, Any]:
    """Values by path of a design that keeps every rule: one or two rows, either notch form, any screw and
    dowel.

    With `rigs` the array is small enough for them, and their tables are drawn too.
    """
    d = Draw(seed)
    # a small array under the rigs: what fits between the screws of the calibration mount, and under the bar
    d.longest_stack, d.widest_pad, d.across_mount = (28.0, 20.0, 41.0) if rigs else (2900.0, 48.0, 500.0)
    # most of them no heavier than the guide's base bears: rear bodies, arms, and their height
    d.deepest, d.longest_arm, d.highest = (
        (40.0, 30.0, 12.0) if rigs and not d.once_in(4) else (150.0, 100.0, 48.0)
    )
    d.most_rings = max(row_lengths)
    d.choose_fasteners()
    d.put("clamp.plate_alloy", d.choice(*PLATE_ALLOYS))
    rows = _stack(d, row_lengths)
    _hinge(d)
    _arms(d, rows)
    _loads(d)
    _clamp(d)
    thinnest = min(t for path, t in d.table.items() if path.endswith(".hinge_thickness"))
    d.most = {"tolerance.hinge_thickness": thinnest / 4}
    from sound_readout import draw_readout

    draw_readout(d)
    for section in ("tolerance", "rating"):
        d.rest(section)
    if rigs:
        from sound_rigs import sound_rigs

        sound_rigs(d)
    return d.table


def _stack(d: Draw, row_lengths: tuple[int, ...]) -> list[int]:
    """Rows, sheet and spacer: a stack at least as long as the set screw between the end plates; returns the
    rows."""
    rows = [d.choice(*row_lengths) for _ in range(d.choice(1, 2))]
    n, least = max(rows), d.m.d + 0.6
    wide = (
        1.9 if d.longest_stack < 100 and d.once_in(2) else LEAST_SPACER
    )  # room for the calibration's roller
    spacer = d.number("array.spacer", wide, min(30.0, d.longest_stack / n / 2))
    thin = max((least - spacer) / n, LEAD) - spacer
    # ledges carry a stop plate that is higher than they are apart
    thin = max(thin, 1.5 - spacer, *([round(spacer / 3 + 5e-4, 3), 2.0] if n == 1 else []))
    sheet = d.number("sheet.thickness", thin, (d.longest_stack - spacer) / n - spacer)
    d.put("array.pitch", round(sheet + spacer, 3))
    return rows


def _hinge(d: Draw) -> None:
    """Hinge, arm height, and the ledge over the arm."""
    sides = d.put("element.sides", d.choice("one", "two"))
    notches = 1 if sides == "one" else 2
    t = d.number("element.hinge_thickness")
    r = d.number("element.fillet_radius", CORNER, 40 / notches)
    # at least as long as a third of its thickness: of a shorter one the roots turn more than the leaf
    # and of a slot from both sides a gauge finds room on the floor
    l = d.number("element.hinge_length", max(2 * r + (0.0 if sides == "one" else 0.5), CUT, t / 3))
    h = d.number("element.arm_height", max(WALL, t + notches * r) + 0.05, d.highest)
    # the stop plate clears the root of the ledge, and reaches to the set screws and the outermost ledge
    widest = min(0.3 + (d.m.d - d.m.set_point) / 2, d.table["array.spacer"] + d.table["sheet.thickness"] / 2)
    corner = d.number("element.corner_radius", CORNER, widest)
    d.rise = d.between(0.2929 * corner + 0.1, max(0.2929 * corner + 0.2, (d.highest + 2 - h) / notches))
    d.put("element.body_height", round(h + notches * d.rise, 3))
    d.t, d.r, d.l, d.h, d.corner, d.two = t, r, l, h, corner, notches == 2
    d.bottom = -d.rise if d.two else 0.0
    d.ledge = round(h + d.rise, 6)


def _arms(d: Draw, rows: list[int]) -> None:
    """Pad, gauge and land, and arms long enough for them."""
    half = d.l / 2
    root = d.number("element.pad_root_radius", CORNER)
    pad = d.number("element.pad_length", WALL + 0.05, min(d.widest_pad, 99 - root - half))
    # gauge and leads beside it stay off the object
    out = LEAD + (d.number("gauge.grid_height") if not d.two else d.rise)
    d.number("element.pad_height", max(root, out))
    d.carrier_most = d.l / 2 - d.r if d.two else 99 - pad - root
    carrier = d.number("gauge.carrier_arm_side", high=d.carrier_most)
    grid = d.number("gauge.grid_length", high=min(d.l, 2 * carrier))
    sheet = d.table["sheet.thickness"]
    d.number("gauge.grid_width", high=d.number("gauge.carrier_width", 0.02, sheet))
    d.carrier_least = grid / 2
    over = d.rise + d.corner * tan(pi / 8) + half
    land = d.number("stop.land_length", high=98.8 - over)
    shortest = max(pad + root + half, pad + root + carrier, land + over + 0.1)
    shortest, longest = (
        min(shortest + 0.002, 100.0),
        max(d.longest_arm, min(shortest + 0.002, 100.0)),
    )  # no sliver of half a micrometre beside the pad's root
    d.arms = [[d.between(shortest, longest) for _ in range(n)] for n in rows]
    # The shortest arm's body reaches as far as the longest arm's: both halves of a length B at which it bends
    # by a third of what its hinge does: 4 (B + L)^3/H^3 of 12 l L^2/t^3.
    least = min(map(min, d.arms))
    lever = least - pad / 2
    d.stiff_body = (d.table["element.body_height"] / d.t * (d.l * lever**2) ** (1 / 3) - lever) / 2
    d.arms = [[min(a, round(least + max(d.stiff_body, 0.0), 3)) for a in row] for row in d.arms]
    d.put("array.row_arms", d.arms)
    _overrides(d)


def _overrides(d: Draw) -> None:
    """Some elements with a hinge of their own: thinner, rounder or shorter, its arm a little lower."""
    for n in range(1, sum(map(len, d.arms)) + 1):
        if not d.once_in(12):
            continue
        own = f"element.override.{n}"
        t = d.put(f"{own}.hinge_thickness", d.between(max(0.005, d.t / 2), d.t))
        r = d.put(f"{own}.fillet_radius", d.between(CORNER, d.r))
        d.put(f"{own}.hinge_length", d.l if d.two else d.between(max(2 * r, CUT, 0.7 * d.l), d.l))
        if not d.two:  # two-sided bodies of another arm height would have their ledge in another plane
            d.put(f"{own}.arm_height", d.between(max(WALL, t + r, d.h - 0.1) + 0.01, d.h))


def _loads(d: Draw) -> None:
    """Material, and what its stops and loads may be: by the leaf's beam theory, with a factor of 2 for what
    it misses."""
    least, most = min(map(min, d.arms)), max(map(max, d.arms))
    pad, sheet = d.table["element.pad_length"], d.table["sheet.thickness"]
    factor = d.number("rating.deflection_factor", high=5.0)
    # an arm that rubs gives way by a share of what a smooth one does: 1 - mu H/L, here half or more
    lever = d.table["element.pad_height"] + d.t / 2
    friction = d.number("rating.friction", high=0.5 * (least - pad / 2) / lever)
    yielding = 1 - friction * lever / (least - pad / 2)
    # deflection at the tip when a leaf of length l yields: 2 (stress/E) a l/t
    bend = 2 / factor * (max(d.l - 2 * d.r, 0) + sqrt(d.r * d.t)) / d.t
    room = d.rise - 0.2929 * d.corner - 0.005
    open_slot = min(0.3 * d.l * least / d.h, room)
    low = 2 * 0.04 / (yielding * bend * least)
    high = max(0.5 * open_slot / (bend * least), low)
    d.put("material.alloy", "drawn")  # a label of its own: its values are nobody else's
    ratio = d.between(min(max(low, min(high, 3e-4), 1e-5), 0.5), min(max(high, 1e-5), 0.5))
    # N for each MPa of yield, so that what passes the closed stop by its lever 1 - L/a and half the hinge's
    # length stays a tenth of it; no overload is smaller than a millionth of a newton
    force = (
        0.7
        / factor
        * min(
            sheet * d.t**2 / (6 * L) * min(3, 0.1 * L / ((1 - L / a) * d.l / 2))
            for a in (least, most)
            for L in [a - pad / 2]
        )
    )
    E = d.number("material.youngs_modulus", max(1e3, 1 / ratio, 2e-6 / force / ratio), min(1e6, 5000 / ratio))
    strength = d.number("material.yield_strength", E * ratio, E * ratio)
    d.rest("material")
    d.elastic = 0.2 * yielding * bend * factor * least * ratio  # mm of deflection that no hinge yields at
    d.room = gap = min(room, yielding * bend * least * ratio)
    tolerance = d.number("stop.tolerance", high=gap / 40)
    d.number("tolerance.ledge", high=gap / 40)
    d.number("rating.overload_force", high=force * strength)
    # rows that stay apart when facing pads turn towards each other
    d.number("tolerance.hinge_length", high=d.l / 10)
    off = 2 * d.number("tolerance.load_arm", high=(49 - pad) / 4)
    turn = min(room, 3 * bend * most * ratio) + tolerance
    towards = 2 * (d.table["element.pad_height"] + d.h) * turn / least
    closest = pad + max(0.1, off) + towards
    if closest > LEGAL["array.row_pitch"].high:
        _one_row(d)
    d.number("array.row_pitch", closest, 2.8 * d.widest_pad - pad)
    if gap > 0.04 and d.once_in(5):
        arm = d.choice(*d.arms[0])
        d.put("stop.gaps", {repr(arm): d.between(2 * tolerance, 4 * tolerance)})
    d.number("tolerance.sheet_thickness", high=d.table["array.spacer"] - 0.0301)
    d.number("tolerance.arm_height", high=0.29 * d.corner)


def _one_row(d: Draw) -> None:
    """The longer row alone: the longest soft arms cannot be kept apart at any legal row pitch."""
    d.arms = [max(d.arms, key=len)]
    d.put("array.row_arms", d.arms)
    for path in [path for path in d.table if path.startswith("element.override.")]:
        del d.table[path]


def _clamp(d: Draw) -> None:
    """Holes in the rear bodies, end plates, stop plate, and the carrier over them."""
    m, mounted, dowel, corner = d.m, d.mounted, d.dowel, d.corner
    sheet, spacer = d.table["sheet.thickness"], d.table["array.spacer"]
    counterbore, nut_corner = m.head + 0.5, m.nut / cos(pi / 6)
    head = max(counterbore, nut_corner) / 2

    # stop plate's seat, set screws beside the rear bodies
    gap = d.number("clamp.stop_plate_gap", corner, min(0.3 + (m.d - m.set_point) / 2, spacer + sheet / 2))
    shortest = max(corner + gap + 0.5, m.d / 2 + 0.3, m.d + 0.6 - min(map(min, d.arms)))
    seat = d.number("element.seat_length", shortest, max(d.stiff_body, 2.0))

    # the carrier; a set screw through it reaches down to the stop plate
    fixing = min(n for n in CAP_LENGTHS if n - 1.5 * m.d - 0.8 >= 2 - 1e-9)
    least = max(fixing - 1.5 * m.d - 0.8 + m.head_height + 0.2, 1.5 * mounted.d, 1.5 * m.d + 1)
    thickness = d.number("clamp.carrier_thickness", least, min(TAP_REACH * m.d, d.across_mount / 5))
    longest = SET_SCREW_LENGTHS[d.table["clamp.screw"]][-1]
    reach = longest - thickness + 1
    top = min(d.ledge + 20 + reach, 100.0) - 0.01
    cone = m.tap_drill / 2 / tan(pi * 59 / 180)
    over = max(counterbore, dowel) / 2 + 1 + 1.5 * m.d + 1.5 + 2 * m.pitch + cone

    # holes in the rear bodies
    upper = d.number("holes.dowel_hole_upper", high=0.05)
    pin = dowel + M6_UPPER[d.table["clamp.dowel"]] + 0.002  # what a plug gauge tells from none
    hole = d.number("holes.dowel_hole", pin, pin + 0.05)
    widest = max(m.clearance, hole + upper)
    layers = ceil(3 / floor(d.table["array.pitch"] / LEAD + 1e-9))
    recess = d.number(
        "element.recess_depth", max(corner + d.bottom + 0.001, layers * LEAD), max(top / 8, layers * LEAD)
    )
    bottom = d.number("clamp.spacer_bottom", recess, recess + top / 16)
    web = d.number("holes.web", WALL, top / 8)
    drop = d.number("clamp.spacer_drop", high=top / 16)
    under = max(counterbore / 2 + 1, nut_corner / 2 + 0.1, dowel / 2 + 1)
    height = d.number(
        "holes.height",
        max(bottom + web + widest / 2, under),
        min(top - over, top - 0.1 - drop - web - widest / 2),
    )
    d.number("clamp.end_plate_bottom", high=height - under)
    rear = d.number(
        "element.rear_height", max(height + web + widest / 2 + drop, d.ledge + 2 * corner), top - 0.1
    )
    lowest = max(height + over, rear + 0.1)
    most = 7 * sheet if max(map(len, d.arms)) == 1 else None
    stop_plate = d.number("clamp.stop_plate_thickness", lowest - d.ledge - reach, most)
    plate_bottom = d.table["clamp.end_plate_bottom"]
    if d.once_in(5):  # given instead of derived: up to where the set screw is just engaged
        on = d.ledge + stop_plate
        lengths = SET_SCREW_LENGTHS[d.table["clamp.screw"]]
        screw = next(
            (n for n in lengths if on + n - thickness + 1 >= lowest and n >= thickness - 0.9), longest
        )
        low = on + max(screw - thickness + 1, 0.1) - plate_bottom
        d.number("clamp.end_plate_height", low, low + thickness - 1 - 1.5 * m.d)

    # screws and dowels behind the clamp edge
    step = max(widest + web, 2 * max(head, dowel / 2) + 0.5, nut_corner + 1.35) + 0.001
    counts = ((1, 1), (2, 1), (1, 2), (2, 2), (4, 1), (8, 4))
    screws, dowels = d.choice(*(c for c in counts if sum(c) * step < 150))
    kinds = ["screw"] * screws + ["dowel"] * dowels
    order = d.random.sample(kinds, len(kinds))
    if len(d.arms) == 1 or len(d.arms[0]) != len(d.arms[1]):  # blanks: a dowel far from their fronts
        order.remove("dowel")
        order.append("dowel")
    least = max(web + widest / 2, head)
    spots = [d.between(least, max(least, 30.0))]
    for _ in order[1:]:
        spots.append(round(spots[-1] + d.between(step, max(step, (d.deepest - spots[-1]) / len(order))), 3))
    d.put("holes.screw_offsets", [x for x, kind in zip(spots, order) if kind == "screw"])
    d.put("holes.dowel_offsets", [x for x, kind in zip(spots, order) if kind == "dowel"])
    offset = d.number("clamp.carrier_screw_offset", counterbore + mounted.d + 1.5, d.deepest)
    rear_end = max(spots[-1] + max(web + widest / 2, head + 1), offset + counterbore / 2 + 1)
    over = max(d.ledge - recess, 0.0)
    behind = sqrt(max(web**2 - over**2, 0.0)) + 0.001
    # ten diameters of the leads are bonded in the recess, behind the terminals
    glued = corner + 10 * LEAD + 0.2 + 1.2
    # a blank's dowel is not all too near its front
    longest = min(1.5 * d.deepest, 15 * max(d.table["holes.dowel_offsets"]))
    length = d.number("element.rear_length", max(rear_end, behind + glued), longest)
    start = d.number("element.recess_offset", behind, length - glued)
    d.recess = length - start
    d.longest_way = d.table["array.row_pitch"] + max(map(max, d.arms)) + seat + length + d.longest_stack
    d.number("gauge.carrier_body_side", d.carrier_least, min(d.carrier_most, seat + 0.35 * d.l + start))

    # plates
    drilled = DRILL_REACH * min(m.tap_drill, dowel)
    stack = max(map(len, d.arms)) * d.table["array.pitch"] + spacer
    least = max(m.tap_drill + 2, dowel + 3.5)  # the setting fixture's pins in their steps
    d.number("clamp.end_plate_thickness", least, min(drilled, (d.across_mount - stack) / 2))
    d.number(
        "clamp.mount_pitch_y",
        max(5, mounted.d + 0.5, mounted.head + 1.1 if d.widest_pad < 48 else 0),
        d.across_mount - 10 - 2 * mounted.d,
    )
    apart = d.number("clamp.hold_down_pitch", 2 * m.d + 1)
    edge = _press_on(d, apart, stop_plate, stack)
    # the end plate between the carrier's screws, under all the force: a tenth of the pads' tolerance
    high = d.table.get("clamp.end_plate_height", lowest - plate_bottom)
    bend = bends(2 * (edge + offset), d.table["clamp.end_plate_thickness"], high)
    # pads that stand off the surface plate take from the stops' gaps: a twentieth of these
    d.most_pad = min((hole + upper / 2 - pin) / 2 + d.room / 30, 0.08 * _shortest_span(d))  # 5 degrees
    force = d.table["rating.overload_force"]
    d.put("rating.overload_force", min(force, d.most_pad / (10.5 * bend)))
    d.number("tolerance.pad_height", min(10.5 * bend * force, d.most_pad), d.most_pad)
    d.number("tolerance.tilt", least_tilt(d))
    for name in ("end_plate_margin", "carrier_margin"):
        d.number(f"clamp.{name}")
    # how far the pads stand from the middle
    d.far_x = (d.table["array.row_pitch"] + d.table["element.pad_length"]) / 2
    d.far_y = (stack - 2 * spacer) / 2


def least_tilt(d: Draw) -> float:
    """Degrees that dowel holes and pads may leave the carrier off square."""
    rows = min(d.table["holes.dowel_offsets"])
    return 1.01 * degrees(hypot(0.015 / rows, d.table["tolerance.pad_height"] / _shortest_span(d))) + 1e-3


def _shortest_span(d: Draw) -> float:
    """Between dowels, from the clamp edge, which is further out than the middle, or along a row."""
    spans = [2 * min(d.table["holes.dowel_offsets"]), (max(map(len, d.arms)) - 1) * d.table["array.pitch"]]
    return min(s for s in spans if s > 0)


def bends(span: float, width: float, high: float) -> float:
    """mm/N of a bar of aluminium between two supports, bending and shear."""
    return span**3 / (4 * 69e3 * width * high**3) + span / (4 * 5 / 6 * 25.9e3 * width * high)


def _press_on(d: Draw, apart: float, thick: float, stack: float) -> float:
    """No more force than bends the stop plate by a hundredth of what leaves its gap. Two Euler beams of
    steel, half as stiff for shear and set screws: across to the set screws, and along the row between them.
    Returns half the stop plate's room across (mm)."""
    longest = max(
        v for path, v in d.table.items() if path.endswith("hinge_length") and path.startswith("element")
    )
    gap, pad = d.table["clamp.stop_plate_gap"], d.table["element.pad_length"]
    edge = (d.table["array.row_pitch"] - pad) / 2 + max(map(max, d.arms)) + longest / 2
    edge += d.table["element.seat_length"]
    across, along = 2 * edge, min(apart, stack)
    wide = min(0.6 * (across - d.m.d - 0.6), stack - 2 * gap)
    bend = across**3 / wide + along**3 / (2 * (edge - gap))
    softest = 2 * bend / (4 * 2e5 * thick**3) + 1e-4
    most = d.room / 100 / softest
    d.put("rating.overload_force", min(d.table["rating.overload_force"], max(1e-6, most)))
    return edge


@st.composite
def sound_designs(draw, row_lengths=(1, 2, 3, 5, 8, 13)) -> Design:
    """A design that keeps every rule, without rigs."""
    return from_table(as_table(sound_table(draw(SEEDS), row_lengths)))


def as_table(values: dict[str, Any]) -> dict[str, Any]:
    """Values by dotted path as the nested dict that TOML gives, with a name for the design."""
    tree: dict[str, Any] = {
        "design": {
            "name": "drawn",
            "title": "Drawn by chance",
            "revision": "A",
            "date": "2026-11-21",
            "author": "tactcad",
            "organisation": "tactcad",
        }
    }
    for path, value in values.items():
        *sections, name = path.split(".")
        node = tree
        for section in sections:
            node = node.setdefault(section, {})
        node[name] = value
    return tree
