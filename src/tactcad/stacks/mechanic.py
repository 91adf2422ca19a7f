"""The virtual mechanic: assembles an array by the guide, from parts as made.

Pins are pressed into the tapped plate; elements slide on them; both plates rest with their lower edges on the
setting fixture's steps. Pressed down there, an element touches the fixture's floor with its pad and its pin
with the top of its hole: this sets its height and its turn about the dowel. The stop plate lies on all
ledges. Parts are rigid. With several dowels a row, the first one locates.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.optimize import linprog

from tactcad.mechanics import ladder
from tactcad.mechanics.section import Array, HingeSection
from tactcad.mechanics.strength import overload_stress, tip_compliance
from tactcad.parts.array.clamp import SQUARE, lean
from tactcad.parts.array.element import (
    ARM_LENGTH,
    DOWEL_HOLE,
    LEDGE,
    PAD_HEIGHT,
    PAD_LENGTH,
    STOP_GAP,
    TIP_PLACE,
)
from tactcad.parts.array.hinge_section import arms, hinge_section
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.measurements import WAYS
from tactcad.parts.array.stop_gap import stop_gaps
from tactcad.parts.rigs.setting_fixture import SettingLayout
from tactcad.scenes.requirement import Deviations, DimensionLimits
from tactcad.scenes.scene import Freedom

from .variables import (
    BLANK_LEDGE,
    FLATNESS,
    FLOOR_FLAT,
    IN_PLAY,
    MODULUS,
    PAD_LEAN,
    PIN,
    SHEET,
    STEPS,
    STEPS_LEAN,
    Axis,
    Plate,
    bore_in,
    of_element,
    over_edge,
    own_holes,
    pair_holes,
    squareness,
)

# By scene and beginning of the designator: the freedoms that are taken as set by contacts.
LEVEL: tuple[Freedom, ...] = ("z", "rx", "ry")
TAKEN_AS_SET: dict[str, dict[str, tuple[Freedom, ...]]] = {
    "setting": {"EP": LEVEL, "E": ("z", "ry"), "BL": ("z", "ry")},
    "array": {"ST": LEVEL, "CA": LEVEL},
}
WITHIN = 1.0 - 1e-12  # of a size that another may not pass, so that rounding does not
CUT = 100.0  # stress over yield strength, at most; chosen: whatever is beyond it is gone
PAD = of_element(PAD_HEIGHT)
# The field of HingeSection that a variable sets; the load arm follows from two others.
HINGE = {
    SHEET if field == "width" else of_element(name): field
    for name, (field, *_) in WAYS.items()
    if field not in ("", "load_arm")
}


@dataclass(frozen=True)
class Assembled:
    """Arrays put together: lengths in mm, of shape (arrays, pieces), pieces by element number unless said.

    layout  the design as drawn
    made    deviations of its parts
    """

    layout: Layout
    made: Deviations

    def with_new(self, of: DimensionLimits, deviations: Array) -> Assembled:
        """The same arrays with other parts in one dimension; contacts that it does not enter are not solved
        anew."""
        changed = Assembled(self.layout, {**self.made, of.name: deviations})
        if of.matters != "pads":
            changed.__dict__.update(high=self.high, turn=self.turn)
            if of.matters != "plate":
                changed.__dict__["plate"] = self.plate
        return changed

    # --- where things are as drawn ---

    @cached_property
    def side(self) -> Array:
        """1 for elements of row one, at positive x, -1 for row two."""
        return np.array([1.0 if p.row == 1 else -1.0 for p in self.layout.elements])

    @property
    def row(self) -> NDArray[np.intp]:
        """0 for elements of row one, 1 for row two."""
        return np.where(self.side > 0, 0, 1)

    @cached_property
    def y(self) -> Array:
        return np.array([p.y for p in self.layout.elements])

    @cached_property
    def arm(self) -> Array:
        return arms(self.layout)

    @property
    def dowel_x(self) -> float:
        return min(self.layout.dowel_x)

    @property
    def first_pins(self) -> list[int]:
        """First pins of both rows, among all pins."""
        return [0, len(self.layout.dowel_x)]

    # --- pins and pads over the fixture's floor ---

    def holes(self, which: Plate, axis: Axis) -> Array:
        """Deviations of both rows' first dowel holes in the `tapped` or `head` plate, (arrays, 2)."""
        pair = self.made[pair_holes(axis)]
        own = self.made[own_holes(which, axis)]
        return (pair + own)[:, self.first_pins]

    def over_floor(self, which: Plate) -> Array:
        """Height over nominal of both rows' first holes in a plate on the fixture, (arrays, 2)."""
        at = [1 if which == "tapped" else 0]
        reach = self.dowel_x / SettingLayout(self.layout.design).half  # of a step's half length
        step = self.made[STEPS][:, at] + self.made[STEPS_LEAN][:, at] * reach * np.array([1.0, -1.0])
        return step + self.made[over_edge(which)][:, self.first_pins]

    def pin(self, axis: Axis, y: Array | float) -> Array:
        """Deviation of both rows' first pins along an axis at y, (arrays, 2); along z over the fixture's
        floor, with their ends in the head plate within its play."""
        layout = self.layout
        # as a share of the squareness's zone, which is as wide as SQUARE
        zone = self.made[squareness(axis)][:, self.first_pins]
        thick = layout.design.clamp.end_plate_thickness
        slope = zone / (SQUARE / 2) * lean(layout) / (layout.stack + thick)
        if axis == "x":
            return self.holes("tapped", axis) + slope * (layout.stack / 2 - y)
        root, far = self.over_floor("tapped"), layout.stack + thick / 2
        off = root + slope * far - self.over_floor("head")
        bent = np.sign(off) * np.maximum(np.abs(off) - self.head_play, 0.0)
        return root + (slope - bent / far) * (layout.stack / 2 - y)

    def _pin_at_elements(self, axis: Axis) -> Array:
        at = {y: self.pin(axis, y) for y in sorted(set(self.y))}
        return np.column_stack([at[y][:, r] for y, r in zip(self.y, self.row)])

    @cached_property
    def play(self) -> Array:
        """Diametral play of each element on its pin."""
        h, size = self.layout.design.holes, float(self.layout.design.clamp.dowel)
        return (
            h.dowel_hole
            - size
            + self.made[of_element(DOWEL_HOLE)]
            - self.made[PIN][:, self.first_pins][:, self.row]
        )

    @cached_property
    def high(self) -> Array:
        """Height over nominal of a level element on its pin, from the floor."""
        return self._pin_at_elements("z") - self.play / 2 - self.made[PAD]

    @cached_property
    def turn(self) -> Array:
        """Turn of each element about its dowel, rad, rear end up: its hole hangs on its pin, and an edge of
        its pad, which may lean, rests on the floor, which may be lower there."""
        layout, high = self.layout, self.high - self.made[FLOOR_FLAT]
        inner = (high + self.made[PAD_LEAN]) / (self.dowel_x - layout.pad_inner)
        return np.minimum(inner, (high - self.made[PAD_LEAN]) / (self.dowel_x - layout.pad_outer))

    def raised(self, x: float) -> Array:
        """Contribution of hole and turn to an element's height at a distance from the middle line."""
        return self.high - self.turn * (self.dowel_x - x)

    @cached_property
    def pads(self) -> Array:
        """Height of each pad's middle over the floor's plane."""
        return self.raised((self.layout.pad_inner + self.layout.pad_outer) / 2)

    @property
    def carried(self) -> Array:
        """Height of each pad's middle once the carrier is screwed on: it stays flat, and the stack between
        the end plates turns with them about y until their upper edges lie on it, half of the twist each."""
        middle = (self.layout.pad_inner + self.layout.pad_outer) / 2
        return self.pads - self.twist * self.side * middle * self.y / self.plates_apart

    @property
    def pads_apart(self) -> Array:
        """Highest over lowest pad, (arrays, 1)."""
        return np.ptp(self.carried, axis=1, keepdims=True)

    # --- end plates ---

    @property
    def head_play(self) -> Array:
        """Radial play of the head plate on the tighter of its pins, (arrays, 1)."""
        m = self.made
        play = m[bore_in("head")] - m[PIN]
        return play.min(axis=1, keepdims=True) / 2

    @property
    def head_misses(self) -> Array:
        """Least radial play that the head plate's holes have left over its pins, (arrays, 1).

        The plate shifts and turns within its play: two pins only ask for the distance of its holes.
        """
        y = -self.layout.stack / 2 - self.layout.design.clamp.end_plate_thickness / 2
        off = self.pin("x", y) - self.holes("head", "x")
        return self.head_play - np.abs(off[:, :1] - off[:, 1:]) / 2

    @property
    def press(self) -> Array:
        """Interference of each pin in the tapped plate, (arrays, pins)."""
        return self.made[PIN] - self.made[bore_in("tapped")]

    @property
    def tilt(self) -> Array:
        """The carrier's angles against the fixture's floor, degrees, (arrays, 3), by the plates' upper edges
        over their lower ones: along the row, and across on each plate, between which it lies."""
        along = (self.edges("head") - self.edges("tapped")).mean(axis=1, keepdims=True) / self.plates_apart
        return np.degrees(np.hstack([along, self.across("tapped"), self.across("head")]))

    @property
    def plates_apart(self) -> float:
        """From the middle of one end plate to that of the other, mm."""
        return self.layout.stack + self.layout.design.clamp.end_plate_thickness

    def edges(self, which: Plate) -> Array:
        """How much higher than drawn a plate's upper edge is over its first holes, (arrays, 2)."""
        return self.over_floor(which) - self.holes(which, "z")

    def across(self, which: Plate) -> Array:
        """Slope of a plate's upper edge across the row, (arrays, 1)."""
        edge = self.edges(which)
        return (edge[:, :1] - edge[:, 1:]) / (2 * self.dowel_x)

    @property
    def twist(self) -> Array:
        """By how much the upper edges of both plates differ in slope, rad, (arrays, 1): tapped plate's, at
        +y, less the other's."""
        return self.across("tapped") - self.across("head")

    # --- rows ---

    @cached_property
    def tips(self) -> Array:
        """Deviation of each tip along x, away from the middle, mm."""
        d = self.layout.design
        place = self.made[IN_PLAY] * self.play / 2 + self.turn * (d.holes.height + d.element.pad_height)
        return self.side * self._pin_at_elements("x") + place - self.made[of_element(TIP_PLACE)]

    @property
    def row_gaps(self) -> Array:
        """Gaps between facing tips, by index along the row; of one row, from its tips to the middle line."""
        gap = self.layout.pad_inner + self.tips
        one, two = gap[:, self.side > 0], gap[:, self.side < 0]
        both = min(one.shape[1], two.shape[1])
        return one[:, :both] + two[:, :both] if both else gap

    # --- the stop ---

    def ledges(self, x: float) -> Array:
        """Height of each ledge over its nominal one at so far from the middle line, pads on the floor."""
        return self.raised(x) + self.made[of_element(LEDGE)]

    @cached_property
    def plate(self) -> Array:
        """The stop plate's underside over the ledges' nominal plane: height in the middle and
        slopes along x and y, (arrays, 3). It lies on elements and blanks, where the set screws press."""
        layout, seat = self.layout, self.layout.hold_down_x
        points, heights = np.column_stack([self.side * seat, self.y]), self.ledges(seat)
        if blanks := layout.blanks():  # their fronts lie on the fixture's strip
            way = np.array([1.0 if row == 1 else -1.0 for row, _ in blanks])
            y = np.array([layout.position_y(index) for _, index in blanks])
            points = np.vstack([points, np.column_stack([way * seat, y])])
            heights = np.hstack([heights, self.made[BLANK_LEDGE]])
        return resting_plane(points, heights)

    @cached_property
    def lifts(self) -> Array:
        """Stop plate over each element's own ledge, at its stop land."""
        land = self.layout.pad_inner + self.layout.design.stop.land_length / 2
        over = self.plate[:, :1] + self.plate[:, 1:2] * (self.side * land) + self.plate[:, 2:] * self.y
        return over - self.ledges(land) + self.made[FLATNESS]

    @cached_property
    def gaps(self) -> Array:
        """Stop gap of each element as assembled."""
        return np.array(stop_gaps(self.layout)) + self.made[of_element(STOP_GAP)] + self.lifts

    # --- mechanics ---

    @cached_property
    def section(self) -> HingeSection:
        """Hinges as made, of shape (arrays, elements)."""
        drawn, m = hinge_section(self.layout, self.layout.elements), self.made
        zero = np.zeros(1)  # a full round has no fillet of its own
        changed = {f: getattr(drawn, f) + m.get(name, zero) for name, f in HINGE.items()}
        arm = m[of_element(ARM_LENGTH)] - m[of_element(PAD_LENGTH)] / 2
        modulus = drawn.youngs_modulus * (1.0 + m[MODULUS])
        # a fillet is never higher than the arm
        deep = WITHIN * (changed["arm_height"] - changed["hinge_thickness"]) / drawn.notch_sides
        full = np.minimum(np.minimum(changed["fillet_radius"], changed["hinge_length"] / 2), deep)
        return drawn.with_(
            **{**changed, "load_arm": drawn.load_arm + arm, "youngs_modulus": modulus, "fillet_radius": full}
        )

    @cached_property
    def stiffness(self) -> Array:
        """K of each element as built, N/mm; NaN beyond the estimator's range."""
        return ladder.evaluate(self.section).stiffness

    @cached_property
    def closing_force(self) -> Array:
        """Force at the pad that closes each stop, N; NaN as the stiffness."""
        return self.gaps / tip_compliance(self.section, self.stiffness, self.arm)

    @property
    def yield_shares(self) -> Array:
        """Stress at each fillet under the overload force, its stop closed, over the yield strength.

        For a hinge out of the estimator's range, the stiffness is the section's integral, as for the drawn
        gaps; if its limits leave no hinge or sheet, CUT.
        """
        s, d = self.section, self.layout.design
        K = ladder.stiffness_beyond_the_fit(s)
        load, give = d.rating.overload_force, self.layout.stop_give
        with np.errstate(invalid="ignore", divide="ignore"):
            closing = np.minimum(self.gaps / tip_compliance(s, K, self.arm), load)
            stress = overload_stress(s, K, self.arm, give, closing, load)
        share = stress / d.material.yield_strength
        return np.where(share < CUT, share, CUT)  # not a number if there is no hinge


BLOCK = 2000  # rows of one program: below that a call's own cost, above it the solver's growth, tells


def resting_plane(points: Array, heights: Array) -> Array:
    """The plane that rests on points, pressed down in their middle.

    Parameters
    ----------
    points
        (n, 2) places of the points, mm; the pressing force goes through their origin.
    heights
        (arrays, n) heights of the points, mm.

    Returns
    -------
    Array
        (arrays, 3): height at the origin and slopes along both axes, so that the plane is below no point and
        as low at the origin as possible; of planes that rock over two points, the one closest to all.
    """
    return _resting(np.asarray(points, float).tobytes(), np.asarray(heights, float).tobytes())


@lru_cache(maxsize=16)  # designs that are compared draw the same heights where only their hinges differ
def _resting(places: bytes, drawn: bytes) -> Array:
    points = np.frombuffer(places).reshape(-1, 2)
    n = len(points)
    heights = np.frombuffer(drawn).reshape(-1, n)
    plane = np.column_stack([np.ones(n), points])
    most = np.ones((n, 1))  # the largest distance over a point, which only decides between equals
    design = np.vstack([np.hstack([-plane, 0.0 * most]), np.hstack([plane, -most])])
    free = (None, None)
    limits = np.hstack([-heights, heights])
    return _blocks(design, limits, [1.0, 0.0, 0.0, ROCKING], [free, free, free, free])[:, :3]


ROCKING = 1e-3


def _blocks(design: Array, limits: Array, cost: list[float], bounds: list[tuple]) -> Array:
    """Solutions x of: least cost x with design x <= limits, for every row of `limits`."""
    at_once = max(1, BLOCK // len(design))
    solved = []
    scale = max(float(np.abs(limits).max()), 1e-9)  # solvers' tolerances are 1e-7: micrometres become ones
    for start in range(0, len(limits), at_once):
        some = limits[start : start + at_once] / scale
        m = len(some)
        result = linprog(
            np.tile(cost, m),
            A_ub=sparse.kron(sparse.eye_array(m), sparse.csr_array(design), format="csr"),
            b_ub=some.ravel(),
            bounds=bounds * m,
            method="highs",
        )
        if result.status != 0:
            raise RuntimeError(f"contacts of arrays {start} to {start + m}: {result.message}")
        solved.append(result.x.reshape(m, -1) * scale)
    return np.vstack(solved)
