"""The places of all parts of the array, derived once from the design.

Frame (mm): x from the middle line between the rows along row one's arms, y along the row, z = 0 on
the elements' flat (gauge) face, + away from the object. Row two is row one's kind of row turned by
180 degrees about z, so every x below is a distance from the middle line and holds for both.

Dimensions along x also accept arrays in place of the design's numbers (sweep's `with_value`, a synthesis's
candidates): then they are those of many designs at once.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, reduce

from tactcad.design.text_values import filling_radius
from tactcad.design.tree import Design

from ..bought.screws import SET_SCREW_LENGTHS
from ..language.metric import METRIC, counterbore_diameter, tapped_depth
from .stop_give import SHARE, StopPlate, derived_pitch, stop_plate_beams

# Least gap between parts that must not touch, in mm; chosen: about a hair.
LEAST_GAP = 0.1
# Least material between a carrier screw's hole and the heads below it; chosen: a third of an M3.
END_PLATE_WEB = 1.0
# Set screws end this far below the carrier's top, so that the axis's plate lies flat on it.
SUNK = 1.0
# Distance of set screws from rear bodies and end plates; chosen: more than their threads' play in the
# carrier.
BESIDE_SET_SCREW = 0.3
# Least material between holes of a plate: feasible in metal, where 0.8 is advised and less is flagged
# (vendors' guides, see checks/data/shop.toml).
HOLE_WEB = 0.5
# Least lever of contacts that fix a rotation, over half the body's diagonal across its axis; for a
# translation, the share left besides coupled rotations. Chosen: a foot of a tenth of its height rocks.
LEVER = 0.1
# Least material to the carrier's edge; chosen: as END_PLATE_WEB.
CARRIER_EDGE = 1.0


def rounded(value: float, digits: int) -> float:
    """`round` for a number or an array."""
    return round(value, digits) if isinstance(value, (int, float)) else value.round(digits)


def larger(a: float, b: float) -> float:
    """The larger of two numbers, or of two arrays place by place."""
    return a * (a >= b) + b * (a < b)


@dataclass(frozen=True)
class HingeShape:
    """One element's hinge and arm (mm): thickness t, slot length l, fillet radius r, arm height h.

    A radius that is half the slot to nine digits is made just that.
    """

    t: float
    l: float
    r: float
    h: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "r", filling_radius(self.r, self.l))


@dataclass(frozen=True)
class ElementPlace:
    """One element of the array. number counts from 1 as in Table 1; row is 1 or 2, index counts from 0
    along it; y is its mid-plane."""

    number: int
    row: int
    index: int
    y: float
    arm: float
    hinge: HingeShape
    hinge_x: float
    load_arm: float
    body_length: float

    @property
    def designator(self) -> str:
        return f"E{self.number}"


@dataclass(frozen=True)
class HoldDown:
    """Set screw length (None: no standard one reaches), and the gap it spans from stop plate to carrier."""

    length: float | None
    reach: float


@dataclass(frozen=True, eq=False)  # one layout equals itself alone, so that it can be a cache's key
class Layout:
    """The array's derived dimensions, mm.

    Parameters
    ----------
    design
        A design as read; the rules between its fields are computed from this.
    """

    design: Design

    @cached_property
    def pad_inner(self) -> float:
        """x of the arms' tips and of the pads' inner edges: half the gap between facing pads."""
        return (self.design.array.row_pitch - self.design.element.pad_length) / 2

    @property
    def pad_outer(self) -> float:
        return self.pad_inner + self.design.element.pad_length

    @cached_property
    def elements(self) -> tuple[ElementPlace, ...]:
        """Every element, by number."""
        return tuple(
            ElementPlace(
                number=number,
                row=row,
                index=index,
                y=self.position_y(index),
                arm=arm,
                hinge=hinge,
                hinge_x=self.pad_inner + arm,
                load_arm=arm - self.design.element.pad_length / 2,
                body_length=rounded(self.clamp_edge - (self.pad_inner + arm) - hinge.l / 2, 9),
            )
            for number, row, index, arm, hinge in self._arms
        )

    @cached_property
    def _arms(self) -> tuple[tuple[int, int, int, float, HingeShape], ...]:
        """Number, row, index, arm and hinge of every element."""
        rows = enumerate(self.design.array.row_arms, start=1)
        arms = [(row, index, arm) for row, arms in rows for index, arm in enumerate(arms)]
        return tuple((n, *arm, self.hinge_of(n)) for n, arm in enumerate(arms, start=1))

    @property
    def common_hinge(self) -> HingeShape:
        """[element]'s hinge, of every element without an override."""
        e = self.design.element
        return HingeShape(t=e.hinge_thickness, l=e.hinge_length, r=e.fillet_radius, h=e.arm_height)

    def hinge_of(self, number: int) -> HingeShape:
        """[element]'s hinge, with what [element.override.NUMBER] changes."""
        own = self.design.element.override.get(number)
        if own is None:
            return self.common_hinge
        given = {"t": own.hinge_thickness, "l": own.hinge_length, "r": own.fillet_radius, "h": own.arm_height}
        return replace(self.common_hinge, **{k: v for k, v in given.items() if v is not None})

    @cached_property
    def clamp_edge(self) -> float:
        """x where spacers and rear bodies begin, one line for all arms: the longest arm's seat behind its
        slot."""
        ends = [self.pad_inner + arm + hinge.l / 2 for *_, arm, hinge in self._arms]
        # rounded to a nanometre, so that one decimal design does not become 11.399999999999999
        return rounded(reduce(larger, ends) + self.design.element.seat_length, 6)

    @property
    def rear_end(self) -> float:
        return rounded(self.clamp_edge + self.design.element.rear_length, 6)

    @property
    def recess_start(self) -> float:
        return round(self.clamp_edge + self.design.element.recess_offset, 6)

    @property
    def screw_x(self) -> tuple[float, ...]:
        return tuple(round(self.clamp_edge + offset, 6) for offset in self.design.holes.screw_offsets)

    @property
    def dowel_x(self) -> tuple[float, ...]:
        return tuple(round(self.clamp_edge + offset, 6) for offset in self.design.holes.dowel_offsets)

    def body_bottom(self, hinge: HingeShape) -> float:
        """z of the front body's lower face: 0, or below if a two-sided body is thicker than its arm."""
        if self.design.element.sides == "one":
            return 0.0
        return round((hinge.h - self.design.element.body_height) / 2, 9)

    def ledge_of(self, hinge: HingeShape) -> float:
        """z of the front body's upper face, on which the stop plate sits."""
        return round(self.body_bottom(hinge) + self.design.element.body_height, 9)

    @property
    def ledge(self) -> float:
        """z of the common ledge. Rule `ledges_in_one_plane` holds it equal for all elements."""
        return self.ledge_of(self.elements[0].hinge)

    # --- the stack along y ---

    @property
    def spacer(self) -> float:
        given = self.design.array.spacer
        return round(self.design.array.pitch - self.design.sheet.thickness, 9) if given is None else given

    @cached_property
    def positions(self) -> int:
        """Elements side by side in the longer row; the other row is filled up with blanks."""
        return max(len(arms) for arms in self.design.array.row_arms)

    @cached_property
    def stack(self) -> float:
        """Length of elements and spacers, one spacer outside at each end."""
        return round(self.positions * self.design.array.pitch + self.spacer, 6)

    def position_y(self, index: int) -> float:
        return round((index - (self.positions - 1) / 2) * self.design.array.pitch, 9)

    def blanks(self) -> tuple[tuple[int, int], ...]:
        """(row, index) of every place of the two rows that no element takes."""
        lengths = [len(arms) for arms in self.design.array.row_arms] + [0]
        return tuple((row, index) for row in (1, 2) for index in range(lengths[row - 1], self.positions))

    # --- plates ---

    @property
    def spacer_z(self) -> tuple[float, float]:
        c = self.design.clamp
        return (c.spacer_bottom, round(self.design.element.rear_height - c.spacer_drop, 9))

    @cached_property
    def end_plate_z(self) -> tuple[float, float]:
        c = self.design.clamp
        if c.end_plate_height is not None:
            return (c.end_plate_bottom, round(c.end_plate_bottom + c.end_plate_height, 9))
        return (c.end_plate_bottom, self.stop_plate_top + self.hold_down.reach)

    @cached_property
    def hold_down(self) -> HoldDown:
        """The shortest standard set screw that is long enough for the carrier's height."""
        c = self.design.clamp
        lowest = self.lowest_carrier
        for length in SET_SCREW_LENGTHS[c.screw]:
            reach = round(length - c.carrier_thickness + SUNK, 9)
            # decimals, kept in binary
            if self.stop_plate_top + reach >= lowest - 1e-9 and reach >= LEAST_GAP:
                return HoldDown(length, reach)
        return HoldDown(None, round(lowest - self.stop_plate_top, 9))

    @cached_property
    def lowest_carrier(self) -> float:
        """Least z of the carrier's underside: over the rear bodies, and its threads over screw heads and
        dowels."""
        c = self.design.clamp
        below = max(counterbore_diameter(c.screw), float(c.dowel)) / 2 + END_PLATE_WEB
        return max(
            self.design.holes.height + below + tapped_depth(c.screw),
            self.design.element.rear_height + LEAST_GAP,
        )

    @property
    def end_plate_half(self) -> float:
        """Half the end plate's length along x."""
        return rounded(self.rear_end + self.design.clamp.end_plate_margin, 6)

    @property
    def end_plate_y(self) -> float:
        """y of the end plate's mid-plane (the other one's is its negative)."""
        return round((self.stack + self.design.clamp.end_plate_thickness) / 2, 9)

    @property
    def stop_plate_half(self) -> float:
        """Half the stop plate's length along x."""
        return round(self.clamp_edge - self.design.clamp.stop_plate_gap, 6)

    @property
    def stop_plate_width(self) -> float:
        """The stop plate along y: inside the end plates with a gap at each end."""
        return round(self.stack - 2 * self.design.clamp.stop_plate_gap, 6)

    @property
    def stop_plate_top(self) -> float:
        return round(self.ledge + self.design.clamp.stop_plate_thickness, 9)

    @property
    def carrier_bottom(self) -> float:
        return self.end_plate_z[1]

    @property
    def carrier_screw_x(self) -> float:
        return round(self.clamp_edge + self.design.clamp.carrier_screw_offset, 6)

    @property
    def hold_down_x(self) -> float:
        """x of the set screws: as near the clamp edge as the neighbouring rear bodies allow, over every
        ledge."""
        return round(self.clamp_edge - METRIC[self.design.clamp.screw].d / 2 - BESIDE_SET_SCREW, 6)

    @cached_property
    def hold_down_pitch(self) -> float:
        """Largest distance of a row's set screws: the design's, or what the plate's bending leaves."""
        d, c = self.design, self.design.clamp
        if c.hold_down_pitch is not None:
            return c.hold_down_pitch
        # within that share of the gap's tolerance, which a gap always exceeds
        force, room = d.rating.overload_force, SHARE * d.stop.tolerance
        return derived_pitch(2 * self.stop_plate_half, c.stop_plate_thickness, c.screw, force, room)

    @property
    def beyond_screws(self) -> float:
        """Distance of the outermost elements' mid-planes beyond the last set screw, mm."""
        return max(0.0, self.position_y(self.positions - 1) - self.hold_down_y[-1])

    @cached_property
    def stop_give(self) -> float:
        """Compliance of the stop plate under one arm, mm/N."""
        return self.stop_plate_beams().one

    def stop_plate_beams(self, pitch: float | None = None) -> StopPlate:
        """The stop plate between its set screws; `pitch` (mm) replaces the largest length along the row
        without one: between two pairs, or twice the arms' distance beyond the last."""
        if pitch is None:
            y = self.hold_down_y
            pitch = max([b - a for a, b in zip(y, y[1:])] + [2 * self.beyond_screws])
        c = self.design.clamp
        plate = (2 * self.stop_plate_half, self.stop_plate_width, c.stop_plate_thickness)
        return stop_plate_beams(2 * self.hold_down_x, pitch, plate, c.screw, self.hold_down.length or 0.0)

    @cached_property
    def hold_down_y(self) -> tuple[float, ...]:
        """y of the set screws of a row: over the outermost elements or as near as the end plates allow,
        even, no further apart than allowed; one in the middle where two would run into each other."""
        d = METRIC[self.design.clamp.screw].d
        span = min((self.positions - 1) * self.design.array.pitch, self.stack - d - 2 * BESIDE_SET_SCREW)
        if span < d + HOLE_WEB:
            return (0.0,)
        count = 2
        while span / (count - 1) > self.hold_down_pitch:
            count += 1
        # by whole numbers that mirror each other, so that the rounded places do too
        return tuple(round(span * i / (2 * (count - 1)), 6) for i in range(1 - count, count, 2))

    @property
    def mount_x(self) -> float:
        """x of the carrier's threads for the axis: midway between set screws and carrier screws, to 0.5
        mm."""
        return round(self.hold_down_x + self.carrier_screw_x) / 2

    @property
    def carrier_size(self) -> tuple[float, float]:
        """Length along x, width along y."""
        return self.carrier_length, self.carrier_width

    @property
    def carrier_length(self) -> float:
        """Along x, over the end plates."""
        return rounded(2 * (self.end_plate_half + self.design.clamp.carrier_margin), 6)

    @property
    def carrier_width(self) -> float:
        """Along y, over the end plates, its own screws' heads, and the axis's threads."""
        c = self.design.clamp
        edge = 4.0  # material beyond a thread of the axis's pattern: one diameter of the usual M4
        head = counterbore_diameter(c.screw) / 2 + CARRIER_EDGE
        along_y = max(
            self.stack + 2 * c.end_plate_thickness, c.mount_pitch_y + 2 * edge, 2 * (self.end_plate_y + head)
        )
        return round(along_y, 6)
