"""Parts that are taken as rigid, and how much they bend: a line for each part and load, of the array and its
rigs.

Beams and round plates (mechanics.bending) on simple supports, unless a line states others; real parts mostly
bend less. Bought parts are left out, since their makers state their stiffness.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from tactcad.design.tree import Design
from tactcad.mechanics.statics import Beam

from ..language.finding import Severity
from . import seating
from .layout import Layout
from .seating import carrier_beam, carrier_opens
from .stop_give import SHARE

# Share that one load may take of the pads' tolerance, of a calibration step, of the allowed tilt. A tenth
# adds 0.5 % in root sum of squares, so that a dozen together add less than a tenth.
TENTH = 0.1
# Relative excess that is still rounding: sums of the same numbers in another order.
ROUNDING = 1e-9


@dataclass(frozen=True)
class Deflection:
    """One part under one load.

    scene       its scene with this load
    part, model the bending part, and its model
    load        N, and `origin`, why so much
    gives       um; negative if that closes a gap
    allowed     um, and `why`
    fields      paths of the design's fields that make it bend less, the most useful first
    severity    `flag`: the array works, but its builder or user must know
    """

    scene: str
    part: str
    model: str
    load: float
    origin: str
    gives: float
    allowed: float
    why: str
    fields: tuple[str, ...]
    severity: Severity = "fail"

    @property
    def too_much(self) -> bool:
        return self.gives > self.allowed * (1.0 + ROUNDING)

    def __str__(self) -> str:
        return (
            f"{self.scene}: {self.part} gives way by {self.gives:.3g} um under {self.load:.3g} N "
            f"({self.origin}), "
            f"{self.model}; allowed are {self.allowed:.3g} um, {self.why}"
        )


# A scene's part of the stiffness table; the design must keep its rules.
Lines = Callable[[Any], Iterator[Deflection]]


def pads_plane(design: Design) -> tuple[float, str]:
    """Allowed displacement of pads against each other by one load, um, and why."""
    return 1e3 * TENTH * design.tolerance.pad_height, "a tenth of tolerance.pad_height"


def array_lines(design: Design) -> Iterator[Deflection]:
    layout = Layout(design)
    yield from _stop_lines(layout)
    force = design.rating.overload_force
    origin = "rating.overload_force"
    alloy = carrier_beam(layout, 1.0)
    z0, z1 = layout.end_plate_z
    span, thickness = 2 * layout.carrier_screw_x, design.clamp.end_plate_thickness
    plate = Beam(span, thickness, z1 - z0, alloy.youngs_modulus, alloy.poisson).supported()
    stack = seating.stack_beam(layout).supported_evenly()
    height = "tolerance.pad_height"
    # nothing is measured during an overload, and the stop's gap is independent of the end plates: flagged
    model, where = "between the carrier's screws, load in the middle", f"{origin}, all on one end"
    plane, fields = pads_plane(design), ("clamp.end_plate_thickness", height, origin)
    yield Deflection("array", "end plate", model, force, where, 1e3 * force * plate, *plane, fields, "flag")
    model, where = "between the end plates, load spread; clamped as one", f"{origin}, on all pads"
    part, fields = "stack of elements", ("element.rear_height", height, origin)
    yield Deflection("array", part, model, force, where, 1e3 * force * stack, *plane, fields, "flag")
    screw = seating.force(layout)
    load = 2 * screw * len(layout.hold_down_y)
    turned = f"{screw:.0f} N of each set screw at {seating.torque(layout):g} N m"
    bow = 1e3 * seating.BOW * design.tolerance.pad_height
    why = "half of tolerance.pad_height: the pads' error an eighth larger"
    model = "between the end plates, pressed under each set screw"
    gives = 1e3 * screw * seating.stack_bow(layout)
    yield Deflection("array", "stack of elements", model, load, turned, gives, bow, why, (height,))
    model = "between the end plates, pressed at each set screw"
    gives = 1e3 * screw * seating.carrier_bow(layout)
    flat, why = 1e3 * seating.FLAT, "as flat as the plate that it is screwed on"
    thicker = ("clamp.carrier_thickness",)
    yield Deflection("array", "carrier", model, load, turned, gives, flat, why, thicker)


def _stop_lines(layout: Layout) -> Iterator[Deflection]:
    """Deflections between arm and stop, for the arm with the least allowance."""
    from .stop_gap import stop_limits

    held = carrier_beam(layout, 2 * layout.end_plate_y).supported()
    force_field = "rating.overload_force"
    plate, carrier = ("clamp.stop_plate_thickness", force_field), ("clamp.carrier_thickness", force_field)
    cases: tuple[tuple[str, str, Callable[[Layout, float], float], tuple[str, ...], Severity], ...] = (
        (
            "stop plate",
            "strip between rows of set screws, plate between pairs",
            lambda layout, y: layout.stop_give,
            plate,
            "fail",
        ),
        ("carrier", "held by its threads in the middle", carrier_opens, carrier, "fail"),
        ("carrier", "the array held by its end plates alone", lambda layout, y: held, carrier, "flag"),
    )
    arms = []
    for p, gap in zip(layout.elements, stop_limits(layout, give=0.0).gap.tolist()):
        most = 1e3 * SHARE * max(gap, 1e-9)  # of a zero allowance, any share is passed
        arms.append((p.y, layout.design.rating.overload_force * p.load_arm / p.arm, most))
    for part, model, give, fields, severity in cases:
        share, force, allowed = max((give(layout, y) * f * 1e3 / most, f, most) for y, f, most in arms)
        where, why = f"{force_field} on one arm, at its tip", "a tenth of the stop's gap"
        gives = share * allowed
        yield Deflection("array", part, model, force, where, gives, allowed, why, fields, severity)
