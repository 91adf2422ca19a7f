"""Candidates: arrays of a few kinds of element, many at a time, with what each of them can do.

A candidate is a row of whole numbers: for each kind an arm (steps of ARM mm), a hinge's thickness (steps of
THICKNESS mm) and a count; then the slot's length and its fillet's radius, which all share. Steps are as fine
as a drawing states and a shop's wire can cut. In a candidate's design the kinds are spread over the rows so
that different ones are neighbours.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from math import ceil, inf
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tactcad.circuit.element_signals import smallest_output
from tactcad.contact.stated_errors import LINEAR_REACH
from tactcad.design.load import paths
from tactcad.design.materials import ALLOYS, Alloy
from tactcad.design.tree import Design, Hinge, SheetMaterial
from tactcad.lab.pads import places
from tactcad.mechanics import as_built, ladder, strength, validity
from tactcad.mechanics.section import Array, HingeSection
from tactcad.mechanics.strength import largest_closing_force, tip_compliance
from tactcad.parts.array.clamp import array_width
from tactcad.parts.array.hinge_section import design_alloy, design_readout, hinge_section
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.stop_gap import STEP_MM, land_room, seat
from tactcad.parts.bought.electronic_parts import converter_of
from tactcad.parts.language.finding import SAME

from .interval import bounds, motion
from .knowledge import Elements, Knowledge, elements, knowledge, reading_noise
from .target import ARM, THICKNESS, Target

SLOT, RADIUS = 0.02, 0.01  # mm, steps
LEAST_STEPS = 4  # of a calibration: one more than a line needs
PLAIN = 6.0  # mm, any arm, for quantities that do not depend on it
POINTS = 3  # of the object's range, by logarithm, that decide: its ends and middle
# A stop stays open by so much at the largest force, beyond its tolerances, mm; chosen: four steps of its gap.
AIR = 0.02


@dataclass(frozen=True)
class Searched:
    """A searched parameter: a whole number of steps, for every kind of element or `shared` by all; `field`:
    its field of the design file."""

    name: str
    field: str
    step: float
    shared: bool = False


# In the order of a candidate's numbers, those of a kind together.
SEARCHED = (
    Searched("arm", "array.row_arms", ARM),
    Searched("thickness", "element.hinge_thickness", THICKNESS),
    Searched("count", "array.row_arms", 1.0),
    Searched("slot", "element.hinge_length", SLOT, shared=True),
    Searched("radius", "element.fillet_radius", RADIUS, shared=True),
)


@dataclass(frozen=True)
class Stand:
    """One choice of the parameters that are not searched: sheet, alloy, hinge tolerance and number of kinds.

    base      the target's base design with sheet, alloy, tolerance, pitch, forces and rows set
    pattern   how kinds are spread over the rows: 0 evenly, else a random order
    springs   whether a body counts as a spring under each pad, for a first guess
    tried     numbers of the poses on a body at which a candidate is tried; none for all of them
    """

    target: Target
    base: Design
    kinds: int
    pattern: int = 0
    springs: bool = False
    tried: tuple[int, ...] = ()

    @property
    def on_layer(self) -> bool:
        return self.target.on_layer and not self.springs

    @cached_property
    def layout(self) -> Layout:
        return Layout(self.base)

    @cached_property
    def alloy(self) -> Alloy:
        return design_alloy(self.base)

    @cached_property
    def noise(self) -> float:
        return reading_noise(self.base)

    @cached_property
    def points(self) -> Array:
        """K_obj that decide, (points, 1, 1)."""
        return np.geomspace(*self.target.stiffness_range, POINTS)[:, np.newaxis, np.newaxis]

    @cached_property
    def widths(self) -> Array:
        """Width of the array along the rows, mm, by the number of elements in the longer row, from 0 on."""
        most = int(self.target.room.elements[1]) // self.target.room.rows + 1
        return np.array([0.0, *(array_width(_with_rows(self.base, n)) for n in range(1, most + 1))])

    @cached_property
    def _places(self) -> dict[tuple[int, ...], tuple[Array, Array]]:
        return {}

    def places(self, rows: tuple[int, ...]) -> tuple[Array, Array]:
        """x and y of the pads of so many elements a row, mm."""
        if rows not in self._places:
            array = replace(self.base.array, row_arms=tuple((PLAIN,) * n for n in rows if n))
            self._places[rows] = places(Layout(replace(self.base, array=array)))
        return self._places[rows]

    @property
    def in_a_row(self) -> int:
        """Elements in the longer row of the largest array allowed; more violate room.elements alone."""
        return ceil(self.target.room.elements[1] / self.target.room.rows)

    @cached_property
    def most(self) -> int:
        """Elements that the room takes."""
        room = self.target.room
        return min(int(room.elements[1]), room.rows * (int((self.widths <= room.width + SAME).sum()) - 1))

    @cached_property
    def fullest(self) -> Layout:
        """A row of as many elements as the room takes in each."""
        return _with_rows(self.base, max(self.most // self.target.room.rows, 1))

    @cached_property
    def smallest_output(self) -> float:
        """Smallest output that the read-out resolves, V, with all elements that the room takes."""
        return smallest_output(self.fullest)

    @cached_property
    def limits(self) -> tuple[Array, Array]:
        """Least and largest of each whole number of a candidate."""
        wish, e = self.target.elements, self.base.element
        longest = max(p.arm + p.hinge.l / 2 for p in self.layout.elements)
        room = (self.target.room.length / 2 - (self.layout.carrier_length / 2 - longest)) / ARM
        # at least the number asked for, so that a too narrow room is the limit reported
        searched = max(self.most, int(self.target.room.elements[0]))
        low = [ceil(wish.arms[0] / ARM - 1e-9), ceil(wish.hinges[0] / THICKNESS - 1e-9), wish.of_a_kind]
        high = [
            int(min(wish.arms[1] / ARM + 1e-9, room)),
            int(wish.hinges[1] / THICKNESS + 1e-9),
            max(searched - (self.kinds - 1) * wish.of_a_kind, wish.of_a_kind),
        ]
        radius = ceil(e.corner_radius / 2 / RADIUS - 1e-9)
        slot = (ceil(max(2 * radius * RADIUS, self.base.gauge.grid_length) / SLOT), e.hinge_length * 2 / SLOT)
        both = [slot[0], radius], [int(max(slot)), int(max(e.fillet_radius * 2 / RADIUS, radius))]
        return np.array(low * self.kinds + both[0]), np.array(high * self.kinds + both[1])

    def candidates(self, rows: Array) -> Candidates:
        """Candidates of whole numbers, (candidates, numbers)."""
        own, shared = ([s for s in SEARCHED if s.shared == alike] for alike in (False, True))
        of_kinds, of_all = np.split(np.rint(rows), [len(own) * self.kinds], axis=1)
        of_kinds = of_kinds.reshape(len(rows), self.kinds, len(own))
        values = {s.name: of_kinds[..., i] * s.step for i, s in enumerate(own)}
        values |= {s.name: of_all[:, i] * s.step for i, s in enumerate(shared)}
        values["radius"] = np.minimum(values["radius"], values["slot"] / 2)
        if self.on_layer:
            from .on_layer import CandidatesOnLayer

            return CandidatesOnLayer(self, **values)
        return Candidates(self, **values)


SIZES: dict[str, Callable[[Layout], float]] = {
    "length": lambda layout: layout.carrier_length,
    "width": array_width,
    "height": lambda layout: (
        layout.design.element.pad_height + layout.carrier_bottom + layout.design.clamp.carrier_thickness
    ),
}


def _with_rows(d: Design, elements: int) -> Layout:
    return Layout(replace(d, array=replace(d.array, row_arms=((PLAIN,) * elements,))))


def stands(target: Target) -> list[Stand]:
    """Every choice of the parameters that are not searched."""
    stock = target.stock
    choices = stock.sheets, stock.alloys, stock.hinge_tolerances, stock.gauges, stock.powers
    bases = [_base(target, *choice) for choice in product(*choices)]
    return [Stand(target, base, kinds) for base in bases for kinds in range(2, target.elements.kinds + 1)]


def _base(target: Target, sheet: float, alloy: str, tolerance: float, gauge: float, power: str) -> Design:
    d = target.base
    spacer = Layout(d).spacer
    pitch = max(target.room.pitch, round(sheet + spacer, 6))
    own = d.material if alloy == d.material.alloy else SheetMaterial(alloy, *_values(alloy))
    spread = d.tolerance.youngs_modulus if own is d.material else ALLOYS[alloy].spread["youngs_modulus"]
    rows = tuple((PLAIN,) for _ in range(target.room.rows))
    across = max(target.room.pitch, d.array.row_pitch) if target.room.rows > 1 else d.array.row_pitch
    return replace(
        d,
        material=own,
        sheet=replace(d.sheet, thickness=sheet),
        array=replace(d.array, pitch=pitch, row_pitch=across, spacer=round(pitch - sheet, 6), row_arms=rows),
        element=replace(d.element, override={}),
        tolerance=replace(d.tolerance, hinge_thickness=tolerance, youngs_modulus=spread),
        gauge=replace(d.gauge, resistance=gauge),
        readout=replace(d.readout, power=power),
        rating=replace(d.rating, overload_force=target.grasp.overload),
        stop=replace(d.stop, gaps=None),
    )


def _values(alloy: str) -> list:
    row = vars(ALLOYS[alloy])
    return [row[name] for name in list(SheetMaterial.__dataclass_fields__)[1:]]


@dataclass(frozen=True)
class Candidates:
    """Many candidates of one stand: arm, thickness and count (candidates, kinds), slot and radius
    (candidates,); mm."""

    stand: Stand
    arm: Array
    thickness: Array
    count: Array
    slot: Array
    radius: Array

    @cached_property
    def decided_by(self) -> dict[int, tuple[int, ...]]:
        """Numbers of the poses on a body that decide a candidate, by its row, of those that were tried."""
        return {}

    @cached_property
    def layout(self) -> Layout:
        """Layout of all candidates at once, with one element of each kind."""
        d = self.stand.base
        slot: Any = {"hinge_length": self.slot, "fillet_radius": self.radius}
        arms: Any = (tuple(self.arm.T),)
        thickness: Any = dict(enumerate(self.thickness.T, start=1))
        override = {number: Hinge(hinge_thickness=t) for number, t in thickness.items()}
        element = replace(d.element, **slot, override=override)
        return Layout(replace(d, array=replace(d.array, row_arms=arms), element=element))

    @cached_property
    def section(self) -> HingeSection:
        return hinge_section(self.layout, self.layout.elements)

    @cached_property
    def elements(self) -> Elements:
        return elements(self.section, self.stand.base)

    @cached_property
    def total(self) -> Array:
        """Elements of each candidate."""
        return self.count.sum(axis=1)

    @cached_property
    def yield_force(self) -> Array:
        """Force at the pad at which the fillet yields, N."""
        return strength.yield_force_where_known(self.section, self.stand.alloy)

    @cached_property
    def rated_deflection(self) -> Array:
        return strength.rated_deflection(self.yield_force, self.elements.stiffness, self.stand.base.rating)

    @cached_property
    def borne(self) -> Array:
        """Steps of a calibration that every hinge bears, of those that the base design makes, not rounded,
        (candidates, 1)."""
        rig = self.stand.base.calibration
        if rig is None:
            return np.zeros((len(self.arm), 1))
        soft = 1.0 + self.elements.stiffness / rig.load_cell_stiffness
        bears = (self.rated_deflection - AIR) * soft / rig.step
        # the second never binds on soft cells
        most = min(rig.travel / rig.step, rig.load_cell_range / rig.step)
        full = self.elements.stiffness / soft * rig.step  # N a step
        bears = np.minimum(bears, rig.load_cell_range / full)
        return np.clip(bears.min(axis=1, keepdims=True), 0.0, most)

    @property
    def steps(self) -> Array:
        """Steps of a calibration, (candidates, 1)."""
        return np.floor(self.borne + 1e-9)

    @cached_property
    def known(self) -> Knowledge:
        """Errors of the elements."""
        s = self.stand
        return knowledge(s.target, s.base, self.elements, np.maximum(self.steps, LEAST_STEPS))

    def feel(self) -> tuple[Array, Array, Array]:
        """Largest relative half-width over the object's range, largest force of each kind, N, and how deep
        pads press into a body, of every candidate."""
        s = self.stand
        grip = s.target.grasp
        got = bounds(self.elements, self.count, self.known, s.points, s.noise, grip.force, grip.loads)
        width = got.half_width(s.points[..., 0]).max(axis=0)
        largest = motion(self.elements, self.count, s.points, grip.force, grip.loads).largest
        return width, largest.max(axis=0), np.zeros(len(self.arm))

    @cached_property
    def felt(self) -> tuple[Array, Array, Array]:
        return self.feel()

    @property
    def half_width(self) -> Array:
        """Largest relative half-width over the object's range."""
        return self.felt[0]

    @property
    def largest_force(self) -> Array:
        """Largest force of each kind over the object's range, N."""
        return self.felt[1]

    @cached_property
    def of_kinds(self) -> dict[str, Array]:
        """Relative excess of each kind over each limit of forces, (candidates, kinds)."""
        s, e = self.stand, self.elements
        grip, d = s.target.grasp, s.base
        tip = tip_compliance(self.section, e.stiffness, self.arm)
        rated = self.yield_force / d.rating.deflection_factor
        overload = d.rating.overload_force
        closing = largest_closing_force(
            self.section, e.stiffness, self.arm, s.fullest.stop_give, overload, rated
        )
        closing = np.minimum(closing * tip, land_room(s.layout, s.layout.common_hinge))
        least_gap = closing - 2.0 * d.stop.tolerance - 2.0 * seat(s.layout) - STEP_MM - AIR / 2
        # at its lower limit a hinge bears less, about as t^2, and deflects more, about as t^-3
        thin = d.tolerance.hinge_thickness / self.thickness
        strong = d.rating.yield_factor * (1.0 + 2.5 * thin)
        soft = tip * (1.0 + 3.5 * thin)
        volts, full = (
            e.signal * self.largest_force / e.stiffness,
            inf,
        )  # a converter's gain follows the signal
        if converter_of(d) is None:
            readout = design_readout(d)
            full = min(readout.highest, -readout.lowest)
        return {
            "grasp.element_force": self.largest_force / grip.element_force - 1.0,
            "strength": self.largest_force * strong / self.yield_force - 1.0,
            "stop": self.largest_force * soft / np.maximum(least_gap, 1e-6) - 1.0,
            "readout": volts / full - 1.0,
        }

    @cached_property
    def misses(self) -> dict[str, Array]:
        """Relative excess of each candidate over each limit; 0 and below where the limit is kept."""
        return {
            **{name: miss.max(axis=1) for name, miss in self.of_kinds.items()},
            **self._resolution,
            **self.of_shape,
            **({"grasp.force": self.felt[2] / LINEAR_REACH - 1.0} if self.stand.on_layer else {}),
        }

    @property
    def of_shape(self) -> dict[str, Array]:
        """Misses that do not depend on force."""
        s, room = self.stand, self.stand.target.room
        length: Any = self.layout.carrier_length
        lacking = LEAST_STEPS / np.maximum(self.steps[:, 0], 0.1) - 1.0
        return {
            "room.elements": np.maximum(self.total / room.elements[1], room.elements[0] / self.total) - 1.0,
            "room.width": s.widths[np.minimum(self.in_a_row, s.in_a_row)] / room.width - 1.0,
            "room.length": length / room.length - 1.0,
            "room.height": np.full(len(self.arm), SIZES["height"](s.layout) / room.height - 1.0),
            "calibration": np.where(s.target.known.how == "calibrated", lacking, -1.0),
        }

    @property
    def _resolution(self) -> dict[str, Array]:
        wish = self.stand.base.readout.force_resolution
        if wish is None:
            return {}
        told = 1e3 * self.stand.smallest_output / self.elements.per_force  # mN
        return {"readout.force_resolution": (told / wish - 1.0).max(axis=1)}

    @cached_property
    def violation(self) -> Array:
        """Sum of all excesses over limits; inf if the estimator does not reach."""
        total = sum(np.maximum(v, 0.0) for v in self.misses.values())
        known = np.isfinite(self.elements.stiffness).all(axis=1) & np.isfinite(self.half_width)
        return np.where(known & self.known_as_made & np.isfinite(total), total, np.inf)

    @property
    def at_limits(self) -> Iterator[HingeSection]:
        """Elements at either end of their tolerances. What bounds the estimator are ratios to the hinge's
        thickness, so the ends are where thickness and all else part most."""
        s, t = self.section, self.stand.base.tolerance
        for sign, layer in ((-1.0, t.recast_layer), (1.0, 0.0)):
            off = {p: getattr(s, p) - sign * getattr(t, name) for name, p in as_built.DIMENSIONS.items()}
            off["hinge_thickness"] = s.hinge_thickness + sign * t.hinge_thickness
            left = as_built.without_layer(s.with_(**off), layer)
            yield left.with_(fillet_radius=np.minimum(left.fillet_radius, left.hinge_length / 2.0))

    @cached_property
    def known_as_made(self) -> NDArray[np.bool_]:
        """Whether the estimator reaches elements at either end of their tolerances too."""
        rung = ladder.DEFAULT_RUNG
        return np.all([(validity.reasons(s, rung) == "").all(axis=1) for s in self.at_limits], axis=0)

    @cached_property
    def out_of_range(self) -> tuple[str, ...]:
        """Why the estimator does not reach the first candidate's elements, as drawn or as made."""
        some = [validity.reasons(s, ladder.DEFAULT_RUNG)[0] for s in (self.section, *self.at_limits)]
        return tuple(dict.fromkeys(str(why) for row in some for why in row if why))

    @property
    def in_a_row(self) -> NDArray[np.int_]:
        """Elements of the longer row."""
        return np.ceil(self.total / self.stand.target.room.rows).astype(int)

    @cached_property
    def area(self) -> Array:
        """Area of the array from above, mm2."""
        widths = self.stand.widths
        return self.layout.carrier_length * widths[np.minimum(self.in_a_row, len(widths) - 1)]

    @cached_property
    def cut(self) -> Array:
        """Wire path around all elements, mm: each taken as long as the one with the longest arm and the
        base's rear."""
        d = self.stand.base.element
        around = 2.0 * (self.arm.max(axis=1) + self.slot + d.seat_length + d.rear_length + d.rear_height)
        return self.total * around

    @cached_property
    def different(self) -> Array:
        """Number of different elements."""
        code = np.sort(np.rint(self.arm / ARM) * 1e4 + np.rint(self.thickness / THICKNESS), axis=1)
        return 1.0 + (np.diff(code, axis=1) > 0).sum(axis=1)


def order(count: list[int], rows: int, pattern: int = 0) -> list[list[int]]:
    """Kind of every place, row by row: each kind spread evenly along both rows, or by `pattern`, a seed.

    A pair at the same spot of the object gives the best ratio, so the next place goes to the kind furthest
    behind its share.
    """
    total = sum(count)
    dealt = [0] * len(count)
    dealing: list[int] = []
    for n in range(1, total + 1):
        lag = [count[k] * n / total - dealt[k] if dealt[k] < count[k] else -np.inf for k in range(len(count))]
        kind = int(np.argmax(lag))
        dealt[kind] += 1
        dealing.append(kind)
    if pattern:
        dealing = np.random.default_rng(pattern).permutation(dealing).tolist()
    first = ceil(total / rows)
    return [dealing[:first], dealing[first:][::-1]][:rows]


def dealt(c: Candidates) -> list[list[int]]:
    """Kind of every place of one candidate (the first), row by row."""
    return order([int(n) for n in c.count[0]], c.stand.target.room.rows, c.stand.pattern)


def realised(c: Candidates) -> Design:
    """The design of one candidate (the first); [element]'s hinge is the first kind's, others override."""
    d, grip = c.stand.base, c.stand.target.grasp
    kinds = dealt(c)
    arms = [round(round(a / ARM) * ARM, 6) for a in c.arm[0]]
    thick = [round(round(t / THICKNESS) * THICKNESS, 6) for t in c.thickness[0]]
    numbered = [k for row in kinds for k in row]
    override = {
        n: Hinge(hinge_thickness=thick[k]) for n, k in enumerate(numbered, start=1) if thick[k] != thick[0]
    }
    force = float(c.largest_force[0].max())
    rating = ceil(force * 100) / 100 if np.isfinite(force) else grip.force
    calibration = d.calibration
    if calibration is not None and c.steps[0, 0] >= 1:
        calibration = replace(calibration, travel=round(float(c.steps[0, 0]) * calibration.step, 6))
    slot: Any = {"hinge_length": round(float(c.slot[0]), 6), "fillet_radius": round(float(c.radius[0]), 6)}
    made = replace(
        d,
        array=replace(d.array, row_arms=tuple(tuple(arms[k] for k in row) for row in kinds)),
        element=replace(d.element, hinge_thickness=thick[0], override=override, **slot),
        rating=replace(d.rating, force=rating),
        calibration=calibration,
    )
    known = paths(made)  # the base design may say where values are from that this one lacks
    return replace(made, origin={path: text for path, text in made.origin.items() if path in known})


def origins(base: Design, made: Design, binding: str) -> dict[str, str]:
    """Origin of every value that differs from the base design's, by its path."""
    before, after = paths(base), paths(made)
    told = {s.field: f"synthesised from a target, on {base.name}; {binding}" for s in SEARCHED}
    told |= {
        "design.name": "chosen: the target's",
        "design.title": "chosen: the target's",
        "design.revision": "chosen: first issue",
        "array.pitch": "synthesised: at least the target's pitch, the sheet's and a spacer's thickness",
        "array.row_pitch": "synthesised: at least the target's pitch",
        "array.spacer": "derived: pitch less sheet",
        "rating.force": "synthesised: largest force on one element over the object's range",
        "rating.overload_force": "chosen: the target's overload",
        "calibration.travel": "synthesised: what every hinge bears",
        "sheet.thickness": "chosen: of the target's stock",
        "tolerance.hinge_thickness": "chosen: of the target's stock",
        "gauge.resistance": "chosen: of the target's stock",
        "readout.power": "chosen: of the target's stock",
        "tolerance.youngs_modulus": "chosen: the material's row",
    }
    told |= {path: "chosen: of the target's stock" for path in after if path.startswith("material.")}
    changed = {path for path, value in after.items() if before.get(path) != value}
    always = {"design.name", "design.title", "design.revision", *(s.field for s in SEARCHED)}
    by_element = "synthesised: the other kind of element, as element.hinge_thickness"
    return {p: told.get(p, by_element) for p, v in after.items() if v is not None and p in changed | always}
