"""The virtual mechanic: puts an array together as the guide says, from parts as they were made.

Pins are pressed into the tapped plate; elements slide on them; the stack stands with its pads on a surface
plate and is clamped there, each element free within its dowel's play; the head plate is levelled within its
own; the stop plate lies on all ledges. Parts are rigid. With several dowels a row, the first one locates.

Contacts between the parts are small linear programs, solved for many arrays at a time.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.optimize import linprog

from tactcad.mechanics import ladder, strain
from tactcad.mechanics.section import Array, HingeSection
from tactcad.mechanics.strength import back_share, stress_share, tip_compliance
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
from tactcad.parts.array.hinge_section import hinge_section
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.measurements import WAYS
from tactcad.parts.array.stop_gap import stop_gap
from tactcad.scenes.requirement import Deviations, DimensionLimits

from .variables import (
    BLANK_LEDGE,
    FLATNESS,
    IN_PLAY,
    MODULUS,
    PIN,
    SHEET,
    Axis,
    Plate,
    bore_in,
    of_element,
    own_holes,
    pair_holes,
    squareness,
)

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
            changed.__dict__["pose"] = self.pose
            if of.matters != "plate":
                changed.__dict__["plate"] = self.plate
        return changed

    # --- where things are as drawn ---

    @cached_property
    def side(self) -> Array:
        """1 for elements of row one, which stand at positive x, -1 for row two."""
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
        return np.array([p.arm for p in self.layout.elements])

    @property
    def dowel_x(self) -> float:
        return min(self.layout.dowel_x)

    @property
    def first_pins(self) -> list[int]:
        """Of both rows, among all pins."""
        return [0, len(self.layout.dowel_x)]

    @property
    def at_dowels(self) -> Array:
        """Places of the elements' dowel holes, (elements, 2)."""
        return np.column_stack([self.side * self.dowel_x, self.y])

    # --- pins and the pads on the surface plate ---

    def holes(self, which: Plate, axis: Axis) -> Array:
        """How far the first dowel holes of both rows are off in the `tapped` or `head` plate, (arrays, 2)."""
        pair = self.made[pair_holes(axis)]
        own = self.made[own_holes(which, axis)]
        return (pair + own)[:, self.first_pins]

    def pin(self, axis: Axis, y: Array | float) -> Array:
        """How far the first pins of both rows are off along an axis at y, (arrays, 2)."""
        layout = self.layout
        # as a share of the squareness's zone, which is as wide as SQUARE
        zone = self.made[squareness(axis)][:, self.first_pins]
        slope = lean(layout) / (layout.stack + layout.design.clamp.end_plate_thickness)
        return self.holes("tapped", axis) + zone / (SQUARE / 2) * slope * (layout.stack / 2 - y)

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
    def pose(self) -> Array:
        """Where the tapped plate stands over the surface plate: its height in the middle, its slopes along x
        and y, as level as the pads allow, and by how much the worst pad misses."""
        heights = self.made[PAD] - self._pin_at_elements("z")
        return nearest_pose(self.at_dowels, heights, self.play / 2)

    def stands(self, points: Array) -> Array:
        """Height of the tapped plate's frame over the surface plate at points (n, 2), (arrays, n)."""
        return self.pose[:, :1] + self.pose[:, 1:3] @ points.T

    @cached_property
    def pads(self) -> Array:
        """Height of each pad over the surface plate: what its pin carries it off; negative where it would
        press into the plate, and so lifts the others."""
        beyond = self.stands(self.at_dowels) + self._pin_at_elements("z") - self.made[PAD]
        return np.sign(beyond) * np.maximum(np.abs(beyond) - self.play / 2, 0.0)

    @property
    def pads_apart(self) -> Array:
        """Highest over lowest pad, (arrays, 1)."""
        return np.ptp(self.pads, axis=1, keepdims=True)

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
        """By how much each pin is larger than its hole in the tapped plate, (arrays, pins)."""
        return self.made[PIN] - self.made[bore_in("tapped")]

    @property
    def tilt(self) -> Array:
        """The carrier's angles against the plane of the pads, along the row and across, degrees, (arrays, 2).

        The head plate is levelled with the tapped one as far as the play of its holes allows.
        """
        layout = self.layout
        y = layout.stack / 2 + layout.design.clamp.end_plate_thickness / 2
        ends = {}  # heights of the upper edges over the pins, as drawn 0
        sides: tuple[tuple[Plate, float], ...] = (("tapped", y), ("head", -y))
        for which, at in sides:
            points = np.array([[self.dowel_x, at], [-self.dowel_x, at]])
            ends[which] = self.stands(points) + self.pin("z", at) - self.holes(which, "z")
        off = ends["head"] - ends["tapped"]
        left = np.sign(off) * np.maximum(np.abs(off) - self.head_play, 0.0)
        along = left.mean(axis=1, keepdims=True) / (2 * y)
        across = (ends["tapped"][:, :1] - ends["tapped"][:, 1:]) / (2 * self.dowel_x)
        return np.degrees(np.hstack([along, across]))

    # --- rows ---

    @cached_property
    def tips(self) -> Array:
        """How far each tip is off along x, away from the middle, mm."""
        place = self.made[IN_PLAY] * self.play / 2
        return self.side * self._pin_at_elements("x") + place - self.made[of_element(TIP_PLACE)]

    @property
    def row_gaps(self) -> Array:
        """Gaps between facing tips, by index along the row; of one row, from its tips to the middle line."""
        gap = self.layout.pad_inner + self.tips
        one, two = gap[:, self.side > 0], gap[:, self.side < 0]
        both = min(one.shape[1], two.shape[1])
        return one[:, :both] + two[:, :both] if both else 2 * gap

    # --- the stop ---

    @cached_property
    def ledges(self) -> Array:
        """Height of each ledge over its nominal one, pads on the surface plate."""
        return self.pads + self.made[of_element(LEDGE)]

    @cached_property
    def plate(self) -> Array:
        """The stop plate's underside over the ledges' nominal plane: height in the middle and
        slopes along x and y, (arrays, 3). It lies on elements and blanks, where the set screws press."""
        layout, seat = self.layout, self.layout.hold_down_x
        points, heights = np.column_stack([self.side * seat, self.y]), self.ledges
        if blanks := layout.blanks():
            way = np.array([1.0 if row == 1 else -1.0 for row, _ in blanks])
            y = np.array([layout.position_y(index) for _, index in blanks])
            pins = self.stands(np.column_stack([way * self.dowel_x, y]))
            points = np.vstack([points, np.column_stack([way * seat, y])])
            heights = np.hstack([heights, pins + self.made[BLANK_LEDGE]])
        return resting_plane(points, heights)

    @cached_property
    def lifts(self) -> Array:
        """Stop plate over each element's own ledge, at its stop land."""
        land = self.layout.pad_inner + self.layout.design.stop.land_length / 2
        over = self.plate[:, :1] + self.plate[:, 1:2] * (self.side * land) + self.plate[:, 2:] * self.y
        return over - self.ledges + self.made[FLATNESS]

    @cached_property
    def gaps(self) -> Array:
        """Stop gap of each element as assembled."""
        drawn = np.array([stop_gap(self.layout, p) for p in self.layout.elements])
        return drawn + self.made[of_element(STOP_GAP)] + self.lifts

    # --- mechanics ---

    @cached_property
    def section(self) -> HingeSection:
        """Hinges as made, of shape (arrays, elements)."""
        drawn, m = hinge_section(self.layout, self.layout.elements), self.made
        zero = np.zeros(1)  # a full round has no fillet of its own
        changed = {f: getattr(drawn, f) + m.get(name, zero) for name, f in HINGE.items()}
        arm = m[of_element(ARM_LENGTH)] - m[of_element(PAD_LENGTH)] / 2
        modulus = drawn.youngs_modulus * (1.0 + m[MODULUS])
        # nor does a fillet reach higher than the arm
        deep = (changed["arm_height"] - changed["hinge_thickness"]) / drawn.notch_sides
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

        Where the estimator does not reach a hinge, its stiffness is the section's integral, as for the drawn
        gaps; where its limits leave no hinge or sheet, CUT.
        """
        s, known, d = self.section, self.stiffness, self.layout.design
        K = np.where(np.isnan(known), ladder.evaluate(s, "section").stiffness, known)
        load, give = d.rating.overload_force, self.layout.stop_give
        with np.errstate(invalid="ignore", divide="ignore"):
            closing = np.minimum(self.gaps / tip_compliance(s, K, self.arm), load)
            forwards = closing + stress_share(s, K, self.arm, give) * (load - closing)
            backwards = back_share(s, K, self.arm, give) * (load - closing)
            stress = strain.stress_beyond_the_fit(s, np.maximum(forwards, backwards))
        share = stress / d.material.yield_strength
        return np.where(share < CUT, share, CUT)  # not a number where there is no hinge


BLOCK = 2000  # rows of one program: below that a call's own cost, above it the solver's growth, tells


def resting_plane(points: Array, heights: Array) -> Array:
    """The plane that rests on points, pressed down in the middle of them.

    Parameters
    ----------
    points
        (n, 2) places of the points, mm; the pressing force goes through their origin.
    heights
        (arrays, n) heights of the points, mm.

    Returns
    -------
    Array
        (arrays, 3): height at the origin and slopes along both axes, so that the plane is nowhere below a
        point and as low at the origin as it can be; of planes that rock over two points, the one that is
        nowhere far above any.
    """
    n = len(points)
    plane = np.column_stack([np.ones(n), points])
    most = np.ones((n, 1))  # the largest distance over a point, which only decides between equals
    design = np.vstack([np.hstack([-plane, 0.0 * most]), np.hstack([plane, -most])])
    free = (None, None)
    limits = np.hstack([-heights, heights])
    return _blocks(design, limits, [1.0, 0.0, 0.0, ROCKING], [free, free, free, free])[:, :3]


ROCKING = 1e-3


def nearest_pose(points: Array, heights: Array, play: Array) -> Array:
    """Pose of a rigid body whose points are to meet given heights, each within its own play.

    Parameters
    ----------
    points
        (n, 2) places of the points, mm.
    heights
        (arrays, n) heights to meet, mm.
    play
        (arrays, n) by how much each may miss its height, either way, mm.

    Returns
    -------
    Array
        (arrays, 4): height at the origin, slopes along both axes, and by how much the worst point misses
        beyond its play; that is least, and 0 where all meet. Where the points leave a choice, it is level.
    """
    n = len(points)
    plane = np.column_stack([np.ones(n), points])
    miss, none = -np.ones((n, 1)), np.zeros((n, 2))
    slopes, off = np.eye(3)[1:], -np.eye(2)
    design = np.vstack(
        [
            np.hstack([plane, miss, none]),
            np.hstack([-plane, miss, none]),
            np.hstack([slopes, np.zeros((2, 1)), off]),
            np.hstack([-slopes, np.zeros((2, 1)), off]),
        ]
    )
    limits = np.hstack([heights + play, play - heights, np.zeros((len(heights), 4))])
    free, more = (None, None), (0.0, None)
    cost = [0.0, 0.0, 0.0, 1.0, LEVEL, LEVEL]
    return _blocks(design, limits, cost, [free, free, free, more, more, more])[:, :4]


# Weight of a slope off level, mm for each mm/mm: beside what misses it only decides between equals.
LEVEL = 1e-2


def _blocks(design: Array, limits: Array, cost: list[float], bounds: list[tuple]) -> Array:
    """Solutions x of: least cost x with design x <= limits, for every row of `limits`."""
    at_once = max(1, BLOCK // len(design))
    solved = []
    scale = max(
        float(np.abs(limits).max()), 1e-9
    )  # solvers' own tolerances are 1e-7: micrometres become ones
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
